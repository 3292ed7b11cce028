"""The joint fit of the findings: sizes solved for, shapes searched, and the intervals of both."""

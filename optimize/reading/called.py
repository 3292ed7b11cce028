"""Synonyms of the keys of a problem file, for messages that suggest a known key."""

from __future__ import annotations

from types import MappingProxyType

PROBLEM_CALLED = MappingProxyType(
    {
        "minimize": ("objective", "minimise", "goal", "target", "cost_function", "optimize"),
        "maximize": ("maximise",),
        "subject_to": ("constraints", "limits", "bounds", "constraint", "requirements"),
        "choose": ("variables", "options", "candidates", "design", "choices"),
        "load_cases": ("loads", "load_case", "payloads"),
        "workspace": ("region", "poses", "working_area"),
        "relative_to": ("calibrated", "calibration"),
    }
)
"""What people call the keys of a problem file as well."""
CHOICES_CALLED = MappingProxyType(
    {
        "section": ("shape", "shapes", "sections", "profile", "profiles", "cross_section"),
        "material": ("materials",),
        "sizes": ("stock", "size"),
        "actuator": ("drive", "drives", "actuators", "gearbox"),
        "same": ("alike", "equal"),
    }
)
"""What people call the choices as well."""

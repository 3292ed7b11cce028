"""Where a problem file lets an arm's base stand: `choose: {base: {x: [0 mm, 200 mm], z: [400 mm, 800 mm]}}`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.reading.ranges import Span
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.reading import Mapping

AXES = ("x", "y", "z")
BaseSpans = tuple[Span, Span, Span]
"""The least and the greatest x, y and z (m) of a base, against where the arm file has it; 0 and 0 where it stays."""


def read_base(choose: Mapping, arm: Arm, workspace: Workspace) -> BaseSpans | None:
    """Where the base may stand; None where that is not chosen. Raises `InputError`."""
    if not choose.has("base"):
        return None
    if not workspace.in_space:
        would_do = "give places of the tip, e.g. workspace: {points: [[400 mm, 300 mm]]}"
        raise choose.error("base", f"changes nothing for poses of the joints; {would_do}")
    spans: list[Span] = []
    with choose.mapping("base").reading() as body:
        for axis in AXES:
            span = body.range(axis, "length") if body.has(axis) else (0.0, 0.0)
            if body.has(axis) and span[0] == span[1]:
                raise body.error(axis, "has one value, so that nothing is to choose; write it into the arm file")
            if axis == "z" and arm.flat and any(span):
                raise body.error(axis, "leaves the plane in which the arm moves; leave it out")
            spans.append(span)
        if not any(map(any, spans)):
            raise body.error("", "needs a range of x, y or z, e.g. {x: [0 mm, 200 mm]}")
    return spans[0], spans[1], spans[2]


def base_in_words(spans: BaseSpans) -> Iterator[str]:
    """The ranges of a base, as people write them."""
    for axis, span in zip(AXES, spans, strict=True):
        if any(span):
            yield f"{axis} {' to '.join(format_quantity(end, 'length') for end in span)}"


def based_at(arm: Arm, base: FloatVector) -> Arm:
    """An arm whose base stands elsewhere (m) than where its file has it: its first joint's frame moves along."""
    first = arm.joints[0]
    x, y, z = (float(f"{a + b:.12g}") for a, b in zip(first.origin_translation, base, strict=True))
    return replace(arm, joints=(replace(first, origin_translation=(x, y, z), dh=None), *arm.joints[1:]))

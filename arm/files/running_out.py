"""Links that run out of a sleeve: a boom or mast whose bending length is its slide's coordinate (`bends_over`)."""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.arm.chain.chain import Joint, Link
from linkwright.core.arm.chain.vectors import add, dot, norm, scale
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import format_quantity, shown
from linkwright.core.units.reading import Mapping

_HAIR = 1e-9


def running_out(body: Mapping, joint: Joint, link: Link, number: int) -> Link:
    """A link of joint `number` (from 1) that `bends_over` its slide's coordinate. Raises `InputError` unless the joint
    is a slide along the link, which has a section and is long enough for its range."""
    named = body.text("bends_over")
    if named != f"q{number}":
        message = f"names the slide that carries the link, here q{number}, not {shown(named)}"
        raise body.error("bends_over", f"{message}; write what runs out of a sleeve as the link of its own slide")
    if joint.revolute:
        raise body.error(
            "bends_over", f"needs a slide, and joint {number} turns; write joint: {{type: prismatic, ...}}"
        )
    if joint.follows is not None:
        raise body.error("bends_over", f"needs a slide with a coordinate of its own, and joint {number} follows others")
    if link.section is None:
        raise body.error("bends_over", "needs a link that gives: write its section and material")
    if isinstance(link.section, Tapered):
        raise body.error("bends_over", "needs a section that is the same all along, not a tapered one")
    if not body.has("direction"):
        link = replace(link, direction=joint.axis)
    apart = norm(add(link.direction, scale(-1.0, joint.axis)))
    if apart > _HAIR or dot(link.direction, joint.axis) <= 0.0:
        raise body.error("bends_over", "needs a link that slides along itself: its direction must be the joint's axis")
    least, most = (end + joint.zero for end in joint.range)
    if least < -_HAIR or most > link.length + _HAIR:
        whole, low, high = (format_quantity(value, "length") for value in (link.length, least, most))
        raise body.error(
            "length",
            f"slide {number} runs out from {low} to {high}, but its boom is {whole}; write the length of the whole "
            f"boom, {high} or more, and a range from 0 mm on",
        )
    return replace(link, runs_out=True)

"""What a simulated instrument reads, from a caller's words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import InputError, shown

from .instrument import KINDS, TILT_X, Instrument, direction_along

_READ = ("position", "along", "distance", "same_point", "plane", "tilt", "bar", "camera")


def observed_by(
    observe: str,
    direction: Sequence[float] | None,
    anchor: Sequence[float] | None,
    arm: Arm,
    *,
    anchor_free: bool,
    tilt_link: str | int | None = None,
    bar: Sequence[float] | None = None,
    camera: str | None = None,
) -> dict[str, Any]:
    """The part of a plan that says what is read; `anchor` and `bar`, the places along it, in m. Raises `InputError`."""
    for name, given, kind in (
        ("direction", direction, "along"), ("anchor", anchor, "distance"), ("tilt_link", tilt_link, "tilt"),
        ("bar", bar, "bar"), ("camera", camera, "camera"),
    ):  # fmt: skip
        if given is not None and observe != kind:
            raise InputError("", name, f"goes with observe {kind}, not {shown(observe)}")
    axes = "xy" if arm.planar() else "xyz"
    if observe in ("position", axes):
        return {}
    if observe and set(observe) <= set(axes) and len(set(observe)) == len(observe):
        return {"slots": tuple(sorted("xyz".index(axis) for axis in observe)), "instrument": Instrument()}
    if observe == "along":
        if direction is None:
            raise InputError("", "direction", "is missing; write the direction of the height, e.g. 0, 0, 1")
        unit_vector = direction_along(direction)
        if unit_vector is None:
            message = f"needs three numbers of a direction that has a length, not {shown(list(direction))}"
            raise InputError("", "direction", message)
        return {"slots": KINDS["along"], "instrument": Instrument(("along",), direction=unit_vector)}
    if observe == "distance":
        if anchor is None or len(anchor) not in (2, 3):
            would_do = "where distances are measured from, e.g. 1 m, 0 m, 0.3 m"
            raise InputError("", "anchor", f"needs three lengths: {would_do}")
        x, y, z = [*anchor, 0.0][:3]
        instrument = Instrument(("distance",), anchor=(x, y, z))
        return {"slots": KINDS["distance"], "instrument": instrument, "anchor_free": anchor_free}
    if observe in ("same_point", "plane"):
        slots = KINDS[observe][:2] if arm.planar() else KINDS[observe]
        return {"slots": slots, "instrument": Instrument((observe,))}
    if observe == "tilt":
        slots = (TILT_X,) if arm.planar() else KINDS["tilt"]
        return {"slots": slots, "instrument": Instrument(("tilt",), tilt_link=_link(tilt_link, arm))}
    if observe == "camera":
        if arm.planar():
            raise InputError("", "observe", "camera needs an arm in space; of one in the plane, take position")
        if camera not in ("fixed", "on_tool"):
            raise InputError("", "camera", "needs fixed (the target is on the tool) or on_tool (the target is fixed)")
        return {"slots": KINDS["camera"], "instrument": Instrument(("camera",), camera=camera)}
    if observe == "bar":
        if bar is None or len(set(bar)) < 2:
            raise InputError("", "bar", "needs two places along the bar or more, e.g. 0 mm, 500 mm")
        slots = KINDS["bar"][:2] if arm.planar() else KINDS["bar"]
        return {"slots": slots, "instrument": Instrument(("bar",)), "bar": tuple(bar)}
    raise InputError("", "observe", f"{shown(observe)} is not one of {', '.join(_READ)} or some of {', '.join(axes)}")


def _link(tilt_link: str | int | None, arm: Arm) -> int:
    text = str(tilt_link).strip() if tilt_link is not None else ""
    if text == "base":
        return 0
    if text.isdecimal() and 1 <= int(text) <= arm.size:
        return int(text)
    raise InputError("", "tilt_link", f"needs base or the number of a link, 1 to {arm.size}, on which the level stands")

"""What an instrument is said to be: by recording.yaml, and in a caller's words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import Mapping as Reader

from .instrument import Instrument
from .registry import INSTRUMENTS, slots_of, with_setting


def read_instrument(mapping: Reader) -> Instrument | None:
    """What the settings say that a recording observes, None where they say nothing. Raises `InputError`."""
    if not mapping.has("observes"):
        _refuse_strays(mapping, ())
        return None
    kinds, of_kind = _named(mapping)
    instrument = Instrument(kinds)
    for kind in kinds:
        given = dict(INSTRUMENTS[kind].read(of_kind.get(kind, mapping)))
        given["settings"] = (*instrument.settings, *given.get("settings", ()))
        instrument = replace(instrument, **given)
        if kind in of_kind:
            of_kind[kind].close()
    _refuse_strays(mapping, kinds)
    return instrument


def _refuse_strays(mapping: Reader, kinds: Sequence[str]) -> None:
    """Refuse settings of kinds that are not observed. Raises `InputError`."""
    for name in dict.fromkeys(name for kind in INSTRUMENTS.values() for name in kind.settings if name != "bar"):
        if mapping.has(name) and not set(with_setting(name)) & set(kinds):
            kind = with_setting(name)[0]
            would_do = f"add {kind} or take it out" if kinds else "write that as well"
            raise mapping.error(name, f"goes with `observes: {kind}`; {would_do}")


def _named(mapping: Reader) -> tuple[tuple[str, ...], dict[str, Reader]]:
    """The kinds that `observes` names, and the settings of those that stand below their names. Raises `InputError`."""
    raw = mapping.raw("observes")
    of_kind: dict[str, Reader] = {}
    if isinstance(raw, dict):
        body = mapping.mapping("observes")
        names: list[object] = list(body.content)
        of_kind = {name: body.mapping(name) for name in body.content if body.has(name)}
    else:
        names = cast(list[object], raw) if isinstance(raw, list) else [raw]
    kinds: list[str] = []
    for name in names:
        if not isinstance(name, str) or name not in INSTRUMENTS:
            near = nearest(name, list(INSTRUMENTS)) if isinstance(name, str) else ""
            raise mapping.error("observes", f"{shown(name)} is not one of {', '.join(INSTRUMENTS)}{near}")
        if name in kinds:
            raise mapping.error("observes", f"names {name} twice")
        kinds.append(name)
    if not kinds:
        raise mapping.error("observes", f"names nothing; it is one or more of {', '.join(INSTRUMENTS)}")
    alone = next((kind for kind in kinds if INSTRUMENTS[kind].alone), None)
    if alone is not None and len(kinds) > 1:
        others = ", ".join(kind for kind in kinds if kind != alone)
        raise mapping.error("observes", f"has {others} beside {alone}; give the {alone} a recording of its own")
    return tuple(kinds), of_kind


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
    settings: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The part of a plan that says what is read; `anchor` and `bar`, the places along it, in m; `settings` are those of
    other kinds. Raises `InputError`."""
    words: dict[str, Any] = {
        "direction": direction, "anchor": anchor, "tilt_link": tilt_link, "bar": bar, "camera": camera,
        **(settings or {}),
    }  # fmt: skip
    for name, given in words.items():
        kinds = with_setting(name)
        if not kinds:
            known = dict.fromkeys(item for kind in INSTRUMENTS.values() for item in kind.settings)
            raise InputError("", name, f"is no setting of an instrument{nearest(name, list(known))}")
        if given is not None and observe not in kinds:
            raise InputError("", name, f"goes with observe {' or '.join(kinds)}, not {shown(observe)}")
    axes = "xy" if arm.planar() else "xyz"
    if observe in ("position", axes):
        return {}
    if observe and set(observe) <= set(axes) and len(set(observe)) == len(observe):
        return {"slots": tuple(sorted("xyz".index(axis) for axis in observe)), "instrument": Instrument()}
    if observe not in INSTRUMENTS:
        known = f"{', '.join(INSTRUMENTS)} or some of {', '.join(axes)}"
        raise InputError("", "observe", f"{shown(observe)} is not one of {known}")
    kind = INSTRUMENTS[observe]
    unsaid = dict.fromkeys(kind.settings)
    asked = kind.asked({**unsaid, **words, "anchor_free": anchor_free}, arm)
    return {"slots": slots_of(observe, flat=arm.planar()), **asked}

"""`load_cases` and `relative_to` of a problem file: what is carried, pushed and moved, and from what errors count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, Calibrated, LoadCase
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.figures import (
    Limit,
    error_of_case,
)
from linkwright.core.arm.files.branches import tip_named
from linkwright.core.arm.files.origin import read_vector
from linkwright.core.arm.files.read import read_load
from linkwright.core.optimize.exchange.cycles import moving_cases
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping


def read_load_cases(mapping: Mapping, arm: Arm) -> tuple[LoadCase, ...]:
    """Each case replaces the arm's payload wholly; a force may stand inside `payload` or beside it. Of several arms on
    one torso a case that names no `tip` is one of each tip that counts, the others with their payloads."""
    if not mapping.has("load_cases"):
        return ()
    cases: list[LoadCase] = []
    for body in mapping.mappings("load_cases"):
        with body.reading("subject_to"):
            case, named = _load_case(body)
            if body.has("motion"):
                cases += moving_cases(body, arm, case if named else replace(case, mass=arm.payload.mass))
                continue
            if body.has("tip") and not arm.branches:
                raise body.error("tip", "is of arms with branches, and this one has a single tip; leave it out")
            tips = [""]
            if body.has("tip"):
                tips = [tip_named(body, arm.branches, body.text("tip"))]
            elif arm.every_tip:
                tips = [branch.name for branch in arm.branches]
            cases += [replace(case, tip=tip, leaves_off=0.0 if named else arm.on(tip).payload.mass) for tip in tips]
    if not cases:
        raise mapping.error("load_cases", "is empty; leave it out to use the arm's own payload")
    return tuple(sorted(cases, key=lambda case: case.moving is not None))


def limits_of_cases(mapping: Mapping, cases: Sequence[LoadCase]) -> tuple[Limit, ...]:
    """The limits that load cases have of their own: on the worst error under them."""
    limits: list[Limit] = []
    bodies = mapping.mappings("load_cases") if mapping.has("load_cases") else ()
    for number, body in enumerate(bodies):
        if not body.has("subject_to"):
            continue
        with body.mapping("subject_to").reading() as limit_body:
            if len(cases) != len(mapping.mappings("load_cases")):
                raise limit_body.error("", "goes with one tip; name the `tip` of each load case")
            bound = limit_body.bound("max_error", "length")
            if bound.relation != "<=" or bound.value <= 0.0:
                whole = shown(limit_body.raw("max_error"))
                raise limit_body.error("max_error", f"needs a limit from above, e.g. '<= 0.1 mm', not {whole}")
            limits.append(Limit(error_of_case(number), "<=", bound.value))
    return tuple(limits)


def _load_case(body: Mapping) -> tuple[LoadCase, bool]:
    """The load of one case, and whether it says a mass."""
    inner = read_load(body.mapping("payload")) if body.has("payload") else LoadCase()
    outer = {name: value for name, value in body.content.items() if name in ("mass", "force", "moment")}
    for name in outer:
        body.has(name)
    beside = read_load(Mapping(outer, file=body.file, key=body.key)) if outer else LoadCase()
    for name, empty in (("mass", 0.0), ("force", ZERO), ("moment", ZERO)):
        if getattr(inner, name) != empty and getattr(beside, name) != empty:
            raise body.error(name, "is given twice: inside payload and beside it")
    inside = body.content.get("payload")
    case = LoadCase(
        mass=inner.mass or beside.mass,
        force=inner.force if any(inner.force) else beside.force,
        moment=inner.moment if any(inner.moment) else beside.moment,
        acceleration=read_vector(body, "acceleration", "acceleration", ZERO),
    )
    return case, "mass" in outer or (isinstance(inside, dict) and "mass" in inside)


def relative_cases(mapping: Mapping, arm: Arm, cases: tuple[LoadCase, ...]) -> tuple[LoadCase, ...]:
    """The load cases with errors that count from the calibrated state of `relative_to`."""
    with mapping.mapping("relative_to").reading() as body:
        payload = read_load(body.mapping("payload")) if body.has("payload") else None
        temperature = body.quantity("temperature", "temperature") if body.has("temperature") else None
        if payload is None and temperature is None:
            would_do = (
                "give the payload or the temperature at which the arm was calibrated, e.g. {payload: {mass: 2 kg}}"
            )
            raise body.error("", f"names no calibrated state; {would_do}")
        state = Calibrated(payload, temperature)
        calibrated = [replace(case, relative_to=state) for case in cases]
        same = all(case.when_calibrated == given for case, given in zip(calibrated, cases, strict=True))
        if same and temperature in (None, arm.temperature):
            message = (
                "is the state in which the arm works, so that nothing changes; name another payload or temperature"
            )
            raise body.error("", message)
    return tuple(calibrated)

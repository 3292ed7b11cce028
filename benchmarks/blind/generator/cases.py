"""One case: an arm, a recording of it with something concealed (or nothing), and the truth of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blind import aliases
from benchmarks.blind.generator.arms import FAMILIES, Ranges, draw_arm
from benchmarks.blind.generator.concealed import OUTSIDE, UNIFORM, Effect, Scene
from benchmarks.blind.generator.designs import DESIGNS, Design, draw_design
from benchmarks.blind.generator.draws import ANY, SINGLES, Recipe, draw_effect, recipe
from benchmarks.blind.generator.measurement import Tracker, clean_tracker, draw_ratio, hostile_tracker, noise
from benchmarks.blind.generator.mechanics import Arm
from benchmarks.blind.generator.vectors import Array
from benchmarks.blind.staging import (
    GEOMETRIC,
    alike,
    dosed_to,
    exact,
    nominal_without,
    nonlinearity,
    nuisance,
    projected_rms,
    stage,
)

DOSES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
INVISIBLE = (
    "clearance_by_weight",
    "first_encoder_free_frame",
    "misaligned_free_frame",
    "servo_droop",
    "base_compliance",
    "one_sided_backlash",
    "instrument_scale",
    "side_held_windup",
)
_NULL_SHARE, _SINGLE_SHARE, _PAIR_SHARE, _OUTSIDE_SHARE = 34, 40, 10, 9  # of 100; the rest is invisible


Alias = tuple[str, tuple[int, ...], float]  # effect, where, correlation


@dataclass(frozen=True)
class Case:
    """All of a case; `readings` (axes, m) in m, as measured."""

    name: str
    seed: tuple[int, ...]
    kind: str
    arm: Arm
    ranges: Ranges
    design: Design
    effects: tuple[Effect, ...]
    tracker: Tracker
    dose: float | None
    projected_snr: float
    effect_snr: tuple[float, ...]
    beyond_library: float | None
    visible: bool
    alias: tuple[tuple[Alias, ...], ...]  # of each effect, the measuring frame projected out where it is free
    alias_given_geometry: tuple[tuple[Alias, ...], ...]  # all geometry projected out; none for geometric effects
    nonlinearity: float  # of the nominal arm, in sigma: greatest difference between exact and first-order
    readings: Array
    outliers: tuple[int, ...]
    hostility: tuple[str, ...]


def kind_of(index: int) -> tuple[str, int]:
    """The kind of the case of this number, and its number among its kind within the hundred."""
    order = np.random.default_rng(20260101 + index // 100).permutation(100)
    place = int(order[index % 100])
    for name, share in (
        ("null", _NULL_SHARE // 2),
        ("hostile_null", _NULL_SHARE // 2),
        ("single", _SINGLE_SHARE),
        ("pair", _PAIR_SHARE),
        ("outside", _OUTSIDE_SHARE),
    ):
        if place < share:
            return name, place + share * (index // 100)
        place -= share
    return "invisible", place + (100 - _NULL_SHARE - _SINGLE_SHARE - _PAIR_SHARE - _OUTSIDE_SHARE) * (index // 100)


def _setting(
    families: tuple[str, ...], needs: Recipe, design_names: tuple[str, ...], sigma: float, rng: np.random.Generator
) -> tuple[Arm, Ranges, Design]:
    """An arm whose own deflections are so small that first-order theory has them to a tenth of sigma."""
    while True:
        family = str(rng.choice(families))
        arm, ranges = draw_arm(family, str(rng.choice(needs.stiffness)), rng)
        design = draw_design(str(rng.choice(design_names)), arm, ranges, rng)
        if nonlinearity(arm, design) < 0.1 * sigma:
            return arm, ranges, design


def _families(needs: Recipe, *, three: bool = False) -> tuple[str, ...]:
    chosen = [f for f in FAMILIES if not (needs.planar_only and f.startswith("spatial"))]
    chosen = [f for f in chosen if not (needs.not_rail and f == "rail_2r")]
    chosen = [f for f in chosen if not (three and f == "planar_2r")]
    # the six-jointed arm costs most and comes less often
    return tuple(f for f in chosen for _ in range(1 if f == "spatial_6r" else 2))


def make_case(name: str, seed: tuple[int, ...], kind: str, number: int) -> Case:
    """The case of this kind and number; the same seed gives the same case to the last digit."""
    rng = np.random.default_rng(seed)
    sigma = round(float(np.exp(rng.uniform(np.log(10.0), np.log(40.0)))), 1) * 1e-6
    if kind in ("null", "hostile_null"):
        arm, ranges, design = _setting(_families(Recipe()), Recipe(), DESIGNS, sigma, rng)
        return _finish(name, seed, kind, number, arm, ranges, design, (), (), sigma, None, rng)
    if kind == "invisible":
        return _invisible(name, seed, number, sigma, rng)
    dose = DOSES[(number // 6 + number) % 6] if kind == "outside" else DOSES[number % 6]
    if kind == "pair":
        dose = max(dose, 0.5)
    names: tuple[str, ...] = ()
    for attempt in range(60):
        if kind == "outside":
            names = (OUTSIDE[number % len(OUTSIDE)],)
        elif kind == "pair":
            names = tuple(str(x) for x in rng.choice(SINGLES, 2, replace=False))
            if names[0] in UNIFORM or names[1] in UNIFORM:
                continue
        else:
            names = (SINGLES[(number // 6 + 5 * number) % len(SINGLES)],)
        if attempt == 12:
            sigma = max(5e-6, round(sigma * 1e6 / 3.0, 1) * 1e-6)  # a finer tracker sees what a small effect is worth
        built = _concealing(names, dose, sigma, attempt, rng)
        if built is None:
            continue
        arm, ranges, design, effects, sizes = built
        return _finish(name, seed, kind, number, arm, ranges, design, effects, sizes, sigma, dose, rng)
    raise RuntimeError(f"{name}: no recording could show {names} at {dose}")


def _joined(names: tuple[str, ...], needs: list[Recipe], attempt: int, rng: np.random.Generator) -> Recipe | None:
    """What all of these effects need together; None where nothing meets it."""
    stiffness = tuple(s for s in ANY if all(s in n.stiffness for n in needs))
    designs = tuple(d for d in DESIGNS if all(d in n.designs for n in needs))
    if not stiffness or not designs:
        return None
    if rng.random() < 0.15 and attempt < 20 and "clearance" not in names and "latency" not in names:
        designs = ("one_payload", "poor", "two_sides", "forced")
    return Recipe(stiffness, designs, any(n.planar_only for n in needs), any(n.not_rail for n in needs))


def _concealing(
    names: tuple[str, ...], dose: float, sigma: float, attempt: int, rng: np.random.Generator
) -> tuple[Arm, Ranges, Design, tuple[Effect, ...], tuple[float, ...]] | None:
    """An arm, a recording and the effects, each at its dose; None where this draw cannot show them."""
    needs = [recipe(name) for name in names]
    joined = _joined(names, needs, attempt, rng)
    if joined is None:
        return None
    families = _families(joined, three="joint_coupling" in names)
    arm, ranges, design = _setting(families, joined, joined.designs, sigma, rng)
    if any(name in UNIFORM for name in names):
        arm = replace(arm, leave_out=names)
    if "frame_misalignment" in names:
        design = replace(design, frame_free=False)
    scene, response = stage(arm, design)
    wanted = dose * sigma * math.sqrt(2 if arm.planar else 3)
    effects: list[Effect] = []
    sizes: list[float] = []
    for name, need in zip(names, needs, strict=True):
        sized = dosed_to(draw_effect(name, scene, ranges, rng), scene, response, wanted, need)
        # a dose that stiff arms cannot reach is taken as far as it goes, once softer ones have been tried
        enough = 0.5 if attempt < 30 else 0.05
        if sized is None or (name not in UNIFORM and not enough < sized[2] / wanted < 2.0):
            return None
        if sized[0].effect == "thermal_expansion" and len(effects) == 1 and "lag" in effects[0].parameters:
            return None  # a warmer hall would change the other effect's dose
        effects.append(sized[0])
        scene = sized[1]
        sizes.append(sized[2])
    if len(effects) == 2 and alike(effects, scene, response):
        return None
    return arm, ranges, scene.design, tuple(effects), tuple(sizes)


def _invisible(name: str, seed: tuple[int, ...], number: int, sigma: float, rng: np.random.Generator) -> Case:
    """Effects that a recording of this design cannot hold, or cannot tell from another."""
    variant = INVISIBLE[number % len(INVISIBLE)]
    planar = tuple(f for f in FAMILIES if not f.startswith("spatial"))
    turning = tuple(f for f in planar if f != "rail_2r")
    droop = variant in ("servo_droop", "base_compliance")
    families = turning if variant in ("base_compliance", "first_encoder_free_frame") else planar
    stiffness = ANY
    designs = ("full",) if droop or variant == "side_held_windup" else ("two_payloads", "one_payload")
    for _ in range(40):
        arm, ranges, design = _setting(families, Recipe(stiffness), designs, sigma, rng)
        free = variant in ("clearance_by_weight", "first_encoder_free_frame", "misaligned_free_frame")
        design = replace(design, frame_free=free)
        scene, response = stage(arm, design)
        effect = _variant(variant, scene, ranges, rng)
        change = aliases.signature(effect, scene, response)
        now, raw = projected_rms(change, scene, response, True)
        wanted = float(rng.choice([2.0, 4.0, 8.0])) * sigma * np.sqrt(2.0)
        if variant not in ("clearance_by_weight", "first_encoder_free_frame", "misaligned_free_frame") and now < 1e-9:
            continue
        effect = effect.dosed(wanted / (raw if free else now))
        return _finish(name, seed, "invisible", number, arm, ranges, design, (effect,), (), sigma, None, rng)
    raise RuntimeError(f"{name}: {variant} could not be drawn")


def _variant(variant: str, scene: Scene, ranges: Ranges, rng: np.random.Generator) -> Effect:
    if variant == "clearance_by_weight":
        return draw_effect("clearance", scene, ranges, rng)
    if variant == "first_encoder_free_frame":
        return Effect("encoder_offset", (1,), "offset", {"offset": 1e-4})
    if variant == "misaligned_free_frame":
        return draw_effect("frame_misalignment", scene, ranges, rng)
    if variant == "one_sided_backlash":
        effect = draw_effect("backlash", scene, ranges, rng)
        return replace(effect, parameters=effect.parameters | {"held_below": 1e6})
    if variant == "side_held_windup":
        effect = draw_effect("friction_windup", scene, ranges, rng)
        return replace(effect, parameters=effect.parameters | {"proportional": 0.0})
    return draw_effect(variant, scene, ranges, rng)


def _finish(
    name: str,
    seed: tuple[int, ...],
    kind: str,
    number: int,
    arm: Arm,
    ranges: Ranges,
    design: Design,
    effects: tuple[Effect, ...],
    sizes: tuple[float, ...],
    sigma: float,
    dose: float | None,
    rng: np.random.Generator,
) -> Case:
    axes, rows = (2 if arm.planar else 3), design.time.size
    scene, response = stage(arm, design)
    noise_rms = sigma * np.sqrt(axes)
    point = exact(arm, design, effects)
    snr, left, visible = 0.0, None, False
    alias: list[tuple[Alias, ...]] = []
    given: list[tuple[Alias, ...]] = []
    if effects:
        change = point - nominal_without(arm, design, effects, response)
        geometric = all(e.effect in GEOMETRIC for e in effects)
        shown, raw = projected_rms(change, scene, response, geometric)
        snr = shown / noise_rms
        framed, _ = projected_rms(change, scene, response, True)
        visible = bool(framed > max(0.02 * raw, 0.05 * noise_rms * min(1.0, raw / noise_rms)))
        result = aliases.candidates(scene, response, list(effects))
        column = aliases.flat(change, arm.planar)
        own = nuisance(scene, response, True)
        if kind != "outside":
            for effect in effects:
                signature = aliases.flat(aliases.signature(effect, scene, response), arm.planar)
                rest = nuisance(scene, response, False)
                alias.append(_over(aliases.correlations(signature, result, own) if visible else [], effects))
                plain = effect.effect in GEOMETRIC
                given.append(() if plain else _over(aliases.correlations(signature, result, rest), effects))
        if kind == "outside":
            rest = aliases.beyond(column, result, nuisance(scene, response, False))
            left = float(np.sqrt(np.sum(rest**2) / rows)) / noise_rms
    tracker, hostility = clean_tracker(sigma, axes, rng), ()
    if kind == "null":
        tracker = Tracker(sigma, draw_ratio(axes, rng))
    if kind == "hostile_null":
        tracker, hostility = hostile_tracker(Tracker(sigma, draw_ratio(axes, rng)), number, rng)
    errors, gross = noise(tracker, axes, rows, rng)
    return Case(
        name=name,
        seed=seed,
        kind=kind,
        arm=arm,
        ranges=ranges,
        design=design,
        effects=effects,
        tracker=tracker,
        dose=dose,
        projected_snr=snr,
        effect_snr=tuple(size / noise_rms for size in sizes),
        beyond_library=left,
        visible=visible,
        alias=tuple(alias),
        alias_given_geometry=tuple(given),
        nonlinearity=nonlinearity(arm, design) / sigma,
        readings=point[:axes] + errors,
        outliers=tuple(gross),
        hostility=hostility,
    )


def _over(results: list[tuple[float, aliases.Candidate]], effects: tuple[Effect, ...]) -> tuple[Alias, ...]:
    own = {(e.effect, e.at) for e in effects}
    return tuple((c.effect, c.at, round(r, 4)) for r, c in results if r > aliases.ALIAS and (c.effect, c.at) not in own)

"""A case: an arm, a session, what is wrong, and what the tracker made of it; all from one seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blind.generator.arms import Ranges
from benchmarks.blind.generator.measurement import Tracker, draw_ratio
from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.arms import FAMILIES, draw_arm
from benchmarks.multibody.causes import KINDS, Cause, Stage, draw_cause, possible
from benchmarks.multibody.doses import basis, dosed, geometry_columns, library_spans, sized
from benchmarks.multibody.engine import NotSettledError, machine
from benchmarks.multibody.instrument import MISLABELLED, STILL, Mount, draw_mount, errors, oracle_rms
from benchmarks.multibody.session import DESIGNS, Plan, draw_session, played
from benchmarks.multibody.unknowns.split import classes_of
from benchmarks.multibody.unknowns.unknown import Unknown

HALVES = ("development", "proof")
PATTERN = (
    *("null", "many", "power", "unknown", "many", "null", "power", "pair", "many", "null"),
    *("unknown", "power", "many", "null", "mislabelled", "pair", "null", "power", "many", "unknown"),
)
DOSES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
VICES = ("plain", "wander", "returns_badly", "heavy_tails", "outliers", "wander", "returns_badly", "plain")
PAIRS = (
    ("joint_compliance", "joint_compliance"),
    ("joint_compliance", "payload"),
    ("joint_compliance", "link_modulus"),
    ("link_mass", "joint_compliance"),
    ("encoder_scale", "encoder_eccentricity"),
    ("backlash", "friction_windup"),
    ("gearbox_thermal", "frame_drift"),
    ("thermal_expansion", "instrument_scale"),
    ("payload", "link_mass"),
    ("link_length", "instrument_scale"),
)
REMOUNTS = 0.35
ALIKE = 0.95
"""A cosine between two causes of one case above which nobody could name both."""


@dataclass(frozen=True)
class Placed:
    """A cause as it is in a case, its signal to noise, and whether it is one of the large."""

    cause: Cause
    snr: float
    large: bool


@dataclass(frozen=True)
class Case:
    """All that is written of a case, and all that is sealed."""

    name: str
    seed: tuple[int, ...]
    half: str
    kind: str
    stage: Stage
    ranges: Ranges
    tracker: Tracker
    vice: str
    return_scatter: float  # rad, of every joint from visit to visit
    frame_free: bool
    tool_free: bool
    mounts: tuple[Mount, ...]
    causes: tuple[Placed, ...]
    unknown: Unknown | None
    unknown_snr: tuple[float, float]  # beyond the library, and beside geometry
    mislabelled: tuple[str, int]
    dose: float
    readings: Array  # (3, rows) in the tracker's frame, m
    oracle: float  # m
    noise: float  # m, RMS length
    sag: float  # m, the greatest deflection of the arm as its file has it


def kind_of(index: int) -> tuple[str, int]:
    """The kind of the case with this number, and which of that kind it is."""
    kind = PATTERN[index % len(PATTERN)]
    before = sum(1 for each in PATTERN[: index % len(PATTERN)] if each == kind)
    return kind, index // len(PATTERN) * PATTERN.count(kind) + before


class NoCaseError(ValueError):
    """No draw of a case came out as it should."""


def make_case(name: str, seed: tuple[int, ...], half: str, kind: str, number: int, remounts: float = REMOUNTS) -> Case:
    """The case of a seed; `remounts` is the share of cases with a free frame whose tracker is set up anew half-way.
    Raises NoCaseError where sixty draws fail."""
    rng = np.random.default_rng(seed)
    for _ in range(60):
        try:
            case = _drawn(name, seed, half, kind, number, remounts, rng)
        except NotSettledError:
            continue
        if case is not None:
            return case
    raise NoCaseError(f"case {name}: no {kind} came out in sixty draws")


def _drawn(
    name: str,
    seed: tuple[int, ...],
    half: str,
    kind: str,
    number: int,
    remounts: float,
    rng: np.random.Generator,
) -> Case | None:
    family = FAMILIES[int(rng.integers(0, len(FAMILIES)))]
    arm, ranges = draw_arm(family, rng)
    design = "twenty" if rng.random() < 0.15 else str(rng.choice(DESIGNS[:3]))
    if kind == "pair" and PAIRS[number % len(PAIRS)] == ("backlash", "friction_windup"):
        design = "full"
    frame_free = bool(rng.random() < 0.5)
    tool_free = frame_free and bool(rng.random() < 0.5)
    mounts = 2 if frame_free and design != "twenty" and kind != "mislabelled" and rng.random() < remounts else 1
    session = draw_session(design, arm, ranges, mounts, rng)
    body = machine(arm)
    stage = Stage(body, session, played(Plan(body, session)))
    vice = VICES[number % len(VICES)] if kind == "null" else str(rng.choice(VICES)) if kind == "many" else "plain"
    sigma = round(float(rng.uniform(10.0, 30.0)), 1) * 1e-6
    tracker = _tracker(sigma, vice, arm.planar, rng)
    axes = 2 if arm.planar else 3
    size = sigma * math.sqrt(axes)

    causes: list[Placed] = []
    unknown: Unknown | None = None
    unknown_snr = (0.0, 0.0)
    amount, dose = 0.0, 0.0
    free = {"frame_free": frame_free, "tool_free": tool_free}
    if kind == "power":
        dose = DOSES[number % len(DOSES)]
        found = _some(stage, [(dose, True)], size, rng, free)
    elif kind == "many":
        large = [
            (float(np.exp(rng.uniform(math.log(2.0), math.log(20.0)))), True) for _ in range(int(rng.integers(1, 3)))
        ]
        small = [(float(rng.uniform(0.1, 0.5)), False) for _ in range(int(rng.integers(4, 9)))]
        found = _some(stage, large + small, size, rng, free)
    elif kind == "pair":
        dose = float(rng.uniform(1.0, 4.0))
        found = _some(
            stage,
            [(dose, True), (dose * float(rng.uniform(0.6, 1.0)), True)],
            size,
            rng,
            free,
            PAIRS[number % len(PAIRS)],
        )
    else:
        found = []
    if found is None:
        return None
    causes = found
    if kind == "unknown":
        classes = classes_of(half)
        each = classes[number % len(classes)]
        if not _can(each.needs, stage):
            return None
        unknown = each.draw(stage, rng)
        dose = (1.0, 2.0, 4.0)[number % 3] * float(rng.uniform(1.0, 1.6))
        came = sized(unknown, stage, dose * size, library_spans(stage), basis(geometry_columns(stage)))
        if came is None:
            return None
        amount, unknown_snr = came[0], (came[1] / size, came[2] / size)
    reach = sum(link.length for link in arm.links)
    scatter = float(rng.uniform(0.3, 1.5)) * size / reach if vice == "returns_badly" else 0.0
    wrong = list(MISLABELLED)[number % len(MISLABELLED)] if kind == "mislabelled" else ""
    if wrong in ("two joints' sides changed places",) and design not in ("full", "sides"):
        return None
    if wrong == "grams under kilograms" and design not in ("full", "payloads"):
        return None

    plan = Plan(body, session)
    if tool_free:
        for coordinate in body.tool[: 2 if arm.planar else 3]:
            plan.rest[coordinate] += float(rng.uniform(-2e-3, 2e-3))
    for placed in causes:
        placed.cause.write(plan)
    if unknown is not None:
        unknown.act(plan, amount)
    true = played(plan)
    if scatter:
        plan.rest[list(body.drive)] += scatter * rng.standard_normal(session.q.shape)
    stood = played(plan) if scatter else true
    rows = np.repeat(np.arange(session.visits), session.repeats)
    measured = stood.reading[:, rows] + errors(tracker, arm.planar, session.visits, session.repeats, rng)
    turns = np.stack([true.rests[v].turn for v in rows], axis=2)
    of_row = np.array(session.mount)[rows]
    oracle = oracle_rms(
        true.reading[:, rows], measured, of_row, frame_free=frame_free, tool_turns=turns if tool_free else None
    )
    stands = tuple(draw_mount(arm.planar, rng) for _ in range(mounts)) if frame_free else (STILL,)
    readings = np.stack(
        [stands[of_row[k]].turn @ measured[:, k] + stands[of_row[k]].shift for k in range(rows.size)], axis=1
    )
    return Case(
        name,
        seed,
        half,
        kind,
        stage,
        ranges,
        tracker,
        vice,
        scatter,
        frame_free,
        tool_free,
        stands,
        tuple(causes),
        unknown,
        unknown_snr,
        (wrong, int(rng.integers(1, arm.count + 1))),
        dose,
        readings,
        oracle,
        size,
        _sag(stage),
    )


def _sag(stage: Stage) -> float:
    """How far the tip is from where stiff links and drives would have it, m, at most."""
    body = stage.machine
    stiff = Plan(body, stage.session)
    stiff.compliance = np.zeros(body.size)
    return float(np.linalg.norm(played(stiff).reading - stage.tips.reading, axis=0).max())


def _tracker(sigma: float, vice: str, planar: bool, rng: np.random.Generator) -> Tracker:
    tracker = Tracker(sigma, draw_ratio(2 if planar else 3, rng))
    if vice == "wander":
        return replace(tracker, drift=float(rng.uniform(0.5, 1.5)) * sigma)
    if vice == "heavy_tails":
        return replace(tracker, degrees_of_freedom=4.0)
    if vice == "outliers":
        return replace(tracker, outlier_share=0.02)
    return tracker


def _can(needs: frozenset[str], stage: Stage) -> bool:
    has = {
        "sides": stage.session.design in ("full", "sides"),
        "payloads": stage.session.design in ("full", "payloads"),
        "space": not stage.machine.arm.planar,
        "links": any(stage.machine.nodes),
        "wrist": stage.machine.arm.count >= 6,
    }
    return all(has[need] for need in needs)


def _some(
    stage: Stage,
    wanted: list[tuple[float, bool]],
    noise: float,
    rng: np.random.Generator,
    free: dict[str, bool],
    effects: tuple[str, ...] = (),
) -> list[Placed] | None:
    """Causes at the doses wanted, no two of one effect at one place, no large one nearly a case of another."""
    chosen: list[Placed] = []
    seen: list[Array] = []
    for k, (dose, large) in enumerate(wanted):
        for _ in range(12):
            names = [effects[k]] if effects else [name for name in KINDS if possible(name, stage)]
            if not all(possible(name, stage) for name in names):
                return None
            name = "link_mass" if not effects and not large and rng.random() < 0.2 else str(rng.choice(names))
            cause = draw_cause(name, stage, rng)
            if effects and k and len(cause.at) == 1 and effects[0] != effects[1] and effects[0] in SAME_JOINT:
                cause = replace(cause, at=chosen[0].cause.at)
            if any((p.cause.effect, p.cause.at) == (cause.effect, cause.at) for p in chosen):
                continue
            came = dosed(cause, stage, dose * noise, **free)
            if came is None:
                continue
            left = came[2] / np.linalg.norm(came[2])
            if large and any(abs(float(left @ other)) > ALIKE for other in seen):
                continue
            if large:
                seen.append(left)
            chosen.append(Placed(came[0], came[1] / noise, large))
            break
        else:
            return None
    return chosen


SAME_JOINT = frozenset({"encoder_scale", "backlash"})
"""Causes whose partner in a hard pair sits at the same joint."""

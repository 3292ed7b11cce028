"""A case: an arm, a session, what is wrong, and what the tracker made of it; all from one seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blind.generator.arms import Ranges
from benchmarks.blind.generator.measurement import Tracker, draw_ratio
from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.arms import FAMILIES, draw_arm
from benchmarks.multibody.causes import KINDS, Cause, Stage, credible, draw_cause, possible
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
_DRAWS = 600
"""How often a case is drawn anew: rare needs (sides, payloads, a link that bends) come together in few sessions."""
ALIKE = 0.95
"""A cosine between two causes of one case above which nobody could name both."""


@dataclass(frozen=True)
class Placed:
    """A cause as it is in a case, its signal to noise, and whether it is one of the large."""

    cause: Cause
    snr: float
    large: bool


@dataclass(frozen=True)
class Scene:
    """Who measures what: an arm in a session, the instrument, and what is free."""

    stage: Stage
    ranges: Ranges
    tracker: Tracker
    vice: str
    frame_free: bool
    tool_free: bool

    @property
    def planar(self) -> bool:
        """Whether the arm moves in a plane."""
        return self.stage.machine.arm.planar

    @property
    def noise(self) -> float:
        """RMS length of the noise, m."""
        return self.tracker.sigma * math.sqrt(2 if self.planar else 3)


@dataclass(frozen=True)
class Wrong:
    """What is wrong: the library's causes, an unknown at a size, columns under wrong names (which, at which joint)."""

    causes: tuple[Placed, ...] = ()
    unknown: Unknown | None = None
    amount: float = 0.0
    unknown_snr: tuple[float, float] = (0.0, 0.0)  # beyond the library, and beside geometry
    mislabelled: tuple[str, int] = ("", 1)
    dose: float = 0.0


@dataclass(frozen=True)
class Case:
    """All that is written of a case, and all that is sealed."""

    name: str
    seed: tuple[int, ...]
    half: str
    kind: str
    scene: Scene
    wrong: Wrong
    return_scatter: float  # rad, of every joint from visit to visit
    mounts: tuple[Mount, ...]
    readings: Array  # (3, rows) in the tracker's frame, m
    oracle: float  # m, of the rows that are no outliers
    sag: float  # m, the greatest deflection of the arm as its file has it


def kind_of(index: int) -> tuple[str, int]:
    """The kind of the case with this number, and which of that kind it is."""
    kind = PATTERN[index % len(PATTERN)]
    before = sum(1 for item in PATTERN[: index % len(PATTERN)] if item == kind)
    return kind, index // len(PATTERN) * PATTERN.count(kind) + before


class NoCaseError(ValueError):
    """No draw of a case came out as it should."""


def make_case(name: str, seed: tuple[int, ...], half: str, kind: str, number: int, remounts: float = REMOUNTS) -> Case:
    """The case of a seed; `remounts` is the share of cases with a free frame whose tracker is set up anew half-way.
    Raises NoCaseError where none of many draws comes out."""
    rng = np.random.default_rng(seed)
    for _ in range(_DRAWS):
        try:
            scene = _scene(kind, number, remounts, rng)
            wrong = _wrong(kind, number, half, scene, rng)
            if wrong is not None:
                return _measured(name, seed, half, kind, scene, wrong, rng)
        except NotSettledError:
            continue
    raise NoCaseError(f"case {name}: no {kind} came out in {_DRAWS} draws")


def _scene(kind: str, number: int, remounts: float, rng: np.random.Generator) -> Scene:
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
    return Scene(stage, ranges, _tracker(sigma, vice, arm.planar, rng), vice, frame_free, tool_free)


def _wrong(kind: str, number: int, half: str, scene: Scene, rng: np.random.Generator) -> Wrong | None:
    """What a case of this kind has wrong; None where the draw does not come out."""
    if kind == "null":
        return Wrong()
    if kind == "unknown":
        return _unknown(number, half, scene, rng)
    if kind == "mislabelled":
        label = list(MISLABELLED)[number % len(MISLABELLED)]
        needs = {"two joints' sides changed places": "sides", "grams under kilograms": "payloads"}.get(label)
        can = needs is None or _can(frozenset({needs}), scene.stage)
        return Wrong(mislabelled=(label, int(rng.integers(1, scene.stage.machine.arm.count + 1)))) if can else None
    effects: tuple[str, ...] = ()
    if kind == "power":
        dose = DOSES[number % len(DOSES)]
        wanted = [(dose, True)]
    elif kind == "many":
        sizes = np.exp(rng.uniform(math.log(2.0), math.log(20.0), int(rng.integers(1, 3))))
        dose = float(sizes.max())
        wanted = [*((float(size), True) for size in sizes), *_small(int(rng.integers(4, 9)), rng)]
    else:
        dose, effects = float(rng.uniform(1.0, 4.0)), PAIRS[number % len(PAIRS)]
        wanted = [(dose, True), (dose * float(rng.uniform(0.6, 1.0)), True)]
    causes = _some(scene, wanted, rng, effects)
    return None if causes is None else Wrong(causes=causes, dose=dose)


def _small(count: int, rng: np.random.Generator) -> list[tuple[float, bool]]:
    return [(float(rng.uniform(0.1, 0.5)), False) for _ in range(count)]


def _unknown(number: int, half: str, scene: Scene, rng: np.random.Generator) -> Wrong | None:
    """An unknown of the half's classes in their turn, every other one among two or three small causes."""
    classes = classes_of(half)
    each = classes[number % len(classes)]
    if not _can(each.needs, scene.stage):
        return None
    unknown = each.draw(scene.stage, rng)
    dose = (1.0, 2.0, 4.0)[number % 3] * float(rng.uniform(1.0, 1.6))
    spans, geometry = library_spans(scene.stage), basis(geometry_columns(scene.stage))
    came = sized(unknown, scene.stage, dose * scene.noise, spans, geometry)
    if came is None:
        return None
    causes = _some(scene, _small(int(rng.integers(2, 4)) if number % 2 else 0, rng), rng)
    if causes is None:
        return None
    amount, beyond, beside = came
    return Wrong(causes, unknown, amount, (beyond / scene.noise, beside / scene.noise), dose=dose)


def _measured(
    name: str, seed: tuple[int, ...], half: str, kind: str, scene: Scene, wrong: Wrong, rng: np.random.Generator
) -> Case:
    """The session played with all that is wrong, and read by the tracker."""
    body, session, planar = scene.stage.machine, scene.stage.session, scene.planar
    plan = Plan(body, session)
    if scene.tool_free:
        for coordinate in body.tool[: 2 if planar else 3]:
            plan.rest[coordinate] += float(rng.uniform(-2e-3, 2e-3))
    for placed in wrong.causes:
        placed.cause.write(plan)
    if wrong.unknown is not None:
        wrong.unknown.act(plan, wrong.amount)
    true = played(plan)
    reach = sum(link.length for link in body.arm.links)
    scatter = float(rng.uniform(0.3, 1.5)) * scene.noise / reach if scene.vice == "returns_badly" else 0.0
    plan.rest[list(body.drive)] += scatter * rng.standard_normal(session.q.shape)
    stood = played(plan) if scatter else true
    rows = np.repeat(np.arange(session.visits), session.repeats)
    erring, sound = errors(scene.tracker, planar, session.visits, session.repeats, rng)
    measured, known = stood.reading[:, rows] + erring, true.reading[:, rows]
    mounted = np.array(session.mount)[rows]
    turns = np.stack([true.rests[v].turn for v in rows], axis=2)
    oracle = oracle_rms(
        known[:, sound],
        measured[:, sound],
        mounted[sound],
        frame_free=scene.frame_free,
        tool_turns=turns[:, :, sound] if scene.tool_free else None,
    )
    count = int(mounted.max()) + 1
    stands = tuple(draw_mount(planar, rng) for _ in range(count)) if scene.frame_free else (STILL,)
    readings = [stands[m].turn @ measured[:, k] + stands[m].shift for k, m in enumerate(mounted)]
    return Case(
        name, seed, half, kind, scene, wrong, scatter, stands, np.stack(readings, axis=1), oracle, _sag(scene.stage)
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
    scene: Scene, wanted: list[tuple[float, bool]], rng: np.random.Generator, effects: tuple[str, ...] = ()
) -> tuple[Placed, ...] | None:
    """Causes at the doses wanted (and large or not), of these effects or of any; no two of one effect at one place, no
    large one nearly a case of another. None where a dose does not come out."""
    chosen: list[Placed] = []
    seen: list[Array] = []
    for k, (dose, large) in enumerate(wanted):
        effect = effects[k] if effects else None
        for _ in range(12):
            came = _one(scene, dose, large, chosen, rng, effect)
            if came is None:
                continue
            placed, vector = came
            left = vector / np.linalg.norm(vector)
            if large and any(abs(float(left @ other)) > ALIKE for other in seen):
                continue
            seen += [left] if large else []
            chosen.append(placed)
            break
        else:
            return None
    return tuple(chosen)


def _one(
    scene: Scene, dose: float, large: bool, chosen: list[Placed], rng: np.random.Generator, effect: str | None
) -> tuple[Placed, Array] | None:
    """A cause at a dose, and what geometry leaves of its change."""
    stage = scene.stage
    names = [name for name in KINDS if possible(name, stage) and effect in (None, name)]
    if not names:
        return None
    some_weight = effect is None and not large and rng.random() < 0.2  # files are wrong in weights above all
    cause = draw_cause("link_mass" if some_weight else str(rng.choice(names)), stage, rng)
    if effect and chosen and chosen[0].cause.effect in SAME_JOINT and chosen[0].cause.effect != effect:
        cause = replace(cause, at=chosen[0].cause.at)
    if any((p.cause.effect, p.cause.at) == (cause.effect, cause.at) for p in chosen):
        return None
    came = dosed(cause, stage, dose * scene.noise, frame_free=scene.frame_free, tool_free=scene.tool_free)
    if came is None or not credible(came[0], stage):
        return None
    return Placed(came[0], came[1] / scene.noise, large), came[2]


SAME_JOINT = frozenset({"encoder_scale", "backlash"})
"""Causes whose partner in a hard pair sits at the same joint."""

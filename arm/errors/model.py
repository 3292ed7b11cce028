"""An arm's error model as functions: symbols for the optimiser, vectorised code for scans, one physics for both.

The model is built once for an arm's structure; the links' rigidities and lengths (`beam_values`) enter as inputs, so
that a changed design needs no new code.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.bodies.beams import beam_of
from linkwright.core.arm.chain.beam import UNIFORM, Beam, Taper
from linkwright.core.arm.chain.chain import Arm, Asymmetry, Joint, Link, LoadCase, Zones
from linkwright.core.arm.chain.kinematics import parts, place, symbols
from linkwright.core.arm.chain.similar_taper import similar_taper
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.chain.vectors import scale
from linkwright.core.arm.compiled.vectorise import VectorFunction, vectorise
from linkwright.core.arm.effects import BACKLASH, JOINT_COMPLIANCE, Settings
from linkwright.core.arm.errors.calibrated import calibrated_temperature, error_since_calibrated, planar_in
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.arm.errors.tip import ActiveEffect, Counted, TipError, TipInterval, active_effects, tip_error
from linkwright.core.arm.errors.varied import as_it_is, varied_case
from linkwright.core.sections.numeric import Array, column_of_symbols
from linkwright.core.sections.taper import FreeTaper, Tapered

BEAM_FIELDS = (
    "length",
    "mass_per_length",
    "axial_rigidity",
    "flexural_rigidity_height",
    "flexural_rigidity_width",
    "torsional_rigidity",
    "shear_rigidity_height",
    "shear_rigidity_width",
    "flexural_rigidity_coupling",
    "shear_centre_height",
    "shear_centre_width",
    "torsion_by_weight",
    "thermal_expansion",
    "stiffness_when_calibrated",
    "shear_when_calibrated",
    "log_taper",
    "balancer",
    "counterweight",
    "counterweight_at",
)
"""The order in which `beam_values` lists each link's length, mass, rigidities, shear centre, thermal expansion, what
its moduli were where the arm was calibrated, its taper, and what is chosen of a counterbalance and a counterweight."""


_BALANCE = ("balancer", "counterweight", "counterweight_at")


def needs_shear_modulus(arm: Arm, loads: Sequence[LoadCase] = ()) -> bool:
    """Whether the arm's model asks its materials for a shear modulus: for shear, or for torsion out of the plane.

    A load case of `loads` (the arm's payload by default) may press a planar arm out of its plane.
    """
    needs = {effect.effect.link.shear_modulus for effect in active_effects(arm)}
    planar = all(planar_in(arm, load) for load in (loads or arm.cases))
    return "always" in needs or ("in space" in needs and not planar)


def needs_thermal_expansion(arm: Arm) -> bool:
    """Whether the arm's model asks its materials how much they expand: the effect does not bring its figure."""
    needs = [(effect.effect.link.expansion_unless, effect.settings.values) for effect in active_effects(arm)]
    return any(name is not None and name not in given for name, given in needs)


def beams_of(arm: Arm, loads: Sequence[LoadCase] = ()) -> tuple[Beam, ...]:
    """The beams that an arm's links are, at its temperature, for load cases (its payload by default).

    Raises `PropertyNeeded` for a link of unknown mass, `MissingProperty` or `OutOfRange` for a material's figure.
    """
    shear, calibrated_at = needs_shear_modulus(arm, loads), calibrated_temperature(loads)
    beams = (beam_of(arm, index, shear=shear, calibrated_at=calibrated_at) for index in range(arm.size))
    return tuple(_with_balance(arm, index, beam) for index, beam in enumerate(beams))


def _with_balance(arm: Arm, index: int, beam: Beam) -> Beam:
    """A link's beam with what is chosen of its joint's counterbalance and its counterweight."""
    joint, chosen = arm.joints[index], [mass for mass in arm.links[index].masses if mass.chosen]
    if joint.balancer_chosen:
        beam = replace(beam, balancer=getattr(joint.counterbalance, joint.balancer_chosen))
    return replace(beam, counterweight=chosen[0].mass, counterweight_at=chosen[0].at[0]) if chosen else beam


def beam_values(beams: Sequence[Beam]) -> Array:
    """The lengths and figures of all links as one row (in the order of `BEAM_FIELDS`, link after link); 0 where there
    is none."""
    return np.array([float(getattr(beam, name) or 0.0) for beam in beams for name in BEAM_FIELDS])


@dataclass(frozen=True)
class PoseArrays:
    """What the model says at N poses of one load case, in m, N and N*m.

    `vector` (N, 3) is the deterministic error; `intervals` (N, k, 3) the reach of each play along a motion and
    `interval_seating` (N, k) the load that seats it; `normals` and `disc_seating` (N, d, 3) belong to the discs, whose
    radii are the model's. `load_scale` (N,) is the size of the loads that the arm carries (N and N*m alike).
    The last `taken` intervals and discs are play that a calibration took where its load had seated it: what nothing
    seats was taken in its middle. `projection` (3, 3) is what leaves the part of the error that counts (None: all of
    it), `vector` and `intervals` being projected already.
    """

    vector: Array
    intervals: Array
    interval_seating: Array
    normals: Array
    disc_seating: Array
    load_scale: Array
    taken: tuple[int, int] = (0, 0)
    projection: Array | None = None
    kinks: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """(N, z, 3), m/rad: what each drive with zones of stiffness moves, per turn; it is in `vector` already."""
    kink_loads: Array = field(default_factory=lambda: np.zeros((0, 0)))
    """(N, z): the loads (N*m) on those drives."""


@dataclass(frozen=True)
class CaseModel:
    """The error model under one load case.

    `state` and `error` hold symbols in `q` (n) and `p` (see `beam_values`); `function` maps (q, p) to what `PoseArrays`
    lists, as CasADi columns; `vectorised` does the same for many rows. `projection` is None where the whole error
    counts.
    """

    load: LoadCase
    q: Any
    p: Any
    state: PoseState
    error: TipError
    outputs: tuple[Any, ...]
    function: Any
    projection: Array | None = None

    @cached_property
    def vectorised(self) -> VectorFunction:
        """The same function for many rows at once; q (N, n) and p (one row for all)."""
        return vectorise([self.q, self.p], list(self.outputs))

    @property
    def radii(self) -> Array:
        """The radii of the discs of play, m."""
        return np.array([disc.radius for disc in self.error.discs])

    def arrays(self, q: Array, p: Array) -> PoseArrays:
        """The model's figures at N poses q (N, n) for a design p (see `beam_values`)."""
        vector, intervals, seating, normals, loads, scale, kinks, kink_loads = self.vectorised(q, p)
        count = len(q)
        return PoseArrays(
            vector,
            np.reshape(intervals, (count, -1, 3)),
            seating,
            np.reshape(normals, (count, -1, 3)),
            np.reshape(loads, (count, -1, 3)),
            scale[:, 0],
            self.taken,
            self.projection,
            np.reshape(kinks, (count, -1, 3)),
            kink_loads,
        )

    @property
    def zones(self) -> tuple[Zones, ...]:
        """The zones of each drive that has some (see `PoseArrays.kinks`)."""
        return tuple(kink.zones for kink in self.error.kinks)

    @property
    def taken(self) -> tuple[int, int]:
        """How many intervals and discs, the last of each, are what a calibration took of the play."""
        return sum(interval.taken for interval in self.error.intervals), sum(disc.taken for disc in self.error.discs)


@dataclass(frozen=True)
class ErrorModel:
    """The error model of an arm under its load cases; make one with `error_model`."""

    arm: Arm
    planar: bool
    cases: tuple[CaseModel, ...]
    tip: VectorFunction
    motion: VectorFunction
    """The nominal tip (m) and its slopes, those of the first joint's coordinate first."""
    drives: bool = False
    """Whether a row p goes on with factors of the drives."""


def error_model(
    arm: Arm,
    loads: Sequence[LoadCase] = (),
    only: str | None = None,
    *,
    drives: bool = False,
    counted: Counted = "position",
    varied: frozenset[str] = frozenset(),
) -> ErrorModel:
    """The arm's error model under the load cases (its payload by default); `only` keeps a single effect, `counted`
    is what is counted of the tip's error (of `orientation` all vectors are rotations, rad).

    With `drives` the row p goes on with a factor of each joint's stiffness, then of each joint's backlash, then with
    what `arm.errors.varied` lists, of which `varied` count.
    """
    return replace(_modelled(arm, tuple(loads or arm.cases), only, drives, counted, varied), arm=arm)


@by_structure
def _modelled(
    arm: Arm, loads: tuple[LoadCase, ...], only: str | None, drives: bool, counted: Counted, varied: frozenset[str]
) -> ErrorModel:
    cases = tuple(_case(arm, load, only, drives, counted, varied) for load in loads)
    q, p = symbols(arm), beam_symbols(arm, drives=drives)
    position = place(arm, parts(q), [p[len(BEAM_FIELDS) * index] for index in range(arm.size)]).tip()
    # Clearances in the plane are one sum apart from all else; where tips have their own, each case keeps them.
    same_radii = arm.play != "worst" or len({round(float(case.radii.sum()), 15) for case in cases}) == 1
    # Rotations of a planar arm are across its plane.
    planar = counted != "orientation" and same_radii and all(planar_in(arm, case.load) for case in cases)
    tip = _column(position)
    motion = vectorise([q, p], [tip, ca.vec(ca.densify(ca.jacobian(tip, q)))])
    return ErrorModel(arm, planar, cases, vectorise([q, p], [tip]), motion, drives)


def beam_symbols(arm: Arm, *, drives: bool = False) -> Any:
    """The symbols p: one for each of `BEAM_FIELDS`, link after link; with `drives` those that `error_model` names."""
    size = len(BEAM_FIELDS) * arm.size + (len(as_it_is(arm.size)) if drives else 0)
    return column_of_symbols("p", size)


def symbolic_beams(arm: Arm, p: Any) -> tuple[Beam, ...]:
    """The arm's beams with the symbols p in place of all that section, material and length settle; rigid links keep
    theirs."""
    beams: list[Beam] = []
    for index, link in enumerate(arm.links):
        base = len(BEAM_FIELDS) * index
        if link.elastic:
            values = {name: p[base + k] for k, name in enumerate(BEAM_FIELDS)}
            if link.material is None or not link.material.has("thermal_expansion"):
                values["thermal_expansion"] = None  # an effect that needs it must notice
            values.update(_of_symmetry(link.asymmetry))
            beams.append(Beam(**values, taper=_taper(arm, index, link, values["log_taper"])))
        else:
            rigid = beam_of(arm, index)
            by_name = {name: p[base + BEAM_FIELDS.index(name)] for name in _BALANCE}
            beams.append(Beam(length=p[base], lumped_mass=rigid.lumped_mass, lumped_at=rigid.lumped_at, **by_name))
    return tuple(beams)


def _of_symmetry(asymmetry: Asymmetry) -> dict[str, float]:
    """What symmetry settles of a beam: constants cost nothing."""
    values: dict[str, float] = {}
    if not asymmetry.askew:
        values["flexural_rigidity_coupling"] = 0.0
    if not asymmetry.off_height:
        values["shear_centre_height"] = 0.0
    if not asymmetry.off_width:
        values["shear_centre_width"] = 0.0
    if not asymmetry.eccentric:
        values["torsion_by_weight"] = 1.0
    return values


def _taper(arm: Arm, index: int, link: Link, log_taper: Any) -> Taper:
    """A link's taper: plain factors, whatever the length, so that uniform links cost no more than ever; of one that is
    to be chosen, factors of its symbol."""
    if isinstance(link.section, FreeTaper):
        return similar_taper(log_taper)
    return beam_of(arm, index).taper if isinstance(link.section, Tapered) else UNIFORM


def _case(
    arm: Arm, load: LoadCase, only: str | None, drives: bool, counted: Counted, varied: frozenset[str]
) -> CaseModel:
    q, p = symbols(arm), beam_symbols(arm, drives=drives)
    effects = [active for active in active_effects(arm) if only is None or active.effect.id == only]
    beams = symbolic_beams(arm, p)
    looser: list[Any] = []
    given: dict[str, Any] = {}
    if drives:
        first = len(BEAM_FIELDS) * arm.size
        stiffer, looser = ([p[first + k * arm.size + joint] for joint in range(arm.size)] for k in (0, 1))
        effects = [part for effect in effects for part in _with_factors(effect, stiffer)]
        arm = replace(arm, joints=tuple(map(_stiffened, arm.joints, stiffer)))
        given, more = varied_case(arm, load, varied, p[first + 2 * arm.size :])
        effects += more
    state = solve(arm, parts(q), beams, load, **given)
    whole = load.relative_to is None
    error = tip_error(state, effects, counted) if whole else error_since_calibrated(state, effects, arm.play, counted)
    if looser:
        error = replace(error, intervals=tuple(_loosened(interval, looser) for interval in error.intervals))
    outputs = _outputs(error, state)
    function = ca.Function("error", [q, p], list(outputs))
    return CaseModel(load, q, p, state, error, outputs, function)


def _outputs(error: TipError, state: PoseState) -> tuple[Any, ...]:
    """The columns that `PoseArrays` lists."""
    return (
        _column(error.vector),
        _column([component for interval in error.intervals for component in interval.vector]),
        _column([interval.seating for interval in error.intervals]),
        _column([component for disc in error.discs for component in disc.normal]),
        _column([component for disc in error.discs for component in disc.seating]),
        _load_scale(state),
        _column([component for kink in error.kinks for component in kink.vector]),
        _column([kink.load for kink in error.kinks]),
    )


def _with_factors(active: ActiveEffect, stiffer: Sequence[Any]) -> list[ActiveEffect]:
    """An effect joint by joint with drives of another stiffness, where it brings compliances of its own."""
    values = active.settings.values
    if active.effect.id != JOINT_COMPLIANCE.id or not values:
        return [active]
    effects: list[ActiveEffect] = []
    for joint, factor in enumerate(stiffer):
        if active.settings.acts_at(joint):
            scaled = {k: v / factor if k == "compliance" else v * factor for k, v in values.items()}
            effects.append(replace(active, settings=Settings((joint,), scaled)))
    return effects


def _loosened(interval: TipInterval, looser: Sequence[Any]) -> TipInterval:
    if interval.effect != BACKLASH.id:
        return interval
    return replace(interval, vector=scale(looser[interval.joint], interval.vector))


def _stiffened(joint: Joint, factor: Any) -> Joint:
    return joint if joint.stiffness is None else replace(joint, stiffness=joint.stiffness * factor)


def _load_scale(state: PoseState) -> Any:
    """The forces that the arm carries, without regard to sign, and their moments over its whole length."""
    forces = [component for link in state.links for component in link.weight]
    forces += [*state.links[-1].force, *state.joints[0].force]
    total = sum((ca.fabs(ca.SX(component)) for component in forces), ca.SX(0.0))
    moment = sum((ca.fabs(ca.SX(component)) for component in state.load.moment), ca.SX(0.0))
    return total * (1.0 + sum(link.beam.length for link in state.links)) + moment


def _column(entries: Sequence[Any]) -> Any:
    return ca.vertcat(*[ca.SX(entry) for entry in entries]) if entries else ca.SX(0, 1)


_RIGID = 1e30
"""N, N*m^2: a rigidity under which nothing gives."""


def rigid(beam: Beam) -> Beam:
    """A beam of the same length that neither gives nor weighs, and grows as it did when it warms; what balances the arm
    stays."""
    return Beam(
        length=beam.length,
        thermal_expansion=beam.thermal_expansion,
        balancer=beam.balancer,
        counterweight=beam.counterweight,
        counterweight_at=beam.counterweight_at,
    )


def values_of_rigid(beams: Sequence[Beam]) -> Array:
    """As `beam_values`, for an error model whose links are elastic: rigidities that a beam lacks are so large that
    nothing gives."""
    values = beam_values(beams).reshape(len(beams), -1)
    for k, name in enumerate(BEAM_FIELDS):
        if "rigidity" in name and "coupling" not in name:
            values[:, k] = np.where(values[:, k] == 0.0, _RIGID, values[:, k])
    return values.ravel()

"""What holds for every effect: its entry, its linearity, its places, its units in files, and its line in the docs."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import linkwright as lw
from handbook.effects import PAGE, effect_page
from linkwright.cli import run
from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.kinematics import parts, symbols
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects import EFFECTS, Effect, Settings, kind_at
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.arm.errors.tip import active_effects, carried_to_tip, tip_error
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.units import kinds
from linkwright.face.planning.request import place_of
from tests.arm.builders import arm_of, rod_lines
from tests.arm.effects.effect_states import Posed, moved, planar, spatial

NOT_LINEAR = frozenset({"link_modulus"})
POSED = (planar(1), planar(2, absolute=True), spatial(3), spatial(4, slide=False))
SIZED = [(effect, size.name) for effect in EFFECTS.values() for size in effect.sizes]
NAMES = [f"{effect.id}.{size}" for effect, size in SIZED]


def shapes(effect: Effect) -> dict[str, float]:
    """Something for every shape parameter."""
    return {shape.name: shape.typical[1] for shape in effect.shapes}


def an_entry(effect: Effect) -> dict[str, float]:
    """Something for every parameter."""
    return {parameter.name: parameter.typical[1] for parameter in effect.parameters}


# ---- the entry


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_every_entry_is_whole(effect: Effect) -> None:
    assert EFFECTS[effect.id] is effect
    assert effect.title
    assert effect.formula
    assert effect.needs
    assert effect.source
    assert set(effect.aliases) <= set(EFFECTS) - {effect.id}
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names)
    for item in effect.parameters:
        assert item.kind in kinds()
        assert kind_at(item, slides=True) in kinds()
        assert item.lower <= item.typical[0] <= item.typical[1] <= item.upper
        assert item.source
        assert bool(item.grid) == (item.role in ("shape", "torque_shape"))
        assert list(item.grid) == sorted(set(item.grid))
        if not item.relative_to_load:
            assert all(item.lower <= value <= item.upper for value in item.grid)
        if item.role in ("size", "torque"):
            assert item.lower <= 0.0 < item.upper
    for group in effect.enough:
        assert set(group) <= set(names)
    assert not effect.shapes or effect.sizes or effect.torque_sizes


def test_the_whole_table_is_there() -> None:
    """The ids of effects.md's table, torsion, what rails, screws and real joints add, and those of motion logs."""
    table = """link_bending slope_propagation axial shear_deformation link_modulus link_mass joint_compliance
    joint_hardening servo_droop backlash friction_windup clearance encoder_offset encoder_eccentricity encoder_scale
    gear_transmission_error joint_coupling link_length payload tool_offset thermal_expansion thermal_bending
    gearbox_thermal creep base_tilt base_compliance frame_misalignment frame_drift instrument_scale
    axis_misalignment counterbalance
    latency stale_reading dynamic_deflection torsion rail_straightness rail_pitch joint_waviness
    screw_expansion column_bending lateral_compliance unknown_weight flange_compliance link_stiffness guide_bending
    friction_coulomb friction_viscous friction_stribeck friction_load friction_asymmetry friction_warmup
    friction_reversal friction_quadratic friction_place armature torque_constant torque_offset torque_delay
    link_inertial gear_ripple spring torque_curve friction_load_stribeck
    gear_efficiency back_emf"""
    assert set(EFFECTS) == set(table.split())


def test_the_documentation_names_every_effect_and_parameter() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert page == effect_page(), "make effects-docs"
    lines = {line.split("`")[1]: line for line in page.splitlines() if line[:3] == "| `"}
    assert set(EFFECTS) <= set(lines)
    for effect in EFFECTS.values():
        for name in ends_of_series([parameter.name for parameter in effect.parameters]):
            assert f"`{name}`" in lines[effect.id], (effect.id, name)


def ends_of_series(names: list[str]) -> list[str]:
    """The names, but of those that are numbered up only the first and the last: `sine_1` to `sine_32`."""
    series: dict[str, list[str]] = {}
    for name in names:
        series.setdefault(re.sub(r"_[0-9]+$", "", name), []).append(name)
    return [name for item in series.values() for name in ((item[0], item[-1]) if len(item) > 8 else item)]


# ---- linearity and places


@given(st.integers(0, len(SIZED) - 1), st.integers(0, len(POSED) - 1), st.floats(-3.0, 3.0), st.floats(0.05, 1.0))
@settings(max_examples=200, deadline=None)
def test_the_displacement_is_linear_in_every_size(which: int, arm: int, factor: float, share: float) -> None:
    effect, size = SIZED[which]
    state = POSED[arm].state
    (parameter,) = [item for item in effect.parameters if item.name == size]
    value = share * parameter.typical[1]
    if effect.id in NOT_LINEAR:
        # To first order only: 1/(1+x) - 1 = -x + x^2 ...
        small, smaller = (moved(state, effect.id, {size: h}) for h in (2e-6, 1e-6))
        assert small == pytest.approx(2.0 * smaller, rel=1e-5, abs=1e-16)
        return
    once = moved(state, effect.id, {**shapes(effect), size: value})
    scaled = moved(state, effect.id, {**shapes(effect), size: factor * value})
    assert scaled == pytest.approx(factor * once, rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("effect", [effect for effect in EFFECTS.values() if len(effect.sizes) > 1], ids=lambda e: e.id)
@pytest.mark.parametrize("posed", POSED, ids=range(4))
def test_sizes_add_up_and_those_absent_count_as_nothing(effect: Effect, posed: Posed) -> None:
    state, values = posed.state, {size.name: size.typical[1] for size in effect.sizes}
    apart = sum(moved(state, effect.id, {**shapes(effect), name: value}) for name, value in values.items())
    assert moved(state, effect.id, {**shapes(effect), **values}) == pytest.approx(apart, rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_without_a_size_nothing_moves(effect: Effect) -> None:
    """But for what an arm has data for: its drives' stiffness, and its materials' expansion."""
    still = [{}, shapes(effect)] + [{**shapes(effect), size.name: 0.0} for size in effect.sizes]
    for posed in POSED:
        for values in still:
            data = effect.automatic or effect.id == "thermal_expansion"
            if not (data and not set(values) & {size.name for size in effect.sizes}):
                assert np.all(moved(posed.state, effect.id, values) == 0.0), values


@pytest.mark.parametrize(
    "effect", [effect for effect in EFFECTS.values() if effect.place in ("joint", "link")], ids=lambda e: e.id
)
@pytest.mark.parametrize("posed", POSED, ids=range(4))
def test_everywhere_is_the_sum_of_every_place(effect: Effect, posed: Posed) -> None:
    values = {**shapes(effect), **{size.name: size.typical[1] for size in effect.sizes}}
    everywhere = moved(posed.state, effect.id, values)
    places = [moved(posed.state, effect.id, values, (i,)) for i in range(posed.arm.size)]
    assert everywhere == pytest.approx(sum(places), rel=1e-9, abs=1e-16)
    if effect.sizes:
        # In the plane an axis has no tilt, its shifts are lengths and offsets, and a bearing carries no moment across
        # its axis: those are for space alone.
        flat = effect.id in ("axis_misalignment", "lateral_compliance") and posed.state.planar
        joints = posed.arm.joints
        acting = [effect.can_act(i, revolute=joint.revolute) and not flat for i, joint in enumerate(joints)]
        assert [bool(np.any(place != 0.0)) for place in places] == acting


@pytest.mark.parametrize(("effect", "size"), SIZED, ids=NAMES)
def test_every_size_moves_some_arm(effect: Effect, size: str) -> None:
    values = {**shapes(effect), size: 1e-3}
    assert any(np.any(moved(posed.state, effect.id, values) != 0.0) for posed in POSED)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_a_planar_arm_stays_in_its_plane(effect: Effect) -> None:
    values = {**shapes(effect), **{size.name: size.typical[1] for size in effect.sizes}}
    assert np.all(moved(planar().state, effect.id, values)[:, 2] == 0.0)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
@pytest.mark.parametrize("posed", POSED, ids=range(4))
def test_readings_at_once_are_readings_one_by_one(effect: Effect, posed: Posed) -> None:
    """But for lags, which ask for the readings before."""
    values = {**shapes(effect), **{size.name: size.typical[1] for size in effect.sizes}}
    values = {name: value for name, value in values.items() if name != "lag"}
    every = moved(posed.state, effect.id, values)
    for row in range(3):
        assert every[row] == pytest.approx(moved(posed.row(row), effect.id, values), rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
@pytest.mark.parametrize("posed", [POSED[1], POSED[2]], ids=["plane", "space"])
def test_a_designs_symbols_give_the_same_numbers(effect: Effect, posed: Posed) -> None:
    """Of what a design may hold: vectors, and the intervals of play."""
    values = {name: value for name, value in an_entry(effect).items() if name not in ("warming", "stiffness")}
    at = tuple(i + 1 for i in range(posed.arm.size) if effect.can_act(i, revolute=posed.arm.joints[i].revolute))
    if not at:
        return
    entry = EffectEntry(effect.id, () if effect.place in ("base", "tip") else at, values)
    arm = replace(posed.arm, effects=(entry,), leave_out=frozenset(EFFECTS) - {"axial"})
    q = symbols(arm)
    made = tip_error(solve(arm, parts(q), posed.beams), active_effects(arm))
    function = ca.Function(
        "e",
        [q],
        [ca.vertcat(*map(ca.SX, [*made.vector, *(c for interval in made.intervals for c in interval.vector)]))],
    )
    for row in posed.q[:3]:
        error = tip_error(solve(arm, row.tolist(), posed.beams), active_effects(arm))
        expected = [*error.vector, *(c for interval in error.intervals for c in interval.vector)]
        assert np.array(function(row)).ravel() == pytest.approx(np.array(expected, dtype=float), rel=1e-9, abs=1e-16)


def test_symbols_are_no_trouble_to_any_effect_by_itself() -> None:
    """The same with nothing left out, so that loads have all of the arm to go through."""
    posed = spatial(3)
    q = symbols(posed.arm)
    state = solve(posed.arm, parts(q), posed.beams)
    for name, values in (("payload", {"mass": 1.0}), ("base_tilt", {"about_y": 1e-3}), ("link_mass", {"mass": 1.0})):
        tip = carried_to_tip(state, EFFECTS[name].twists(state, Settings((), values)))
        function = ca.Function("e", [q], [ca.vertcat(*map(ca.SX, tip))])
        expected = moved(solve(posed.arm, posed.q[0].tolist(), posed.beams), name, values)
        assert np.array(function(posed.q[0])).ravel() == pytest.approx(expected, rel=1e-9)


# ---- in files

RAIL_ARM = """temperature: 40 degC
chain:
  - joint: {stiffness: 50 kN*m/rad, mass: 2 kg}
    link: {length: 400 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
  - joint: {type: prismatic, range: [0 mm, 400 mm], stiffness: 40 N/um}
    link: {length: 300 mm, section: {shape: circle, diameter: 50 mm}, material: steel-s355}
  - joint: {}
    link: {length: 300 mm, section: {shape: circle, diameter: 40 mm}, material: steel-s355}
payload: {mass: 2 kg}
"""


def entry_text(effect: Effect, at: int | None, *, slides: bool) -> str:
    values = [
        f"{each.name}: {format_quantity(each.typical[1], kind_at(each, slides=slides and effect.place == 'joint'))}"
        for each in effect.parameters
    ]
    where = [] if at is None else [f"at: {at}"]
    return f"effects:\n  - {{{', '.join([f'effect: {effect.id}', *where, *values])}}}\n"


@pytest.mark.parametrize("effect", [item for item in EFFECTS.values() if item.parameters], ids=lambda e: e.id)
@pytest.mark.parametrize("at", [1, 2, 3, None])
def test_every_effect_is_read_and_written_back(effect: Effect, at: int | None, tmp_path: Path) -> None:
    slides = at == 2
    everywhere = effect.place in ("base", "tip")
    if everywhere != (at is None) or (at and not effect.can_act(at - 1, revolute=not slides)):
        return
    arm = arm_of(RAIL_ARM + entry_text(effect, at, slides=slides), tmp_path)
    (entry,) = arm.effects
    assert (entry.effect, entry.at) == (effect.id, (at,) if at else ())
    assert dict(entry.parameters) == pytest.approx(an_entry(effect), rel=1e-9)
    (again,) = arm_of(arm_to_yaml(arm), tmp_path).effects
    assert (again.effect, again.at) == (entry.effect, entry.at)
    assert dict(again.parameters) == pytest.approx(dict(entry.parameters), rel=1e-9)
    # A mast's 1/EI is that of a beam, whatever travels along it.
    own = any(parameter.across or parameter.kind == "flexibility" for parameter in effect.parameters)
    if slides and effect.place == "joint" and not own:
        assert not re.search(r"rad\b|deg|N\*m", arm_to_yaml(arm).partition("effects:")[2])


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("{effect: encoder_offset, at: 1}", ["moves nothing", "offset"]),
        ("{effect: joint_hardening, at: 1, compliance: 1e-5 rad/(N*m)}", ["compliance and knee", "stiffness_1"]),
        ("{effect: gear_transmission_error, at: 1, sine: 1 mrad}", ["sine and order", "cosine and order"]),
        ("{effect: creep, at: 1, time_constant: 1 h}", ["compliance and time_constant"]),
        ("{effect: link_modulus, at: 1, excess: -1.5}", ["excess", "between -0.9 and 3"]),
        ("{effect: latency, delay: 5 s}", ["delay", "between -1 s and 1 s", "5 s"]),
        ("{effect: latency, delay: 5 mm}", ["delay", "s"]),
        ("{effect: friction_windup, at: 1, windup: -1 mrad}", ["windup", "negative"]),
        ("{effect: encoder_offset, at: 2, offset: 1 mrad}", ["offset", "mm"]),
        ("{effect: encoder_offset, at: [1, 2], offset: 1 mrad}", ["at", "slides", "offset"]),
        ("{effect: encoder_offset, offset: 1 mrad}", ["at", "slides", "offset"]),
        ("{effect: payload, at: 3, mass: 1 kg}", ["at", "tip"]),
        ("{effect: base_compliance, at: 1, compliance: 1e-7 rad/(N*m)}", ["at", "base"]),
        ("{effect: joint_coupling, at: 1, coupling: 0.01}", ["at", "after the first"]),
        ("{effect: encoder_eccentricity, at: 2, sine: 1 mm}", ["at", "turn", "joint 2"]),
        ("{effect: rail_straightness, at: 1, deviation: 1 mm}", ["at", "slide", "joint 1"]),
        ("{effect: rail_pitch, at: 2}", ["angle"]),
    ],
)
def test_entries_that_mean_nothing_are_refused_in_one_line(entry: str, says: list[str], tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        arm_of(f"{RAIL_ARM}effects:\n  - {entry}\n", tmp_path)
    message = str(caught.value)
    assert "\n" not in message
    for part in ["arm.yaml", "effects[1]", *says]:
        assert part in message, message


def test_an_evaluation_says_which_effects_it_cannot_count(tmp_path: Path) -> None:
    text = rod_lines([400, 300]) + (
        "effects:\n  - {effect: latency, delay: 5 ms}\n"
        "  - {effect: creep, at: 1, compliance: 1e-6 rad/(N*m), time_constant: 1 h}\n"
        "  - {effect: gearbox_thermal, at: 1, per_kelvin: 1 urad/K}\n"
    )
    result = evaluate(arm_of(text, tmp_path))
    assert result.warnings == (
        "latency adds nothing here: it needs what only a recording holds (velocities)",
        "creep adds nothing here: it needs what only a recording holds (time under load)",
    )
    plain = evaluate(arm_of(rod_lines([400, 300]), tmp_path))
    assert plain.warnings == ()
    assert result.max_error == pytest.approx(plain.max_error, rel=1e-9)


def test_effects_of_the_library_change_a_design(tmp_path: Path) -> None:
    """Outstretched and level, 10 mm more at the far link put the tip 10 mm farther, whatever the pose."""
    text = "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\n" + rod_lines([400, 300])
    plain = evaluate(arm_of(text, tmp_path))
    longer = evaluate(arm_of(text + "effects: [{effect: link_length, at: 2, length: 10 mm}]\n", tmp_path))
    assert plain.max_error == pytest.approx(0.0, abs=1e-12)
    assert longer.max_error == pytest.approx(0.01, rel=1e-9)
    assert longer.by_effect["link_length"] == pytest.approx(0.01, rel=1e-9)
    # The second encoder's order-five error, at its worst: 1 mrad over 0.3 m.
    wavy = "effects: [{effect: gear_transmission_error, at: 2, sine: 1 mrad, order: 5}]\n"
    assert evaluate(arm_of(text + wavy, tmp_path)).max_error == pytest.approx(3e-4, rel=1e-6)


# ---- on the command line


def test_show_and_list_tell_role_bounds_and_grid(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["effects", "show", "joint_hardening"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    for part in ("a size", "a shape", "given, not fitted", "bounds 0 ", "of the drive's greatest load", "0.35"):
        assert part in shown
    target = tmp_path / "effects.json"
    assert run(["effects", "list", "--json", str(target)]) == 0
    entries = {entry["id"]: entry for entry in json.loads(target.read_text())["effects"]}
    assert set(entries) == set(EFFECTS)
    order = next(entry for entry in entries["gear_transmission_error"]["parameters"] if entry["name"] == "order")
    assert (order["role"], order["relative_to_load"]) == ("shape", False)
    assert 100.0 in order["grid"]
    assert entries["latency"]["requires"] == ["velocities"]
    assert entries["servo_droop"]["before_encoder"] is True


def test_what_the_arm_has_data_for_may_be_named_without_a_size(tmp_path: Path) -> None:
    """Left out of the whole and named at one joint, backlash is that joint's own."""
    text = "leave_out: [backlash]\neffects: [{effect: backlash, at: 1}]\n" + rod_lines(
        [400, 300], joint=", backlash: 1 mrad"
    )
    (entry,) = arm_of(text, tmp_path).effects
    assert (entry.effect, entry.at, dict(entry.parameters)) == ("backlash", (1,), {})


def test_what_people_call_an_effect_leads_to_it_alone() -> None:
    """In the line that refuses the name, of a plan too."""
    called = [synonym for effect in EFFECTS.values() for synonym in effect.synonyms]
    assert len(called) == len(set(called))
    assert not set(called) & set(EFFECTS)
    for effect in EFFECTS.values():
        for synonym in effect.synonyms:
            assert nearest(synonym, EFFECTS) == f"; did you mean '{effect.id}'?"
    with pytest.raises(InputError, match="there is no effect 'tip_mass'; did you mean 'payload'"):
        place_of("tip_mass:1", lw.Arm.of(planar(2).arm))


def test_a_difference_is_not_called_what_it_is_a_difference_of() -> None:
    """Of a link that is longer by 0.8 mm nobody should read that 0.8 mm is its length."""
    titles = [parameter.title for parameter in EFFECTS["link_length"].parameters]
    assert titles[:2] == ["longer by", "further along x by"]


def test_what_links_share_and_what_an_encoder_sees() -> None:
    """One material, one air and one clock for all; only a servo's droop is before the encoder."""
    together = {"link_modulus", "link_length", "thermal_expansion", "thermal_bending", "latency", "torque_delay"}
    assert {effect.id for effect in EFFECTS.values() if effect.together} == together
    assert {effect.id for effect in EFFECTS.values() if effect.drive.before_encoder} == {"servo_droop"}


@pytest.mark.parametrize("effect", [effect for effect in EFFECTS.values() if effect.place == "joint" and effect.sizes])
def test_what_a_joint_does_across_itself_no_encoder_sees(effect: Effect) -> None:
    """Nothing of it along the joint's coordinate in any state; whatever else moves a joint does so along that."""
    along, any_at_all = 0.0, 0.0
    for posed in POSED:
        state = posed.state
        for size in effect.sizes:
            values = Settings((), {**shapes(effect), size.name: size.typical[1]})
            tip = moved(state, effect.id, dict(values.values))
            any_at_all = max(any_at_all, float(np.abs(tip).max()))
            there = seen(state, effect, values, Asked(len(posed.q), joint_side=True)).joint_side
            assert there is not None
            along = max(along, float(np.abs(there).max()))
    assert (along < 1e-15) is effect.drive.across or any_at_all == 0.0

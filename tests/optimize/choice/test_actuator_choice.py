"""Choosing actuators with the links: against every choice solved on its own, and under the limits that count them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.actuators import USER_ACTUATORS
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.choice.actuators import assignments, with_actuators
from linkwright.core.optimize.choice.driven import stays_beside
from linkwright.core.optimize.infeasible.quick import out_of_reach
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import best_value, jointed, measured_price, problem_of, ranged

TWO = jointed([400, 300], ranged("-120 120", "-150 150", more=""))
GEARS = "[CSG-17-100-2UH, CSG-25-100-2UH, RV-6E]"
SIZES = "section_size: [20 mm, 90 mm]"

OWN = """\
format_version: 1
maker: Somebody
references: {list: "Somebody's price list"}
actuators:
  DEAR: {gear: planetary, rated_torque: 90 N*m, stiffness: 80 kN*m/rad, backlash: 0 arcmin, mass: 2 kg, source: list,
         cost: {value: 900 EUR, spread: [800 EUR, 950 EUR], date: 2026-01}}
  CHEAP: {gear: planetary, rated_torque: 90 N*m, stiffness: 40 kN*m/rad, backlash: 1 arcmin, mass: 2 kg, source: list,
          cost: {value: 300 EUR, spread: [250 EUR, 350 EUR], date: 2026-01}}
"""


@pytest.fixture
def priced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which actuators with prices are known."""
    (tmp_path / "own.yaml").write_text(OWN, encoding="utf-8")
    monkeypatch.setenv(USER_ACTUATORS.variable, str(tmp_path / "own.yaml"))
    return tmp_path


def choosing(folder: Path, limits: str, gears: str = GEARS, more: str = "", minimize: str = "max_error") -> Problem:
    text = f"minimize: {minimize}\nsubject_to: {{{limits}, {SIZES}}}\nchoose: {{actuator: {gears}{more}}}\n"
    return problem_of(folder, TWO, text)


@pytest.mark.slow
def test_the_choice_is_the_best_of_all_solved_one_by_one(tmp_path: Path) -> None:
    problem = choosing(tmp_path, "total_mass: '<= 11 kg'")
    result = optimise(problem)
    values: dict[tuple[str, ...], float] = {}
    for pick in assignments(problem):
        own = replace(problem, arm=with_actuators(problem.arm, pick), actuators=None)
        names = tuple(item.name for item in pick if item is not None)
        try:
            solved = optimise(own)
        except NoAnswer:
            continue
        # Judged by `evaluate` on the arm itself, limits and all.
        judged = evaluate(solved.arm, problem.workspace, problem.load_cases)
        assert judged.total_mass <= 11.0 * (1.0 + 1e-6)
        assert judged.drives is not None
        assert judged.drives.greatest_use is not None
        assert judged.drives.greatest_use <= 1.0 + 1e-4
        values[names] = judged.max_error
    best = min(values, key=lambda names: values[names])
    assert tuple(joint.actuator.name for joint in result.arm.joints if joint.actuator is not None) == best
    assert result.after.max_error == pytest.approx(values[best], rel=2e-4)
    assert len(result.drives) == 9
    assert result.drives_exhaustive
    assert result.drives[0].actuators == best
    assert len(set(values.values())) > 3


def test_one_list_for_each_joint_and_the_same_for_all(tmp_path: Path) -> None:
    each = choosing(tmp_path, "total_mass: '<= 12 kg'", "[[RV-20E, RV-6E], [CSG-17-100-2UH]]")
    assert [[a.name for a in pick if a] for pick in assignments(each)] == [
        ["RV-20E", "CSG-17-100-2UH"],
        ["RV-6E", "CSG-17-100-2UH"],
    ]
    same = choosing(tmp_path, "total_mass: '<= 12 kg'", GEARS, ", same: [actuator]")
    assert all(len({actuator.name for actuator in pick if actuator}) == 1 for pick in assignments(same))
    assert len(assignments(same)) == 3
    kept = choosing(tmp_path, "total_mass: '<= 12 kg'", "[[], [CSG-17-100-2UH]]")
    assert [pick[0] for pick in assignments(kept)] == [None]


def test_a_rated_torque_binds_and_has_its_price(tmp_path: Path) -> None:
    # With a drive that hardly gives, heavier links err less: without the gear's rating they would be heavier still.
    text = "subject_to: {mass: '<= 40 kg', section_size: [20 mm, 140 mm]}\n"
    gear = "actuator: CSG-20-100-2UH, stiffness: 50 MN*m/rad"
    arm = TWO.replace("range: [-120 deg, 120 deg]", f"range: [-120 deg, 120 deg], {gear}")
    problem = problem_of(tmp_path, arm, text)
    assert [limit.text for limit in problem.limits] == ["mass <= 40 kg", "torque_use <= 1"]
    result = optimise(problem)
    assert result.after.drives is not None
    assert result.after.drives.greatest_use == pytest.approx(1.0, rel=1e-4)
    free = optimise(replace(problem, limits=problem.limits[:1]))
    assert free.after.mass > 1.05 * result.after.mass
    assert free.after.max_error < result.after.max_error
    binding = {limit.name: limit for limit in result.binding}
    assert binding["torque_use"].price < 0.0
    assert binding["torque_use"].price == pytest.approx(measured_price(problem, binding["torque_use"]), rel=0.02)


def test_a_gear_too_weak_for_any_design_is_no_answer(tmp_path: Path) -> None:
    with pytest.raises(NoAnswer, match="torque_use"):
        optimise(choosing(tmp_path, "total_mass: '<= 20 kg'", "[[CSG-14-100-2UH], [RV-6E]]"))


def test_the_drives_count_in_mass_and_cost(priced: Path) -> None:
    rich = optimise(choosing(priced, "mass: '<= 6 kg', cost: '<= 2000 EUR'", "[DEAR, CHEAP]"))
    poor = optimise(choosing(priced, "mass: '<= 6 kg', cost: '<= 1300 EUR'", "[DEAR, CHEAP]"))
    names = [[joint.actuator.name for joint in item.arm.joints if joint.actuator] for item in (rich, poor)]
    assert names[0] == ["DEAR", "DEAR"]
    assert sorted(names[1]) == ["CHEAP", "DEAR"]
    assert poor.after.cost is not None
    assert 1200.0 < poor.after.cost <= 1300.0 * (1.0 + 1e-6)
    assert poor.after.max_error > rich.after.max_error


@pytest.mark.slow
def test_minimising_cost_takes_the_cheapest_drives_that_do(priced: Path) -> None:
    loose = optimise(choosing(priced, "max_error: '<= 2 mm'", "[DEAR, CHEAP]", minimize="cost"))
    tight = optimise(choosing(priced, "max_error: '<= 0.75 mm'", "[DEAR, CHEAP]", minimize="cost"))
    assert {joint.actuator.name for joint in loose.arm.joints if joint.actuator} == {"CHEAP"}
    assert any(joint.actuator.name == "DEAR" for joint in tight.arm.joints if joint.actuator)
    assert loose.after.cost == pytest.approx(loose.objective, rel=1e-12)
    assert loose.objective < tight.objective


def test_a_cost_without_a_price_is_wrong_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no price is known of RV-6E"):
        optimise(choosing(tmp_path, "mass: '<= 6 kg', cost: '<= 2000 EUR'", "[RV-6E]"))


@pytest.mark.parametrize(
    ("gears", "message"),
    [("[RV-7E]", "no actuator 'RV-7E'"), ("[]", "empty"), ("[[RV-6E]]", "each of the 2 joints"), ("[5]", "names")],
)
def test_a_choice_that_cannot_be_is_refused(gears: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        choosing(tmp_path, "total_mass: '<= 12 kg'", gears)


def test_only_optimize_settles_a_choice_of_actuators(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="settled by `optimize`"):
        best_value(choosing(tmp_path, "total_mass: '<= 12 kg'"))


def test_joints_that_must_agree_need_an_actuator_in_common(tmp_path: Path) -> None:
    with pytest.raises(NoAnswer, match="in common"):
        optimise(choosing(tmp_path, "total_mass: '<= 12 kg'", "[[RV-6E], [RV-20E]]", ", same: [actuator]"))


def test_a_torque_limit_without_actuators_is_wrong_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs joints whose rated torque is known"):
        problem_of(tmp_path, TWO, "subject_to: {mass: '<= 6 kg', torque_use: '<= 0.5'}\n")


@pytest.mark.slow
def test_a_search_joint_by_joint_is_told_and_no_worse_than_its_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = choosing(tmp_path, "total_mass: '<= 11 kg'")
    whole = optimise(problem)
    monkeypatch.setattr("linkwright.core.optimize.choice.actuators.MOST_ASSIGNMENTS", 4)
    part = optimise(problem)
    assert not part.drives_exhaustive
    assert len(part.drives) <= len(whole.drives)
    alike = replace(problem, same=frozenset({"actuator"}))
    assert whole.objective * (1.0 - 1e-4) <= part.objective <= optimise(alike).objective * (1.0 + 1e-4)


def test_near_ties_are_those_of_all_drives(tmp_path: Path) -> None:
    """Every choice of drives and of materials that is within 3 % when it is solved by itself is listed."""
    text = (
        f"subject_to: {{total_mass: '<= 11 kg', {SIZES}}}\n"
        "choose: {section: [circle], material: [aluminium-6061-t6, aluminium-7075-t6], same: [material],\n"
        "  actuator: [[CSG-25-100-2UH, RV-6E], [CSG-17-100-2UH]]}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise(problem)
    assert problem.materials is not None
    values: dict[tuple[object, ...], float] = {}
    for pick in assignments(problem):
        for material in problem.materials:
            arm = with_actuators(problem.arm, pick)
            own = replace(problem, arm=arm, actuators=None, materials=(material,))
            names = tuple(item.name for item in pick if item is not None)
            try:
                values[names, (material.name,) * 2] = optimise(own).objective
            except NoAnswer:
                continue
    assert result.objective == pytest.approx(min(values.values()), rel=2e-4)
    own = tuple(joint.actuator.name for joint in result.arm.joints if joint.actuator is not None)
    best = own, tuple(link.material.name for link in result.arm.links if link.material is not None)
    ties = {(near_tie.actuators, near_tie.materials): near_tie for near_tie in result.near_ties}
    near = {key for key, value in values.items() if value <= result.objective * 1.0299} - {best}
    assert near
    assert set(ties) >= near
    assert best not in ties
    assert result.near_ties_left == 0
    for key, tie in ties.items():
        assert tie.objective == pytest.approx(values[key], rel=2e-4)
        assert evaluate(tie.arm, problem.workspace).max_error == pytest.approx(tie.max_error, rel=1e-4)
        assert tuple(joint.actuator.name for joint in tie.arm.joints if joint.actuator is not None) == key[0]


LIGHT_OR_HEAVY = """\
format_version: 1
maker: Somebody
references: {list: "Somebody's price list"}
actuators:
  LIGHT: {gear: planetary, rated_torque: 900 N*m, stiffness: 80 kN*m/rad, backlash: 0 arcmin, mass: 1 kg, source: list}
  HEAVY: {gear: planetary, rated_torque: 900 N*m, stiffness: 80 kN*m/rad, backlash: 0 arcmin, mass: 12 kg, source: list}
"""


@pytest.mark.slow
def test_a_heavy_drive_may_be_the_better_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against a force that lifts the tip the weight of a drive between the links helps: what the lightest would err by
    puts no limit out of reach."""
    (tmp_path / "own.yaml").write_text(LIGHT_OR_HEAVY, encoding="utf-8")
    monkeypatch.setenv(USER_ACTUATORS.variable, str(tmp_path / "own.yaml"))
    lifted = jointed(
        [500, 500],
        ranged("-5 5", "-5 5", more=""),
        rest="payload: {mass: 0 kg, force: [0 N, 150 N, 0 N]}\n",
    )
    results: dict[str, float] = {}
    for names in ("LIGHT", "HEAVY"):
        text = f"subject_to: {{{SIZES}, mass: '<= 30 kg'}}\nchoose: {{actuator: [[LIGHT], [{names}]]}}\n"
        results[names] = optimise(problem_of(tmp_path, lifted, text)).objective
    assert results["HEAVY"] < 0.9 * results["LIGHT"]
    limit = 1e3 * (0.6 * results["HEAVY"] + 0.4 * results["LIGHT"])
    text = (
        f"minimize: mass\nsubject_to: {{{SIZES}, max_error: '<= {limit:.5f} mm'}}\n"
        "choose: {actuator: [[LIGHT], [LIGHT, HEAVY]]}\n"
    )
    problem = problem_of(tmp_path, lifted, text)
    assert out_of_reach(problem) == ()
    assert [joint.actuator.name for joint in optimise(problem).arm.joints if joint.actuator] == ["LIGHT", "HEAVY"]


STIFF_OR_SOFT = """\
format_version: 1
maker: Somebody
references: {list: "Somebody's price list"}
actuators:
  STIFF: {gear: planetary, rated_torque: 900 N*m, stiffness: 80 kN*m/rad, backlash: 0 arcmin, mass: 4 kg, source: list}
  SOFT: {gear: planetary, rated_torque: 900 N*m, stiffness: 20 kN*m/rad, backlash: 0 arcmin, mass: 1 kg, source: list}
"""


@pytest.mark.slow
@pytest.mark.parametrize("given", ["", ", stiffness: 50 kN*m/rad"])
@pytest.mark.parametrize("robust", ["worst", "90 %"])
def test_drives_are_chosen_for_what_is_uncertain(
    given: str, robust: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The drive that is best for the arm as it is breaks the limit once it may be softer: another one keeps it, and an
    arm as given without a drive that gives has one that may be softer all the same."""
    (tmp_path / "own.yaml").write_text(STIFF_OR_SOFT, encoding="utf-8")
    monkeypatch.setenv(USER_ACTUATORS.variable, str(tmp_path / "own.yaml"))
    arm = jointed([500], ranged("-30 30", more=given))

    def asked(drives: str, more: str = "") -> Problem:
        text = "minimize: total_mass\nsubject_to: {max_error: '<= 0.8 mm', section_size: [10 mm, 150 mm]}\n"
        return problem_of(tmp_path, arm, f"{text}choose: {{actuator: [{drives}]}}\n{more}")

    soft = f"robust: {robust}\nuncertain: {{stiffness: 40 %}}\n"
    assert optimise(asked("STIFF, SOFT")).drives[0].actuators == ("SOFT",)
    result = optimise(asked("STIFF, SOFT", soft))
    assert [(drive.actuators, drive.outcome) for drive in result.drives] == [
        (("STIFF",), "best"),
        (("SOFT",), "infeasible"),
    ]
    assert result.objective == pytest.approx(optimise(asked("STIFF", soft)).objective, rel=1e-4)
    assert result.robust is not None
    assert result.robust.design.value <= 0.8e-3 * (1.0 + 1e-4)
    with pytest.raises(NoAnswer, match="max_error"):
        optimise(asked("SOFT", soft))


BESIDE = "tilting_stiffness: 60 kN*m/rad, mass: 5 kg, backlash: 2 arcmin, rated_torque: 70 N*m, cost: 500 EUR"


def beside(drive: str) -> str:
    """The arm of two joints, the second of which has a drive and figures of its own beside it."""
    first, second = TWO.rsplit("joint: {", 1)
    return f"{first}joint: {{actuator: {drive}, {BESIDE}, {second}"


def arm_of(folder: Path, text: str) -> Arm:
    (folder / "named.yaml").write_text(text, encoding="utf-8")
    return read_arm(folder / "named.yaml")


@pytest.mark.parametrize("drive", ["CSG-17-100-2UH", "CSG-25-100-2UH", "RV-6E"])
def test_a_chosen_actuator_is_as_if_the_arm_file_named_it(tmp_path: Path, drive: str) -> None:
    """What stands beside its name stays, whichever is chosen; the arm as read from a file that names it is the same."""
    text = f"minimize: max_error\nsubject_to: {{mass: '<= 8 kg', {SIZES}}}\nchoose: {{actuator: [[], [{drive}]]}}\n"
    problem = problem_of(tmp_path, beside("CSG-17-100-2UH"), text)
    (pick,) = assignments(problem)
    assert with_actuators(problem.arm, pick).joints == arm_of(tmp_path, beside(drive)).joints
    stays = stays_beside(problem.arm.joints, {1})
    assert stays is not None
    assert "the arm file's backlash, cost, mass, rated torque, tilting stiffness of joint 2 count" in stays
    assert stays_beside(problem.arm.joints, {0}) is None


def test_an_arm_whose_only_choice_is_its_own_drives_stays_as_it_is(tmp_path: Path) -> None:
    """With lengths and sections given, so that nothing is left to choose."""
    arm = beside("CSG-17-100-2UH")
    size = "{diameter: [60 mm]}"
    text = f"minimize: max_error\nchoose: {{actuator: [[], [CSG-17-100-2UH]], sizes: [{size}, {size}]}}\n"
    result = optimise(problem_of(tmp_path, arm, text))
    given = arm_of(tmp_path, arm)
    assert result.arm.joints == given.joints
    assert result.after.max_error == pytest.approx(result.before.max_error, rel=1e-9)
    assert evaluate(given).max_error == pytest.approx(result.before.max_error, rel=1e-9)
    assert arm_of(tmp_path, arm_to_yaml(result.arm)).joints == given.joints


def test_a_drive_whose_figures_the_joint_gives_can_be_chosen(tmp_path: Path) -> None:
    """A servo of which nobody publishes a rated torque."""
    servo = "actuator: STS3215-C018, stiffness: 27 N*m/rad, rated_torque: 1 N*m"
    arm = TWO.replace("joint: {", f"joint: {{{servo}, ", 1)
    text = (
        f"minimize: max_error\nsubject_to: {{mass: '<= 8 kg', {SIZES}}}\nchoose: {{actuator: [[STS3215-C018], %s]}}\n"
    )
    problem = problem_of(tmp_path, arm, text % "[]")
    (pick,) = assignments(problem)
    assert with_actuators(problem.arm, pick).joints[0].stiffness == 27.0
    with pytest.raises(InputError, match=r"rated_torque: \.\.\.` at joint 2 of the arm file"):
        problem_of(tmp_path, arm, text % "[STS3215-C018]")

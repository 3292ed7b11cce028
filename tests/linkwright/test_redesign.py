"""The design question put again with what a diagnosis found."""

import json
from dataclasses import replace

import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects.elastic.joint_compliance import drive_compliance
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.problem import read_problem
from linkwright.core.units.quantities import InputError
from linkwright.redesigning import (
    STIFFER,
    decisions,
    redesign,
    stiffer_drives,
    with_findings,
    worst_error,
)
from tests.diagnose.made_diagnosis import made_arm, softer, write_recording
from tests.linkwright.reports.test_report import Page

PROBLEM = """\
arm: arm.yaml
subject_to: {mass: "<= 3 kg", section_size: [20 mm, 80 mm], thickness: [2 mm, 10 mm]}
choose: {section: [tube], material: [aluminium-6061-t6]}
"""


@pytest.mark.slow
def test_command_designs_anew(linkwright, bench):
    """The old optimum is worse than it was promised, and the new one no worse than that; said on screen and page."""
    write_recording(bench)
    (bench / "problem.yaml").write_text(PROBLEM, encoding="utf-8")
    status, out, _ = linkwright(
        "diagnose", "arm.yaml", "recording.csv", "--problem", "problem.yaml", "--json", "d.json", "--out", "res"
    )
    assert status == 0
    result = json.loads((bench / "d.json").read_text(encoding="utf-8"))["redesign"]
    assert result["had_mm"] > 1.05 * result["promised_mm"]
    assert result["has_mm"] <= result["had_mm"] * (1.0 + 1e-3)
    assert [item["joint"] for item in result["stiffer_drives"]] == [2]
    text = Page((bench / "res" / "report.html").read_text(encoding="utf-8")).text
    for sentence in result["sentences"]:
        assert sentence in " ".join(out.split())
        assert sentence in text


def test_old_design_keeps_its_links_and_gets_the_physics():
    """Links from the design, everything else from the corrected arm; the error grows by what the drive gives."""
    arm = made_arm()
    corrected = softer(arm, 5e-5)
    design = replace(arm, links=(replace(arm.links[0], length=0.5), *arm.links[1:]))
    both = with_findings(design, corrected)
    assert both.links == design.links
    assert both.effects == corrected.effects
    space = read_space(design)
    assert worst_error(both, *space) > worst_error(design, *space)
    assert worst_error(both, *space) == pytest.approx(evaluate(both).max_error, rel=1e-6)


def read_space(arm):
    from linkwright.core.arm.worst.workspace import Workspace

    return Workspace(), (arm.payload,)


def test_whole_compliance_of_a_drive():
    """The arm file's and what was found add up; left out of the model, only what was found counts."""
    arm = made_arm()
    assert drive_compliance(arm, 1) == pytest.approx(1.0 / 60e3)
    assert drive_compliance(softer(arm, 2e-5), 1) == pytest.approx(1.0 / 60e3 + 2e-5)
    assert drive_compliance(softer(arm, 2e-5), 0) == pytest.approx(1.0 / 60e3)
    left_out = replace(softer(arm, 2e-5), leave_out=frozenset({"joint_compliance"}))
    assert [drive_compliance(left_out, joint) for joint in range(3)] == pytest.approx([0.0, 2e-5, 0.0])
    stiffness = replace(arm, effects=(EffectEntry("joint_compliance", (1,), {"stiffness": 1e5}),))
    assert drive_compliance(stiffness, 0) == pytest.approx(1.0 / 60e3 + 1e-5)


def test_stiffer_drive_is_the_arm_with_that_stiffness():
    """A tenth stiffer is 66 instead of 60 kN*m/rad: the same error as an arm file that says so."""
    arm = made_arm()
    space, cases = read_space(arm)
    before = worst_error(arm, space, cases)
    result = stiffer_drives(arm, space, cases, before)
    assert [item.joint for item in result] == [1, 2, 3]
    for index, each in enumerate(result):
        joints = list(arm.joints)
        joints[index] = replace(joints[index], stiffness=60e3 * (1.0 + STIFFER))
        after = worst_error(replace(arm, joints=tuple(joints)), space, cases)
        assert each.change == pytest.approx(after - before, rel=1e-6)


def test_rigid_drives_have_nothing_to_gain():
    arm = made_arm()
    rigid = replace(arm, joints=tuple(replace(joint, stiffness=None) for joint in arm.joints))
    assert stiffer_drives(rigid, *read_space(rigid), 1.0) == ()


def test_decisions_are_what_differs():
    """A hundredth of a length is no other decision; another length, shape or material is."""
    arm = made_arm()
    link = arm.links[0]
    assert decisions(arm, replace(arm, links=(replace(link, length=0.4001), *arm.links[1:]))) == ()
    longer = replace(arm, links=(arm.links[0], replace(arm.links[1], length=0.5), arm.links[2]))
    assert [(decision.link, decision.what, decision.before, decision.after) for decision in decisions(arm, longer)] == [
        (2, "length", 0.42, 0.5)
    ]


def test_problem_of_another_arm_is_refused(bench):
    asked = read_problem(bench / "problem.yaml")
    with pytest.raises(InputError, match="2 joints"):
        redesign(asked, made_arm(), made_arm())

"""A wire drawn out from an anchor, whose counter begins anywhere: by plain geometry, diagnosed, simulated, planned."""

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.instruments.spatial_arm import Truth, placed, read, session, spatial_arm, tips

ANCHOR, ZERO, SIGMA = (0.7, -0.4, 0.9), 0.037, 20e-6
POSES, PAYLOAD = session(60, seed=3, repeats=2)


def recorded(truth, *, anchor, noise=0.0):
    real = placed(POSES)[0] if truth is None else tips(POSES, PAYLOAD, truth)
    values = np.linalg.norm(real - ANCHOR, axis=1)[:, None] + ZERO
    values = values + noise * np.random.default_rng(4).standard_normal(values.shape)
    slots = np.full((len(POSES), 1), slots_of("draw_wire")[0])
    return read(POSES, PAYLOAD, values, slots=slots, instrument=Instrument(("draw_wire",), anchor=anchor))


@pytest.mark.parametrize("anchor", [ANCHOR, None])
def test_a_sound_arm_leaves_nothing_whatever_the_counter_began_with(anchor):
    observed = observe(spatial_arm(), recorded(None, anchor=anchor))
    assert np.abs(observed.residual).max() < 1e-9
    assert observed.view.names[-1] == "zero of the wire"
    assert len(observed.view.names) == (1 if anchor else 4)


@pytest.mark.parametrize("anchor", [ANCHOR, pytest.param(None, marks=pytest.mark.slow)])
def test_a_zero_of_a_joint_is_named_and_no_zero_of_the_wire(anchor):
    truth = Truth(zeros=(0.0, 0.003, 0.0, 0.0, 0.0))
    result = diagnose(spatial_arm(), recorded(truth, anchor=anchor, noise=SIGMA))
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("encoder_offset", (2,))
    assert abs(finding.parameters[0].value) == pytest.approx(0.003, abs=2e-4)


def test_it_is_simulated_read_and_planned(tmp_path):
    arm = lw.read_arm("examples/welding-arm/arm.yaml")
    anchor = ["1 m", "0.5 m", "0 m"]
    made = lw.simulate(arm, poses=30, observe="draw_wire", anchor=anchor, repeats=1)
    made.save(tmp_path / "r.csv")
    assert "wire_mm" in (tmp_path / "r.csv").read_text().splitlines()[0]
    again = lw.read_recording(tmp_path / "r.csv", arm)
    assert again.found.instrument == made.found.instrument
    assert np.abs(observe(arm.model, again.found).residual).max() < 1e-3
    plan = lw.plan(arm, poses=12, for_=["encoder_offset:2"], repeats=1, instrument="draw_wire", anchor=anchor)
    assert "how far a wire is drawn out" in str(plan.description)
    assert list(plan.shown["effect"]) == ["encoder_offset"]

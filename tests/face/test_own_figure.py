"""A figure through poses that only this file knows: one object, registered once, and every room goes by it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import linkwright as lw

G = 9.81
PAYLOAD, LENGTH = 4.0, 0.5
NAME = "shoulder_moment"


def moment(state: lw.PoseState) -> tuple[object, ...]:
    """The moment on the first joint about its axis."""
    return (state.joints[0].moment[2],)


FIGURE = lw.Figure(
    name=NAME,
    title="moment at the shoulder",
    kind="torque",
    unit="N*m",
    senses=("<=",),
    key="shoulder_moment_Nm",
    follows=lw.at_poses(NAME, moment, either_way=True),
    note="greatest, about its axis",
)


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    """The figure is known for as long as a test runs."""
    lw.limits.register(FIGURE)
    yield
    lw.limits.withdraw(NAME)


def by_hand(arm: lw.Arm) -> float:
    """Stretched out level: payload at the end, each rod's weight in its middle."""
    rods = [(link.material.at(293.15).density, link.section.properties(0.3).area) for link in arm.model.links]
    first, second = (density * area * LENGTH for density, area in rods)
    return G * LENGTH * (2.0 * PAYLOAD + 0.5 * first + 1.5 * second)


def rods() -> lw.Arm:
    """Two steel rods that turn through level."""
    joint = lw.Joint(range=["-60 deg", "90 deg"], stiffness="60 kN*m/rad")
    link = lw.Link(length=LENGTH, section=lw.shapes.Circle(diameter="50 mm"), material="steel-s355")
    return lw.Arm(chain=[(joint, link), (joint, link)], payload={"mass": PAYLOAD})


def test_it_is_evaluated_wherever_figures_are(tmp_path: Path) -> None:
    arm = rods()
    result = lw.evaluate(arm)
    assert result.figures.loc[NAME, "value"] == pytest.approx(by_hand(arm), rel=1e-6)
    assert '"shoulder_moment_Nm": ' in result.to_json()
    result.save(tmp_path)
    assert "moment at the shoulder" in (tmp_path / "report.html").read_text()
    table = lw.sweep(arm, {"chain[2].link.section.diameter": ["50 mm", "60 mm"]}, figures=[NAME])
    thicker = arm.replace("chain[2].link.section.diameter", "60 mm")
    assert np.allclose(table.iloc[:, -1], [by_hand(arm), by_hand(thicker)], rtol=1e-6)


def test_a_limit_on_it_holds() -> None:
    free = lw.optimize(lw.Problem(rods(), subject_to={"section_size": ["20 mm", "60 mm"], "mass": "<= 12 kg"}))
    least = by_hand(free.arm)
    limits = {"section_size": ["20 mm", "60 mm"], "mass": "<= 12 kg", NAME: f"<= {0.9 * least:.6f} N*m"}
    held = lw.optimize(lw.Problem(rods(), subject_to=limits))
    assert by_hand(held.arm) == pytest.approx(0.9 * least, rel=1e-5)
    assert held.max_error_mm > free.max_error_mm
    (price,) = [item.price for item in held.found.binding if item.name == NAME]
    assert price is not None
    assert price < 0.0


def test_it_is_an_axis_of_a_tradeoff() -> None:
    problem = lw.Problem(rods(), subject_to={"section_size": ["20 mm", "60 mm"]})
    front = lw.tradeoff(problem, x=NAME, y="max_error", accuracy=0.1)
    for design in front.designs:
        told = design.figures.loc[NAME, "value"]
        assert told == pytest.approx(by_hand(design.arm), rel=1e-5)
    assert len(front.designs) >= 2


def test_it_is_minimised() -> None:
    """With the error held a lighter arm has less of it: the error is then at its limit."""
    limits = {"section_size": ["20 mm", "60 mm"], "max_error": "<= 2.2 mm"}
    result = lw.optimize(lw.Problem(rods(), minimize=NAME, subject_to=limits))
    assert result.found.objective == pytest.approx(by_hand(result.arm), rel=1e-5)
    assert result.max_error_mm == pytest.approx(2.2, rel=1e-4)
    lightest = lw.optimize(lw.Problem(rods(), minimize="mass", subject_to=limits))
    assert by_hand(result.arm) <= by_hand(lightest.arm) * (1.0 + 1e-6)

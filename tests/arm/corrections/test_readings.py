"""Zeros and scales as ros2_control has them, and all that was found as a table, against chains of their own."""

import csv
import io
import math
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.corrections import CORRECTIONS
from linkwright.core.arm.descriptions.imported import import_robot
from tests.arm.descriptions.urdf_chain import tip_pose

URDF = """<robot name="odd"><link name="base"/><link name="upper"/><link name="fore"/><link name="wrist"/>
  <link name="tool0"/>
  <joint name="slew" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.30"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
  <joint name="lift" type="revolute"><origin rpy="0.2 0.7 -0.3" xyz="0.05 .4 0.1"/><parent link="upper"/>
    <child link="fore"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
  <joint name="reach" type="prismatic"><origin xyz="0.3 0 0"/><parent link="fore"/><child link="wrist"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.3"/></joint>
  <joint name="end" type="fixed"><parent link="wrist"/><child link="tool0"/><origin xyz="0.25 0 0"/></joint>
</robot>"""
NAMES = ("slew", "lift", "reach")
OFFSETS, SCALES = {"lift": 0.01, "reach": -0.002}, {"slew": 0.003, "reach": 0.0004}
FOUND = (
    EffectEntry("encoder_offset", (2,), {"offset": 0.007}),
    EffectEntry("encoder_offset", (2,), {"offset": 0.003}),
    EffectEntry("encoder_offset", (3,), {"offset": -0.002}),
    EffectEntry("encoder_scale", (1,), {"scale": 0.003}),
    EffectEntry("encoder_scale", (3,), {"scale": 0.0004}),
)
BACKLASH = EffectEntry("backlash", (2,), {"total": 0.001})


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "odd.urdf"
    path.write_text(URDF, encoding="utf-8")
    return import_robot(path, base="base", tip="tool0").arm


def read():
    return np.random.default_rng(3).uniform([-1.0, -1.0, 0.0], [1.0, 1.0, 0.3], (6, 3))


def true_tip(readings):
    """Of the machine whose joints stand at (1 + scale) * reading + offset."""
    at = {
        name: (1 + SCALES.get(name, 0.0)) * q + OFFSETS.get(name, 0.0) for name, q in zip(NAMES, readings, strict=True)
    }
    return tip_pose(URDF, "base", "tool0", at)[:3, 3]


def test_transmissions_make_the_true_coordinate_of_what_is_read(arm):
    """By ros2_control's own formula, x_j = x_a / n + x_off."""
    out = CORRECTIONS["ros2-offsets"](replace(arm, effects=(*FOUND, BACKLASH)))
    joints = {
        item.find("joint").get("name"): (
            float(item.findtext("joint/mechanical_reduction")),
            float(item.findtext("joint/offset")),
        )
        for item in ElementTree.fromstring(out.text).findall("transmission")
    }
    assert set(joints) == set(NAMES)
    for readings in read():
        at = {}
        for name, reading in zip(NAMES, readings, strict=True):
            reduction, offset = joints[name]
            at[name] = reading / reduction + offset
        assert tip_pose(URDF, "base", "tool0", at)[:3, 3] == pytest.approx(true_tip(readings), abs=1e-10)
        nominal = tip_pose(URDF, "base", "tool0", dict(zip(NAMES, readings, strict=True)))[:3, 3]
        assert np.abs(nominal - true_tip(readings)).max() > 1e-4
    assert len(out.lost) == 1
    assert "backlash" in out.lost[0]


def rebuilt(rows, column, readings):
    """The tip by the table alone: frames, zeros and scales of joints, then a link of its length along x."""
    where = np.eye(4)
    for number, reading in enumerate(readings, start=1):
        of = {figure: row[column] for (place, figure), row in rows.items() if place == f"joint {number}"}
        value = {figure: float(text) for figure, text in of.items()}
        step = np.eye(4)
        step[:3, :3] = Rotation.from_euler(
            "xyz", [value["roll"], value["pitch"], value["yaw"]], degrees=True
        ).as_matrix()
        step[:3, 3] = 1e-3 * np.array([value["x"], value["y"], value["z"]])
        slides = rows[f"joint {number}", "zero"]["unit"] == "mm"
        zero = value["zero"] * (1e-3 if slides else math.radians(1.0))
        coordinate = zero + (1.0 + value["scale"]) * reading
        move = np.eye(4)
        axis = np.array([value["axis x"], value["axis y"], value["axis z"]])
        if slides:
            move[:3, 3] = coordinate * axis
        else:
            move[:3, :3] = Rotation.from_rotvec(coordinate * axis).as_matrix()
        lead = np.eye(4)
        link = {figure: float(row[column]) for (place, figure), row in rows.items() if place == f"link {number}"}
        lead[:3, 3] = 1e-3 * link["length"] * np.array([link["direction x"], link["direction y"], link["direction z"]])
        lead[:3, :3] = Rotation.from_euler("xyz", [link["roll"], link["pitch"], link["yaw"]], degrees=True).as_matrix()
        where = where @ step @ move @ lead
    tool = {figure: float(row[column]) for (place, figure), row in rows.items() if place == "tool"}
    return (where @ np.array([1e-3 * tool["x"], 1e-3 * tool["y"], 1e-3 * tool["z"], 1.0]))[:3]


def test_the_table_alone_has_the_tip_where_the_machine_has_it(arm):
    out = CORRECTIONS["csv"](replace(arm, effects=(*FOUND, BACKLASH)))
    rows = {(row["place"], row["figure"]): row for row in csv.DictReader(io.StringIO(out.text))}
    for readings in read():
        assert rebuilt(rows, "after", readings) == pytest.approx(true_tip(readings), abs=1e-10)
        nominal = tip_pose(URDF, "base", "tool0", dict(zip(NAMES, readings, strict=True)))[:3, 3]
        assert rebuilt(rows, "before", readings) == pytest.approx(nominal, abs=1e-10)
    assert rows["joint 2", "zero"]["name"] == "lift"
    assert rows["joint 2", "backlash.total"] == {
        "place": "joint 2", "name": "", "figure": "backlash.total", "unit": "rad", "before": "0", "after": "0.001"
    }  # fmt: skip
    assert not out.lost
    assert any(item.startswith("lift: zero 0 deg is now 0.57") for item in out.carried)


def test_the_table_has_lengths_and_axes(arm):
    effects = (
        EffectEntry("link_length", (2,), {"length": 0.002}),
        EffectEntry("axis_misalignment", (2,), {"tilt_u": 0.01}),
    )
    out = CORRECTIONS["csv"](replace(arm, effects=effects))
    rows = {(row["place"], row["figure"]): row for row in csv.DictReader(io.StringIO(out.text))}
    before, after = (float(rows["link 2", "length"][item]) for item in ("before", "after"))
    assert after - before == pytest.approx(2.0)
    turned = [
        Rotation.from_euler(
            "xyz", [float(rows["joint 2", item][at]) for item in ("roll", "pitch", "yaw")], degrees=True
        )
        for at in ("before", "after")
    ]
    assert (turned[0].inv() * turned[1]).magnitude() == pytest.approx(0.01, rel=1e-9)


def test_stretch_is_in_no_format(arm):
    entry = EffectEntry("link_length", (), {"stretch": 1e-4})
    for name in ("csv", "ros2-offsets"):
        assert "link_length" in CORRECTIONS[name](replace(arm, effects=(entry,))).lost[0]

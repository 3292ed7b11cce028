"""`linkwright import`: the arm file, what is lacking, and what is never written over."""

import json
from pathlib import Path

import pytest

import linkwright as lw

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "urdf" / "tabletop.urdf"


@pytest.fixture
def empty(tmp_path, monkeypatch):
    """A folder without files, as the working folder."""
    folder = tmp_path / "empty"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def test_the_arm_file_is_written_once(linkwright, empty):
    """It reads back; a second import does not write over it; the Python face writes the same."""
    status, out, err = linkwright("import", str(EXAMPLE), "--tip", "tip", "--json", "found.json")
    assert (status, err) == (0, "")
    assert "3 joints from base to tip, 2.5 kg that move" in out
    assert "stiffness of the drives" in out
    result = lw.import_arm(EXAMPLE, tip="tip")
    assert (empty / "found.json").read_text(encoding="utf-8") == result.to_json()
    result.save(empty / "same.yaml")
    assert (empty / "same.yaml").read_bytes() == (empty / "arm.yaml").read_bytes()
    content = json.loads(result.to_json())
    assert [joint["link"] for joint in content["joints"]] == ["column", "forearm", "slide"]
    assert [joint["mass_kg"] for joint in content["joints"]] == pytest.approx([1.1, 0.8, 0.6])
    assert lw.read_arm(empty / "arm.yaml").model.lengths == pytest.approx(result.arm.model.lengths)
    assert linkwright("import", str(EXAMPLE), "--tip", "tip")[0] == 2
    status, _, err = linkwright("import", str(EXAMPLE))
    assert status == 2
    assert "arm.yaml: is there already" in err


@pytest.mark.usefixtures("empty")
def test_of_several_tips_of_the_same_joints_one_is_taken(linkwright):
    """The others are named, with how to take one of them; where ends have other joints nothing is written."""
    status, out, err = linkwright("import", str(EXAMPLE), "--out", "one.yaml")
    assert (status, err) == (0, "")
    assert "The tip is tip. With it move finger" in out
    assert "--tip names another" in out
    text = EXAMPLE.read_text(encoding="utf-8").replace(
        'name="pointer" type="fixed"', 'name="pointer" type="continuous"'
    )
    Path("other.urdf").write_text(text, encoding="utf-8")
    status, out, err = linkwright("import", "other.urdf", "--out", "other.yaml")
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert "tip (4 joints), finger (3 joints)" in err
    assert not Path("other.yaml").exists()
    status, _, err = linkwright("import", "nothing.urdf", "--out", "other.yaml")
    assert status == 2
    assert "nothing.urdf: there is no such file" in err


WITHOUT = (
    '<robot name="r"><link name="base"/>{}<joint name="slew" type="revolute"><parent link="base"/><child link="post"/>'
    '<limit lower="-3" upper="3" effort="0" velocity="0"/><axis xyz="0 0 1"/></joint>'
    '<joint name="lift" type="revolute"><parent link="post"/><child link="boom"/>'
    '<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>'
    '<limit lower="-1" upper="1" effort="0" velocity="0"/></joint><joint name="end" type="fixed"><parent link="boom"/>'
    '<child link="tip"/><origin xyz="0.8 0 0"/></joint></robot>'
).format("".join(f'<link name="{name}"/>' for name in ("post", "boom", "tip")))


def test_without_weights_commands_say_which_are_needed(linkwright, empty):
    """A URDF that says no weight: `unknown`, and the link and its key in one line of what needs it."""
    (empty / "robot.urdf").write_text(WITHOUT, encoding="utf-8")
    status, out, _ = linkwright("import", "robot.urdf", "--json", "found.json")
    assert status == 0
    assert "nothing of its weight is known" in out
    content = json.loads((empty / "found.json").read_text(encoding="utf-8"))
    assert [joint["mass_kg"] for joint in content["joints"]] == [None, None]
    assert isinstance(content["not_carried"], list)
    assert linkwright("evaluate", "arm.yaml")[0] == 0
    for asked in (
        ("budget", "arm.yaml"),
        ("export", "arm.yaml", "--to", "mjcf"),
        ("export", "arm.yaml", "--to", "bom"),
    ):
        status, out, err = linkwright(*asked)
        assert (status, out) == (2, "")
        assert err.startswith("arm.yaml: chain[1].link.mass: the mass of link 1, post, is unknown (of link 2 too)")
        assert err.count("\n") == 1
    status, out, _ = linkwright("export", "arm.yaml", "--to", "urdf")
    assert status == 0
    assert "links of unknown mass" in " ".join(out.split())


MESHES = """<mujoco><asset><mesh file="boom.stl"/></asset><worldbody><body name="post"><joint name="slew"/>
  <inertial pos="0 0 0.2" mass="3" diaginertia="0.1 0.1 0.1"/><body name="boom" pos="0 0 0.4"><joint name="lift"
  axis="0 1 0"/><geom type="mesh" mesh="boom"/><site name="tip" pos="0.8 0 0"/></body></body></worldbody></mujoco>"""


def test_a_description_is_asked_for_weights_in_its_own_words(linkwright, empty):
    """No key of an arm file: the body or link, what to write there, and the mesh that is missing."""
    (empty / "robot.urdf").write_text(WITHOUT, encoding="utf-8")
    (empty / "robot.xml").write_text(MESHES, encoding="utf-8")
    for name, words in (
        ("robot.urdf", "link 1, post, is unknown (of link 2 too), and this needs its weight; write <inertial> <mass"),
        ("robot.xml", 'link 2, boom, is unknown, and this needs its weight; write <inertial pos="0.1 0 0" mass="1.2"'),
    ):
        status, out, err = linkwright("export", name, "--to", "mjcf", "--out", "out.xml")
        assert (status, out) == (2, "")
        assert err.startswith(f"{name}: the mass of {words}")
        assert err.count("\n") == 1
        assert "chain[" not in err
    assert "into body boom (boom.stl is not there as a closed STL)" in err

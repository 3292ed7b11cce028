"""`linkwright export`: files for simulators, what they cannot hold, and what is refused."""

import json

import mujoco
import pytest

import linkwright as lw


def test_each_format_is_written(linkwright, bench):
    """Under the arm file's name, once; JSON and the Python face say the same."""
    for form, name in (("urdf", "arm.urdf"), ("mjcf", "arm.xml")):
        status, out, err = linkwright("export", "arm.yaml", "--to", form, "--json", "said.json")
        assert (status, err) == (0, "")
        assert f"written: {name}" in out
        result = lw.export_arm(bench / "arm.yaml", to=form)
        assert (bench / name).read_text(encoding="utf-8") == result.text
        assert (bench / "said.json").read_text(encoding="utf-8") == result.to_json()
        for words in json.loads(result.to_json())["not_carried"]:
            assert f"Not in this file: {words}." in result.text
            assert words in " ".join(out.split()) or len(words) > 40
    assert mujoco.MjModel.from_xml_path(str(bench / "arm.xml")).nu == lw.read_arm(bench / "arm.yaml").model.size
    status, _, err = linkwright("export", "arm.yaml", "--to", "urdf")
    assert status == 2
    assert "arm.urdf: is there already" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("arm.yaml", "--to", "collada"), "--to: 'collada' is no format; write urdf, mjcf, dxf, step, bom"),
        (("arm.yaml",), "--to: is due, or --into FILE"),
        (("arm.yaml", "--to", "urdf", "--into", "arm.urdf"), "--to: is due, or --into FILE, but not both"),
        (("arm.yaml", "--into", "nothing.urdf"), "nothing.urdf: there is no such file"),
        (("arm.yaml", "--to", "urdf", "--out", "arm.yaml"), "is the input"),
    ],
)
@pytest.mark.usefixtures("bench")
def test_wrong_input_is_one_line(linkwright, arguments, words):
    """With what would do."""
    status, out, err = linkwright("export", *arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert err.count("\n") == 1


def test_what_was_found_goes_into_the_users_own_file(linkwright, bench):
    """A new file beside it, which is never written over unasked; the file itself stays as it is."""
    linkwright("export", "arm.yaml", "--to", "urdf", "--out", "robot.urdf")
    before = (bench / "robot.urdf").read_bytes()
    text = (bench / "arm.yaml").read_text(encoding="utf-8")
    (bench / "found.yaml").write_text(text + "effects:\n  - {effect: encoder_offset, at: 1, offset: 0.5 deg}\n")
    status, out, err = linkwright("export", "found.yaml", "--into", "robot.urdf", "--json", "said.json")
    assert (status, err) == (0, "")
    assert "written: robot-corrected.urdf" in out
    content = json.loads((bench / "said.json").read_text(encoding="utf-8"))
    assert content["to"] == "urdf"
    assert len(content["carried"]) == 1
    assert "joint1: rpy" in content["carried"][0]
    assert (bench / "robot.urdf").read_bytes() == before
    result = lw.export_arm(bench / "found.yaml", into=bench / "robot.urdf")
    assert (bench / "robot-corrected.urdf").read_bytes() == result.text.encode()
    status, _, err = linkwright("export", "found.yaml", "--into", "robot.urdf")
    assert (status, "robot-corrected.urdf: is there already" in err) == (2, True)
    status, _, err = linkwright("export", "found.yaml", "--into", "robot.urdf", "--out", "robot.urdf")
    assert (status, "is the input" in err) == (2, True)

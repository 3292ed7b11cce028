"""`linkwright export`: files for simulators, what they cannot hold, and what is refused."""

import json

import mujoco
import pytest

import linkwright as lw


def test_each_format_is_written(linkwright, bench):
    """Under the arm file's name, once; JSON and the Python face say the same."""
    for form, name in (("urdf", "arm.urdf"), ("mjcf", "arm.xml"), ("sdf", "arm.sdf")):
        status, out, err = linkwright("export", "arm.yaml", "--to", form, "--json", "said.json")
        assert (status, err) == (0, "")
        assert f"written: {name}" in out
        found = lw.export_arm(bench / "arm.yaml", to=form)
        assert (bench / name).read_text(encoding="utf-8") == found.text
        assert (bench / "said.json").read_text(encoding="utf-8") == found.to_json()
        for words in json.loads(found.to_json())["not_carried"]:
            assert f"Not in this file: {words}." in found.text
            assert words in " ".join(out.split()) or len(words) > 40
    assert mujoco.MjModel.from_xml_path(str(bench / "arm.xml")).nu == lw.read_arm(bench / "arm.yaml").model.size
    status, _, err = linkwright("export", "arm.yaml", "--to", "urdf")
    assert status == 2
    assert "arm.urdf: is there already" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("arm.yaml", "--to", "collada"), "--to: 'collada' is no format; write urdf, mjcf, sdf, dxf, step, bom"),
        (("arm.yaml",), "Missing option '--to'"),
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

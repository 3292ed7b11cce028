"""Files of somebody who meets YAML for the first time: each mistake is one line that says where and what would do."""

import re

import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml

ARM = """name: bench arm
gravity: [0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {range: [-30 deg, 120 deg], mass: 1.2 kg, stiffness: 20000 N*m/rad}
    link: {length: 350 mm, section: {shape: tube, diameter: 40 mm, thickness: 3 mm}, material: aluminium-6082-t6}
  - joint: {range: [-150 deg, 150 deg], mass: 0.6 kg, stiffness: 8000 N*m/rad}
    link: {length: 300 mm, section: {shape: tube, diameter: 40 mm, thickness: 3 mm}, material: aluminium-6082-t6}
payload: {mass: 2 kg}
"""
CHAIN_AS_MAPPING = "chain:\n  joint: {range: [-30 deg, 120 deg]}\n  link: {length: 350 mm, rigid: true}\n"


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ("    link: {length: 350", "\tlink: {length: 350", "line 5: is indented by a tab; YAML is indented by blanks"),
        ("    link: {length: 350", "\u00a0   link: {length: 350", "line 5: is indented by a no-break space"),
        ("chain:", "chain", "line 3 near 'chain': no colon follows this; write 'key: value'"),
        ("name: bench", "name:bench", "line 2 near 'gravity: .*goes on from the line above, which lacks its colon"),
        ("name: bench arm", "name: arm: v2", r"line 1 near 'name: arm: v2': a second colon .* needs quotes"),
        ("name: bench arm", "name: @arm", "line 1 near 'name: @arm': a text that begins with @ needs quotes"),
        ("name: bench arm", 'name: "arm', "line 1 near 'name: \"arm': the quote that opens here is never closed"),
        ("name: bench arm", "name: 2026", "name: needs a text, not 2026; write '2026' in quotes"),
        ("{mass: 2 kg}", "{mass: 2 kg", "line 8 .*the bracket that opens here is never closed; '}' is missing"),
        ("1.2 kg, stiff", "1.2 kg stiff", "line 4 near '.*1.2 kg stiffness: .*a comma or '}' is missing before this"),
        ("    link: {length: 350", "   link: {length: 350", "line 5 near .*does not begin in the column"),
        ("{length: 350 mm", "{length: 0,4 m", "line 5: the comma ends the number in '0,4 m'; write a decimal point"),
        ("-9.81 m/s^2", "-9,81 m/s^2", r"line 2: the comma ends the number in '-9,81 m/s\^2'"),
        ("20000 N", "20,000 N", "line 4: .*'20,000 N\\*m/rad'; .*thousands without a mark"),
        ("[0 m/s^2, -9.81 m/s^2]", "9.81", r"gravity: needs a list of x, y and z, e.g. \[0 m/s\^2, -9.81 m/s\^2"),
        (ARM, CHAIN_AS_MAPPING, "chain: needs a list of entries that each begin with '- '"),
        (
            "    link: {length: 350",
            "  - link: {length: 350",
            r"chain\[2\].joint: is missing; .*each '- ' begins another",
        ),
        ("joint: {range: [-30 deg, 120 deg], mass: 1.2 kg, stiffness: 20000 N*m/rad}", "joint:", "joint: is empty;"),
        ("[-30 deg, 120 deg]", "120 deg", r"needs a range of two, lowest and highest, e.g. \[0 deg, 0.5 deg\]"),
        ("bench arm", ">= 1", "line 1 near 'name: >= 1': a text that begins with > or | needs quotes"),
        ("name: bench arm", "leave_out: bending", r"leave_out: needs a list, e.g. \[bending\], not 'bending'"),
        ("{mass: 2 kg}", "2 kg", r"payload: needs its keys: payload: {mass: 2 kg}"),
        (
            "{shape: tube, diameter: 40 mm, thickness: 3 mm}",
            "pipe",
            r"write {shape: tube, diameter: ..., thickness: ...}",
        ),
    ],
)
def test_a_mistake_is_one_line_that_says_what_would_do(tmp_path, right, wrong, said):
    assert right in ARM
    path = tmp_path / "arm.yaml"
    path.write_text(ARM.replace(right, wrong, 1), encoding="utf-8")
    with pytest.raises(InputError, match=said) as caught:
        read_arm(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")


def test_what_is_right_stays_right(tmp_path):
    assert parse_yaml("{a: [0,0,1], b: [0,5 mm], c: {1: 5,2: 6}, d: [1,2,3]}", file="f") == {
        "a": [0, 0, 1],
        "b": [0, "5 mm"],
        "c": {"1": 5, "2": 6},
        "d": [1, 2, 3],
    }
    path = tmp_path / "arm.yaml"
    path.write_text(ARM.replace("-30 deg", "\u201330 deg", 1), encoding="utf-8")
    assert read_arm(path).joints[0].range[0] == pytest.approx(-0.5235987755982988)


def test_the_line_of_the_mistake_is_named_or_the_next():
    """Whatever mark is forgotten, the parser gives up there or on the line after."""
    lines = {place: line_named(ARM[:place] + ARM[place + 1 :]) for place, mark in enumerate(ARM) if mark in ":,{}[]- "}
    late = {place: line - 1 - ARM.count("\n", 0, place) for place, line in lines.items() if line is not None}
    assert len(late) > 50
    assert {*late.values()} == {0, 1}


def line_named(text: str) -> int | None:
    """The line of the mistake by the message; None where the text is YAML still."""
    try:
        parse_yaml(text, file="f.yaml")
    except InputError as error:
        result = re.match(r"f\.yaml: line (\d+)", str(error))
        return int(result[1]) if result else -99
    return None


def test_a_word_that_several_names_hold_names_them_all():
    known = ["steel-s235", "steel-s355", "steelite", "pla-printed"]
    assert nearest("Steel", known) == "; did you mean one of steel-s235, steel-s355?"
    assert nearest("PLA", known) == "; did you mean 'pla-printed'?"
    assert nearest("steel_s355", known) == "; did you mean 'steel-s355'?"

"""Splices in YAML text: the change and nothing else, whatever comments, quotes and layout stand around it."""

import random

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml, yaml_line

TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs",)), min_size=0, max_size=20)
PLAIN = st.sampled_from(["1 GPa", "on", "1e3", "012", "~", "null", "- x", "a: b", "a #b", "12 um/(m*K)", "'q'", ""])


@given(st.one_of(TEXTS, PLAIN))
def test_any_text_is_written_so_that_it_reads_back(text):
    assert parse_yaml(f"[{yaml_line(text)}]", file="") == [text]
    assert parse_yaml(yaml_line({text: 1}), file="") == {text: 1}


NAMES = ["alpha", "beta 2", "gamma.x", "delta", "on"]
INNER = st.lists(st.sampled_from(["# in it", "      # in it, too", ""]), max_size=2)
COMMENTS = st.lists(st.sampled_from(["# one", "#two: 2", "# three 'q", "", "  # four {"]), max_size=2)


@st.composite
def documents(draw):
    """A catalogue-like file with comments wherever YAML lets them stand, block and flow entries mixed."""
    lines = [*draw(COMMENTS), "format_version: 1  # head"]
    names = draw(st.lists(st.sampled_from(NAMES), min_size=1, unique=True))
    lines += [*draw(COMMENTS), "materials:" + draw(st.sampled_from(["", "   # list"]))]
    for name in names:
        lines += ["  " + line.strip() if line.strip() else "" for line in draw(COMMENTS)]
        key = draw(st.sampled_from([name, f'"{name}"', f"'{name}'"]))
        if draw(st.booleans()):
            lines.append(f"  {key}: {{density: {{value: 1 kg/m^3, source: x}}, title: 'it''s'}}   # flow # {name}")
            continue
        lines.append(f"  {key}:  # block")
        lines += ["    density:", "      value: 1 kg/m^3  # inner", *draw(INNER), "      source: x"]
        lines += draw(
            st.sampled_from([["    title: plain"], ["    title: >-  # folded", "      two", "      lines"], []])
        )
        lines += draw(st.sampled_from([[], ["    table: [[1, 2],", "      [3, 4]]  # rows"]]))
    if draw(st.booleans()):
        lines += ["family: x # tail", *draw(COMMENTS)]
    newline = draw(st.sampled_from(["\n", "\r\n"]))
    return newline.join(lines) + draw(st.sampled_from(["", newline])), names


def comments_of(text):
    return sorted(line[line.index("#") :].strip() for line in text.splitlines() if "#" in line)


@settings(deadline=None, max_examples=80)
@given(documents(), st.randoms(use_true_random=False))
def test_an_edit_keeps_comments_and_order_and_changes_only_its_place(document, chance: random.Random):
    text, names = document
    name = chance.choice(names)
    edited = YamlText(text, file="f")
    before = parse_yaml(text, file="f")

    edited.set(["materials", name, "density", "value"], "2 kg/m^3")
    edited.set(["materials", name, "cost"], {"value": "1 EUR/kg", "source": "y"})
    edited.extend(["materials"], {"new one": {"density": "3 kg/m^3"}, "another": {"density": "4 kg/m^3"}})
    edited.remove(["materials", "another"])
    after = parse_yaml(edited.text, file="f")
    assert comments_of(edited.text) == comments_of(text)
    assert list(after["materials"]) == [*names, "new one"]
    before["materials"][name]["density"]["value"] = "2 kg/m^3"
    before["materials"][name]["cost"] = {"value": "1 EUR/kg", "source": "y"}
    before["materials"]["new one"] = {"density": "3 kg/m^3"}
    assert after == before

    edited.remove(["materials", "new one"])
    edited.remove(["materials", name, "cost"])
    edited.set(["materials", name, "density", "value"], "1 kg/m^3")
    assert parse_yaml(edited.text, file="f") == parse_yaml(text, file="f")
    assert comments_of(edited.text) == comments_of(text)


@settings(deadline=None, max_examples=60)
@given(documents(), st.randoms(use_true_random=False))
def test_a_removal_keeps_the_comments_around(document, chance: random.Random):
    text, names = document
    index = chance.randrange(len(names))
    edited = YamlText(text, file="f")
    edited.remove(["materials", names[index]])
    assert list(parse_yaml(edited.text, file="f")["materials"] or {}) == names[:index] + names[index + 1 :]
    outside = [line.strip() for line in text.splitlines() if line.startswith(("#", "  #")) and "in it" not in line]
    assert all(edited.text.count(line) >= outside.count(line) for line in outside)


def test_a_plain_edit_changes_one_line_only():
    text = "# a\nmaterials:\n  # of x\n  x:   {a: 1, b: 'two'}   # keep\n\n"
    text += "  y:\n    a: >-\n      long\n      text\n# end\n"
    edited = YamlText(text, file="f")
    edited.set(["materials", "x", "a"], 2)
    assert edited.text == text.replace("  {a: 1, b: 'two'}", "{a: 2, b: 'two'}  ")
    edited.set(["materials", "y", "a"], "short")
    assert edited.text.endswith("  y:\n    a: short\n# end\n")


def test_an_empty_mapping_opens_and_closes():
    edited = YamlText("materials: {}  # none yet", file="f")
    edited.set(["materials", "x"], {"a": "b"}, block=True)
    assert edited.text.split("\n") == [edited.text.partition("\n")[0], "  x:", "    a: b", ""]
    assert edited.text.split()[:4] == ["materials:", "#", "none", "yet"]
    edited.remove(["materials", "x"])
    assert yaml.safe_load(edited.text) == {"materials": {}}
    assert "# none yet" in edited.text


@pytest.mark.parametrize("path", [["materials", "no"], ["none", "x"]])
def test_what_is_not_there_cannot_be_removed(path):
    with pytest.raises(InputError, match=r"f: "):
        YamlText("materials: {x: {a: 1}}", file="f").remove(path)


def test_a_value_is_no_place_for_keys():
    with pytest.raises(InputError, match="holds no keys"):
        YamlText("materials: {x: 1}", file="f").set(["materials", "x", "a"], 1)


ODD = """\
---
# head
"format_version":   1
on: ~   # kept
numbers: [+5,  1e3, 012,
  .5]  # and these
none:
many: {a: 1, # of a
  b: 'x'}

materials:
  first: {a: 1}   # of the first
  # before the second

  second:
    a:  "q"  # two blanks
    b: plain
      over two lines
    c: |
      # no comment
      text

    # before d
    d: 1
"""


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_what_an_edit_does_not_name_stays_to_the_letter(newline):
    text = ODD.replace("\n", newline)
    edited = YamlText(text, file="f")
    edited.set(["materials", "second", "d"], 2)
    assert edited.text == text.replace("d: 1", "d: 2")
    edited.remove(["materials", "second", "c"])
    edited.remove(["materials", "first"])
    kept = text.replace("d: 1", "d: 2").replace(f"  first: {{a: 1}}   # of the first{newline}", "")
    assert edited.text == kept.replace("    c: |\n      # no comment\n      text\n".replace("\n", newline), "")
    edited.extend(["materials"], {"fourth": {"a": 1}})
    assert edited.text.endswith("    d: 2\n  fourth:\n    a: 1\n".replace("\n", newline))


def test_comments_inside_brackets_are_not_lost_without_a_word():
    with pytest.raises(InputError, match="f: has comments inside brackets, which would be lost; edit it by hand"):
        YamlText(ODD, file="f").set(["many", "a"], 2)

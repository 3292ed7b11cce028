"""Reading YAML key by key: every mistake is one line with file, key and what would do."""

from pathlib import Path

import pytest

from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, load_yaml, parse_bundled_yaml, parse_yaml

CORE = Path(__file__).parents[2] / "linkwright" / "core"


def parse(text):
    return parse_yaml(text, file="f.yaml")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3", "line 3: the key 'a' occurs twice"),
        ("x:\n  a: 1\n  a: 2", "line 3: the key 'a' occurs twice"),
        ("a: [1, 2", "line 1"),
        ("a: b: c", "line 1"),
        ("a:\tb", "line 1"),
        ("a: &x 1\nb: *x", "aliases"),
        ("a: &x [*x]", "aliases"),
        ("a: {<<: {b: 1}}", "merge"),
        ("? [1, 2]\n: 3", "plain text"),
        ("a: !!python/object/apply:os.system ['true']", "tags"),
        ("a: !!timestamp 400 mm", "tags"),
        ("a: " + "[" * 500 + "]" * 500, "nested too deeply"),
        ("a: 1\n---\nb: 2", "document"),
        ("a: \x07", "not YAML"),
    ],
)
def test_refuses_what_is_not_plain_yaml(text, words):
    with pytest.raises(InputError) as caught:
        parse(text)
    assert str(caught.value).startswith("f.yaml: ")
    assert "\n" not in str(caught.value)
    assert words in str(caught.value)


def test_words_mean_what_they_say():
    content = parse("y: on\nno: y\na: 012\nb: 1e3\nc: 1:30\nd: 2024-01-01\ne: true\nf: 5\ng: ~\n400: x")
    assert content == {
        "y": "on",
        "no": "y",
        "a": 12,
        "b": 1000.0,
        "c": "1:30",
        "d": "2024-01-01",
        "e": True,
        "f": 5,
        "g": None,
        "400": "x",
    }


@pytest.mark.parametrize("folder", ["materials/catalogue", "arm/actuators", "sections/stock"])
def test_the_programs_own_files_are_plain_yaml_that_the_c_parser_reads_alike(folder):
    results = sorted((CORE / folder).glob("*.yaml"))
    assert results
    for path in results:
        text = path.read_text(encoding="utf-8")
        assert parse_bundled_yaml(text) == parse_yaml(text, file=path), path.name


def test_files_that_cannot_be_read(tmp_path):
    latin = tmp_path / "latin.yaml"
    latin.write_bytes("name: Träger".encode("latin-1"))
    empty = tmp_path / "empty.yaml"
    empty.write_text("# nothing\n")
    listing = tmp_path / "list.yaml"
    listing.write_text("- 1\n")
    for path, words in [
        (tmp_path / "none.yaml", "no such file"),
        (tmp_path, "directory"),
        (latin, "UTF-8"),
        (empty, "empty"),
        (listing, "needs keys"),
        ("a\0b", "cannot be read"),
    ]:
        with pytest.raises(InputError, match=words):
            load_yaml(path)


def test_byte_order_mark_is_no_key(tmp_path):
    path = tmp_path / "bom.yaml"
    path.write_bytes(b"\xef\xbb\xbfname: arm\n")
    assert load_yaml(path).text("name") == "arm"


def link(content):
    return Mapping(content, file="arm.yaml", key="chain[1].link")


def test_reads_each_kind_of_entry():
    mapping = link(
        {
            "length": "400 mm",
            "ratio": "1e-1",
            "count": 3,
            "name": "upper",
            "rigid": True,
            "range": ["-1 deg", "1 deg"],
            "gravity": ["0 m/s^2", "-9.81 m/s^2", "0 m/s^2"],
            "section": {"shape": "circle"},
            "parts": [{"mass": "1 kg"}, {"mass": "2 kg"}],
            "limit": "<= 26 kg",
            "empty": None,
        }
    )
    assert mapping.quantity("length", "length") == 0.4
    assert mapping.number("ratio") == 0.1
    assert mapping.integer("count") == 3
    assert mapping.text("name") == "upper"
    assert mapping.boolean("rigid") is True
    assert mapping.range("range", "angle")[1] == pytest.approx(0.0174532925199)
    assert mapping.vector("gravity", "acceleration", 3) == (0, -9.81, 0)
    assert mapping.mapping("section").choice("shape", ["circle", "tube"]) == "circle"
    assert [part.quantity("mass", "mass") for part in mapping.mappings("parts")] == [1, 2]
    assert mapping.mappings("parts")[1].key == "chain[1].link.parts[2]"
    assert mapping.bound("limit", "mass").value == 26
    assert mapping.optional_quantity("empty", "mass") is None
    assert mapping.quantity("absent", "mass", 7.0) == 7.0
    mapping.close()


@pytest.mark.parametrize(
    ("read", "words"),
    [
        (lambda m: m.quantity("missing", "length"), "link.missing: is missing; write e.g. '400 mm'"),
        (lambda m: m.quantity("width", "length"), "did you mean 'width'"),
        (lambda m: m.text("count"), "link.count: needs a text, not 3"),
        (lambda m: m.integer("name"), "needs a whole number"),
        (lambda m: m.integer("flag"), "needs a whole number, not True"),
        (lambda m: m.boolean("count"), "needs true or false"),
        (lambda m: m.items("name"), "needs a list"),
        (lambda m: m.mapping("name"), "needs keys"),
        (lambda m: m.choice("name", ["worst", "loaded"]), "did you mean 'worst'"),
        (lambda m: m.choice("count", ["worst", "loaded"]), "link.count: 3 is not one of worst, loaded"),
        (lambda m: m.vector("three", "length", 2), "needs 2 values, not 3"),
    ],
)
def test_wrong_entries_say_what_would_do(read, words):
    three = ["1 m", "1 m", "1 m"]
    mapping = link({"count": 3, "name": "wrost", "flag": True, "three": three, "widht": "1 mm"})
    with pytest.raises(InputError) as caught:
        read(mapping)
    assert str(caught.value).startswith("arm.yaml: chain[1].link")
    assert words in str(caught.value)


def test_unknown_key_names_the_nearest_known_one():
    def read(mapping):
        with mapping.reading():
            mapping.quantity("length", "length")
            mapping.text("material", "steel-s355")

    read(link({"length": "1 m", "material": "x"}))
    with pytest.raises(InputError, match="unknown key 'materail'; did you mean 'material'"):
        read(link({"length": "1 m", "materail": "x"}))


def test_a_known_key_is_no_error_and_other_keys_may_be_read_elsewhere():
    mapping = link({"length": "1 m", "other": 1})
    mapping.quantity("length", "length")
    with pytest.raises(InputError, match="other"):
        mapping.close()
    mapping.close("other")

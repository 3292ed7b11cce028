"""`linkwright actuators`, and actuators in the other commands' output."""

from __future__ import annotations

import json
import math

import pytest

from linkwright.core.arm.actuators import (
    CONFIRMABLE,
    USER_ACTUATORS,
    load_actuators,
    read_actuators,
    shipped_actuators,
)
from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.reading import load_yaml
from linkwright.results.figures_in_words import with_unit

OWN = """\
format_version: 1
maker: Somebody
references: {list: "Somebody's price list"}
actuators:
  TURNER 1: {gear: planetary, rated_torque: 30 N*m, stiffness: 5 kN*m/rad, backlash: 3 arcmin, mass: 2 kg, source: list,
             cost: {value: 800 EUR, spread: [700 EUR, 950 EUR], date: 2026-01}}
"""

CHOICE = """\
arm: arm.yaml
subject_to: {total_mass: "<= 16 kg", section_size: [20 mm, 80 mm], thickness: [2 mm, 10 mm]}
choose: {section: [tube], material: [aluminium-6061-t6], actuator: [RV-6E, CSG-25-100-2UH]}
"""


@pytest.fixture(autouse=True)
def _shipped_only(monkeypatch):
    monkeypatch.delenv(USER_ACTUATORS.variable, raising=False)


def test_list_shows_all_and_filters_by_torque(linkwright, bench):
    status, out, _ = linkwright("actuators", "list", "--json", "all.json")
    everything = json.loads((bench / "all.json").read_text())["actuators"]
    assert status == 0
    assert all(item["name"] in out for item in everything)
    status, out, _ = linkwright("actuators", "list", "--least-torque", "1 kN*m", "--json", "strong.json")
    strong = json.loads((bench / "strong.json").read_text())["actuators"]
    assert status == 0
    assert [item["name"] for item in strong] == [
        e["name"] for e in everything if (e["rated_torque_Nm"] or 0.0) >= 1000.0
    ]
    assert 0 < len(strong) < len(everything)
    assert linkwright("actuators", "list", "--least-torque", "100 kN*m")[1].startswith("no actuator")


def test_show_gives_every_figure_with_its_source(linkwright, bench):
    status, out, _ = linkwright("actuators", "show", "RV-20E", "--json", "one.json")
    result = json.loads((bench / "one.json").read_text())
    assert status == 0
    assert "Nabtesco" in out
    assert "not known" in out
    assert result["cost_EUR"] is None
    assert result["stiffness_Nm_per_rad"] == pytest.approx(49.0 * 60.0 * 180.0 / math.pi, rel=1e-12)
    assert result["backlash_arcmin"] == pytest.approx(1.0, rel=1e-12)


def test_each_figure_that_nobody_could_find_is_marked(linkwright, bench):
    _, out, _ = linkwright("actuators", "list", "--json", "all.json")
    marks = {load["name"]: load["unconfirmed"] for load in json.loads((bench / "all.json").read_text())["actuators"]}
    assert set(marks["RV-20E"]) == {"stiffness"}
    assert set(marks["RV-6E"]) == {"rated_torque", "peak_torque", "stiffness", "backlash", "mass"}
    (row,) = (line for line in out.splitlines() if line.startswith("RV-20E"))
    assert row.count("?") == 1
    assert "could not be found" in out
    _, out, _ = linkwright("actuators", "show", "CSG-20-100-2UH", "--json", "one.json")
    assert "0.98 kg ?" not in out
    assert "16 kN·m/rad ?" in out
    assert "? stiffness, not confirmed: in no text" in out
    assert "harmonicdrive.net" in json.loads((bench / "one.json").read_text())["found_in"]


def test_a_figure_of_ones_own_is_confirmed(linkwright, bench):
    edit = ("--source", "Weighed", "--catalogue", "own.yaml")
    assert linkwright("actuators", "edit", "CSG-25-100-2UH", "mass", "1.6 kg", *edit)[0] == 0
    assert dict(load_actuators([bench / "own.yaml"]).find("CSG-25-100-2UH").unconfirmed).keys() == {"stiffness"}
    assert linkwright("actuators", "edit", "RV-20E", "stiffness", "50 N*m/arcmin", *edit)[0] == 0
    assert load_actuators([bench / "own.yaml"]).find("RV-20E").unconfirmed == ()
    assert linkwright("actuators", "edit", "RV-6E", "mass", "2.6 kg", *edit)[0] == 0
    assert "mass" not in dict(load_actuators([bench / "own.yaml"]).find("RV-6E").unconfirmed)
    known = load_actuators([bench / "own.yaml"]).find("RV-6E")
    assert len(known.unconfirmed) == sum(getattr(known, item) is not None for item in CONFIRMABLE) - 1


def test_every_shipped_figure_was_found_or_is_marked():
    for actuator in load_actuators(user=False):
        assert actuator.found_in or {name for name, _ in actuator.unconfirmed} >= {
            name for name in CONFIRMABLE if getattr(actuator, name) is not None
        }


def test_a_servo_needs_beside_it_what_nobody_publishes(linkwright, bench):
    """Its stiffness: one line asks for it, and so does a choice, which has no place for it."""
    text = (bench / "arm.yaml").read_text()
    servo = text.replace("backlash: 3 arcmin", "actuator: MX-64", 1)
    (bench / "servo.yaml").write_text(servo)
    status, _, error = linkwright("evaluate", "servo.yaml")
    assert status == 2
    assert "stiffness: is not known of MX-64; write `stiffness: ... N*m/rad` beside the actuator" in error
    (bench / "servo.yaml").write_text(servo.replace("MX-64", "17HS19-1684S-PG27"))
    assert "write `stiffness: ... N*m/rad, mass: ... kg` beside" in linkwright("evaluate", "servo.yaml")[2]
    (bench / "servo.yaml").write_text(servo.replace("actuator: MX-64", "actuator: MX-64, stiffness: 200 N*m/rad"))
    assert linkwright("evaluate", "servo.yaml", "--json", "servo.json")[0] == 0
    (drive,) = (load for load in json.loads((bench / "servo.json").read_text())["drives"] if load["actuator"])
    assert (drive["rated_torque_Nm"], drive["peak_torque_Nm"]) == (None, 6.0)
    (bench / "choice.yaml").write_text(CHOICE.replace("CSG-25-100-2UH", "MX-64"))
    status, _, error = linkwright("optimize", "choice.yaml")
    assert status == 2
    assert "cannot choose MX-64, whose rated torque, stiffness the catalogue does not know" in error


def test_what_is_not_known_is_a_dash(linkwright):
    (row,) = (line for line in linkwright("actuators", "list")[1].splitlines() if line.startswith("STS3215"))
    assert row.split()[1:] == ["servo", "–", "2.94", "0.027", "52.2", "0.055", "?", "–"]
    out = linkwright("actuators", "show", "STS3215-C018")[1]
    assert "not known" in out
    assert "SO-ARM100, issue 134" in out


def test_an_actuator_without_any_figure_is_refused(linkwright, bench):
    (bench / "own.yaml").write_text(
        "format_version: 1\nmaker: X\nreferences: {a: b}\nactuators: {N 1: {gear: belt, ratio: 3, source: a}}\n"
    )
    status, _, error = linkwright("actuators", "check", "own.yaml")
    assert status == 2
    assert "has no figure" in error


@pytest.mark.parametrize("name", ["CSG-20-100-2UH", "RV-6E"])
def test_marks_go_with_a_table(linkwright, bench, name):
    assert linkwright("actuators", "export", name, "--out", "one.csv")[0] == 0
    assert linkwright("actuators", "import", "one.csv", "--catalogue", "own.yaml")[0] == 0
    one, shipped = load_actuators([bench / "own.yaml"]).find(name), load_actuators(user=False).find(name)
    assert one.file.endswith("own.yaml")
    assert one.unconfirmed == shipped.unconfirmed
    assert one.found_in == ("" if name == "RV-6E" else shipped.found_in)


def test_zones_of_stiffness_and_prices_go_with_a_table(linkwright, bench):
    """Which end at one torque, in a cell by itself; and so does a price, with its spread and its date."""
    (bench / "own.yaml").write_text(
        OWN.replace("stiffness: 5 kN*m/rad", "stiffness: [5 kN*m/rad, 7 kN*m/rad], zone_torques: [3 N*m]")
    )
    assert linkwright("actuators", "export", "TURNER 1", "--out", "one.csv", "--catalogue", "own.yaml")[0] == 0
    assert linkwright("actuators", "import", "one.csv", "--catalogue", "other.yaml")[0] == 0
    again = read_actuators(load_yaml(bench / "other.yaml"))["TURNER 1"]
    assert (again.stiffnesses, again.zone_torques) == ((5e3, 7e3), (3.0,))
    assert (again.cost, again.cost_spread, again.cost_date) == (800.0, (700.0, 950.0), "2026-01")


@pytest.mark.parametrize(
    ("mark", "found", "words"),
    [
        ("unconfirmed: nothing found", 4, ""),  # its rated torque, stiffness, backlash and mass
        ("unconfirmed: {mass: nothing found}", 1, ""),
        ("unconfirmed: {weight: nothing found}", 0, "unknown key 'weight'"),
    ],
)
def test_marks_of_a_file(linkwright, bench, mark, found, words):
    (bench / "own.yaml").write_text(OWN.replace("actuators:", f"{mark}\nactuators:"))
    status, out, error = linkwright("actuators", "show", "TURNER 1", "--catalogue", "own.yaml")
    assert status == (2 if words else 0)
    assert out.count("not confirmed: nothing found") == found
    assert words in error


def test_a_file_of_ones_own_adds_to_the_list(linkwright, bench):
    (bench / "own.yaml").write_text(OWN)
    assert "TURNER 1" not in linkwright("actuators", "list")[1]
    assert "TURNER 1" in linkwright("actuators", "list", "--catalogue", "own.yaml")[1]
    assert "800 EUR (700 to 950, 2026-01)" in linkwright("actuators", "show", "TURNER 1", "--catalogue", "own.yaml")[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("show", "RV-20"), "did you mean 'RV-20E'"),
        (("list", "--least-torque", "100 N"), "--least-torque"),
        (("list", "--catalogue", "missing.yaml"), "no such file"),
    ],
)
def test_wrong_input_is_one_line_and_status_two(arguments, message, linkwright):
    status, _, error = linkwright("actuators", *arguments)
    assert status == 2
    assert message in error
    assert error.count("\n") == 1


def test_evaluate_tells_what_the_drives_hold(linkwright, bench):
    text = (bench / "arm.yaml").read_text().replace("backlash: 3 arcmin", "actuator: CSG-14-100-2UH")
    (bench / "driven.yaml").write_text(text)
    status, out, _ = linkwright("evaluate", "driven.yaml", "--json", "e.json")
    result = json.loads((bench / "e.json").read_text())
    assert status == 0
    peak = load_actuators().find("CSG-14-100-2UH").peak_torque
    assert f"; CSG-14-100-2UH gives {peak:.4g} N*m at most, so it cannot hold the arm there" in out
    assert [drive["actuator"] for drive in result["drives"]] == ["CSG-14-100-2UH", None]
    assert result["drives"][0]["torque_use"] == pytest.approx(result["drives"][0]["greatest_load"] / 10.0, rel=1e-12)
    assert result["cost_EUR"] is None
    assert "CSG-14-100-2UH" in result["unknown"]["cost"]


ROLLS = """\
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: y, range: [-90 deg, 0 deg], actuator: CSG-14-100-2UH}
    link: {length: 200 mm, rigid: true, mass: 1 kg}
  - joint: {axis: x, range: [-90 deg, 90 deg], actuator: CSG-14-100-2UH}
    link: {length: 100 mm, rigid: true, masses: [{mass: 1 kg, at: [50 mm, 0 mm, 0 mm]}], mass: 1 kg}
"""


def test_a_drive_that_holds_nothing_is_used_by_nothing(linkwright, bench):
    """What rounding leaves of the load about an axis that the weights hang on is no share of the rated torque."""
    (bench / "rolls.yaml").write_text(ROLLS)
    status, out, _ = linkwright("evaluate", "rolls.yaml")
    assert status == 0
    (line,) = (line for line in out.splitlines() if line.split()[:2] == ["2", "CSG-14-100-2UH"])
    assert line.split() == ["2", "CSG-14-100-2UH", "0", "N·m", "10", "N·m", "0", "%", "–"]


@pytest.mark.slow
def test_optimize_writes_the_chosen_actuators_and_the_rounded_sizes(linkwright, bench):
    (bench / "choice.yaml").write_text(CHOICE)
    arguments = ("optimize", "choice.yaml", "--round", "stock", "--out", "out", "--json", "r.json")
    status, out, error = linkwright(*arguments)
    assert status == 0, error
    result = json.loads((bench / "r.json").read_text())
    arm = read_arm(bench / "out" / "arm.yaml")
    best = result["actuators"][0]
    assert best["outcome"] == "best"
    assert [joint.actuator.name for joint in arm.joints] == best["actuators"]
    assert len(result["actuators"]) == 4
    assert [link.section_name for link in arm.links] == [link["stock"] for link in result["rounded"]["links"]]
    assert all(link.section_name for link in arm.links)
    assert result["rounded"]["max_error_mm"] >= result["max_error_mm"] * (1.0 - 1e-4)
    assert result["rounded"]["cost_of_rounding"]["value"] == pytest.approx(
        result["rounded"]["max_error_mm"] - result["max_error_mm"], rel=1e-9
    )
    assert [limit["name"] for limit in result["rounded"]["limits"]] == ["total_mass", "torque_use", "local_buckling"]
    for limit in result["rounded"]["limits"]:
        within = (
            limit["value"] >= limit["limit_value"] if ">=" in limit["limit"] else limit["value"] <= limit["limit_value"]
        )
        assert within, limit
    assert "rounded to stock sizes" in out
    # What is written is what is shown first, the optimum beside it.
    error = with_unit(result["rounded"]["max_error_mm"], "mm", 4)
    assert f"{error} after (" in out
    row = next(line for line in out.splitlines() if line.startswith("mass of the links "))
    assert with_unit(result["rounded"]["mass_kg"], "kg", 4) in row
    assert f"{with_unit(result['mass_kg'], 'kg', 4)} as" in row
    page = (bench / "out" / "report.html").read_text()
    assert "Rounded to stock sizes" in page
    assert "What binds before rounding" in page
    assert arm.links[0].section_name in page
    assert best["actuators"][0] in page


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (("--round", "half a millimetre"), 2, "--round"),
        (("--round-length", "1 mm"), 2, "goes with --round"),
        (("--round", "30 mm"), 0, "no multiple of 30 mm"),
    ],
)
def test_rounding_that_cannot_be_ends_plainly(options, status, message, linkwright, bench):
    """A mistake with 2; where there are no such sizes the optimum stands, and the screen says so."""
    (bench / "plain.yaml").write_text(CHOICE.replace(", actuator: [RV-6E, CSG-25-100-2UH]", ""))
    result, out, error = linkwright("optimize", "plain.yaml", *options)
    assert result == status
    assert message in (error if status else out)


def test_ones_own_file_is_edited_by_commands(linkwright, bench, monkeypatch):
    own = bench / "mine.yaml"
    monkeypatch.setenv(USER_ACTUATORS.variable, str(own))
    keys = ("maker=Somebody", "gear=planetary", "rated_torque=20 N*m", "stiffness=5 kN*m/rad", "backlash=3 arcmin")
    assert linkwright("actuators", "add", "TURNER 1", *keys, "mass=2 kg", "--source", "Data sheet 7")[0] == 0
    assert linkwright("actuators", "edit", "RV-20E", "mass=4.9 kg", "--source", "weighed")[0] == 0
    price = "{value: 700 EUR, spread: [600 EUR, 800 EUR], date: 2026-03}"
    assert linkwright("actuators", "edit", "RV-6E", f"cost={price}", "--source", "Offer 12")[0] == 0
    result = load_actuators()
    turner, heavier, priced = (result.find(name) for name in ("TURNER 1", "RV-20E", "RV-6E"))
    assert (turner.maker, turner.mass, turner.source) == ("Somebody", 2.0, "Data sheet 7")
    shipped = shipped_actuators()
    assert (heavier.maker, heavier.mass, heavier.stiffness) == ("Nabtesco", 4.9, shipped["RV-20E"].stiffness)
    assert heavier.source == f"{shipped['RV-20E'].source}; mass: weighed"
    assert (priced.cost, priced.cost_date, priced.file) == (700.0, "2026-03", str(own))
    assert set(read_actuators(load_yaml(own))) == {"TURNER 1", "RV-20E", "RV-6E"}
    status, _, said = linkwright("actuators", "edit", "TURNER 1", "mass=-1 kg")
    assert (status, said.count("\n")) == (2, 1)
    assert "actuators.TURNER 1.mass: must be positive" in said
    assert linkwright("actuators", "export", "TURNER 1", "RV-20E", "--out", "out.yaml")[0] == 0
    assert read_actuators(load_yaml(bench / "out.yaml"))["RV-20E"].mass == 4.9
    assert linkwright("actuators", "remove", "RV-20E")[0] == 0
    assert load_actuators().find("RV-20E").mass == shipped["RV-20E"].mass
    assert linkwright("actuators", "edit", "RV-6E", "cost", "--unset")[0] == 0
    assert load_actuators().find("RV-6E").cost is None


def test_a_file_may_hold_prices_alone(bench):
    (bench / "prices.yaml").write_text(
        "format_version: 1\nprices: {RV-20E: {value: 900 EUR, spread: [800 EUR, 1000 EUR], date: 2026, source: x}}\n"
    )
    result = load_actuators([bench / "prices.yaml"], user=False).find("RV-20E")
    assert (result.cost, result.cost_spread, result.cost_date) == (900.0, (800.0, 1000.0), "2026")
    assert result.note == "cost: x"

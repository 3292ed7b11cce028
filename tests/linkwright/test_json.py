"""What `--json` holds, by the contract, and that it is strict JSON."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.units.quantities import InputError
from linkwright.json.design import coordinates, evaluation_json, optimization_json
from linkwright.json.fields import fields, fields_if
from linkwright.output.files import json_text, write_file


def strictly(text):
    """Parse JSON; NaN and Infinity, which Python lets pass, are refused."""

    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_evaluate_writes_the_fields_of_the_contract(linkwright, bench):
    """With workspace and load cases from the problem."""
    status, out, _ = linkwright("evaluate", "arm.yaml", "--problem", "problem.yaml", "--json", "result.json")
    assert status == 0
    content = strictly((bench / "result.json").read_text(encoding="utf-8"))
    worst = content["worst_poses"][0]
    assert worst["error_mm"] == content["max_error_mm"] > 0
    assert worst["load_case"] in (1, 2)
    assert len(worst["q_deg"]) == 2
    assert "q_mm" not in worst
    assert content["upper_bound_mm"] is None or content["upper_bound_mm"] >= content["max_error_mm"]
    assert content["by_effect_mm"]["backlash"] > 0
    assert content["min_safety_factor"] > 1
    assert len(content["load_cases"]) == 2
    assert content["workspace"]["points_mm"] == [[500.0, 200.0], [400.0, 300.0]]
    assert content["workspace"]["joints"]["lower"]["q_deg"] == pytest.approx([-90.0, -100.0])
    assert content["cost_EUR"] > 0
    assert "cost" not in content["unknown"]
    assert "EUR" in out


def test_a_cost_that_cannot_be_known_is_null_with_its_reason(linkwright, bench):
    """The arm's own material in place has no cost."""
    text = (bench / "arm.yaml").read_text(encoding="utf-8")
    bare = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3}"
    (bench / "arm.yaml").write_text(text.replace("aluminium-6061-t6", bare), encoding="utf-8")
    status, out, _ = linkwright("evaluate", "arm.yaml", "--json", "result.json")
    assert status == 0
    content = strictly((bench / "result.json").read_text(encoding="utf-8"))
    assert content["cost_EUR"] is None
    assert "cost" in content["unknown"]
    assert "cost is not known" in out


def test_evaluation_figures_are_those_of_the_evaluation(evaluation):
    """Units are converted once, and the right way."""
    content = strictly(json_text(evaluation_json(evaluation)))
    assert content["max_error_mm"] == pytest.approx(1e3 * evaluation.max_error)
    assert content["upper_bound_mm"] == pytest.approx(1e3 * evaluation.upper_bound)
    assert content["upper_bound_first_order_mm"] == pytest.approx(1e3 * evaluation.worst.upper_bound)
    assert content["by_effect_mm"] == pytest.approx({k: 1e3 * v for k, v in evaluation.by_effect.items()})
    assert content["mass_kg"] == pytest.approx(evaluation.mass)
    assert content["reach_mm"] == pytest.approx(700.0)
    assert content["compliance"]["matrix_mm_per_N"][1][1] == pytest.approx(1e3 * evaluation.compliance.matrix[1][1])
    pose = content["worst_poses"][0]
    assert [math.radians(q) for q in pose["q_deg"]] == pytest.approx(list(evaluation.worst.poses[0].q))
    assert pose["load_case"] == evaluation.worst.poses[0].load_case + 1
    assert [item["link"] for item in content["strength"]] == [1, 2]
    for each in content["strength"]:
        limit = evaluation.arm.links[each["link"] - 1].material.need("yield_strength")
        assert 1e6 * each["stress_MPa"] * each["safety_factor"] == pytest.approx(limit)


def test_optimize_writes_those_and_before(result):
    """And status, bound, links, what binds, seconds and iterations."""
    content = strictly(json_text(optimization_json(result)))
    assert content["status"] == "certified"
    assert content["max_error_mm"] == pytest.approx(1e3 * result.after.max_error)
    assert content["before"]["max_error_mm"] == pytest.approx(1e3 * result.before.max_error)
    assert content["before"]["worst_poses"]
    assert content["lower_bound_mm"] == pytest.approx(1e3 * result.lower_bound)
    assert content["iterations"] == 2
    assert content["seconds"] == 0.5
    assert content["exchange_log"][0]["design_change"] is None
    first = content["links"][0]
    assert first["length"] == "400 mm"
    assert first["section"] == {"shape": "tube", "diameter": "80 mm", "thickness": "3 mm"}
    assert first["material"] == "aluminium-6061-t6"
    (limit,) = content["binding"]
    assert (limit["name"], limit["price"], limit["price_unit"]) == ("mass", -0.0042, "mm/kg")
    assert content["problem"] == "problem.yaml"


def test_a_bound_on_mass_is_not_in_millimetres(result):
    """Null where the field has no meaning."""
    content = optimization_json(replace(result, minimize="mass", objective=2.5, lower_bound=2.4))
    assert content["lower_bound_mm"] is None
    assert content["lower_bound"] == {"value": 2.4, "unit": "kg"}


@pytest.mark.parametrize("command", ["materials", "sections", "effects"])
def test_lists_are_written(linkwright, bench, command):
    """Every entry has its name."""
    status, _, _ = linkwright(command, "list", "--json", "list.json")
    assert status == 0
    content = strictly((bench / "list.json").read_text(encoding="utf-8"))
    if command == "materials":
        results = {entry["name"]: entry for entry in content["materials"]}
        assert results["steel-s355"]["properties"]["elastic_modulus"]["si"] == pytest.approx(210e9)
        assert results["steel-s355"]["properties"]["elastic_modulus"]["source"]
    elif command == "sections":
        assert {"circle", "tube", "i_section"} <= {entry["name"] for entry in content["shapes"]}
    else:
        backlash = next(entry for entry in content["effects"] if entry["id"] == "backlash")
        assert backlash["formula"]


def test_coordinates_of_a_mixed_chain():
    """Degrees and millimetres in lists of their own, null where a joint is of the other kind."""
    arm = Arm("mixed", (Joint("prismatic"), Joint()), (Link(0.1, mass=1.0), Link(0.1, mass=1.0)))
    assert coordinates(arm, (0.25, math.pi / 2)) == {"q_deg": [None, pytest.approx(90.0)], "q_mm": [250.0, None]}


def test_units_of_fields_are_said_by_their_keys():
    """A key's ending converts, what stands behind `=` is where the figure is found, and what is not known is null."""
    turn = SimpleNamespace(backlash=math.pi / 180.0, mass=2.0, at=(1, 2), kept=SimpleNamespace(length=0.25, seen=None))
    keys = ("backlash_deg", "play_arcmin=backlash", "mass_kg", "at", "kept_mm=kept.length", "seen_mm=kept.seen")
    assert fields(turn, *keys) == {
        "backlash_deg": pytest.approx(1.0),
        "play_arcmin": pytest.approx(60.0),
        "mass_kg": 2.0,
        "at": [1, 2],
        "kept_mm": 250.0,
        "seen_mm": None,
    }
    assert fields_if(None, "mass_kg") is None


def test_numbers_that_are_none_become_null():
    """NaN and infinities would not be JSON."""
    assert strictly(json_text({"a": [math.nan, math.inf, 1.5], "b": {"c": -math.inf}})) == {
        "a": [None, None, 1.5],
        "b": {"c": None},
    }


def test_a_file_is_replaced_whole(tmp_path):
    """A link stays a link, nothing is left beside it, and a folder in the way is wrong input."""
    target, link = tmp_path / "real.json", tmp_path / "link.json"
    target.write_text("old", encoding="utf-8")
    link.symlink_to(target)
    write_file(link, "new")
    assert target.read_text(encoding="utf-8") == "new"
    assert link.is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.json", "real.json"]
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError):
        write_file(tmp_path / "folder", "text")

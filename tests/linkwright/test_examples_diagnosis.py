"""The commands of the diagnosis examples, run as their READMEs print them: the recordings are what `simulate` makes,
and the verdicts are those that the pages tell."""

import json
import shutil
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from linkwright.cli import run
from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.quantities import read_quantity
from tests.handbook.pages import shown, told

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
ARCMINUTE = np.pi / 10800.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The examples in a folder of their own, with the user's catalogue out of the way."""
    room = tmp_path_factory.mktemp("examples")
    for example in ("hidden-backlash", "left-out-slopes", "welding-arm"):
        shutil.copytree(EXAMPLES / example, room / example)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(room / "no-configuration"))
        patch.delenv("LINKWRIGHT_CATALOGUE", raising=False)
        yield room


def followed(folder, example, *, patch):
    """Run all commands of an example's README in order, which print what stands there; gives the folder in which their
    files stand."""
    patch.chdir(folder / example)
    for item in shown(EXAMPLES / example / "README.md"):
        with redirect_stdout(StringIO()) as out, redirect_stderr(out):
            assert run(item.words) == 0, item
        assert told(item.printed, out.getvalue()) == []
    return folder / example


@pytest.fixture(scope="module")
def backlash(folder):
    with pytest.MonkeyPatch.context() as patch:
        yield followed(folder, "hidden-backlash", patch=patch)


@pytest.fixture(scope="module")
def slopes(folder):
    with pytest.MonkeyPatch.context() as patch:
        yield followed(folder, "left-out-slopes", patch=patch)


@pytest.mark.parametrize(
    ("example", "names"),
    [("backlash", ("recording.csv", "after-service.csv")), ("slopes", ("recording.csv",))],
)
def test_recordings_are_what_their_commands_make(example, names, request):
    """The committed files to the last digit but one, small, and each with settings that leave nothing free."""
    made = request.getfixturevalue(example)
    for name in names:
        kept = EXAMPLES / made.name / name
        assert kept.stat().st_size < 60_000
        one, other = pd.read_csv(kept), pd.read_csv(made / name)
        assert list(one.columns) == list(other.columns)
        assert 0 < len(one) < 200
        assert np.abs(one.to_numpy() - other.to_numpy()).max() < 2e-5
        assert kept.with_suffix(".yaml").read_text(encoding="utf-8") == "frame: known\ntool: known\n"


def answer(made):
    return json.loads((made / "result" / "diagnosis.json").read_text(encoding="utf-8"))


def test_hidden_backlash_is_named(backlash):
    """Joint 2, 1.2 arcmin, nothing else; the noise floor is reached on readings not fitted as well."""
    result = answer(backlash)
    assert result["verdict"] == "named"
    assert [(item["effect"], item["at"], item["alternatives"]) for item in result["missing"]] == [("backlash", [2], [])]
    total = result["missing"][0]["parameters"]["total_2"]
    low, high = (read_quantity(f"{end} {total['unit']}", "angle", file="", key="") for end in total["ci95"])
    assert low < 1.2 * ARCMINUTE < high
    assert high - low < 0.1 * ARCMINUTE
    assert result["where"]["joint"] == 2
    assert result["rms_before_mm"] > 5.0 * result["noise_floor_mm"]
    assert result["rms_after_held_out_mm"] < 1.05 * result["noise_floor_mm"]
    assert result["rejected_rows"] == []


def test_corrected_arm_plays_further(backlash):
    """What the diagnosis found is in the arm file, as an effect and not as a joint's own data."""
    given, corrected = read_arm(backlash / "arm.yaml"), read_arm(backlash / "result" / "arm.yaml")
    assert given.effects == ()
    assert [(entry.effect, entry.at) for entry in corrected.effects] == [("backlash", (2,))]
    assert corrected.effects[0].parameters["total"] == pytest.approx(1.2 * ARCMINUTE, rel=0.05)
    table = pd.read_csv(backlash / "result-table.csv")
    assert table.left_mm.max() < 1e-3
    assert set(table.payload_kg) == {10.0}


def test_service_shows_in_the_comparison(backlash):
    """From 1.2 to 0.3 arcmin, and nothing else has changed."""
    content = json.loads((backlash / "result-changes.json").read_text(encoding="utf-8"))
    assert [(item["effect"], item["at"], item["parameter"]) for item in content["changes"] if item["changed"]] == [
        ("backlash", [2], "total")
    ]
    change = content["changes"][0]
    low, high = (read_quantity(f"{end} {change['unit']}", "angle", file="", key="") for end in change["ci95"])
    assert low < -0.9 * ARCMINUTE < high < 0.0


def test_slopes_are_named_and_the_line_goes(slopes):
    """The whole of the slopes, so that the corrected arm is the one with the whole physics."""
    result = answer(slopes)
    assert result["verdict"] == "named"
    assert [item["effect"] for item in result["missing"]] == ["slope_propagation"]
    low, high = result["missing"][0]["parameters"]["share"]["ci95"]
    assert low < 1.0 < high
    assert read_arm(slopes / "arm.yaml").leave_out == {"slope_propagation"}
    corrected, whole = read_arm(slopes / "result" / "arm.yaml"), read_arm(slopes.parent / "welding-arm" / "arm.yaml")
    assert (corrected.leave_out, corrected.effects) == (frozenset(), ())
    assert corrected.links == whole.links


def test_design_without_slopes_keeps_no_promise(slopes):
    """The old optimum has more than twice what it was promised; link 2 is no longer of steel; the new one is better."""
    redesign = answer(slopes)["redesign"]
    assert redesign["had_mm"] > 2.0 * redesign["promised_mm"]
    assert redesign["has_mm"] < 0.95 * redesign["had_mm"]
    changed = {(item["link"], item["what"]): (item["before"], item["after"]) for item in redesign["decisions"]}
    assert changed[2, "material"] == ("steel-s355", "aluminium-6061-t6")
    before, after = changed[1, "length"]
    assert after > before + 50.0
    assert redesign["status"] == ["certified", "certified"]

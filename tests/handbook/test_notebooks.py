"""The worked notebooks run from top to bottom, hold what they state, and are stored with what they print and draw."""

import nbformat
import pytest

from handbook.notebooks import as_markdown, executed, shown
from handbook.sources import NOTEBOOKS, ROOT
from tests.handbook.pages import told

ALL = sorted((ROOT / NOTEBOOKS).glob("*.ipynb"))

STATEMENTS = {
    "catalogues": """
metals = some["MJ_per_kg"].iloc[:3]
assert metals.max() / metals.min() < 1.15
assert some["MJ_per_kg"]["cfrp-quasi-isotropic"] > 1.2 * metals.max()
assert set(lightest.links["material"]) == {"cfrp-quasi-isotropic"}
assert set(cheapest.links["material"]) == {"steel-s355"}
assert lightest.after.mass_kg < 0.3 * cheapest.after.mass_kg
assert costs["cheapest"] < 0.1 * costs["lightest"]
assert sum(lw.sections.table["shape"] == "tube") > 20
assert real.max_error_mm <= 0.2
assert real.mass_kg >= cheapest.after.mass_kg
for _, designs in front.table.groupby("front"):
    assert designs["mass_kg"].is_monotonic_increasing
    assert designs["max_error_mm"].is_monotonic_decreasing
assert "tube" in middle.to_yaml()
assert stiff["stiffness_Nm_per_rad"].is_monotonic_decreasing
""",
    "hidden-physics": """
assert given.rms_mm > 0.1
assert diagnosis.verdict == "named"
assert set(zip(diagnosis.findings["effect"], diagnosis.findings["at"], strict=True)) == {("backlash", (2,))}
found = diagnosis.findings.set_index("parameter")
hidden = {"total_2": 0.349, "held_below_2": 15.0}
assert all(found.loc[name, "low"] < value < found.loc[name, "high"] for name, value in hidden.items())
assert after.rms_mm < 1.05 * floor
assert nothing.verdict == "none"
assert nothing.findings.empty
assert real.max_error_mm > 1.1 * promised.max_error_mm
assert later.rms_mm > 3 * after.rms_mm
""",
    "paper": """
by_hand = 1e3 * 2700 * 9.81 * 1.240**4 / (2 * 71e9 * 0.05**2)  # q L^4 / 8 E I of one bar held straight out
assert by_hand < still.max_error_mm < 1.01 * by_hand
assert math.isclose(played.max_error_mm - still.max_error_mm, 3 * 0.025 + 0.5 * (1.24 + 0.84 + 0.42), rel_tol=1e-3)
assert (table.index[0], table.index[-1]) == ("i_section", "circle")
assert table["error_mm"].max() < still.max_error_mm / 4
assert math.isclose(light.mass_kg, still.mass_kg, rel_tol=1e-5)  # the last of its rows
steel, aluminium = materials.loc["steel-s355"], materials.loc["aluminium-6061-t6"]
assert abs(steel["equal_size_mm"] / aluminium["equal_size_mm"] - 1) < 0.05
assert 2.5 < steel["equal_mass_mm"] / aluminium["equal_mass_mm"] < 3
assert math.hypot(growth, sag) * (1 - 1e-9) < both < 1.01 * math.hypot(growth, sag)
assert growth / sag > 4.5
assert (worth[1:] > 0).all()
assert worth["best lengths too"] > worth["best diameters"] > worth["best shape for all"]
for number, lever in {1: 1.24, 2: 0.84, 3: 0.42}.items():
    swing = tolerances.loc[f"backlash of joint {number}", "per_10_percent_mm"]
    assert math.isclose(swing, 0.1 * 0.5 * lever, rel_tol=0.01)
assert tolerances.index[0] == "stiffness of joint 1"
assert math.isclose(parts["none"], played.max_error_mm, rel_tol=1e-4)
assert added["added, mm"].idxmax() == "pitch"
assert 0.9 * 0.05 * 1.24 < parts["pitch"] - parts["none"] <= 1.001 * 0.05 * 1.24
assert seam.proved
assert seam.table.iloc[4]["normal, mm"] < seam.table.iloc[4]["tangential, mm"]
""",
    "welding-arm": """
assert by_hand < found.max_error_mm < 1.01 * by_hand
assert found.upper_bound_mm < 1.001 * found.max_error_mm
shares = found.by_effect.set_index("effect")["error_mm"] / found.max_error_mm
assert 0.7 < shares["slope_propagation"] < 0.8
assert 3 < power < 4
assert best.after.max_error_mm < best.before.max_error_mm / 14
assert best.after.mass_kg < 26.2951
assert list(best.links["section"].str.split(":").str[0]) == ["rectangle", "i section", "i section"]
assert math.isclose(again.max_error_mm, best.after.max_error_mm, rel_tol=1e-6)
assert math.isclose(best.links["length_mm"].sum(), 1240, rel_tol=1e-6)
before, after = worse["sideways_stiffness"]
assert before / 3.15 < after < before / 3.05
assert best.after.max_error_mm < stiff.after.max_error_mm < best.before.max_error_mm / 11
prices = stiff.binding.set_index("limit")["price"]
assert prices["mass <= 26.295 kg"] < 0 < prices["sideways_stiffness >= 200 N/mm"]
""",
}
"""What each notebook's words rest on, asked of its variables once it has run."""


def printed(notebook):
    """The text that its cells show, without that of plots."""
    texts = [
        item.get("text") or item.data.get("text/plain", "") for cell in code(notebook) for item in shown(cell.outputs)
    ]
    return [text for text in texts if not text.startswith(("Figure(", "<Figure>"))]


def code(notebook):
    """Its cells of code."""
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.mark.slow
@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_notebook_runs_and_keeps_what_it_states(path, monkeypatch, tmp_path):
    """Its statements hold in a fresh kernel, and what it prints is what is stored (`make notebooks`)."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("PLOTLY_RENDERER", "plotly_mimetype")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "no-configuration"))
    stored = printed(nbformat.read(path, as_version=4))
    fresh = printed(executed(path, STATEMENTS[path.stem]))
    assert stored
    assert told(stored, "\n".join(fresh)) == []


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_notebook_is_stored_with_its_pictures(path):
    """Valid, with a title and every cell's output: a picture of each plot, no assertion, no complaint."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    page = as_markdown(notebook, path.name)
    assert page.count('src="data:image/png;base64,') == sum(cell.source.count(".plot()") for cell in code(notebook))
    assert all(cell.outputs for cell in code(notebook))
    assert "assert " not in page
    assert notebook.cells[0].source.startswith("# ")
    assert path.stat().st_size < 400_000


def test_there_are_four():
    """The checks above would pass on none."""
    assert [path.stem for path in ALL] == ["catalogues", "hidden-physics", "paper", "welding-arm"] == sorted(STATEMENTS)

"""The worked notebooks run from top to bottom, and are stored as people should find them."""

import nbformat
import pytest

from handbook.notebooks import as_markdown, executed
from handbook.sources import NOTEBOOKS, ROOT

pytestmark = pytest.mark.slow

ALL = sorted((ROOT / NOTEBOOKS).glob("*.ipynb"))


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_notebook_runs_and_keeps_what_it_states(path, monkeypatch, tmp_path):
    """Its assertions hold in a fresh kernel; what it draws and shows comes onto its page."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("PLOTLY_RENDERER", "plotly_mimetype")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "no-configuration"))
    page = as_markdown(executed(path), path.name)
    assert page.count('<div class="plot">') == path.read_text(encoding="utf-8").count(".plot()")
    assert '<div class="output">' in page


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_notebook_is_stored_without_outputs(path):
    """Valid, small, with statements that can fail and a title."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    assert sum(cell.source.count("assert ") for cell in code) >= 5
    assert notebook.cells[0].source.startswith("# ")


def test_there_are_four():
    """The checks above would pass on none."""
    assert [path.stem for path in ALL] == ["catalogues", "hidden-physics", "paper", "welding-arm"]

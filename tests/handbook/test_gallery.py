"""The gallery's scripts run, are short, and draw and print what is stored with them."""

import base64
import math
import re

import numpy as np
import pytest

from handbook.gallery import page, picture_of, run, scripts
from handbook.pictures import answer_in
from tests.costs import slow_but
from tests.handbook.pages import told

ALL = {f"{script.parent.name}/{script.stem}": script for script in scripts()}
QUICK = ("arms/own_effect", "design/show")


def numbers(drawn):
    """All numbers that traces hold, however deep; plotly packs arrays of them."""
    if isinstance(drawn, dict) and "bdata" in drawn:
        return np.frombuffer(base64.b64decode(drawn["bdata"]), drawn["dtype"]).tolist()
    if isinstance(drawn, dict):
        return [number for item in drawn.values() for number in numbers(item)]
    if isinstance(drawn, list | tuple):
        return [number for item in drawn for number in numbers(item)]
    return [drawn] if isinstance(drawn, int | float) else []


@pytest.fixture
def without_a_catalogue_of_ones_own(monkeypatch, tmp_path):
    """As whoever follows the page for the first time has it."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS", "LINKWRIGHT_ACTUATORS"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.usefixtures("without_a_catalogue_of_ones_own")
@pytest.mark.parametrize("name", slow_but(ALL, *QUICK))
def test_script_draws_and_prints_what_is_stored(name):
    """What it prints is what stood by its picture when that was taken (`make gallery`)."""
    figure, said = run(ALL[name])
    assert said
    assert told(answer_in(picture_of(ALL[name])).splitlines(), said) == []
    drawn = numbers(figure["data"])
    assert drawn
    assert all(math.isfinite(number) for number in drawn)


@pytest.mark.parametrize("name", ALL)
def test_script_is_short_and_has_its_picture(name):
    """Some thirty lines at most, a sentence at its head, nothing of the program but `lw`."""
    text = ALL[name].read_text(encoding="utf-8")
    assert 6 <= len(text.splitlines()) <= 40
    assert re.match(r'""".+[.?]"""\n', text)
    assert re.findall(r"linkwright\S*", re.sub(r"import linkwright as lw", "", text)) == []
    assert picture_of(ALL[name]).is_file()


def test_page_shows_them_all():
    """Twenty, each with its picture, its code and what it prints."""
    shown = page()
    assert len(ALL) == 20
    assert shown.count("```python") == shown.count("![") == shown.count("```text") == 20
    assert set(QUICK) <= set(ALL)

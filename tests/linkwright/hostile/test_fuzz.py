"""A sample of `make fuzz`: odd files of every kind are read, or refused in one line; and that this can fail."""

import time
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz import held
from benchmarks.fuzz.held import Wrong, hold
from benchmarks.fuzz.kinds import kinds
from benchmarks.fuzz.odd import odd_files
from linkwright.core.units.quantities import InputError

pytestmark = pytest.mark.slow

NAMES = (
    *("arm", "problem", "materials", "sections", "actuators", "workbook", "materials_book", "sizes_book", "recording"),
    *("result", "exchange", "sheet", "watch", "plan", "instruments", "request", "dropped", "folder"),
)
known = cache(kinds)


def test_names_are_those_of_all_kinds():
    """They are written down, since making the kinds takes longer than any test should take to be found."""
    assert tuple(known()) == NAMES


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_odd_files_are_read_or_refused_in_one_line(tmp_path_factory, name, data):
    kind = known()[name]
    hold(kind, data.draw(odd_files(dict(kind.odd))), tmp_path_factory.mktemp("odd"))


@pytest.mark.parametrize("name", NAMES)
def test_the_good_files_are_read(tmp_path, name):
    """Otherwise the odd ones would be odd in one way only."""
    kind = known()[name]
    assert hold(kind, {file: seeds[0].encode() for file, seeds in kind.odd.items()}, tmp_path)


@pytest.mark.parametrize("name", ["arm", "problem"])
def test_so_are_those_with_rare_keys(tmp_path, name):
    ((file, seeds),) = known()[name].odd.items()
    assert [text for text in seeds if not hold(known()[name], {file: text.encode()}, tmp_path)] == []


def test_what_is_held_can_be_missed(tmp_path):
    """Two lines, and what is no refusal."""

    def two_lines(folder):
        error = InputError(folder, "", "one")
        error.args = ("one\ntwo",)
        raise error

    def crash(folder):
        raise KeyError(folder)

    kind = known()["arm"]
    with pytest.raises(Wrong):
        hold(replace(kind, read=two_lines), {}, tmp_path)
    with pytest.raises(KeyError):
        hold(replace(kind, read=crash), {}, tmp_path)


@pytest.mark.parametrize(("slow", "said"), [("reading", "took longer than 1 s"), ("thinking", "")])
def test_reading_alone_is_timed(monkeypatch, slow, said):
    """A reader that hangs is ended; what thinks up the next file may take its time."""

    def read(_):
        if slow == "reading":
            time.sleep(600.0)

    def thought(_):
        return st.builds(lambda: time.sleep(3.0 * (slow == "thinking")) or {})

    monkeypatch.setattr(held, "SECONDS", 1.0)
    monkeypatch.setattr(held, "odd_files", thought)
    monkeypatch.setattr(held, "kinds", lambda: {"arm": replace(known()["arm"], read=read)})
    watched = held.Watched("arm", 1, 1)
    while not watched.ended():
        time.sleep(0.05)
    assert said in watched.wrong
    assert watched.held == 1
    assert bool(watched.wrong) == bool(said)

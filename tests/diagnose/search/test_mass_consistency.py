"""What gives under links that nobody has weighed, by recordings of vectors turned by hand: a base that only balances
other findings goes, one that does give stays."""

from __future__ import annotations

from dataclasses import replace

import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search import mass_consistency
from linkwright.core.diagnose.search.mass_consistency import renamed_under_one_set, under_one_set
from linkwright.core.diagnose.search.naming import Named, Namer, name_missing
from tests.diagnose.fitting.test_shared_masses import on_a_soft_base, standing_arm

BASE, ELBOW, SECOND = ("base_compliance", ()), ("joint_compliance", (2,)), ("axis_misalignment", (1,))
ALWAYS = replace(RULES, search=replace(RULES.search, balanced=0.0))
"""Whatever gives is taken to balance others, so that the search is made again without it every time."""


def namer_of(base: float, drive: float) -> Namer:
    recording = replace(on_a_soft_base(3, base, 0.0, drive), frame="free")
    prepared = prepare(observe(standing_arm(mast=False), recording, rules=ALWAYS), Options(rules=ALWAYS), None)
    return Namer(prepared, thorough=False, seed=1)


def places(namer: Namer, members: tuple[int, ...]) -> set[tuple[str, tuple[int, ...]]]:
    return {(namer.pool.groups[m].candidate.effect, namer.pool.groups[m].candidate.at) for m in members}


def member(namer: Namer, effect: str, at: tuple[int, ...]) -> int:
    return next(k for k, g in enumerate(namer.pool.groups) if (g.candidate.effect, g.candidate.at) == (effect, at))


def test_a_base_named_for_a_drive_goes() -> None:
    namer = namer_of(0.0, 2e-5)
    wrong = tuple(member(namer, *item) for item in (BASE, SECOND))
    result = under_one_set(namer, Named(wrong, (), (0.001, 0.001), namer.test(()), None), lambda _: None)
    assert places(namer, renamed_under_one_set(namer, result)) == {ELBOW}


def test_a_base_that_gives_stays() -> None:
    namer = namer_of(3e-6, 2e-5)
    named = name_missing(namer, lambda _: None)
    assert BASE in places(namer, named.members)
    result = under_one_set(namer, named, lambda _: None)
    assert result.members == named.members


def test_nothing_that_gives_is_left_as_it_is_named() -> None:
    namer = namer_of(0.0, 2e-5)
    named = Named((member(namer, *SECOND),), (), (0.001,), namer.test(()), None)
    assert under_one_set(namer, named, lambda _: pytest.fail("searched again")) is named
    assert renamed_under_one_set(namer, replace(named, members=())) == ()


@pytest.mark.parametrize(("travel", "worse", "first"), [(0.0, 10.0, 3), (1.0, 10.0, 2), (0.0, 30.0, 2)])
def test_a_drive_that_stands_is_not_accused_for_one_that_moves(
    monkeypatch: pytest.MonkeyPatch, travel: float, worse: float, first: int
) -> None:
    """A drive that turns takes its place where it fits nearly as well, not where that is refuted; of two that turn the
    better stays. The criteria are given."""
    namer = namer_of(0.0, 2e-5)
    recording = namer.prepared.observed.recording
    q = recording.q.copy()
    q[:, 1] *= travel
    observed = replace(namer.prepared.observed, recording=replace(recording, q=q))
    namer = namer.with_prepared(replace(namer.prepared, observed=observed))
    second, third = (member(namer, "joint_compliance", (index,)) for index in (1, 2))
    monkeypatch.setattr(mass_consistency, "renamed", lambda *_: (third,))
    monkeypatch.setattr(mass_consistency, "_joint", lambda *_: object())
    monkeypatch.setattr(mass_consistency, "_criterion", lambda *given: worse if given[-1][0] == third else 0.0)
    named = Named((second,), (), (0.001,), namer.test(()), None)
    assert renamed_under_one_set(namer, named) == ((third,) if first == 3 else (second,))

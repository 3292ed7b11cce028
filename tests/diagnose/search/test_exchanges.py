"""Sets of causes that could stand in the place of a set, by the textbook's kinematics."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.exchanges import _leaving, better
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import SIGMA, arm_of_drives, given_way, read, turned_by
from tests.diagnose.core_cases import prepared_null
from tests.diagnose.recorded import LENGTHS

ZERO, LENGTH = ("encoder_offset", (3,), ""), ("link_length", (3,), "")


@pytest.mark.parametrize(("along", "across"), [(1e-3, -7e-4), (-4e-4, 2e-4)])
def test_a_tool_that_is_off_both_ways_is_a_length_and_a_zero(along: float, across: float) -> None:
    """In the plane a tool off along and across its link is, to first order, that link longer and its zero off."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-1.6, 1.6, (80, 3))
    angle = q.sum(axis=1)
    out, aside = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    result = diagnose(arm_of_drives(), read(q, along * out + across * aside, rng))
    exchange = next(item for item in result.exchanges if ("tool_offset", (), "") in (*item.effects, *item.instead_of))
    assert {frozenset(exchange.effects), frozenset(exchange.instead_of)} == {
        frozenset([("tool_offset", (), "")]),
        frozenset([ZERO, LENGTH]),
    }
    assert sum("These readings do not tell" in note for note in result.notes) == len(result.exchanges)


@pytest.mark.parametrize("seed", slow_but(range(3), 1))
def test_what_readings_tell_has_no_set_in_its_place(seed: int) -> None:
    """A zero off by far more than the noise, and a push that bends the drives as no two other things do."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.6, 1.6, (80, 3))
    zero = diagnose(arm_of_drives(), read(q, turned_by(q, (0.0, 40.0 * SIGMA / LENGTHS[1], 0.0)), rng))
    assert [(finding.effect, finding.at) for finding in zero.findings] == [("encoder_offset", (2,))]
    assert zero.exchanges == ()
    pushed = given_way(q, np.tile([0.0, -30.0], (80, 1)))
    load = diagnose(arm_of_drives(), read(q, pushed, rng))
    assert {finding.effect for finding in load.findings} == {"payload"}
    assert load.exchanges == ()


def test_the_only_cause_that_is_left_has_nothing_in_its_place() -> None:
    rng = np.random.default_rng(1)
    q = rng.uniform(-1.6, 1.6, (80, 3))
    only = Options(without=frozenset(EFFECTS) - {"payload"})
    result = diagnose(arm_of_drives(), read(q, given_way(q, np.tile([0.0, -30.0], (80, 1))), rng), options=only)
    assert [finding.effect for finding in result.findings] == ["payload"]


@pytest.mark.parametrize("count", [1, 2, 5])
def test_what_is_left_beside_the_others_is_as_if_they_were_taken_at_once(count: int) -> None:
    """Every so many of five, each once, however the others are taken as given one half after the other."""
    namer = Namer(prepared_null(), thorough=False, seed=0)
    families = namer.pool.family
    members = [int(np.flatnonzero(families == family)[0]) for family in np.unique(families[namer.library])[:5]]
    left = list(_leaving(namer, namer.prepared.products, members, [*combinations(members, count)]))
    assert sorted(place for place, _ in left) == sorted(combinations(members, count))
    for place, beside in left:
        others = [member for member in members if member not in place]
        at_once = namer.prepared.products.beside(namer.pool.columns(others))
        assert beside.rss == pytest.approx(at_once.rss, rel=1e-9)
        assert beside.against == pytest.approx(at_once.against, abs=1e-6 * np.abs(at_once.against).max())
        assert beside.gains() == pytest.approx(at_once.gains(), abs=1e-6 * at_once.gains().max())


@pytest.mark.parametrize("seed", slow_but([3, 4], 3))
def test_one_for_two_is_looked_for_only_where_it_could_explain_more(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same end as where every pair is looked at, by far fewer of them."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.6, 1.6, (60, 3))
    off = turned_by(q, (2e-4, -3e-4, 2.5e-4)) + given_way(q, np.tile([0.0, -30.0], (60, 1)))
    namer = Namer(prepare(observe(arm_of_drives(), read(q, off, rng)), Options(), None), thorough=False, seed=0)
    families = namer.pool.family
    members = [int(np.flatnonzero(families == family)[0]) for family in np.unique(families[namer.library])[:6]]
    pairs: list[int] = []

    def counted(*asked: Any) -> Any:
        pairs.append(sum(len(part) == 2 for part in asked[3]))
        return _leaving(*asked)

    def every_pair(namer: Namer, products: Any, members: Any, parts: Any) -> Any:
        return _leaving(
            namer, products, members, parts if parts and len(parts[0]) == 1 else [*combinations(members, 2)]
        )

    monkeypatch.setattr("linkwright.core.diagnose.search.exchanges._leaving", counted)
    end = better(namer, members)
    monkeypatch.setattr("linkwright.core.diagnose.search.exchanges._leaving", every_pair)
    assert better(namer, members) == end
    assert max(pairs) < len(members) * (len(members) - 1) / 2

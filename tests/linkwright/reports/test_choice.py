"""Pictures of the choice: what each shape and limit costs, and the stress that each section bears."""

import re

import pytest

import linkwright as lw
from linkwright.results.combinations import binding, candidates, costs
from linkwright.results.document import Bars, words


@pytest.fixture(scope="module")
def best():
    """Bars or tubes, of one size for all links."""
    return lw.optimize(
        lw.Problem(
            arm="examples/welding-arm/arm.yaml",
            workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
            subject_to={"mass": "<= 15 kg", "section_size": ["40 mm", "120 mm"]},
            choose={"section": ["circle", "tube"], "same": ["section", "size"]},
        )
    )


def bars(table):
    """The share of each row's bar, by the row's head."""
    return {words(row[0]): next(cell for cell in row if isinstance(cell, Bars)).bars[0] for row in table.rows}


def test_each_shape_has_its_price(best):
    """The best costs nothing; the others what their best combination has more, in proportion, at most five times."""
    found = {item.shapes[0]: item.objective for item in best.found.candidates}
    drawn = bars(candidates(best.found))
    least, most = min(found.values()), max(found.values())
    assert drawn["all tube"] == ("after", pytest.approx(least / min(most, 5 * least)))
    (section,) = costs(best.found)
    rows = {words(row[0]): row for row in section.items[0].rows}
    assert words(rows["tube"][2]) == "0 %"
    assert float(words(rows["circle"][2]).split()[0]) == pytest.approx(100 * (found["circle"] / least - 1), rel=0.01)
    assert bars(section.items[0])["circle"][1] > 0.99


def test_prices_are_drawn_as_shares_of_the_objective(best):
    """One per cent of a limit moves the objective by its price times a hundredth of the limit."""
    table = binding(best.found)
    shares = [0.01 * item.price * item.limit / best.max_error_mm for item in best.found.binding]
    drawn = bars(table)
    for item, part in zip(best.found.binding, shares, strict=True):
        shown = next(words(row[3]) for row in table.rows if row[0] == item.text)
        assert float(shown.split()[0]) == pytest.approx(abs(100 * part), rel=0.06)
        assert drawn[item.text][1] == pytest.approx(abs(part) / max(map(abs, shares)))


def test_sections_stand_beside_their_stress(best):
    """In MPa, of the yield strength, and as a bar of that share."""
    page = best._page((), "", "")
    assert len(re.findall(r"bears [0-9.]+ MPa of", page)) == 6
    gauge = r'bears ([0-9.]+) MPa of [0-9.]+ MPa [^"]*"bar"[^"]*"track whole"[^"]*"fill after"[^"]*"width:([0-9.]+)%'
    shown = re.findall(gauge, page)
    strength = best.found.after.strength
    for (stress, share), value, factor in zip(shown, strength.stress, strength.safety_factor, strict=True):
        assert float(stress) == pytest.approx(1e-6 * value, rel=0.01)
        assert float(share) == pytest.approx(100 / factor, abs=0.006)

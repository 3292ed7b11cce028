"""Tables over many variants of an arm: each row is what the variant's own evaluation says."""

from __future__ import annotations

import itertools

import numpy as np
import pandas as pd
import pytest

import linkwright as lw

FIGURES = ("max_error", "mass", "total_mass", "reach", "cost", "safety_factor", "tip_stiffness", "torque_use", "aspect")
ARM = {
    "name": "crane",
    "chain": [
        {
            "joint": {"range": ["-60 deg", "100 deg"], "stiffness": "60 kN*m/rad", "backlash": "2 arcmin"},
            "link": {
                "length": "500 mm",
                "section": {"shape": "tube", "diameter": "90 mm", "thickness": "4 mm"},
                "material": "steel-s355",
            },
        },
        {
            "joint": {"range": ["-120 deg", "120 deg"], "mass": "4 kg"},
            "link": {
                "length": "400 mm",
                "section": {"shape": "rectangle", "width": "30 mm", "height": "60 mm"},
                "material": "aluminium-6061-t6",
            },
        },
    ],
    "payload": {"mass": "6 kg"},
}


@pytest.fixture(scope="module")
def arm() -> lw.Arm:
    """Two links of unlike sections and materials; a drive that gives, with play."""
    return lw.Arm(**ARM)  # type: ignore[arg-type]


def variant(arm: lw.Arm, table: pd.DataFrame, row: int) -> lw.Arm:
    """The arm that a row is of."""
    for key in table.columns:
        if "." in key:
            arm = arm.replace(key, table[key][row])
    return arm


def test_each_row_is_what_its_own_evaluation_says(arm: lw.Arm) -> None:
    """Sizes, materials, shapes and what is no link's: payload and stiffness. Figures of links, sums and poses."""
    values = {
        "chain[1].link.length": ["400 mm", 0.7],
        "chain[2].link.section": [{"shape": "rectangle", "width": "30 mm", "height": "60 mm"}, "IPE 80"],
        "chain[2].link.material": ["aluminium-6061-t6", "steel-s355"],
        "payload.mass": ["1 kg", "9 kg"],
        "chain[1].joint.stiffness": ["60 kN*m/rad", "20 kN*m/rad"],
    }
    table = lw.sweep(arm, values, figures=FIGURES)
    combinations = list(itertools.product(*values.values()))
    assert [tuple(row) for row in table[list(values)].itertuples(index=False)] == combinations
    for row in (0, 13, 22, 31):
        evaluation = lw.evaluate(variant(arm, table, row)).found
        for name in FIGURES:
            figure = lw.limits[name]
            told = figure.shown(figure.value(evaluation))
            assert table[figure.key][row] == pytest.approx(np.nan if told is None else told, rel=1e-6, nan_ok=True)


def test_zipped_lists_and_a_table_are_a_row_each(arm: lw.Arm) -> None:
    """One for each place in the lists, as one for each row of a DataFrame."""
    values = {"chain[1].link.section.diameter": ["80 mm", "100 mm"], "chain[2].link.length": ["450 mm", "350 mm"]}
    zipped = lw.sweep(arm, values, zipped=True)
    assert len(zipped) == 2
    assert zipped["reach_mm"].tolist() == pytest.approx([950.0, 850.0])
    pd.testing.assert_frame_equal(zipped, lw.sweep(arm, pd.DataFrame(values)))
    by_all = lw.sweep(arm, values)
    pd.testing.assert_frame_equal(by_all.iloc[[0, 3]].reset_index(drop=True), zipped)


def test_work_is_told_of_and_a_frequency_is_searched_variant_by_variant(arm: lw.Arm) -> None:
    """Shares that only grow, to the whole; a shorter link swings faster."""
    heard: list[float] = []
    table = lw.sweep(
        arm,
        {"chain[2].link.length": ["300 mm", "500 mm"]},
        figures=["first_frequency"],
        progress=lambda _, share: heard.append(share),
    )
    assert table["first_frequency_Hz"][0] > table["first_frequency_Hz"][1]
    assert heard == sorted(heard)
    assert heard[-1] == pytest.approx(1.0)
    result = lw.evaluate(variant(arm, table, 1)).figures
    assert table["first_frequency_Hz"][1] == pytest.approx(result["value"]["first_frequency"], rel=1e-6)


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        ({"chain[1].link.lenght": ["1 m"]}, {}, "chain[1].link: unknown key 'lenght'; did you mean 'length'?"),
        ({"chain[9].link.length": ["1 m"]}, {}, "chain[9].link.length: there is no entry 9; the list holds 2"),
        ({"chain[1].link.length": ["1 m", "1 kg"]}, {}, "chain[1].link.length: '1 kg' is a mass, not a length"),
        ({"chain[1].link.length": []}, {}, "chain[1].link.length: has no values"),
        ({}, {}, "names no key"),
        ({"payload.mass": ["1 kg"]}, {"figures": ["mas"]}, "there is no figure 'mas'; did you mean 'mass'?"),
        (
            {"payload.mass": ["1 kg"], "chain[1].link.length": ["1 m", "2 m"]},
            {"zipped": True},
            "all keys need as many values, and they have: payload.mass 1, chain[1].link.length 2",
        ),
    ],
)
def test_what_does_not_fit_is_one_line(arm: lw.Arm, values: object, options: dict[str, object], message: str) -> None:
    """With the key and what would do."""
    with pytest.raises(lw.InputError) as caught:
        lw.sweep(arm, values, **options)  # type: ignore[arg-type]
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)

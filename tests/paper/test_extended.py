"""The tables that the paper lacks, held against closed forms, brute force and the paper's own arm."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.cli import run
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.paper.corrected import PaperArm, worst_error
from linkwright.paper.extended.sensitivity import seam_table, sensitivities
from linkwright.paper.extended.tables import LENGTHS, Extended
from linkwright.paper.extended.warmth import growth_of, mass_of, material_table, warmed
from linkwright.paper.output.pages import (
    BEGIN,
    END,
    EXTENDED_BEGIN,
    EXTENDED_END,
    all_into,
    extended_csv,
    extended_markdown,
)
from linkwright.paper.output.screen import show_extended
from linkwright.paper.postures import Postures, around
from linkwright.paper.printed import read_paper
from linkwright.paper.rows import Column, ExtendedTable
from linkwright.screen.console import console

pytestmark = pytest.mark.slow

SMALL = ExtendedTable("small", "A small one", (Column("who"), Column("how far", "mm")), (("a", 1.5), ("b", None)), "so")


@pytest.fixture(scope="module")
def arms():
    return PaperArm(read_paper())


@pytest.fixture(scope="module")
def extended(arms):
    return Extended(arms)


@pytest.fixture(scope="module")
def shapes(extended):
    return extended.shapes(("circle", "rectangle"))


@pytest.fixture(scope="module")
def steps(extended):
    return extended.steps(("circle", "tube"), ("steel-s355",), finalists=2)


def _rigid(backlash=(0.0, 0.0, 0.0), clearance=0.0, stiffness=None):
    """Massless links of the paper's lengths: nothing but play moves the tip."""
    joints = tuple(Joint(backlash=each, clearance=clearance, stiffness=stiffness) for each in backlash)
    return Arm("rigid", joints, tuple(Link(length, mass=0.0) for length in (0.4, 0.42, 0.42)))


# ---- shapes


def test_a_round_bar_has_no_proportions_to_choose(shapes):
    """At the paper's mass and one section for all it is the paper's own arm."""
    row = dict(zip(shapes.column("shape"), shapes.rows, strict=True))["circle"]
    assert row[2] == pytest.approx(row[1], rel=1e-6)
    assert row[3] == "100 mm"


def test_a_rectangle_stands_on_edge_as_high_as_it_may(shapes):
    """Self-weight sag goes with rho A / (E I), that is with 12 / h^2: a bar of full height, 157.1 * 50 mm^2 of area."""
    row = dict(zip(shapes.column("shape"), shapes.rows, strict=True))["rectangle"]
    assert row[3] == "56.1 × 140 mm"
    # Bending alone would give (50 / 140)^2 of the flat bar; shear, which a bar on edge has more of, only adds.
    assert row[1] * (50.0 / 140.0) ** 2 < row[2] < 1.03 * row[1] * (50.0 / 140.0) ** 2
    assert row[4] < row[2]


# ---- materials


def test_equal_mass_is_equal_mass(arms):
    """Bars of the diameter given weigh what the paper's do, and sag by rho / E times (d0 / d)^2 (bending)."""
    table = material_table(arms, ("steel-s355", "aluminium-6061-t6"))
    rows = dict(zip(table.column("material"), table.rows, strict=True))
    parameters = arms.paper.parameters
    for name in ("steel-s355", "aluminium-6061-t6"):
        _, modulus, density, size, warm, diameter, mass, warm_mass, growth = rows[name]
        assert density * diameter**2 == pytest.approx(parameters.density * 100.0**2)
        softness = density / parameters.density * parameters.elastic_modulus / (1e9 * modulus)
        assert size == pytest.approx(rows["aluminium (paper)"][3] * softness, rel=2e-3)
        assert mass == pytest.approx(size * (100.0 / diameter) ** 2, rel=0.01)
        made_of = load_catalogue(user=False).find(name)
        ratio = made_of.need("elastic_modulus", 293.15) / made_of.need("elastic_modulus", 323.15)
        assert (warm / size, warm_mass / mass) == pytest.approx((ratio, ratio), rel=1e-4)
        assert growth == pytest.approx(1240.0 * 30.0 * made_of.need("thermal_expansion", 323.15))
    assert rows["aluminium-6061-t6"][4] > rows["aluminium-6061-t6"][3]  # softer when warm
    assert rows["carbon steel (paper, lower)"][4] is None


def test_growth_is_an_error_of_the_warmed_arm(arms):
    """Rigidly hanging links still grow: the model's error has it in full, 1240 mm * 23e-6 * 30."""
    made_of = load_catalogue(user=False).find("aluminium-6061-t6")
    growth = growth_of(made_of, 1.24)
    assert growth == pytest.approx(1.24 * 23e-6 * 30.0)
    arm = replace(arms.arm(made_of=made_of), gravity=(0.0, 0.0, 0.0))
    assert worst_error(warmed(arm)) == pytest.approx(growth, rel=1e-6)


# ---- steps


def test_every_step_is_worth_something_or_nothing(steps):
    """More freedom is never worse; the gains add up to the whole way."""
    worst, worth = steps.column("worst error"), steps.column("worth")
    assert worth[0] is None
    assert all(gain > -1e-5 for gain in worth[1:])
    assert sum(worth[1:]) == pytest.approx(worst[0] - worst[-1], abs=1e-5)
    assert worst[0] == pytest.approx(1.50229, abs=1e-5)
    assert all(mass <= 26.2952 for mass in steps.column("mass"))


def test_longer_first_links_cut_what_backlash_swings(extended, steps):
    """With reach kept, backlash costs b/2 (L + (L2 + L3) + L3): best with link 1 longest and link 3 shortest."""
    row = steps.rows[2]
    half = 0.5 * extended.played.joints[0].backlash
    longest, shortest = LENGTHS[1], LENGTHS[0]
    play = half * (1.24 + (1.24 - longest) + shortest) + 3 * 0.025e-3
    assert row[1] - row[3] == pytest.approx(1e3 * play, rel=1e-4)
    assert [link.split(" of ")[0] for link in row[5].split("; ")] == ["620 mm", "420 mm", "200 mm"]


# ---- tolerances


def test_sensitivities_of_play_are_lever_arms():
    """d(worst)/d(clearance) is 1, d(worst)/d(backlash) half of what lies beyond the joint, by geometry."""
    found = {(each.kind, each.number): each for each in sensitivities(_rigid((1e-3, 2e-3, 1e-3), 25e-6))}
    for number, lever in ((1, 1.24), (2, 0.84), (3, 0.42)):
        assert found["backlash", number].slope == pytest.approx(0.5 * lever, rel=1e-5)
        assert found["clearance", number].slope == pytest.approx(1.0, rel=1e-5)
        beyond = sum(0.5e-3 * (2 if joint == 2 else 1) for joint in range(1, number + 1))
        assert found["length", number].slope == pytest.approx(beyond, rel=1e-5)
    assert ("stiffness", 1) not in found


def test_the_sensitivity_of_a_drive_is_the_derivative_of_torque_over_stiffness():
    """One joint and a mass at the end of a rigid link: error = m g L^2 / K, so -m g L^2 / K^2."""
    arm = Arm("one", (Joint(stiffness=5e4),), (Link(0.8, mass=4.0, center_of_mass=0.8),))
    found = {each.kind: each for each in sensitivities(arm)}
    assert found["stiffness"].slope == pytest.approx(-4.0 * 9.81 * 0.8**2 / 5e4**2, rel=1e-4)
    assert found["length"].slope > 0.0


def test_the_ranking_is_by_what_a_tenth_buys(extended):
    """Largest first, whichever way it goes."""
    table = extended.tolerances()
    tenths = [abs(value) for value in table.column("per 10 %")]
    assert tenths == sorted(tenths, reverse=True)
    assert table.column("rank") == tuple(float(k) for k in range(1, 13))
    signs = dict(zip(table.column("tolerance"), np.sign(table.column("per unit")), strict=True))
    assert {name for name, sign in signs.items() if sign < 0.0} == {f"stiffness of joint {k}" for k in (1, 2, 3)}


# ---- seam


def test_backlash_of_the_first_joint_moves_the_tip_round_the_base():
    """Whatever the posture: the error is b/2 times the tip's own vector turned by 90 degrees."""
    table = seam_table(_rigid((2e-3, 0.0, 0.0)), (0.6, 0.5), (-0.6, 0.5), points=5, postures=32)
    for row, x in zip(table.rows, (600.0, 300.0, 0.0, -300.0, -600.0), strict=False):
        assert row[1] == pytest.approx(1e-3 * 500.0, rel=1e-6)
        assert row[2] == pytest.approx(1e-3 * abs(x), rel=1e-6, abs=1e-9)
        assert row[3] == pytest.approx(1e-3 * math.hypot(x, 500.0), rel=2e-4)
    assert table.rows[-1][1:3] == pytest.approx((0.5, 0.6))


def test_the_seam_is_searched_over_all_postures(extended):
    """Against the closed form of the 2R inverse at every orientation of link 3, 0.25 degrees apart."""
    postures = Postures(extended.played, 512)
    point = np.array([[0.3, 0.5, 0.0]])
    directions = around(8)
    found = postures.farthest(point, directions)[0]
    turns = np.radians(np.arange(0.0, 360.0, 0.25))
    wrist = point[0, :2] - 0.42 * np.column_stack([np.cos(turns), np.sin(turns)])
    cosine = ((wrist**2).sum(axis=1) - 0.4**2 - 0.42**2) / (2 * 0.4 * 0.42)
    rows = []
    for elbow in (1.0, -1.0):
        ok = np.abs(cosine) < 1.0
        q2 = elbow * np.arccos(cosine[ok])
        q1 = np.arctan2(wrist[ok, 1], wrist[ok, 0]) - np.arctan2(0.42 * np.sin(q2), 0.4 + 0.42 * np.cos(q2))
        rows.append(np.column_stack([q1, q2, turns[ok] - q1 - q2]))
    brute = postures.support(np.vstack(rows), directions).max(axis=0)
    assert found == pytest.approx(brute, rel=1e-3)


def test_a_seam_out_of_reach_is_refused():
    with pytest.raises(Unreachable, match="1300"):
        seam_table(_rigid((1e-3, 0.0, 0.0)), (0.6, 0.5), (1.3, 0.0), points=3, postures=16)


# ---- output


def test_markdown_and_csv_hold_every_cell():
    assert {"| b | – |", "### A small one", "| a | 1.5 |"} <= set(extended_markdown([SMALL]).splitlines())
    assert list(csv.reader(extended_csv(SMALL).splitlines())) == [["who", "how far, mm"], ["a", "1.5"], ["b", ""]]


def test_marks_of_extended_tables_keep_what_they_hold_without_new_ones():
    page = f"x\n{BEGIN}\nold\n{END}\ny\n{EXTENDED_BEGIN}\nolder\n{EXTENDED_END}\nz\n"
    kept = all_into(page, "new\n", ())
    assert kept == f"x\n{BEGIN}\nnew\n{END}\ny\n{EXTENDED_BEGIN}\nolder\n{EXTENDED_END}\nz\n"
    renewed = all_into(page, "new\n", [SMALL])
    assert "older" not in renewed
    assert "| a | 1.5 |" in renewed
    assert renewed.endswith("z\n")
    assert "| a | 1.5 |" in all_into("no marks", "new\n", [SMALL])


def test_a_row_without_its_cell_is_refused():
    with pytest.raises(ValueError, match="a cell for each"):
        replace(SMALL, rows=(("a",),))


def test_the_command_writes_extended_tables_and_quick_leaves_them_out(tmp_path, monkeypatch):
    """Screen, JSON, CSV and Markdown, from one list."""
    monkeypatch.setattr("linkwright.paper.face.make_extended", lambda _progress=None: (SMALL,))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("linkwright.commands.paper.tables.EXTENDED_KEYS", ("small",))
    for arguments in ((), ("--quick",)):
        assert run(["tables", "--json", "t.json", "--csv", "csv", "--markdown", "t.md", *arguments]) == 0
        content = json.loads((tmp_path / "t.json").read_text(encoding="utf-8"))
        if arguments:
            assert content["extended"] == []
        else:
            assert content["extended"] == [
                {
                    "key": "small",
                    "title": "A small one",
                    "columns": [{"name": "who", "unit": ""}, {"name": "how far", "unit": "mm"}],
                    "rows": [["a", 1.5], ["b", None]],
                    "note": "so",
                }
            ]
            assert (tmp_path / "csv" / "small.csv").read_text(encoding="utf-8").startswith("who,")
        assert ("A small one" in (tmp_path / "t.md").read_text(encoding="utf-8")) != bool(arguments)


def test_progress_is_told_before_each_table(arms, monkeypatch):
    """In the order of the page; every key is one that the command may write."""
    from linkwright.commands.paper.tables import EXTENDED_KEYS

    makers = ("shapes", "materials", "steps", "tolerances", "seam", "heat", "rail", "dual_arm")
    for name, key in zip(makers, EXTENDED_KEYS, strict=True):
        monkeypatch.setattr(Extended, name, _named(name, key))
    said: list[tuple[int, int, str]] = []
    tables = Extended(arms, lambda done, total, text: said.append((done, total, text))).tables()
    assert tuple(table.key for table in tables) == EXTENDED_KEYS
    assert [each[:2] for each in said] == [(k, 8) for k in range(8)]
    assert said[2][2].endswith("steps")


def _named(name, key):
    def maker(_self):
        return replace(SMALL, key=key)

    maker.__name__ = name
    return maker


def test_the_docs_page_has_every_extended_table():
    """`linkwright tables --markdown docs/paper.md` renews them; here that each stands there with its columns."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "paper.md").read_text(encoding="utf-8")
    block = page[page.index(EXTENDED_BEGIN) : page.index(EXTENDED_END)]
    assert block.count("\n### ") == 8
    assert "| as given | 1.502 | – | 0.1773 | 26.3 |" in block
    assert "| worst along it | 0.98" in block
    assert "| 10 | clearance of joint 1 | 0.025 | mm | 1 | 0.0025 |" in block


def test_masses_are_the_links(arms):
    """pi/4 d^2 rho L of the paper's bars."""
    assert mass_of(arms.arm()) == pytest.approx(math.pi / 4 * 0.1**2 * 2700.0 * 1.24)


def test_no_column_is_lost_where_there_is_no_terminal(arms, capsys):
    """Nine columns within a hundred, the last with its heading."""
    long_names = ("cfrp-high-modulus-unidirectional", "aluminium-6061-t6")
    show_extended(console(), [material_table(arms, long_names)])
    out = capsys.readouterr().out
    assert all(word in out for word in ("growth,", "diameter,", "kg/m³"))
    assert max(map(len, out.splitlines())) <= 100

"""The corrected figures against hand calculation, and the verdicts drawn from them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.paper.corrected import DEFORMATION, PaperArm, pose_errors, search_of, worst_error, worst_signed
from linkwright.paper.printed import read_paper
from linkwright.paper.tables import proofs, verdicts

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def arms():
    return PaperArm(read_paper())


def uniform_cantilever(modulus, density, second_moment, area=math.pi * 0.05**2, length=1.24):
    """Q L^4 / (8 E I) of a bar held straight out, m."""
    return density * 9.81 * area * length**4 / (8.0 * modulus * second_moment)


def test_bending_of_the_whole_bar(arms):
    """0.17640 mm: three bars in line are one cantilever (Gere & Goodno, cantilever under uniform load)."""
    bending = frozenset({"shear_deformation", "axial"})
    assert 1e3 * worst_error(arms.arm(leave_out=bending)) == pytest.approx(0.17640, abs=5e-6)


def test_shear_adds_its_little(arms):
    """Q L^2 / (2 G A_s), A_s of the round section by strain energy: 0.9 mm/1000 and not more."""
    bending = 1e3 * worst_error(arms.arm(leave_out=frozenset({"shear_deformation", "axial"})))
    shear = 208.03 * 1.24**2 / (2 * 71e9 / 2.66 * 0.9 * math.pi * 0.05**2) * 1e3
    assert 1e3 * worst_error(arms.arm()) - bending == pytest.approx(shear, rel=0.06)


@pytest.mark.parametrize(
    ("joints", "swing"), [((1,), 1.24), ((2,), 0.84), ((3,), 0.42), ((1, 2), 2.08), ((1, 2, 3), 2.5)]
)
def test_backlash_turns_all_that_follows(book, joints, swing):
    """Half a thousandth of a radian times the reach beyond each joint."""
    pairs = zip(book.paper.backlash, book.table("backlash").rows, strict=True)
    rows = {tuple(sorted(given.joints)): row for given, row in pairs}
    assert 1e3 * rows[joints].corrected[0] == pytest.approx(0.5 * swing, rel=1e-6)


@pytest.mark.parametrize("signs", [(1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1), (1, -1, -1)])
def test_backlash_held_to_one_side(arms, signs):
    """Link i turns by the sum of the signs up to it; the best pose lines the three links up."""
    turns = np.abs(np.cumsum(signs))
    expected = 5e-4 * float(turns @ np.array([0.4, 0.42, 0.42]))
    assert worst_signed(arms.arm(backlash=(1, 2, 3), leave_out=DEFORMATION), signs) == pytest.approx(expected, rel=1e-6)


def test_one_side_is_never_worse_than_either(book):
    """With the signs free the worst is that of equal signs."""
    rows = book.table("backlash_direction").rows
    free = book.table("backlash").rows[-1].corrected
    assert rows[0].corrected == pytest.approx(free, rel=1e-6)
    assert all(row.corrected[1] <= free[1] * (1 + 1e-9) for row in rows)


def test_no_random_pose_is_worse(arms):
    """Of the deformed arm with clearance and backlash in every joint."""
    arm = arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3))
    poses = np.random.default_rng(1).uniform(-math.pi, math.pi, (20_000, 3))
    worst = worst_error(arm)
    assert 0.9 * worst < pose_errors(arm, poses).max() <= worst


@pytest.mark.parametrize(
    ("name", "modulus", "density"),
    [("carbon steel", 196e9, 7850), ("cast iron", 155e9, 7200), ("alloy steel", 190e9, 7820)],
)
def test_materials_by_the_cantilever(book, name, modulus, density):
    """Bending goes with density over modulus; shear adds half a per cent."""
    row = next(row for row in book.table("material").rows if row.label == name)
    bending = uniform_cantilever(modulus, density, math.pi * 0.1**4 / 64)
    assert bending < row.corrected[0] < 1.01 * bending


def test_shapes_by_the_cantilever(book):
    """Rectangle on its flat, triangle about its centroid: the sag goes with one over I."""
    rows = {row.label: row.corrected[0] for row in book.table("shape").rows}
    for name, second_moment in (("rectangle", 0.1571 * 0.05**3 / 12), ("triangle", 0.3142 * 0.05**3 / 36)):
        bending = uniform_cantilever(71e9, 2700, second_moment, area=0.007855)
        assert bending < rows[name] < 1.01 * bending


def test_the_arm_has_no_more_physics_than_said(arms):
    """Without play and deformation nothing is left."""
    assert worst_error(arms.arm(leave_out=DEFORMATION)) == 0.0
    search, _ = search_of(arms.arm())
    assert all(joint.stiffness is None and joint.mass == 0.0 for joint in search.arm.joints)
    assert search.arm.payload.mass == 0.0


def test_every_figure_that_differs_has_its_reason(book):
    """No row is without a note, and where a printed figure is not met the note names it or what came out."""
    for table in book.tables:
        for row in table.rows:
            assert len(row.note) > 15
            for printed, ours, met in zip(row.printed, row.reproduced_printed, row.agrees, strict=True):
                assert met or (printed in row.note and ours in row.note)


def test_the_four_verdicts(book):
    """The third conclusion is an artefact: deformation adds the same in every row of Table III."""
    judged = verdicts(book)
    assert [item.number for item in judged] == [1, 2, 3, 4]
    assert [item.judgement for item in judged] == ["holds", "holds in part", "does not hold", "holds in part"]
    rows = book.table("clearance").rows
    added = [row.corrected[1] - row.corrected[0] for row in rows]
    assert max(added) - min(added) < 1e-4 * added[0]
    printed = [float(row.printed[1]) - float(row.printed[0]) for row in (rows[0], rows[-1])]
    assert printed[1] > 6 * printed[0]
    assert "squaring" in judged[2].reason
    assert "0.1773 mm in every row" in judged[2].reason


def test_a_verdict_follows_its_figures(book):
    """Were deformation to add more to worse rows, the sentence would say so."""
    table = book.table("clearance")
    worse = replace(table.rows[-1], corrected=(table.rows[-1].corrected[0], 9e-4))
    changed = replace(book, tables=(replace(table, rows=(*table.rows[:-1], worse)), *book.tables[1:]))
    assert "in every row" not in verdicts(changed)[2].reason


def test_maxima_add_up(book, arms):
    """Clearance, backlash and deformation are worst in one and the same pose."""
    together = worst_error(arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3)))
    parts = book.table("clearance").rows[-1].corrected[0] + book.table("backlash").rows[-1].corrected[0]
    assert together == pytest.approx(parts + book.table("clearance").rows[0].corrected[1], rel=1e-4)


def test_what_the_paper_proved_about_seams(book):
    """For its own lengths without limits, and for nothing else."""
    shown = proofs(book)
    assert [item.holds for item in shown] == [False, False, True, False, False]
    hole, limited = shown[3].seam, shown[4].seam
    assert hole.exact
    assert hole.first_unreachable == pytest.approx((0.4, 0.3), abs=1e-12)
    assert not limited.exact
    # By hand: joints 2 and 3 at 60 deg leave the tip (0.4, 0.7275) m from the base at least.
    inner = math.hypot(0.4, 2 * 0.42 * math.sin(math.radians(60)))
    assert limited.first_unreachable == pytest.approx((math.sqrt(inner**2 - 0.09), 0.3), abs=1e-6)
    assert limited.missing == pytest.approx(inner - 0.3, abs=1e-5)

"""Drawings and lists of parts: to scale, by closed forms, and the same for the same arm."""

import io
import math

import ezdxf
import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.sections import ISection, Rectangle, Tube
from linkwright.core.sections.taper import build_tapered
from tests.linkwright.samples import arm_of

SECTIONS = (
    Rectangle(0.06, 0.1),
    Tube(0.08, 0.005),
    ISection(0.05, 0.12, 0.008, 0.006),
    build_tapered("tube", {"diameter": (0.12, 0.06), "thickness": 0.004}),
)


@pytest.fixture(scope="module")
def arm():
    """Four links of different sections, one of them tapered."""
    return arm_of(SECTIONS, (0.5, 0.4, 0.3, 0.2))


def drawing(model):
    """The drawing, read back."""
    return ezdxf.read(io.StringIO(lw.export_arm(lw.Arm.of(model), to="dxf").text))


def test_the_drawing_is_sound_and_in_millimetres(arm):
    document = drawing(arm)
    assert not document.audit().errors
    assert document.units == ezdxf.units.MM
    again = [lw.export_arm(lw.Arm.of(arm), to="dxf").text for _ in range(2)]
    assert again[0] == again[1]


def area(points):
    """Of a closed polygon, by the shoelace formula."""
    x, y = np.array(points).T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def test_links_and_sections_are_to_scale(arm):
    """Side views as long and high as the links; the areas of the sections by closed forms; dimensions that say so."""
    space = drawing(arm).modelspace()
    lines = [[tuple(p)[:2] for p in item.get_points()] for item in space.query("LWPOLYLINE[layer=='OUTLINE']")]
    areas = sorted(area(points) for points in lines)
    views = [500.0 * 100.0, 400.0 * 80.0, 300.0 * 120.0, 200.0 * 0.5 * (120.0 + 60.0)]
    sections = [60.0 * 100.0, 2 * 50.0 * 8.0 + (120.0 - 16.0) * 6.0]
    assert areas == pytest.approx(sorted([*views, *sections]), rel=1e-9)
    radii = sorted(item.dxf.radius for item in space.query("CIRCLE[layer=='OUTLINE']"))
    assert radii == pytest.approx(sorted([40.0, 35.0, 60.0, 56.0, 30.0, 26.0]), rel=1e-4)
    said = sorted(item.get_measurement() for item in space.query("DIMENSION"))
    wide_and_high = [60, 100, 80, 80, 50, 120, 120, 120, 60, 60]
    assert said == pytest.approx(sorted([500, 400, 300, 200, *wide_and_high]), rel=1e-4)


def test_a_rigid_link_is_an_axis_and_that_is_said():
    model = Arm("one", (Joint(),), (Link(0.4, mass=1.0),))
    result = lw.export_arm(lw.Arm.of(model), to="dxf").found
    assert any("link 1 is rigid" in item for item in result.lost)
    space = ezdxf.read(io.StringIO(result.text)).modelspace()
    assert not space.query("LWPOLYLINE")
    assert [item.get_measurement() for item in space.query("DIMENSION")] == pytest.approx([400.0])


def test_parts_have_the_masses_and_inertias_of_bodies(arm):
    """A block: m (b^2 + h^2)/12 and so on; a tube m (R^2 + r^2)/2 about its axis."""
    table = pd.read_csv(io.StringIO(lw.export_arm(lw.Arm.of(arm), to="bom").text))
    links = table[table["part"].str.startswith("link")].reset_index(drop=True)
    density = arm.links[0].material.need("density")
    block = links.iloc[0]
    mass = density * 0.06 * 0.1 * 0.5
    assert block["mass_kg"] == pytest.approx(mass)
    assert block["center_along_mm"] == pytest.approx(250.0)
    assert block["I_along_along_kg_m2"] == pytest.approx(mass * (0.06**2 + 0.1**2) / 12)
    assert block["I_height_height_kg_m2"] == pytest.approx(mass * (0.5**2 + 0.06**2) / 12)
    assert block["I_width_width_kg_m2"] == pytest.approx(mass * (0.5**2 + 0.1**2) / 12)
    assert block["price_EUR"] == pytest.approx(mass * arm.links[0].material.need("cost"))
    tube = links.iloc[1]
    assert tube["I_along_along_kg_m2"] == pytest.approx(tube["mass_kg"] * (0.04**2 + 0.035**2) / 2)
    cone = links.iloc[3]  # a hollow one: the mean of pi (d^4 - e^4)/32 over linear d, e is that of their fifth powers
    fifths = [(near**5 - far**5) / (5 * (near - far)) for near, far in ((0.12, 0.06), (0.112, 0.052))]
    assert cone["I_along_along_kg_m2"] == pytest.approx(density * 0.2 * math.pi / 32 * (fifths[0] - fifths[1]))
    drives = table[table["part"].str.startswith("drive")]
    assert drives["mass_kg"].tolist() == [2.0] * 4
    assert links["mass_kg"].sum() == pytest.approx(lw.evaluate(lw.Arm.of(arm)).mass_kg)
    assert "(tapered)" in links["section"].iloc[3]


def test_what_has_no_price_is_said():
    model = Arm("two", (Joint(mass=2.0), Joint()), (Link(0.4, mass=1.0), Link(0.4, mass=2.0)))
    result = lw.export_arm(lw.Arm.of(model), to="bom").found
    assert any("no price is known of drive of joint 1, link 1, link 2" in item for item in result.lost)
    assert math.isnan(pd.read_csv(io.StringIO(result.text))["price_EUR"].iloc[0])

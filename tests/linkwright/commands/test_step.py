"""Arms as solid bodies: read back, their volumes, boxes and inertias by closed forms and by the list of parts."""

import io
import math
import sys

import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.sections import ISection, RectangularTube, Tube
from linkwright.core.sections.build import build
from linkwright.core.sections.taper import build_tapered
from linkwright.core.units.quantities import InputError
from linkwright.drawings import step
from tests.linkwright.samples import arm_of

SECTIONS = (
    RectangularTube(0.06, 0.1, 0.005, corner_radius=0.01),
    Tube(0.08, 0.005),
    ISection(0.046, 0.08, 0.0052, 0.0038, root_radius=0.005),
    build_tapered("tube", {"diameter": (0.12, 0.06), "thickness": 0.004}),
    build("channel", {"width": 0.04, "height": 0.08, "flange_thickness": 0.006, "web_thickness": 0.004}),
)
LENGTHS = (0.5, 0.4, 0.3, 0.2, 0.25)


def frustum(first, second, length):
    """The volume of a cone cut off, by its radii."""
    return math.pi * length / 3.0 * (first**2 + first * second + second**2)


VOLUMES = {
    "link 1": 500.0 * ((60.0 * 100.0 - (4 - math.pi) * 10.0**2) - (50.0 * 90.0 - (4 - math.pi) * 5.0**2)),
    "link 2": 400.0 * math.pi * (40.0**2 - 35.0**2),
    "link 3": 300.0 * 764.3,  # IPE 80: 7.64 cm2, EN 10365
    "link 4": frustum(60.0, 30.0, 200.0) - frustum(56.0, 26.0, 200.0),
    "link 5": 250.0 * (2 * 40.0 * 6.0 + 68.0 * 4.0),
}
"""mm^3"""


@pytest.fixture(scope="module")
def arm():
    """Links one after another along x."""
    pytest.importorskip("build123d", reason="build123d cannot be loaded here", exc_type=ImportError)
    return arm_of(SECTIONS, LENGTHS)


@pytest.fixture(scope="module")
def bodies(arm, tmp_path_factory):
    """The bodies of the file, read back, by their names."""
    from build123d import import_step

    file = tmp_path_factory.mktemp("step") / "arm.step"
    lw.export_arm(lw.Arm.of(arm), to="step").save(file)
    assert "AUTOMOTIVE_DESIGN" in file.read_text(encoding="ascii")  # AP214
    return {child.label.replace("_", " "): child.solids()[0] for child in import_step(file).children}


def test_volumes_and_boxes_are_those_of_the_links(bodies):
    assert list(bodies) == list(VOLUMES)
    starts = 1e3 * np.cumsum([0.0, *LENGTHS])
    sizes = [(100.0, 60.0), (80.0, 80.0), (80.0, 46.0), (120.0, 120.0), (80.0, 40.0)]
    for solid, volume, begin, end, size in zip(
        bodies.values(), VOLUMES.values(), starts[:-1], starts[1:], sizes, strict=True
    ):
        assert solid.is_valid
        assert solid.volume == pytest.approx(volume, rel=1e-4)
        box = solid.bounding_box()
        assert pytest.approx([begin, end, *size], abs=1e-3) == [box.min.X, box.max.X, box.size.Y, box.size.Z]


def test_masses_centres_and_inertias_are_those_of_the_list_of_parts(arm, bodies):
    """The solids are integrated by CAD, the list by the formulas of sections: neither knows of the other."""
    table = pd.read_csv(io.StringIO(lw.export_arm(lw.Arm.of(arm), to="bom").text))
    links = table[table["part"].isin(list(bodies))].set_index("part")
    for number, (name, solid) in enumerate(bodies.items()):
        row, density = links.loc[name], arm.links[number].material.need("density")
        assert row["mass_kg"] == pytest.approx(density * solid.volume / 1e9, rel=1e-5)
        center = solid.center().X - 1e3 * sum(LENGTHS[:number])
        assert row["center_along_mm"] == pytest.approx(center, rel=1e-5)
        # Along, height and width of an arm in the x-y plane are x, y and z.
        inertia = density * 1e-15 * np.array(solid.matrix_of_inertia)
        said = [row[f"I_{item}_{item}_kg_m2"] for item in ("along", "height", "width")]
        assert said == pytest.approx(list(np.diag(inertia)), rel=1e-4)


def test_the_same_arm_gives_the_same_file(arm):
    assert len({lw.export_arm(lw.Arm.of(arm), to="step").text for _ in range(2)}) == 1


TAPERS = (
    ("rectangular_tube", {"width": (0.06, 0.084), "height": 0.1, "thickness": 0.005, "corner_radius": 0.03}),
    ("triangular_tube", {"width": 0.06, "height": (0.1, 0.07), "thickness": 0.004}),
    ("i_section", {"width": 0.06, "height": (0.1, 0.06), "flange_thickness": 0.006, "web_thickness": 0.004}),
    ("octagonal_tube", {"width": (0.1, 0.06), "thickness": 0.004}),
    ("hexagonal_tube", {"height": (0.1, 0.06), "thickness": 0.004}),
    ("t_section", {"width": 0.06, "height": (0.1, 0.07), "flange_thickness": 0.006, "web_thickness": 0.004}),
    ("ellipse", {"width": 0.05, "height": (0.1, 0.06)}),
)


def test_every_taper_is_the_body_of_its_formulas(arm):
    """Areas at 2,000 cuts, added up."""
    del arm
    share = (np.arange(2000) + 0.5) / 2000
    tapers = [build_tapered(*item) for item in TAPERS]
    result = step.solids(arm_of(tapers, [0.3] * len(tapers)))
    for solid, section in zip(result.values(), tapers, strict=True):
        assert solid.is_valid
        assert solid.volume / 300e6 == pytest.approx(float(np.mean(section.along(share, 0.3).area)), rel=2e-5)


def test_a_body_that_is_not_the_link_is_refused(arm, monkeypatch):
    monkeypatch.setattr(step, "contours", lambda _: step_contours(Tube(0.08, 0.00501)))
    with pytest.raises(InputError, match=r"link 1 would be wrong as a solid: its volume is off by 0\.0\d+"):
        step.solids(arm_of((Tube(0.08, 0.005),), (0.4,)))
    assert arm


def step_contours(section):
    """What the edges of a section are."""
    from linkwright.drawings.contours import contours

    return contours(section)


def test_rigid_links_are_told(arm):
    model = Arm("two", (Joint(), Joint()), (Link(0.4, mass=1.0), arm.links[1]))
    result = lw.export_arm(lw.Arm.of(model), to="step").found
    assert result.lost[0] == "link 1 is rigid and has no section to make a body of"
    assert "'link 2'" in result.text
    with pytest.raises(InputError, match="no link of the arm has a section"):
        lw.export_arm(lw.Arm.of(Arm("one", (Joint(),), (Link(0.4, mass=1.0),))), to="step")


def test_without_build123d_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "build123d", None)
    with pytest.raises(InputError, match=r"pip install 'build123d>=[0-9.]+'") as error:
        lw.export_arm(lw.Arm.of(arm_of(SECTIONS[:1], LENGTHS[:1])), to="step")
    assert "\n" not in str(error.value)

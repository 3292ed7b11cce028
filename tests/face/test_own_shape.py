"""Shapes of which only this file knows, by an outline alone: evaluated, chosen, limited and drawn like others."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import ezdxf
import numpy as np
import pytest

import linkwright as lw
from linkwright.core.sections import HexagonalTube, Wall

NAMES = ("hexagon_by_outline", "slotted")


@dataclass(frozen=True)
class HexagonByOutline(lw.Shape):
    """A hexagonal tube that knows no formula."""

    height: float
    thickness: float

    shape: ClassVar[str] = "hexagon_by_outline"
    dimensions: ClassVar[tuple[lw.Dimension, ...]] = (
        lw.Dimension("height", "across flats", "outer"),
        lw.Dimension("thickness", "of the wall", "wall"),
    )

    def outline(self):
        """Two hexagons."""
        angle = math.pi / 3.0 * np.array([*range(6), 0])
        edge = np.column_stack((np.cos(angle), np.sin(angle))) / math.sqrt(3.0)
        return [self.height * edge, (self.height - 2.0 * self.thickness) * edge[::-1]]

    def wall_parts(self, web):
        """Those of the shipped tube."""
        return HexagonalTube(self.height, self.thickness).wall_parts(web)


def side(turn: int) -> np.ndarray:
    """A quarter of the edge of a slotted extrusion, turned about the middle, mm."""
    half, lip, mouth, room, depth = 20.0, 2.0, 4.1, 8.0, 8.0
    points = [(-half, -half), (-mouth, -half), (-mouth, lip - half), (-room, lip - half), (-room, depth - half)]
    across = points + [(-y, z) for y, z in reversed(points[1:])]
    c, s = round(math.cos(turn * math.pi / 2.0)), round(math.sin(turn * math.pi / 2.0))
    return np.array(across) @ np.array([[c, s], [-s, c]])


def draw(path: Path) -> Path:
    """A drawing of the extrusion: lines around and a bore."""
    document = ezdxf.new()
    space = document.modelspace()
    corners = np.vstack([side(turn) for turn in range(4)])
    for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        space.add_line(first, second)
    space.add_circle((0.0, 0.0), 3.4)
    space.add_text("40 x 40")
    document.saveas(path)
    return path


@pytest.fixture(scope="module", autouse=True)
def registered(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The shapes are known for as long as the tests of this file run."""
    drawn = lw.shapes.from_dxf(draw(tmp_path_factory.mktemp("drawing") / "slotted.dxf"), "slotted")

    class Slotted(drawn):
        """The extrusion, with the lips of a slot as its walls."""

        def wall_parts(self, web):
            del web
            part = self.height / 40.0
            ends = ((12.0 * part, 1.0 * part), (15.9 * part, 1.0 * part))
            return (Wall("lip", "each lip of a slot", "outstand", 3.9 * part, 2.0 * part, ends),)

    lw.shapes.register(HexagonByOutline)
    lw.shapes.register(Slotted)
    yield
    for name in NAMES:
        lw.shapes.withdraw(name)


def arm(first: object, second: object = None) -> lw.Arm:
    """Two links of these sections, or of one."""
    joint = lw.Joint(range=["-60 deg", "90 deg"], stiffness="60 kN*m/rad")
    links = [lw.Link(length="400 mm", section=item, material="aluminium-6061-t6") for item in (first, second or first)]
    return lw.Arm(chain=[(joint, link) for link in links], payload={"mass": "4 kg"})


def area(loop: np.ndarray) -> float:
    """Within a loop."""
    y, z = loop.T
    return 0.5 * float(y @ np.roll(z, -1) - z @ np.roll(y, -1))


def sections() -> dict[str, tuple[object, object]]:
    """A section of each by the outline, and one that is the same by formulas or by points."""
    points = np.vstack([side(turn) for turn in range(4)])
    turned = np.arange(64) * (math.pi / 32.0)
    bore = 3.4 * np.column_stack((np.cos(turned), np.sin(turned)))
    as_points = {"points": (points * 1e-3).tolist(), "holes": [(bore * 1e-3).tolist()]}
    return {
        "hexagon_by_outline": (
            lw.shapes.HexagonByOutline(height="50 mm", thickness="3 mm"),
            lw.shapes.HexagonalTube(height="50 mm", thickness="3 mm"),
        ),
        "slotted": (lw.shapes.Slotted(height="40 mm"), lw.shapes.Polygon(**as_points)),
    }


@pytest.mark.parametrize("name", NAMES)
def test_the_contract_is_kept(name: str) -> None:
    lw.shapes.check(lw.shapes[name])


@pytest.mark.parametrize("name", NAMES)
def test_an_arm_of_it_is_evaluated(name: str) -> None:
    """As one of the same section by formulas or by points; and its walls buckle or do not."""
    section, same = sections()[name]
    result = lw.evaluate(arm(section))
    assert result.max_error_mm == pytest.approx(lw.evaluate(arm(same)).max_error_mm, rel=1e-3)
    assert result.figures.loc["local_buckling", "value"] > 2.0


@pytest.mark.parametrize("name", NAMES)
def test_its_sizes_are_chosen(name: str) -> None:
    """Against the shipped hexagonal tube, or heights that are a little less or more."""
    limits = {"max_error": "<= 1.2 mm", "section_size": ["20 mm", "90 mm"], "thickness": ["1.5 mm", "6 mm"]}
    section, same = sections()[name]
    asked = {"minimize": "mass", "subject_to": limits}
    best = lw.optimize(lw.Problem(arm(section), **asked, choose={"section": [name]}))
    assert best.max_error_mm == pytest.approx(1.2, rel=1e-3)
    if name == "hexagon_by_outline":
        shipped = lw.optimize(lw.Problem(arm(same), **asked, choose={"section": ["hexagonal_tube"]}))
        assert best.mass_kg == pytest.approx(shipped.mass_kg, rel=2e-3)
        return
    for size in (0.97, 1.03):
        heights = [size * link.section.height for link in best.arm.model.links]
        other = arm(*(lw.shapes.Slotted(height=height) for height in heights))
        assert (lw.evaluate(other).max_error_mm > 1.2) == (size < 1.0)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("to", ["dxf", "step"])
def test_it_is_drawn(name: str, to: str, tmp_path: Path) -> None:
    section, _ = sections()[name]
    made = lw.export_arm(arm(section), to=to)
    path = tmp_path / f"arm.{to}"
    path.write_text(made.text, encoding="utf-8")
    if to == "step":
        from build123d import import_step

        volume = sum(solid.volume for solid in import_step(path).solids())
        expected = 2.0 * 400.0 * 1e6 * float(section.properties(0.3).area)
        assert volume == pytest.approx(expected, rel=2e-3)
        return
    lines = ezdxf.readfile(path).modelspace().query("LWPOLYLINE")
    areas = [abs(area(np.array([point[:2] for point in line.get_points()]))) for line in lines]
    assert max(areas) > 0.0
    outer = 1e6 * abs(area(section.outline()[0]))
    assert any(found == pytest.approx(outer, rel=1e-6) for found in areas)


@pytest.mark.parametrize(
    ("text", "said"),
    [("", "is no sound DXF file|it is no DXF file|cannot be read"), (None, "has no closed outline")],
)
def test_a_drawing_without_an_outline_is_refused(text: str | None, said: str, tmp_path: Path) -> None:
    path = tmp_path / "open.dxf"
    if text is None:
        document = ezdxf.new()
        document.modelspace().add_line((0.0, 0.0), (1.0, 0.0))
        document.saveas(path)
    else:
        path.write_text("no drawing", encoding="utf-8")
    with pytest.raises(lw.InputError, match=said):
        lw.shapes.from_dxf(path, "open_shape")

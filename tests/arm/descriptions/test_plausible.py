"""Weights that no body has are named with their figures; sound ones are not."""

import numpy as np
import pytest

from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.descriptions.reading.meshes import solid
from linkwright.core.arm.descriptions.reading.tree import NO_STEP, Shape
from tests.arm.descriptions.test_weights import chain, weighs

SOUND = 'ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"'


def doubts(folder, text):
    path = folder / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    return import_robot(path).doubts


@pytest.mark.parametrize(
    ("links", "words"),
    [
        ((weighs(3), weighs(2), weighs(1)), []),
        (
            (weighs(3), weighs(0.007, 'ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"'), weighs(2)),
            ["7 g", "2 kg"],
        ),
        ((weighs(3), weighs(2, 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"')), ["1 kg*m^2", "707 mm", "300 mm"]),
        (
            (weighs(3), weighs(2, 'ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.05"')),
            ["0.05", "sum of the others"],
        ),
        ((weighs(3), weighs(2, 'ixx="0.01" ixy="0.03" ixz="0" iyy="0.01" iyz="0" izz="0.02"')), ["-0.02", "negative"]),
        ((weighs(3), weighs(2, 'ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"')), []),
    ],
)
def test_figures_that_no_body_has(tmp_path, links, words):
    """A link of 7 g between 3 and 2 kg; 1 kg*m^2 at 2 kg, whose radius of gyration is 1/sqrt(2) m, on links of 300 mm;
    a moment above the sum of the others (a flat plate has just the sum); 0.01 - 0.03 kg*m^2."""
    result = doubts(tmp_path, chain(*links))
    assert len(result) == bool(words)
    for word in words:
        assert word in result[0]
        assert result[0].startswith("l2 ")


@pytest.mark.parametrize(
    ("mass", "words"),
    [(3.0, None), (26.5, None), (0.05, "lighter than foam"), (27.0, "denser than solid bronze-c93200")],
)
def test_masses_beside_what_links_are_drawn_by(tmp_path, mass, words):
    """A box of 0.1 x 0.1 x 0.3 m holds 3 litres: 26.8 kg of the catalogue's densest bronze, 0.1 kg of foam."""
    small = f'ixx="{mass / 1e3}" ixy="0" ixz="0" iyy="{mass / 1e3}" iyz="0" izz="{mass / 1e3}"'
    result = doubts(tmp_path, chain(weighs(mass, small), weighs(mass, small), drawn=(1,)))
    assert len(result) == (words is not None)
    assert words is None or (words in result[0] and "3 litres" in result[0])


def cube(side, kind):
    """A cube as STL, facets turned out."""
    faces = []
    for axis in range(3):
        for end in (0.0, 1.0):
            corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
            square = side * np.insert(corners, axis, end, axis=1)
            square = square if (end == 1.0) != (axis == 1) else square[::-1]
            faces += [square[[0, 1, 2]], square[[0, 2, 3]]]
    if kind == "ascii":
        lines = "".join(f"vertex {x} {y} {z}\n" for face in faces for x, y, z in face)
        return f"solid cube\n{lines}endsolid\n".encode()
    records = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records["corners"] = faces
    return b" " * 80 + len(faces).to_bytes(4, "little") + records.tobytes()


@pytest.mark.parametrize("kind", ["ascii", "binary"])
def test_a_mesh_has_its_volume(tmp_path, kind):
    """A cube of 200 units of which each is 1 mm: 8 litres, found beside the URDF's folder by its package's name."""
    (tmp_path / "arm_description" / "meshes").mkdir(parents=True)
    (tmp_path / "arm_description" / "urdf").mkdir()
    (tmp_path / "arm_description" / "meshes" / "cube.stl").write_bytes(cube(200.0, kind))
    robot = tmp_path / "arm_description" / "urdf" / "arm.urdf"
    for name in ("package://arm_description/meshes/cube.stl", "../meshes/cube.stl"):
        result = solid(Shape("mesh", (1e-3, 1e-3, 1e-3), NO_STEP, name), robot)
        assert result.volume == pytest.approx(8e-3, rel=1e-6)
        assert result.corners.max(axis=0) == pytest.approx([0.2, 0.2, 0.2], rel=1e-6)
    assert solid(Shape("mesh", (1.0, 1.0, 1.0), NO_STEP, "../meshes/none.stl"), robot) is None
    (tmp_path / "arm_description" / "meshes" / "open.stl").write_bytes(cube(200.0, "binary")[: 84 + 50 * 10])
    assert solid(Shape("mesh", (1.0, 1.0, 1.0), NO_STEP, "../meshes/open.stl"), robot) is None


def test_a_mass_far_from_its_meshs(tmp_path):
    """50 g in the 8 litres of its mesh."""
    (tmp_path / "cube.stl").write_bytes(cube(0.2, "binary"))
    mesh = '<visual><geometry><mesh filename="cube.stl"/></geometry></visual>'
    light = weighs(0.05, 'ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"')
    result = doubts(tmp_path, chain(light + mesh, light))
    assert len(result) == 1
    assert "l1 weighs 50 g in the 8 litres" in result[0]

"""Volumes and extents of what a URDF's links are drawn by; of meshes those in STL files that are there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass
from linkwright.core.sections.numeric import Array
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError

from .tree import Shape

_CLOSED = 1e-3
"""Of its surface: by so little the facets of a closed mesh, as vectors, may miss to cancel out (single precision)."""


@dataclass(frozen=True)
class Solid:
    """A shape in its link's frame: its `volume` (m^3; None where its surface is open), its `center` (m), its `second`
    moments of volume about that (3, 3; m^5), and `corners` (N, 3; m) between which all of it lies."""

    volume: float | None
    center: Array
    second: Array
    corners: Array

    def weighing(self, density: float) -> Mass | None:
        """The body of one density (kg/m^3) that fills it; None where its surface is open."""
        if self.volume is None:
            return None
        inertia = density * (np.trace(self.second) * np.eye(3) - self.second)
        return Mass(density * self.volume, self.center, inertia)


def solid(shape: Shape, robot_file: Path) -> Solid | None:
    """A shape as a solid; None where the file does not say its sizes, or its mesh is not there as STL."""
    solid_ = _mesh(shape, robot_file) if shape.kind == "mesh" else _simple(shape)
    if solid_ is None:
        return None
    turn, shift = np.array(shape.origin[0], dtype=float), np.array(shape.origin[1], dtype=float)
    return Solid(
        solid_.volume, turn @ solid_.center + shift, turn @ solid_.second @ turn.T, solid_.corners @ turn.T + shift
    )


def _simple(shape: Shape) -> Solid | None:
    sizes = shape.sizes
    if not sizes or min(sizes) <= 0.0:
        return None
    if shape.kind == "box":
        half, volume = np.array(sizes) / 2.0, math.prod(sizes)
        second = volume * half**2 / 3.0
    elif shape.kind in ("sphere", "ellipsoid"):
        half = np.full(3, sizes[0]) if shape.kind == "sphere" else np.array(sizes)
        volume = 4.0 / 3.0 * math.pi * float(np.prod(half))
        second = volume * half**2 / 5.0
    else:
        radius, length = sizes
        tube = math.pi * radius**2 * length
        caps = 4.0 / 3.0 * math.pi * radius**3 if shape.kind == "capsule" else 0.0
        half = np.array([radius, radius, length / 2.0 + (radius if caps else 0.0)])
        volume = tube + caps
        across = tube * radius**2 / 4.0 + caps * radius**2 / 5.0
        # A hemisphere's centre is 3/8 of its radius beyond its base.
        far = length**2 / 4.0 + 3.0 / 8.0 * length * radius + radius**2 / 5.0
        second = np.array([across, across, tube * length**2 / 12.0 + caps * far])
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    return Solid(volume, np.zeros(3), np.diag(second), signs * half)


def _mesh(shape: Shape, robot_file: Path) -> Solid | None:
    file = _file_of(shape.file, robot_file)
    if file is None or len(shape.sizes) != 3:
        return None
    try:
        triangles = _triangles(read_bytes(file))
    except InputError:
        return None
    if triangles is None or not len(triangles):
        return None
    triangles = triangles * np.array(shape.sizes)
    first, second, third = (triangles[:, k] for k in range(3))
    normals = np.cross(second - first, third - first)
    surface = float(np.linalg.norm(normals, axis=1).sum())
    closed = surface > 0.0 and float(np.linalg.norm(normals.sum(axis=0))) <= _CLOSED * surface
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    ends = np.stack([low, high])
    corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    if not closed and not shape.hulls:
        return Solid(None, np.zeros(3), np.zeros((3, 3)), corners)
    areas = np.linalg.norm(normals, axis=1)
    center = _pyramids(triangles, areas @ triangles.mean(axis=1) / areas.sum(), shape.hulls)[1]
    volume, _, second = _pyramids(triangles, center, shape.hulls)
    return Solid(volume if volume > 0.0 else None, center, second, corners)


def _pyramids(triangles: Array, apex: Array, hulls: bool) -> tuple[float, Array, Array]:
    """Volume, centre and second moments about the apex of the pyramids that stand on facets, hollow ones taken off (F.
    Tonon, J. Math. Stat. 1 (2005) 8, doi:10.3844/jmssp.2005.8.11), or counted as full ones."""
    first, second, third = (triangles[:, k] - apex for k in range(3))
    parts = np.einsum("ij,ij->i", first, np.cross(second, third)) / 6.0
    parts = np.abs(parts) if hulls else parts * np.sign(parts.sum())
    sums = first + second + third
    volume = float(parts.sum())
    moments = sum(np.einsum("i,ij,ik->jk", parts, item, item) for item in (first, second, third, sums)) / 20.0
    return volume, apex + parts @ sums / (4.0 * volume) if volume else apex, np.asarray(moments)


def _file_of(name: str, robot_file: Path) -> Path | None:
    """The STL file that a URDF names: `package://NAME/..` is sought in and beside the folders above the URDF."""
    if not name.lower().endswith(".stl"):
        return None
    if not name.startswith("package://"):
        file = robot_file.parent / name.removeprefix("file://")
        return file if file.is_file() else None
    package, _, rest = name.removeprefix("package://").partition("/")
    for folder in robot_file.resolve().parents:
        for root in (folder, folder / package) if folder.name == package else (folder / package,):
            if (root / rest).is_file():
                return root / rest
    return None


def _triangles(content: bytes) -> Array | None:
    """The corners (N, 3, 3) of an STL file's facets, binary or as text; None for what is neither."""
    count = int.from_bytes(content[80:84], "little") if len(content) >= 84 else -1
    if len(content) == 84 + 50 * count:
        kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        corners = np.frombuffer(content, kind, count=count, offset=84)["corners"].astype(float)
    else:
        lines = (line.split() for line in content.decode("ascii", errors="replace").splitlines())
        try:
            results = [[float(word) for word in words[1:4]] for words in lines if words[:1] == ["vertex"]]
            corners = np.array(results, dtype=float).reshape(-1, 3, 3)
        except ValueError:
            return None
    return corners if np.all(np.isfinite(corners)) else None

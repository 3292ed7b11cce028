"""The ways in which the walls of a section buckle, and how much of that its loads use up.

A use of 1 is the load at which a wall buckles, linear theory and simply supported edges taken. Flat walls: with an even
part a, an uneven part b and a shear s of what each alone would take, they buckle where a + b^2 + s^2 = 1 for a share of
the load (G. Gerard and H. Becker, Handbook of Structural Stability I, NACA TN 3781, 1957; EN 1993-1-5:2006, eq. 10.6),
so that the use is a/2 + sqrt(a^2/4 + b^2 + s^2). Edge stresses are those of the whole section, under axial force,
bending in both planes, the transverse forces over the shear areas, and the torque of a closed wall (T/(2 A_m t)). Of a
wall with a free edge a is that of the stress at three quarters of its width, which turns it about the other edge; it
may also buckle as if the free edge were held, where that is pulled.

Round walls: compression, bending and shear add up, each over what it takes alone (NASA SP-8007, revised 1968), with its
knock-down factors 1 - 0.901 (1 - e^-phi) under axial compression and 1 - 0.731 (1 - e^-phi) under bending, phi =
sqrt(R/t)/16, the lower bounds of tests up to R/t = 1500; twisted, for a link that is long against its radius (for a
short one that is safe). An elliptical wall counts as a round one of the radius of curvature at each of its points (J.
W. Hutchinson, Buckling and initial postbuckling behavior of oval cylindrical shells under axial compression, J. Appl.
Mech. 35, 1968), under the factor of compression.

Left out: yielding before a wall buckles (`safety_factor`), what a wall carries beyond, shear in walls with a free edge,
and what holds the edges of a wall beside simple supports, which would make it stronger.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.core.sections import Wall, walls
from linkwright.core.sections.numeric import exp, sqrt

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.materials.walls import WallCompliance
    from linkwright.core.sections import Arc, Section
    from linkwright.core.sections.properties import SectionProperties

Point = tuple[Any, Any]


@dataclass(frozen=True)
class WallLoads:
    """The loads of a section: compression (N, negative in tension), moments (N*m) that bend towards height and width,
    transverse forces along them (N), torque (N*m), and the length (m) of the link; floats, arrays or symbols."""

    pressing: Any
    in_height: Any
    in_width: Any
    along_height: Any
    along_width: Any
    torque: Any
    length: Any

    def over(self, size: Any) -> WallLoads:
        """The loads that do to a section what these do to one `size` times as large."""
        square, cube = size * size, size * size * size
        return WallLoads(
            self.pressing / square,
            self.in_height / cube,
            self.in_width / cube,
            self.along_height / square,
            self.along_width / square,
            self.torque / cube,
            self.length / size,
        )


@dataclass(frozen=True)
class Mode:
    """A way to buckle: what each load adds to its parts. In floats, arrays or symbols.

    `pressed`, `height`, `width` and `either` (1/N, 1/(N*m)) are of the even part: of compression, of the moments in
    height and width, of their resultant; `flow_height`, `flow_width` and `flow_torque` are those of shear that adds to
    it, over the square root of the length (m). `height_uneven` and `width_uneven` are of the uneven part,
    `shear_height`, `shear_width` and `shear_torque` of shear. `mirrored_height` and `mirrored_width` are 1 where the
    wall has its image on the other side, so that the sign of a moment does not count, else 0.
    """

    pressed: Any
    height: Any = 0.0
    width: Any = 0.0
    either: Any = 0.0
    flow_height: Any = 0.0
    flow_width: Any = 0.0
    flow_torque: Any = 0.0
    height_uneven: Any = 0.0
    width_uneven: Any = 0.0
    shear_height: Any = 0.0
    shear_width: Any = 0.0
    shear_torque: Any = 0.0
    mirrored_height: Any = 1.0
    mirrored_width: Any = 1.0

    def use(self, loads: WallLoads) -> Any:
        """The share of the load at which the wall buckles; never below 0."""
        height, width = _size(loads.in_height), _size(loads.in_width)
        height = self.mirrored_height * height + (1.0 - self.mirrored_height) * loads.in_height
        width = self.mirrored_width * width + (1.0 - self.mirrored_width) * loads.in_width
        across = _size(loads.along_height), _size(loads.along_width), _size(loads.torque)
        either = sqrt(loads.in_height * loads.in_height + loads.in_width * loads.in_width + _NOTHING)
        flow = self.flow_height * across[0] + self.flow_width * across[1] + self.flow_torque * across[2]
        even = self.pressed * loads.pressing + self.height * height + self.width * width + self.either * either
        even = even + flow * sqrt(loads.length)
        uneven = self.height_uneven * height + self.width_uneven * width
        shear = self.shear_height * across[0] + self.shear_width * across[1] + self.shear_torque * across[2]
        return 0.5 * even + sqrt(0.25 * even * even + uneven * uneven + shear * shear + _NOTHING * _NOTHING)


_NOTHING = 1e-12
"""Keeps derivatives of sizes finite at zero: a millionth of a newton (or newton metre)."""


def _size(value: Any) -> Any:
    return sqrt(value * value + _NOTHING)


def modes_of(
    section: Section, properties: SectionProperties, material: MaterialValues
) -> list[tuple[str, Mode]] | None:
    """How each wall of a section of these properties buckles, with what it is called; none where it is solid, None
    where its walls, or how its material bends in them, are not known."""
    known = walls(section, (properties.centroid_y, properties.centroid_z))
    if known is None or (known and material.walls is None):
        return None
    modes: list[tuple[str, Mode]] = []
    for wall in known:
        assert material.walls is not None
        modes_here = (
            _round(wall, properties, material.walls) if wall.ends is None else _flat(wall, properties, material.walls)
        )
        modes += [(wall.text, mode) for mode in modes_here]
    return modes


def _stress(properties: SectionProperties) -> Callable[[Point], tuple[Any, Any]]:
    """The compression (1/m^3) at points (m), or between them, under unit moments in height and in width."""
    in_height, in_width, askew = properties.second_moment_y, properties.second_moment_z, properties.product_moment_yz
    if isinstance(askew, float) and askew == 0.0:
        return lambda at: (at[1] / in_height, at[0] / in_width)
    rest = in_height * in_width - askew * askew
    return lambda at: ((at[1] * in_width - at[0] * askew) / rest, (at[0] * in_height - at[1] * askew) / rest)


def _flat(wall: Wall, properties: SectionProperties, material: WallCompliance) -> list[Mode]:
    assert wall.ends is not None
    (y0, z0), (y1, z1) = wall.ends
    along_y, along_z = y1 - y0, z1 - z0
    clear = sqrt(along_y * along_y + along_z * along_z)
    slender = (clear / wall.thickness) ** 2
    stress = _stress(properties)
    mirrored = {"mirrored_height": float(wall.mirrored[0]), "mirrored_width": float(wall.mirrored[1])}

    def mode(at: float, pressed: Any, share: float, bent: Any, **shear: Any) -> Mode:
        """`at` is the share of the width at which the even part is, `share` that of the uneven part."""
        height, width = stress((y0 + at * along_y, z0 + at * along_z))
        uneven = stress((share * along_y, share * along_z))
        even, bends = slender * pressed, slender * bent
        return Mode(
            even / properties.area,
            even * height,
            even * width,
            height_uneven=bends * uneven[0],
            width_uneven=bends * uneven[1],
            **shear,
            **mirrored,
        )

    if wall.free:
        turning = mode(0.75, material.free_pressed, 1.0, material.free_bent)
        return [turning, mode(0.5, material.pressed, 0.5, material.bent)]
    sheared = slender * material.sheared
    shear = {
        "shear_height": sheared * sqrt(along_z * along_z) / (clear * properties.shear_area_z),
        "shear_width": sheared * sqrt(along_y * along_y) / (clear * properties.shear_area_y),
    }
    if wall.encloses is not None:
        shear["shear_torque"] = sheared / (2.0 * wall.encloses * wall.thickness)
    return [mode(0.5, material.pressed, 0.5, material.bent, **shear)]


def _round(wall: Wall, properties: SectionProperties, material: WallCompliance) -> list[Mode]:
    modes: list[Mode] = []
    for arc in wall.arcs:
        modes += _at_arc(arc, wall, properties, material)
    return modes


def _at_arc(arc: Arc, wall: Wall, properties: SectionProperties, material: WallCompliance) -> list[Mode]:
    assert wall.encloses is not None
    slender = arc.radius / wall.thickness
    decay = 1.0 - exp(-sqrt(slender / material.round_depth) / 16.0)
    pressed = slender * material.round_pressed / (1.0 - 0.901 * decay)
    bent = slender * material.round_pressed / (1.0 - 0.731 * decay)
    twisted = material.round_twisted * slender**1.25 / sqrt(arc.radius)
    flow = {
        "flow_height": twisted / properties.shear_area_z,
        "flow_width": twisted / properties.shear_area_y,
        "flow_torque": twisted / (2.0 * wall.encloses * wall.thickness),
    }
    if arc.y is not None:
        height, width = _stress(properties)((arc.y, arc.z))
        return [Mode(pressed / properties.area, pressed * height, pressed * width, **flow)]
    either = bent * arc.radius / properties.second_moment_y
    # Tension relieves a wall that is bent by no more than it takes off its stress.
    return [Mode(item / properties.area, either=either, **flow) for item in (pressed, bent)]

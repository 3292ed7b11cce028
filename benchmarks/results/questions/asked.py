"""What can be asked of a design: each figure, region and choice against every choice singly, by hand."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from benchmarks.results.row import Row
from linkwright.core.arm.actuators import load_actuators
from linkwright.core.sections.numeric import Array

from .beams import Chain, Joint, Load, box, grid, tube
from .singly import (
    LENGTHS,
    METALS,
    POSES,
    RANGES,
    RODS,
    Asked,
    Plane,
    chain,
    combinations_of,
    lightest_rods,
    poses_to,
    rods,
    worst,
)

_TWO_KG = Load(2.0)
_PLAY = math.radians(1.0 / 60.0)
_PLAYING = Plane(joint=", backlash: 1 arcmin").text


def figures() -> Iterator[Asked]:
    """Limits on figures of the tip."""
    yield lightest_rods(
        "`orientation_error`",
        "orientation_error: '<= 1.2 mrad'",
        lambda d, name: worst(rods(d, name), _TWO_KG, of_turn=True),
        1.2e-3,
    )
    yield lightest_rods(
        "`orientation_error` about an axis",
        "orientation_error: {axis: [0, 0, 1], value: '<= 1.5 mrad'}",
        lambda d, name: worst(rods(d, name, _PLAY), _TWO_KG, of_turn=True, along=(0.0, 0.0, 1.0)),
        1.5e-3,
        _PLAYING,
    )
    yield lightest_rods(
        "`error_along`",
        "error_along: {direction: [3, 4], value: '<= 0.9 mm'}",
        lambda d, name: worst(rods(d, name, _PLAY), _TWO_KG, along=(0.6, 0.8, 0.0)),
        0.9e-3,
        _PLAYING,
    )
    yield lightest_rods(
        "`tip_stiffness_along`",
        "tip_stiffness_along: {direction: [0, 1], value: '>= 60 N/mm'}",
        lambda d, name: float(rods(d, name).compliance(POSES)[:, 1, 1].max()),
        1.0 / 60e3,
    )


def _carried(arm: Chain) -> float:
    return brentq(lambda mass: worst(arm, Load(mass)) - 0.6e-3, 0.0, 100.0)


def largest_payload() -> Asked:
    """The largest payload of listed tubes."""
    sizes = [tube(d, 3e-3) for d in (0.04, 0.06, 0.08)]
    text = (
        "maximize: payload\nsubject_to: {max_error: '<= 0.6 mm', mass: '<= 2.6 kg'}\n"
        "choose: {section: [tube], sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}}\n"
    )

    def best() -> float:
        return max(_carried(arm) for arm in combinations_of(sizes, METALS[:1]) if arm.mass <= 2.6)

    return Asked("`maximize: payload`", Plane().text, text, best, "nine tubes")


def listed() -> Iterator[Asked]:
    """Sections and materials of which a list or a number is said."""
    boxes = [(w, h) for w, h in itertools.product((0.03, 0.04, 0.05), repeat=2)]
    text = (
        "minimize: max_error\nsubject_to: {section_height: '<= 45 mm', section_width: '<= 35 mm', mass: '<= 2.5 kg'}\n"
        "choose: {section: [rectangular_tube], sizes: {width: [30 mm, 40 mm, 50 mm], height: [30 mm, 40 mm, 50 mm], "
        "thickness: [3 mm]}}\n"
    )

    def highest() -> float:
        kept = [box(w, h, 3e-3) for w, h in boxes if h <= 0.045 and w <= 0.035]
        return min(worst(arm, _TWO_KG) for arm in combinations_of(kept, METALS[:1]) if arm.mass <= 2.5)

    yield Asked("`section_height`, `section_width`", Plane().text, text, highest, "81 pairs of boxes")
    tubes = [tube(d, 3e-3) for d in (0.04, 0.05, 0.06)]
    choice = "choose: {section: [tube], material: [%s], sizes: {diameter: [40 mm, 50 mm, 60 mm], thickness: [3 mm]}}\n"
    for name, alike in (("materials", _one_metal), ("parts", _one_part)):
        text = f"minimize: max_error\nsubject_to: {{{name}: '<= 1', mass: '<= 2.2 kg'}}\n{choice % ', '.join(METALS)}"

        def best(alike: object = alike) -> float:
            arms = (arm for arm in combinations_of(tubes, METALS) if arm.mass <= 2.2)
            return min(worst(arm, _TWO_KG) for arm in arms if alike(arm))  # type: ignore[operator]

        yield Asked(f"`{name}`", Plane().text, text, best, "81 pairs of tubes and metals")


def _one_metal(arm: Chain) -> bool:
    return arm.links[0].metal == arm.links[1].metal


def _one_part(arm: Chain) -> bool:
    return _one_metal(arm) and arm.links[0].section == arm.links[1].section


def wall_steps() -> Asked:
    """The lightest tubes with walls as sold."""
    text = (
        "minimize: mass\nsubject_to: {max_error: '<= 0.7 mm', section_size: [10 mm, 150 mm], "
        "thickness: {steps: [2 mm, 3 mm, 5 mm]}, local_buckling: off}\nchoose: {section: [tube]}\n"
    )

    def mass(first: float, walls: tuple[float, float]) -> float:
        def off(second: float) -> float:
            return worst(chain([tube(first, walls[0]), tube(second, walls[1])], METALS[:1] * 2), _TWO_KG) - 0.7e-3

        if off(0.02) < 0.0 or off(0.15) > 0.0:
            return math.inf
        second = brentq(off, 0.02, 0.15, xtol=1e-7)
        return chain([tube(first, walls[0]), tube(second, walls[1])], METALS[:1] * 2).mass

    def best() -> float:
        least = math.inf
        for walls in itertools.product((2e-3, 3e-3, 5e-3), repeat=2):
            tried = np.linspace(0.03, 0.14, 45)
            masses = [mass(d, walls) for d in tried.tolist()]
            near = tried[int(np.argmin(masses))]
            finer = np.linspace(near - 0.0025, near + 0.0025, 21)
            least = min(least, *masses, *(mass(d, walls) for d in finer.tolist()))
        return least

    return Asked("`thickness: {steps}`", Plane().text, text, best, "nine pairs of walls, every diameter")


_POINTS = ((0.6, 0.2), (0.45, -0.35))


def points() -> Iterator[Asked]:
    """Points with limits and weights of their own."""
    near, far = (f"{{at: [{1e3 * x:g} mm, {1e3 * y:g} mm]" for x, y in _POINTS)
    space = f"workspace: {{points: [{near}, max_error: '<= 0.8 mm'}}, {far}, max_error: '<= 0.4 mm'}}]}}\n"

    def worst_share(d: float, name: str) -> float:
        arm = rods(d, name)
        reached = zip(poses_to(_POINTS), (0.8e-3, 0.4e-3), strict=True)
        return max(worst(arm, _TWO_KG, q) / most for q, most in reached)

    yield lightest_rods("`points` with `max_error`", "", worst_share, 1.0, text=space)
    weighted = f"workspace: {{points: [{near}, weight: 3}}, {far}}}]}}\n"

    def average(d: float, name: str) -> float:
        arm, squares = rods(d, name), 0.0
        for q, weight in zip(poses_to(_POINTS), (0.75, 0.25), strict=True):
            squares += weight * float(np.mean(np.linalg.norm(arm.moved(q, _TWO_KG).shift, axis=1) ** 2))
        return math.sqrt(squares)

    yield lightest_rods("`points` with `weight`", "average_error: '<= 0.5 mm'", average, 0.5e-3, text=weighted)


def base() -> Asked:
    """Where the base stands, with listed tubes."""
    places = ((0.35, 0.2), (0.6, 0.25), (0.5, -0.15))
    listed_points = ", ".join(f"[{1e3 * x:g} mm, {1e3 * y:g} mm]" for x, y in places)
    text = (
        f"minimize: max_error\nworkspace: {{points: [{listed_points}]}}\nsubject_to: {{mass: '<= 2.6 kg'}}\n"
        "choose: {base: {y: [-200 mm, 200 mm]}, section: [tube], "
        "sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}}\n"
    )
    sizes = [tube(d, 3e-3) for d in (0.04, 0.06, 0.08)]
    arms = [arm for arm in combinations_of(sizes, METALS[:1]) if arm.mass <= 2.6]

    def least(y: float) -> float:
        reached = poses_to(places, (0.0, y))
        if not all(len(q) for q in reached):
            return math.inf
        return min(worst(arm, _TWO_KG, np.vstack(reached)) for arm in arms)

    def best() -> float:
        tried = np.linspace(-0.2, 0.2, 201)
        near = tried[int(np.argmin([least(y) for y in tried.tolist()]))]
        return min(least(y) for y in np.clip(np.linspace(near - 2e-3, near + 2e-3, 101), -0.2, 0.2).tolist())

    return Asked("`choose.base`", Plane().text, text, best, "301 bases, nine tubes at each")


def uncertain() -> Iterator[Asked]:
    """What is not known exactly, at every corner of what may be."""

    def held(payload: float = 1.0, longer: float = 0.0, warmer: float = 0.0, turned: float = 0.0) -> object:
        def figure(d: float, name: str) -> float:
            force = (-60.0 * math.sin(turned), 60.0 * math.cos(turned), 0.0)
            most = 0.0
            for sides in itertools.product((-1.0, 1.0) if longer else (0.0,), repeat=2):
                arm = rods(d, name, warmer=warmer, longer=tuple(side * longer for side in sides))
                most = max(most, worst(arm, Load(2.0 * payload, force if turned else (0.0, 0.0, 0.0))))
            return most

        return figure

    def worst_turn(d: float, name: str) -> float:
        return max(held(turned=math.radians(angle))(d, name) for angle in np.linspace(-30.0, 30.0, 13) if angle)  # type: ignore[operator]

    text = "robust: worst\nuncertain: {%s}\n"
    limit = "max_error: '<= 0.8 mm'"
    plane = Plane(payload="mass: 2 kg, force: [0 N, 60 N, 0 N]").text
    yield lightest_rods("`uncertain: payload`", limit, held(payload=1.3), 0.8e-3, text=text % "payload: 30 %")
    cases = (
        "load_cases:\n  - {payload: {mass: 2 kg}, subject_to: {max_error: '<= 0.8 mm'}}\n  - {payload: {mass: 4 kg}}\n"
    )
    what = "`uncertain: payload`, `max_error` of a load case"
    yield lightest_rods(what, "", held(payload=1.3), 0.8e-3, text=cases + text % "payload: 30 %")
    yield lightest_rods("`uncertain: link_length`", limit, held(longer=2e-4), 0.8e-3, text=text % "link_length: 0.2 mm")
    yield lightest_rods("`uncertain: temperature`", limit, _warm, 0.8e-3, text=text % "temperature: 15 K")
    yield lightest_rods(
        "`uncertain: force_direction`", limit, worst_turn, 0.8e-3, plane, text % "force_direction: 30 deg"
    )


def _warm(d: float, name: str) -> float:
    return max(worst(rods(d, name, warmer=warmer), _TWO_KG) for warmer in (-15.0, 0.0, 15.0))


def moving_base() -> Asked:
    """A base that speeds up."""
    text = "load_cases: [{payload: {mass: 2 kg}, acceleration: [4 m/s^2, 2 m/s^2]}]\n"
    return lightest_rods(
        "`acceleration` of the base",
        "max_error: '<= 0.9 mm'",
        lambda d, name: worst(rods(d, name, gravity=(-4.0, -11.81, 0.0)), _TWO_KG),
        0.9e-3,
        text=text,
    )


def repeatability() -> Asked:
    """The lightest drives whose play is small enough."""
    names = ("CSG-14-100-2UH", "CSG-17-100-2UH", "CSG-20-100-2UH", "RV-6E")
    drives = load_actuators()
    text = (
        "minimize: total_mass\nsubject_to: {repeatability: '<= 0.13 mm', section_size: [50 mm, 50 mm]}\n"
        f"choose: {{actuator: [{', '.join(names)}]}}\n"
    )
    ranges = (f"[{low} deg, {high} deg]" for low, high in RANGES)
    rows = "".join(
        f"  - joint: {{range: {span}}}\n    link: {{length: {1e3 * length} mm, section: {{shape: circle, "
        f"diameter: 50 mm}}, material: {METALS[0]}}}\n"
        for span, length in zip(ranges, LENGTHS, strict=True)
    )
    arm = f"chain:\n{rows}payload: {{mass: 2 kg}}\nleave_out: [shear_deformation]\n"

    def best() -> float:
        masses: list[float] = []
        for pick in itertools.product(names, repeat=2):
            own = [drives.find(name) for name in pick]
            joints = tuple(
                Joint(compliance=1.0 / item.stiffness, mass=item.mass, backlash=item.backlash) for item in own
            )
            moved = replace(rods(0.05, METALS[0]), joints=joints)
            use = np.abs(moved.moved(POSES, _TWO_KG).torque).max(axis=0) / [item.rated_torque for item in own]
            if use.max() <= 1.0 and worst(moved, _TWO_KG, lost_alone=True) <= 0.13e-3:
                masses.append(moved.mass + sum(item.mass for item in own) + 2.0)
        return min(masses)

    return Asked("`repeatability`", arm, text, best, "16 pairs of drives")


def rated_torque() -> Asked:
    """The thickest rods that a drive holds."""
    text = f"minimize: max_error\nsubject_to: {{{RODS}}}\nchoose: {{section: [circle], same: [size]}}\n"

    def best() -> float:
        def use(d: float) -> float:
            return float(np.abs(rods(d, METALS[0]).moved(POSES, _TWO_KG).torque[:, 0]).max()) / 25.0

        most = brentq(lambda d: use(d) - 1.0, 0.012, 0.15)
        return min(worst(rods(d, METALS[0]), _TWO_KG) for d in np.linspace(0.5 * most, most, 200).tolist())

    return Asked("`rated_torque`", Plane(joint=", rated_torque: 25 N*m").text, text, best, "every diameter")


_TABLE, _POST = -0.17, ((0.64, -0.3), (0.9, 0.06))
_ABOVE = grid((20.0, 70.0), (-100.0, -60.0), each=81)


def _separation(q: Array, diameter: float) -> float:
    """The least gap (m) along x or y of discs across both rods from a table and a post, over 201 points of each."""
    share, least = np.linspace(0.0, 1.0, 201), math.inf
    one, both = q[:, 0], q[:, 0] + q[:, 1]
    first, second = (np.stack([np.cos(angle), np.sin(angle)], axis=1) for angle in (one, both))
    elbow = LENGTHS[0] * first
    parts = (
        elbow[:, None] * np.maximum(share, 0.1)[:, None],
        elbow[:, None] + LENGTHS[1] * second[:, None] * share[:, None],
    )
    for points_of, along in zip(parts, (first, second), strict=True):
        out = 0.5 * diameter * np.abs(along[:, ::-1])[:, None]
        table = points_of[..., 1] - out[..., 1] - _TABLE
        low, high = (np.array(corner) for corner in _POST)
        post = np.maximum(low - points_of - out, points_of - high - out).max(axis=2)
        least = min(least, float(table.min()), float(post.min()))
    return least


def separation() -> Asked:
    """Rods as thick as a table and a post leave room."""
    arm = Plane().text.replace("[-60.0 deg, 60.0 deg]", "[20 deg, 70 deg]")
    arm = arm.replace("[-120.0 deg, 120.0 deg]", "[-100 deg, -60 deg]").replace("stiffness: 60 kN*m/rad, ", "")
    text = (
        f"minimize: max_error\nsubject_to: {{separation: '>= 3 mm', {RODS}}}\n"
        "choose: {section: [circle], same: [size]}\n"
        "avoid: [{below: {y: -170 mm}}, {box: [[640 mm, -300 mm], [900 mm, 60 mm]]}]\n"
    )

    def best() -> float:
        most = brentq(lambda d: _separation(_ABOVE, d) - 3e-3, 0.01, 0.15)
        return worst(replace(rods(most, METALS[0]), joints=(Joint(mass=1.0),) * 2), _TWO_KG, _ABOVE)

    return Asked("`avoid` and `separation`", arm, text, best, "every diameter, 201 points of each rod")


def rows() -> list[Row]:
    """All of them."""
    singly = [largest_payload(), wall_steps(), base(), moving_base(), repeatability(), rated_torque(), separation()]
    return [asked.row() for asked in (*figures(), *singly, *listed(), *points(), *uncertain())]

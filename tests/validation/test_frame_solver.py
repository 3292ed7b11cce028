"""The frame solver against textbook closed forms, and the random chains against virtual work.

Roark: W. C. Young, R. G. Budynas, A. M. Sadegh, Roark's Formulas for Stress and Strain, 8th ed., McGraw-Hill
2012. Blevins: R. D. Blevins, Formulas for Natural Frequency and Mode Shape, Krieger 1979. Timoshenko: S.
Timoshenko, Strength of Materials, Part I, 3rd ed., Van Nostrand 1955.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.frame_solver import (
    Frame,
    Member,
    PointLoad,
    PointMass,
    Spring,
    Support,
    UnstableFrameError,
    frequencies,
    solve,
)
from tests.random_chains import (
    RandomChain,
    RandomLink,
    build_frame,
    places,
    random_planar_chain,
    random_spatial_chain,
    rotation_about,
    tip_motion,
)

EXACT = 1e-11  # relative: the members are exact, only rounding remains

LENGTH = 0.7
FORCE = 130.0
MOMENT = 45.0
LOAD = 210.0  # N/m

BEAM = Member(
    start=0,
    end=1,
    height_direction=(0, 1, 0),
    elastic_modulus=71e9,
    shear_modulus=26.7e9,
    area=1.2e-3,
    second_moment_height=1.6e-6,
    second_moment_width=0.5e-6,
    torsion_constant=0.9e-6,
    density=2700.0,
)
SHEAR_BEAM = replace(BEAM, shear_area_height=0.7e-3, shear_area_width=0.4e-3)

# Bending towards y is in the height plane of BEAM and turns about z; towards z it is in the width plane,
# about -y.
HEIGHT = {"direction": (0, 1, 0), "turn": (0, 0, 1), "second_moment": BEAM.second_moment_height}
WIDTH = {"direction": (0, 0, 1), "turn": (0, -1, 0), "second_moment": BEAM.second_moment_width}
both_planes = pytest.mark.parametrize("plane", [HEIGHT, WIDTH], ids=["height", "width"])


def cantilever(member: Member = BEAM, pieces: int = 1, **what) -> Frame:
    """A beam of LENGTH along x, clamped at the origin."""
    return Frame(
        nodes=[(LENGTH * k / pieces, 0, 0) for k in range(pieces + 1)],
        members=[replace(member, start=k, end=k + 1) for k in range(pieces)],
        supports=[Support(0)],
        **what,
    )


def tip_in_plane(frame: Frame, plane: dict) -> tuple[float, float]:
    """The last node's deflection and slope in a plane of bending; all its other motions must vanish."""
    tip = solve(frame)[-1]
    direction, turn = np.array(plane["direction"]), np.array(plane["turn"])
    deflection, slope = tip[:3] @ direction, tip[3:] @ turn
    np.testing.assert_allclose(tip[:3], deflection * direction, atol=1e-14)
    np.testing.assert_allclose(tip[3:], slope * turn, atol=1e-14)
    return deflection, slope


@both_planes
def test_cantilever_with_end_load(plane):
    """Roark table 8.1, case 1a with a = 0: F L^3/3EI and F L^2/2EI."""
    load = PointLoad(1, force=FORCE * np.array(plane["direction"]))
    rigidity = BEAM.elastic_modulus * plane["second_moment"]
    expected = FORCE * LENGTH**3 / (3 * rigidity), FORCE * LENGTH**2 / (2 * rigidity)
    assert tip_in_plane(cantilever(loads=[load]), plane) == pytest.approx(expected, rel=EXACT)


@both_planes
def test_cantilever_with_uniform_load(plane):
    """Roark table 8.1, case 2a with a = 0 and a uniform load: w L^4/8EI and w L^3/6EI."""
    member = replace(BEAM, distributed_load=LOAD * np.array(plane["direction"]))
    rigidity = BEAM.elastic_modulus * plane["second_moment"]
    expected = LOAD * LENGTH**4 / (8 * rigidity), LOAD * LENGTH**3 / (6 * rigidity)
    assert tip_in_plane(cantilever(member), plane) == pytest.approx(expected, rel=EXACT)


@both_planes
def test_cantilever_with_end_moment(plane):
    """Roark table 8.1, case 3a with a = 0: M L^2/2EI and M L/EI."""
    load = PointLoad(1, moment=MOMENT * np.array(plane["turn"]))
    rigidity = BEAM.elastic_modulus * plane["second_moment"]
    expected = MOMENT * LENGTH**2 / (2 * rigidity), MOMENT * LENGTH / rigidity
    assert tip_in_plane(cantilever(loads=[load]), plane) == pytest.approx(expected, rel=EXACT)


@both_planes
def test_own_weight_and_tip_mass_are_loads(plane):
    """Weight is a uniform load of rho A g and a mass a force m g (Roark table 8.1, cases 2a and 1a)."""
    mass, g = 3.1, 9.81
    frame = cantilever(masses=[PointMass(1, mass)], gravity=-g * np.array(plane["direction"]))
    weight = BEAM.density * BEAM.area * g
    rigidity = BEAM.elastic_modulus * plane["second_moment"]
    expected = -(weight * LENGTH**4 / 8 + mass * g * LENGTH**3 / 3) / rigidity
    assert tip_in_plane(frame, plane)[0] == pytest.approx(expected, rel=EXACT)


@both_planes
def test_shear_adds_to_the_cantilever_deflection_and_not_to_its_slope(plane):
    """Timoshenko, shear in bending: F L/(kappa G A) by an end load, w L^2/(2 kappa G A) by a uniform one.

    The slope is that of the section, which shear leaves alone; mixing it with that of the axis is the mistake
    to catch.
    """
    shear_area = SHEAR_BEAM.shear_area_height if plane is HEIGHT else SHEAR_BEAM.shear_area_width
    shear_rigidity = SHEAR_BEAM.shear_modulus * shear_area
    direction = np.array(plane["direction"])
    for load, member_load, addition in (
        (FORCE, 0.0, FORCE * LENGTH / shear_rigidity),
        (0.0, LOAD, LOAD * LENGTH**2 / (2 * shear_rigidity)),
    ):
        loads = [PointLoad(1, force=load * direction)]
        stiff, soft = (
            tip_in_plane(cantilever(replace(member, distributed_load=member_load * direction), loads=loads), plane)
            for member in (BEAM, SHEAR_BEAM)
        )
        assert soft[0] - stiff[0] == pytest.approx(addition, rel=1e-9)
        assert soft[1] == pytest.approx(stiff[1], rel=EXACT)


@both_planes
def test_beam_held_at_both_ends(plane):
    """Roark table 8.1, case 2d: w L^4/384EI at the middle, and w L^2/(8 kappa G A) more with shear.

    Statically indeterminate, so a wrong term of the stiffness shows that a cantilever would hide.
    """
    shear_area = SHEAR_BEAM.shear_area_height if plane is HEIGHT else SHEAR_BEAM.shear_area_width
    member = replace(SHEAR_BEAM, distributed_load=LOAD * np.array(plane["direction"]))
    middle = solve(replace(cantilever(member, pieces=2), supports=[Support(0), Support(2)]))[1]
    expected = LOAD * LENGTH**4 / (384 * BEAM.elastic_modulus * plane["second_moment"])
    expected += LOAD * LENGTH**2 / (8 * SHEAR_BEAM.shear_modulus * shear_area)
    assert middle[:3] @ np.array(plane["direction"]) == pytest.approx(expected, rel=EXACT)


def test_propped_cantilever():
    """Roark table 8.1, case 2c: the slope at the simply supported end is w L^3/48EI."""
    member = replace(BEAM, distributed_load=(0, -LOAD, 0))
    tip = solve(replace(cantilever(member), supports=[Support(0), Support(1, held=(1,))]))[1]
    expected = LOAD * LENGTH**3 / (48 * BEAM.elastic_modulus * BEAM.second_moment_height)
    assert tip[5] == pytest.approx(expected, rel=EXACT)
    assert tip[1] == 0.0


def test_axial_load_and_own_weight_along_the_axis():
    """F L/EA, and a hanging bar's own weight w L^2/2EA (Timoshenko, chapter I)."""
    load = PointLoad(1, force=(FORCE, 0, 0))
    frame = cantilever(replace(BEAM, distributed_load=(LOAD, 0, 0)), loads=[load])
    expected = (FORCE * LENGTH + LOAD * LENGTH**2 / 2) / (BEAM.elastic_modulus * BEAM.area)
    np.testing.assert_allclose(solve(frame)[1], [expected, 0, 0, 0, 0, 0], rtol=EXACT, atol=1e-20)


def test_torsion():
    """T L/GJ (Roark table 10.1)."""
    frame = cantilever(loads=[PointLoad(1, moment=(MOMENT, 0, 0))])
    expected = MOMENT * LENGTH / (BEAM.shear_modulus * BEAM.torsion_constant)
    np.testing.assert_allclose(solve(frame)[1], [0, 0, 0, expected, 0, 0], rtol=EXACT, atol=1e-20)


def bracket(first: float, second: float) -> Frame:
    """Two legs at a right angle in the x-y plane, loaded out of it at the free end."""
    return Frame(
        nodes=[(0, 0, 0), (first, 0, 0), (first, second, 0)],
        members=[
            replace(BEAM, height_direction=(0, 0, 1)),
            replace(BEAM, start=1, end=2, height_direction=(0, 0, 1)),
        ],
        supports=[Support(0)],
        loads=[PointLoad(2, force=(0, 0, FORCE))],
    )


def test_right_angle_bracket_loaded_out_of_its_plane():
    """F (a^3 + b^3)/3EI + F b^2 a/GJ, by Castigliano's theorem (Timoshenko, on strain energy).

    The first leg bends as a cantilever of its own and twists under F b; the second leg bends.
    """
    a, b = 0.5, 0.3
    bending = FORCE * (a**3 + b**3) / (3 * BEAM.elastic_modulus * BEAM.second_moment_height)
    twisting = FORCE * b**2 * a / (BEAM.shear_modulus * BEAM.torsion_constant)
    assert solve(bracket(a, b))[2, 2] == pytest.approx(bending + twisting, rel=EXACT)


def test_turning_the_whole_frame_turns_its_displacements():
    """No direction in space is special."""
    frame = bracket(0.5, 0.3)
    turn = rotation_about(np.array([2.0, -1.0, 2.0]) / 3, 1.1)
    turned = replace(
        frame,
        nodes=np.array(frame.nodes) @ turn.T,
        members=[replace(member, height_direction=turn @ member.height_direction) for member in frame.members],
        loads=[PointLoad(2, force=turn @ (0, 0, FORCE))],
    )
    expected = solve(frame)[2].reshape(2, 3) @ turn.T
    np.testing.assert_allclose(solve(turned)[2].reshape(2, 3), expected, rtol=1e-10, atol=1e-15)


def jointed_cantilever(spring: Spring, load: PointLoad) -> Frame:
    """A spring on the ground at the origin and BEAM beyond it, along x."""
    return Frame(
        nodes=[(0, 0, 0), (0, 0, 0), (LENGTH, 0, 0)],
        members=[replace(BEAM, start=1, end=2)],
        supports=[Support(0)],
        springs=[spring],
        loads=[load],
    )


def test_rotational_spring_adds_a_rigid_turn():
    """F L^2/k + F L^3/3EI (Roark table 8.1, case 1a on an elastic joint)."""
    stiffness = 8e4
    frame = jointed_cantilever(Spring(0, 1, (0, 0, 1), stiffness), PointLoad(2, force=(0, FORCE, 0)))
    expected = FORCE * LENGTH**2 / stiffness
    expected += FORCE * LENGTH**3 / (3 * BEAM.elastic_modulus * BEAM.second_moment_height)
    result = solve(frame)
    assert result[2, 1] == pytest.approx(expected, rel=EXACT)
    np.testing.assert_allclose(result[1], [0, 0, 0, 0, 0, FORCE * LENGTH / stiffness], rtol=EXACT, atol=1e-20)


def test_rotational_spring_about_an_oblique_axis():
    """Only the moment's component along the axis turns the joint, and it turns about that axis alone."""
    axis = np.array([1.0, 2.0, 2.0]) / 3
    stiffness = 8e4
    frame = jointed_cantilever(Spring(0, 1, 5.0 * axis, stiffness), PointLoad(2, force=(0, FORCE, 0)))
    joint = solve(frame)[1]
    expected = (FORCE * LENGTH * axis[2] / stiffness) * axis
    np.testing.assert_allclose(joint, np.concatenate([np.zeros(3), expected]), rtol=EXACT, atol=1e-20)


def test_spring_across_the_load_is_idle():
    """A drive about the link's own axis does not feel a force through it: the other motions are tied."""
    load = PointLoad(2, force=(0, FORCE, 0))
    loose = solve(jointed_cantilever(Spring(0, 1, (1, 0, 0), 1.0), load))
    tied = solve(jointed_cantilever(Spring(0, 1, (1, 0, 0), np.inf), load))
    np.testing.assert_allclose(loose, tied, rtol=EXACT, atol=1e-18)
    np.testing.assert_array_equal(tied[1], np.zeros(6))


def test_translational_spring():
    """A slide along x on a spring moves by F/k beside the rod's F L/EA, and holds all else."""
    stiffness = 3e5
    spring = Spring(0, 1, (1, 0, 0), stiffness, motion="translation")
    result = solve(jointed_cantilever(spring, PointLoad(2, force=(FORCE, FORCE, 0))))
    np.testing.assert_allclose(result[1], [FORCE / stiffness, 0, 0, 0, 0, 0], rtol=EXACT, atol=1e-20)
    expected = FORCE / stiffness + FORCE * LENGTH / (BEAM.elastic_modulus * BEAM.area)
    assert result[2, 0] == pytest.approx(expected, rel=EXACT)


def test_springs_in_a_row_at_one_point():
    """A universal joint: two springs at one point, each turning under the moment about its own axis."""
    frame = Frame(
        nodes=[(0, 0, 0), (0, 0, 0), (0, 0, 0), (LENGTH, 0, 0)],
        members=[replace(BEAM, start=2, end=3)],
        supports=[Support(0)],
        springs=[Spring(1, 2, (0, 1, 0), 7e4), Spring(0, 1, (0, 0, 1), 8e4)],
        loads=[PointLoad(3, force=(0, FORCE, FORCE))],
    )
    moment = FORCE * LENGTH
    np.testing.assert_allclose(solve(frame)[2], [0, 0, 0, 0, -moment / 7e4, moment / 8e4], rtol=EXACT, atol=1e-20)


def test_a_frame_that_can_move_freely_is_refused():
    """A pinned beam spins about its pin; an answer there would be noise."""
    load = PointLoad(1, force=(0, FORCE, 0))
    with pytest.raises(UnstableFrameError, match="nothing resists"):
        solve(replace(cantilever(loads=[load]), supports=[Support(0, held=(0, 1, 2, 3, 4))]))
    with pytest.raises(UnstableFrameError, match="nothing resists"):
        solve(jointed_cantilever(Spring(0, 1, (0, 0, 1), 0.0), PointLoad(2, force=(0, FORCE, 0))))


def first_frequency(second_moment: float) -> float:
    """Blevins table 8-1, clamped-free: 3.5160/(2 pi) sqrt(EI/(rho A L^4)), with more figures of the root."""
    inertia = BEAM.density * BEAM.area * LENGTH**4
    return 1.875104068711961**2 / (2 * np.pi) * np.sqrt(BEAM.elastic_modulus * second_moment / inertia)


def test_first_frequency_of_a_cantilever_converges_from_above():
    """A consistent mass gives an upper bound; its excess falls as the fourth power of the members' length."""
    exact = first_frequency(BEAM.second_moment_width)
    excess = [frequencies(cantilever(pieces=pieces), rotary_inertia=False)[0] / exact - 1 for pieces in (2, 4, 8, 16)]
    assert 0 < excess[0] < 5e-4
    assert 0 < excess[3] < 2e-7
    for coarse, fine in pairwise(excess):
        assert 14 < coarse / fine < 18


def test_frequencies_of_both_planes_and_of_torsion():
    """Each plane has its own first frequency, and torsion has sqrt(G J/(rho I_p))/4L (Blevins, chapter 8)."""
    result = frequencies(cantilever(pieces=24), rotary_inertia=False)
    polar = BEAM.second_moment_height + BEAM.second_moment_width
    torsional = np.sqrt(BEAM.shear_modulus * BEAM.torsion_constant / (BEAM.density * polar)) / (4 * LENGTH)
    for expected, tolerance in (
        (first_frequency(BEAM.second_moment_width), 1e-7),
        (first_frequency(BEAM.second_moment_height), 1e-7),
        (torsional, 2e-4),  # linear twist along a member: the error falls as its square, (pi/2/24)^2/24
    ):
        assert np.min(abs(result / expected - 1)) < tolerance


def test_frequency_with_a_tip_mass_on_a_light_beam():
    """sqrt(3EI/(L^3 (M + 33/140 m)))/2pi: Rayleigh's method with the static shape (Blevins, chapter 8)."""
    tip_mass = 40.0
    result = frequencies(cantilever(pieces=4, masses=[PointMass(4, tip_mass)]), rotary_inertia=False)[0]
    inertia = tip_mass + 33 / 140 * BEAM.density * BEAM.area * LENGTH
    stiffness = 3 * BEAM.elastic_modulus * BEAM.second_moment_width / LENGTH**3
    expected = np.sqrt(stiffness / inertia) / (2 * np.pi)
    assert result == pytest.approx(expected, rel=1e-5)
    assert result < expected  # an assumed shape gives an upper bound


def test_stocky_simply_supported_beam_with_shear_and_rotary_inertia():
    """The first root of the beam equation of S. Timoshenko, Phil. Mag. 41 (1921) 744, on simple supports.

    With k = pi/L: (rho^2 I/kG) w^4 - (rho A + rho I k^2 + rho A E I k^2/(kappa G A)) w^2 + E I k^4 = 0.
    """
    beam = SHEAR_BEAM
    second_moment, shear_rigidity = beam.second_moment_height, beam.shear_modulus * beam.shear_area_height
    wave = np.pi / LENGTH
    line, rotary = beam.density * beam.area, beam.density * second_moment
    bending = beam.elastic_modulus * second_moment
    squares = np.roots(
        [
            rotary * line / shear_rigidity,
            -(line + rotary * wave**2 + line * bending * wave**2 / shear_rigidity),
            bending * wave**4,
        ]
    )
    expected = np.sqrt(squares.min()) / (2 * np.pi)
    slender = wave**2 * np.sqrt(bending / line) / (2 * np.pi)
    assert expected < 0.97 * slender  # else this beam could not tell the theories apart

    def found(pieces: int) -> float:
        sides = [Support(node, held=(2, 3, 4)) for node in range(1, pieces)]  # bending in the height plane only
        ends = [Support(node, held=(0, 1, 2, 3, 4)) for node in (0, pieces)]
        return frequencies(replace(cantilever(beam, pieces=pieces), supports=[*sides, *ends]))[0]

    # The members' shapes leave out the shear of the inertia along them, so the error falls as the square.
    coarse, fine = found(12), found(24)
    assert expected < fine < coarse
    assert (4 * fine - coarse) / 3 == pytest.approx(expected, rel=1e-6)


def virtual_work_tip_motion(chain: RandomChain) -> np.ndarray:
    """The tip's six displacements by the unit-load method, another way than the frame's.

    The arm is statically determinate, so cutting it at a point gives the six section forces from all that
    lies beyond; the work of the real ones on those of a unit load, integrated along the arm, is the
    displacement. The integrands are of degree three at most in the position, so three Gauss points are exact.
    """
    stand = places(chain)
    gravity, force = np.array(chain.gravity), np.array(chain.tip_force)
    tip = stand[-1].end
    points, weights = np.polynomial.legendre.leggauss(3)

    def beyond(index: int, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and moment about `at` of all that lies beyond it, `at` being on link `index`."""
        parts = [(tip, force + chain.payload_mass * gravity)]
        for k in range(index, len(stand)):
            link, place = chain.links[k], stand[k]
            start = at if k == index else place.start
            mass = link.density * link.area * np.linalg.norm(place.end - start)
            parts.append(((start + place.end) / 2, mass * gravity))
            if k > index:
                parts.append((place.start, link.joint_mass * gravity))
        total = sum(part for _, part in parts)
        return total, sum(np.cross(where - at, part) for where, part in parts)

    def units(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and moment at `at` of unit forces and moments at the tip; rows are the six of them."""
        forces = np.vstack([np.eye(3), np.zeros((3, 3))])
        moments = np.vstack([np.cross(tip - at, np.eye(3)), np.eye(3)])
        return forces, moments

    motion = np.zeros(6)
    for index, (link, place) in enumerate(zip(chain.links, stand, strict=True)):
        axes = np.array([place.along, place.height, place.width])
        shear_modulus = link.shear_modulus
        force_flexibility = 1 / np.array(
            [
                link.elastic_modulus * link.area,
                shear_modulus * link.shear_area_height,
                shear_modulus * link.shear_area_width,
            ]
        )
        # A moment about the width axis bends in the plane of link and height.
        moment_flexibility = 1 / np.array(
            [
                shear_modulus * link.torsion_constant,
                link.elastic_modulus * link.second_moment_z,
                link.elastic_modulus * link.second_moment_y,
            ]
        )
        for xi, weight in zip((points + 1) / 2, weights / 2, strict=True):
            at = place.start + xi * (place.end - place.start)
            real_force, real_moment = (axes @ vector for vector in beyond(index, at))
            unit_forces, unit_moments = (rows @ axes.T for rows in units(at))
            density = unit_forces @ (force_flexibility * real_force)
            density += unit_moments @ (moment_flexibility * real_moment)
            motion += weight * link.length * density
        if link.joint_stiffness is not None:
            _, real_moment = beyond(index, place.start)
            _, unit_moments = units(place.start)
            turn = real_moment @ place.joint_axis / link.joint_stiffness
            motion += (unit_moments @ place.joint_axis) * turn
    return motion


@pytest.mark.parametrize("make", [random_planar_chain, random_spatial_chain])
@pytest.mark.parametrize("seed", range(20))
def test_random_chains_agree_with_virtual_work(make, seed):
    """Two methods that share nothing but the description of the arm."""
    chain = make(np.random.default_rng(seed))
    expected = virtual_work_tip_motion(chain)
    displacement, rotation = tip_motion(chain)
    np.testing.assert_allclose(displacement, expected[:3], rtol=0, atol=1e-9 * np.linalg.norm(expected[:3]))
    np.testing.assert_allclose(rotation, expected[3:], rtol=0, atol=1e-9 * np.linalg.norm(expected[3:]))


@pytest.mark.parametrize("seed", range(5))
def test_dividing_links_changes_nothing(seed):
    """The members are exact in statics, so the division of a link cannot matter."""
    chain = random_spatial_chain(np.random.default_rng(seed), links=3)
    whole, tip = build_frame(chain)
    divided, divided_tip = build_frame(chain, pieces=4)
    expected = solve(whole)[tip]
    np.testing.assert_allclose(solve(divided)[divided_tip], expected, rtol=0, atol=1e-9 * np.linalg.norm(expected[:3]))


@pytest.mark.parametrize("seed", range(5))
def test_planar_chains_stay_in_their_plane(seed):
    """Axes along z, loads in x-y: nothing leaves the plane, and something moves in it."""
    displacement, rotation = tip_motion(random_planar_chain(np.random.default_rng(seed)))
    assert abs(displacement[2]) < 1e-12 * np.linalg.norm(displacement[:2])
    assert np.linalg.norm(rotation[:2]) < 1e-12 * abs(rotation[2])


def test_the_generator_covers_the_special_cases():
    """A hundred spatial arms hold axes along the link, rigid and elastic joints, no payload, every count."""
    chains = [random_spatial_chain(np.random.default_rng(seed)) for seed in range(100)]
    links: list[RandomLink] = [link for chain in chains for link in chain.links]
    assert {len(chain.links) for chain in chains} == {1, 2, 3, 4, 5}
    assert any(abs(link.axis[0]) == 1 for link in links)
    assert {link.joint_stiffness is None for link in links} == {True, False}
    assert {chain.payload_mass == 0 for chain in chains} == {True, False}


def test_section_sides_follow_the_joint_axis():
    """A joint about y lifts its link along x towards -z: there the section's height lies, and I_y resists."""
    link = random_planar_chain(np.random.default_rng(0), links=1).links[0]
    link = replace(link, axis=(0.0, 1.0, 0.0), angle=0.0, joint_stiffness=None)
    chain = RandomChain((link,), gravity=(0.0, 0.0, 0.0), payload_mass=0.0, tip_force=(0.0, 0.0, FORCE))
    displacement, _ = tip_motion(chain, shear=False)
    expected = FORCE * link.length**3 / (3 * link.elastic_modulus * link.second_moment_y)
    np.testing.assert_allclose(displacement, [0, 0, expected], rtol=EXACT, atol=1e-18)
    np.testing.assert_allclose(places(chain)[0].height, [0, 0, -1], atol=1e-15)

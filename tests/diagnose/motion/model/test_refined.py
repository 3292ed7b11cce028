"""Numbers that a pattern is not linear in are found between and beyond the values that were tried, and what stands
beside them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.result import FittedParameter
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm

DRY, MORE = 1.5, 5.0
"""N*m of dry friction, and N*m more at no speed."""


def sizes_at_the_first_joint(
    folder: Path, torque: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> dict[tuple[str, str], FittedParameter]:
    """What is found, by effect and parameter, where the first joint takes a torque by its angle and speed more."""
    log = logged(
        2, lambda time: np.full(len(time), HAND), lambda q, v: np.array([torque(q[0], v[0]), np.zeros_like(v[1])])
    )
    return {
        (item.effect, size.parameter): size
        for item in diagnose_motion(plumb_arm(folder), [log]).findings
        for size in item.parameters
        if item.at == (1,)
    }


def holds(size: FittedParameter, true: float) -> bool:
    """Whether an interval holds the truth."""
    return size.interval[0] <= true <= size.interval[1]


@pytest.mark.parametrize("at", [0.14, 0.17])
def test_a_speed_between_two_that_were_tried_is_found(tmp_path: Path, at: float) -> None:
    """rad/s in which the friction falls to 37 %; 0.1 and 0.3 are tried."""
    sizes = sizes_at_the_first_joint(tmp_path, lambda _, v: (DRY + MORE * np.exp(-np.abs(v) / at)) * np.sign(v))
    speed, more = sizes["friction_stribeck", "speed"], sizes["friction_stribeck", "torque"]
    assert speed.value == pytest.approx(at, rel=0.05)
    assert speed.interval[1] / speed.interval[0] < 1.5
    assert holds(speed, at)
    assert holds(more, MORE)
    assert holds(sizes["friction_coulomb", "torque"], DRY)
    assert more.value == pytest.approx(MORE, rel=0.05)


def test_a_time_below_those_that_are_tried_is_found(tmp_path: Path) -> None:
    """s in which 63 % of the friction's growth is done; 12 is the least that names are sought with."""
    at = 6.0
    grown = 1.0 - np.exp(-np.arange(3000) / 100.0 / at)
    sizes = sizes_at_the_first_joint(tmp_path, lambda _, v: (DRY + MORE * grown) * np.sign(v))
    time, more = sizes["friction_warmup", "time"], sizes["friction_warmup", "torque"]
    assert time.value == pytest.approx(at, rel=0.1)
    assert time.interval[1] / time.interval[0] < 1.5
    assert holds(time, at)
    assert holds(more, MORE)
    assert holds(sizes["friction_coulomb", "torque"], DRY)


def test_a_time_that_a_log_is_too_short_for_may_be_any_longer_one(tmp_path: Path) -> None:
    """s; in 30 s friction grows by 1 N*m, nearly as straight as a line."""
    at, more = 1000.0, 1000.0 / 30.0
    grown = 1.0 - np.exp(-np.arange(3000) / 100.0 / at)
    sizes = sizes_at_the_first_joint(tmp_path, lambda _, v: (DRY + more * grown) * np.sign(v))
    assert holds(sizes["friction_warmup", "time"], at)
    assert holds(sizes["friction_warmup", "torque"], more)


def test_the_order_of_a_ripple_is_the_one_that_explains_it(tmp_path: Path) -> None:
    """Periods in a turn of a joint that swings by less than a turn, where the next order looks nearly like it."""
    order, sine, cosine = 3, -2.0, 3.0
    sizes = sizes_at_the_first_joint(tmp_path, lambda q, _: sine * np.sin(order * q) + cosine * np.cos(order * q))
    assert holds(sizes["gear_ripple", "order"], order)
    assert holds(sizes["gear_ripple", "sine"], sine)
    assert holds(sizes["gear_ripple", "cosine"], cosine)


def test_names_that_are_alike_widen_each_other(tmp_path: Path) -> None:
    """Friction and more of it one way: friction beside an offset says the same, with another size of friction."""
    dry, one_way = 1.0, 3.0
    sizes = sizes_at_the_first_joint(tmp_path, lambda _, v: dry * np.sign(v) + one_way * (v > 0.0))
    true = {"friction_coulomb": dry, "friction_asymmetry": one_way}
    named = {effect: size for (effect, parameter), size in sizes.items() if parameter == "torque"}
    assert "friction_coulomb" in named
    for effect in named.keys() & true.keys():
        assert holds(named[effect], true[effect])
    assert holds(named["friction_coulomb"], dry + 0.5 * one_way)


def test_a_clock_that_is_off_by_part_of_a_sample_leaves_a_rotor_in_its_interval(tmp_path: Path) -> None:
    """A file holds no clock: in it, 40 N*m s of viscous friction that is 4 ms late stand for 0.16 kg m2 less."""
    viscous, rotor, late = 40.0, 2.0, 4e-3

    def turned(_: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([viscous * v[0] + rotor * np.gradient(v[0], 0.01), np.zeros_like(v[1])])

    log = logged(2, lambda time: np.full(len(time), HAND), turned)
    torque = np.stack([np.interp(log.time - late, log.time, each) for each in log.torque.T], axis=1)
    found = diagnose_motion(plumb_arm(tmp_path), [replace(log, torque=torque)]).findings
    sizes = {item.effect: item.parameters[0] for item in found if item.at == (1,)}
    assert holds(sizes["friction_viscous"], viscous)
    assert holds(sizes["armature"], rotor)

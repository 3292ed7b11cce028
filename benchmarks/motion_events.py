"""Events in logs of six joints, simulated by MuJoCo: contacts, collisions, loads taken or left, rough friction alone.

python -m benchmarks.motion_events FIRST LAST [KIND ...]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np

import linkwright as lw
from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator import cases
from benchmarks.motion.generator.arms import STEP, draw_arm
from benchmarks.motion.generator.files import write_case
from benchmarks.motion.generator.logger import draw_logger, log_of
from benchmarks.motion.generator.signals import rms
from benchmarks.motion.generator.trajectories import draw_reference
from benchmarks.motion.generator.world import Law, State, declared_torque, simulate, world_of
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog

SECONDS = 30.0
CONTACT, COLLISION, TAKEN = (8.0, 10.5), (12.0, 12.15), 15.0


def pushed(link: int, force: Array, span: tuple[float, float]) -> Law:
    """A steady force (3,) N at the origin of the body beyond a link (from 1), at the tip for the last."""

    def act(state: State) -> None:
        body = state.data.model.body(f"link{link}").id
        on = span[0] <= state.time < span[1]
        last = body == state.last
        at = state.data.site_xpos[0] if last else state.data.xpos[state.data.model.body(f"link{link + 1}").id]
        moment = np.cross(at - state.data.xipos[body], force)
        state.data.xfrc_applied[body] = np.concatenate([force, moment]) * on

    return act


def carried(mass: float, since: float) -> Law:
    """A load at the tip from an instant on: a point mass, by its weight and by how the tip speeds up."""
    speeds: list[Array] = []

    def act(state: State) -> None:
        site, speed = state.data.site_xpos[0], np.zeros(6)
        mujoco.mj_objectVelocity(state.data.model, state.data, mujoco.mjtObj.mjOBJ_SITE, 0, speed, 0)
        speeds.append(speed[3:].copy())
        rising = (speeds[-1] - speeds[-2]) / STEP if len(speeds) > 1 else np.zeros(3)
        del speeds[:-2]
        force = mass * (np.array([0.0, 0.0, -9.81]) - rising) * (state.time >= since)
        moment = np.cross(site - state.data.xipos[state.last], force)
        state.data.xfrc_applied[state.last] = np.concatenate([force, moment])

    return act


def rough(seed: int, share: float) -> Law:
    """Friction that comes and goes by a share of what is declared, with a memory of half a second."""
    rng, kept = np.random.default_rng(seed), list[Array]()

    def act(state: State) -> None:
        if not kept:
            kept.append(np.zeros(len(state.loss)))
        (now,) = kept
        now += STEP / 0.5 * -now + np.sqrt(2.0 * STEP / 0.5) * rng.standard_normal(len(now))
        state.loss[:] = state.loss * np.maximum(1.0 + share * now, 0.0)

    return act


def logged(seed: int, law_of: Callable[[], Law] | None, family: str) -> tuple[Arm, MotionLog]:
    """An arm and a log of its motion with rough friction and a law beside."""
    rng = np.random.default_rng((seed, 49))
    arm = draw_arm(family, rng)
    reference = draw_reference(arm, SECONDS, rng)
    arm = cases._with_drives(arm, [reference.every(cases.COARSE)], rng)  # pyright: ignore[reportPrivateUsage]
    reference = replace(reference, arm=arm)
    scale = rms(reference.every(cases.COARSE).torque)
    world = world_of(arm)
    world.laws.append(lambda: rough(seed, 0.15))
    if law_of is not None:
        world.laws.append(law_of)
    track = simulate(world, arm, reference, declared_torque(arm, reference), 30.0)
    logger, bare = draw_logger(arm, rng), np.zeros(arm.count)
    log = log_of(logger, arm, track, scale, world.delay, rng)
    case = cases.Case(
        "events", (0, 0, seed), "development", "null", arm, logger, (log, log), (), None, 0.0, scale, bare, bare
    )
    with TemporaryDirectory() as folder:
        write_case(case, Path(folder))
        (at,) = Path(folder).glob("cases/events")
        model = lw.read_arm(at / "arm.yaml")
        return model.model, lw.read_log(at / "recording-1.csv", model, settings=at / "recording-1.yaml").found


def main() -> None:
    """Prints what each log is answered with."""
    force = np.array([25.0, -20.0, 30.0])
    kinds: dict[str, Callable[[], Law] | None] = {
        "clean": None,
        "contact at the tip": lambda: pushed(6, force, CONTACT),
        "contact at the elbow's link": lambda: pushed(3, 3.0 * force, CONTACT),
        "collision": lambda: pushed(6, 8.0 * force, COLLISION),
        "load taken": lambda: carried(1.5, TAKEN),
        "load left": lambda: carried(-1.5, TAKEN),
    }
    for seed in range(int(sys.argv[1]), int(sys.argv[2])):
        for name, law in kinds.items():
            if len(sys.argv) > 3 and name not in sys.argv[3:]:
                continue
            arm, log = logged(seed, law, "six_spherical_wrist")
            result = diagnose_motion(arm, [log])
            told = [
                (e.kind, e.links, e.joints, round(e.change.start.time, 2), e.change.end and round(e.change.end.time, 2),
                 [(p.name, round(p.value, 3), [round(x, 3) for x in p.interval]) for p in e.change.parameters[:1]])
                for e in result.events
            ]  # fmt: skip
            print(seed, name, result.verdict, told, [f.effect for f in result.findings], flush=True)


if __name__ == "__main__":
    main()

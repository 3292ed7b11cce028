"""Torques: motion logs of arms, each learned on some and judged on others, joint by joint.

All three are judged on the rows that `predict` counts, low-passed alike: the textbook is asked for the torque of the
same motion.
"""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd
import yaml

from benchmarks.real.data import NoDataError, data_folder
from benchmarks.real.public.sources import TIAGO_JOINTS, UR10E_CONSTANTS, UR10E_LEARNED, UR10E_MOTIONS
from benchmarks.real.public.where import public_folder
from benchmarks.real.table.row import Figures, Row
from benchmarks.real.textbook import torques
from benchmarks.real.textbook.chain import Array, from_urdf
from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.preparation import PreparedLog, prepare
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.quantities import InputError

FIRST = 0.6
"""The part of a single log that is learned on; the rest judges."""


@dataclass(frozen=True)
class Robot:
    """A robot's URDF with its joints and the link at its tip, its folder, and which logs are learned on and judge; one
    log alone is cut in two. `constants` N*m/A where currents are logged without settings."""

    name: str
    folder: Callable[[], Path]
    urdf: Callable[[], Path]
    joints: tuple[str, ...]
    tip: str
    learned: tuple[str, ...]
    judged: tuple[str, ...] = ()
    constants: tuple[float, ...] | None = None


def _public(name: str, file: str = "") -> Path:
    return public_folder(name) / file


def _shared(name: str) -> Path:
    folder = data_folder() / name
    if not folder.is_dir():
        raise NoDataError(f"{name} is not in {data_folder()}; docs/real-machines.md says where to get it")
    return folder


def _of_public(name: str) -> tuple[Callable[[], Path], Callable[[], Path]]:
    return partial(_public, name), partial(_public, name, "robot.urdf")


_UR10E = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
_PANDA = tuple(f"panda_joint{k}" for k in range(1, 8))
_AIRBOT = tuple(f"joint{k}" for k in range(1, 7))
_LWR = tuple(f"lwr_{k}_joint" for k in range(7))
_SINGLE = ("20_01_22-joint_2", "20_01_22-joint_4")
ROBOTS: Mapping[str, Robot] = MappingProxyType(
    {
        "ur10e": Robot(
            "UR10e",
            partial(_shared, "ur10e-motion"),
            partial(_public, "ur10e", "robot.urdf"),
            _UR10E,
            "tool0",
            UR10E_LEARNED,
            _SINGLE,
            UR10E_CONSTANTS,
        ),
        "ur10e-others": Robot("UR10e", *_of_public("ur10e"), _UR10E, "tool0", UR10E_LEARNED, UR10E_MOTIONS),
        "panda": Robot("Panda", *_of_public("panda"), _PANDA, "panda_link8", ("exciting",)),
        "panda-shared": Robot(
            "Panda (first 60 %)",
            partial(_shared, "panda-motion"),
            partial(_public, "panda", "robot.urdf"),
            _PANDA,
            "panda_link8",
            ("exciting_first_60_percent",),
        ),
        "tx40": Robot("TX40", *_of_public("tx40"), tuple(f"joint_{k}" for k in range(1, 7)), "tool0", ("exciting",)),
        "tiago": Robot("TIAGo", *_of_public("tiago"), TIAGO_JOINTS, "arm_tool_link", ("exciting",)),
        "airbot": Robot("AIRBOT", *_of_public("airbot"), _AIRBOT, "link6", ("chirp",), ("trapezoidal",)),
        "airbot-back": Robot("AIRBOT", *_of_public("airbot"), _AIRBOT, "link6", ("trapezoidal",), ("chirp",)),
        "lwr4": Robot("LWR4", *_of_public("lwr4"), _LWR, "lwr_7_link", ("exciting1", "exciting2"), ("exciting3",)),
    }
)


def imported(robot: Robot, folder: Path) -> Arm:
    """The robot's URDF as an arm file. Raises ValueError where it cannot be read."""
    path = folder / f"{robot.name}.yaml"
    words = ["import", str(robot.urdf()), "--tip", robot.tip, "--out", str(path)]
    with contextlib.redirect_stdout(io.StringIO()):
        status = outcome([*words, "--json", str(folder / "imported.json")])
    if status:
        raise ValueError(f"{robot.urdf()} cannot be imported")
    return read_arm(path)


def _logs(robot: Robot, arm: Arm, scratch: Path) -> tuple[dict[str, MotionLog], dict[str, MotionLog]]:
    """What is learned on, and what judges."""
    folder = robot.folder()
    settings = folder / "recording.yaml"
    if not settings.is_file():
        said: dict[str, object] = {"observes": "motion", "filter": {"cutoff": "8 Hz"}}
        if robot.constants:
            said["torque_constants"] = list(robot.constants)
        settings = scratch / "recording.yaml"
        settings.write_text(yaml.safe_dump(said), encoding="utf-8")
    files = {name: folder / f"{name}.csv" for name in (*robot.learned, *robot.judged)}
    if robot.judged:
        both = {name: read_log(path, arm, settings) for name, path in files.items()}
        return {name: both[name] for name in robot.learned}, {name: both[name] for name in robot.judged}
    table = pd.read_csv(files[robot.learned[0]])
    cut = int(FIRST * len(table))
    parts = {f"first {FIRST:.0%}": table.iloc[:cut], "the rest": table.iloc[cut:]}
    logs: list[MotionLog] = []
    for name, part in parts.items():
        path = scratch / f"{name}.csv"
        part.to_csv(path, index=False)
        logs.append(read_log(path, arm, settings))
    first, rest = parts
    return {first: logs[0]}, {rest: logs[1]}


def left_of(prepared: PreparedLog, torque: Callable[[Motion], Array]) -> Array:
    """(M, n) N*m that a model leaves of the samples kept, low-passed; nan where a joint does not move."""
    rest = np.full(prepared.moving.shape, np.nan)
    for part, numbers, within in prepared.pieces():
        rest[numbers] = prepared.filtered(prepared.measured[part] - torque(prepared.piece(part)))[within]
    return np.where(prepared.moving, rest, np.nan)


def _rms(parts: Sequence[Array]) -> Array:
    """(n,) of several logs' rows together; nan where a joint never moves."""
    rows = np.concatenate(parts)
    count = np.isfinite(rows).sum(axis=0)
    whole = np.nansum(rows**2, axis=0)
    return np.where(count > 0, np.sqrt(whole / np.maximum(count, 1)), np.nan)


def compared(robot: Robot) -> Iterator[Row]:
    """Rows of one robot, by joint: the logs that judge are taken together."""
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        arm = imported(robot, scratch)
        learned, judged = _logs(robot, arm, scratch)
        cutoff, file, said, promised = _ours(arm, list(learned.values()), scratch)
    chain = from_urdf(robot.urdf(), robot.joints)
    book = torques.identified(chain, [torques.Log(log.time, log.q, log.torque) for log in learned.values()], cutoff)
    models: list[Callable[[Motion], Array]] = [
        lambda motion: torques.nominal(chain).torque(motion.q, motion.velocity, motion.acceleration),
        lambda motion: book.torque(motion.q, motion.velocity, motion.acceleration),
        lambda motion: model_torque(_by(file, motion)),
    ]
    held, seen = (
        [_rms([left_of(prepare(file, log, rules=RULES), model) for log in logs.values()]) for model in models]
        for logs in (judged, learned)
    )
    slides = chain.slides
    for j in range(chain.size):
        if np.isnan(held[0][j]) or np.isnan(seen[0][j]):
            continue
        where = f"{' + '.join(judged)}, joint {j + 1}{' (N)' if slides[j] else ''}"
        yield Row(
            robot.name,
            " + ".join(learned),
            where,
            Figures(*(float(item[j]) for item in held)),
            Figures(*(float(item[j]) for item in seen)),
            said,
            file is not arm,
            promised[j],
        )


def _by(arm: Arm, motion: Motion) -> Motion:
    return replace(motion, arm=arm)


def _ours(arm: Arm, logs: Sequence[MotionLog], scratch: Path) -> tuple[float, Arm, str, list[float]]:
    """The low-pass (Hz), the written file, what was said, and what is promised by joint."""
    try:
        result = diagnose_motion(arm, logs)
        path = scratch / "written.yaml"
        write_arm(result.corrected, path)
        file = read_arm(path) if result.corrected.effects != arm.effects else arm
    except InputError as error:
        cutoff = prepare(arm, logs[0], rules=RULES).cutoff
        return cutoff, arm, f"refused: {error}", [float("nan")] * arm.size
    promised = [joint.after for joint in result.per_joint]
    return result.cutoff or 8.0, file, f"{result.verdict}, {len(result.findings)} names", promised


MACHINES: Mapping[str, Callable[[], Iterator[Row]]] = MappingProxyType(
    {name: partial(compared, robot) for name, robot in ROBOTS.items()}
)

"""Motion logs of real arms: python -m benchmarks.real.logs [--urdf FOLDER] [--out FOLDER]

A UR10e is learned on its exciting motions without a load and tried on motions of one joint at a time; with a load, the
payload is asked for. A Panda is learned on the first part of its motion and tried on the rest. Beside what the tool
leaves stand the figures to beat and what four parameters a joint leave (friction loss, damping, rotor inertia and a
factor of the torque, by least squares on the same logs with the masses of the URDF), which is what a user of
mujoco.sysid would tick. The URDF files, ur10e.urdf and panda.urdf, are looked for beside the logs, or in FOLDER.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import pandas as pd
import yaml

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import Rigid
from benchmarks.motion.generator.signals import CUTOFF, low_passed, moving, rms
from benchmarks.real.data import NoDataError, data_folder

RATE = 100.0
PAYLOAD = (2.5, 3.4)
"""kg at the UR10e's flange, within which the load of its logs is."""


@dataclass(frozen=True)
class Robot:
    """A robot's logs, which of them are learned on and which has a load (all others are tests), its torque constants
    (N*m/A; None: torques are logged) and the figures to beat, N*m by joint, with what they are of."""

    name: str
    folder: str
    tip: str
    learned: tuple[str, ...]
    loaded: str
    constants: tuple[float, ...] | None
    beat: tuple[str, tuple[float, ...]]


UR10E = Robot(
    "ur10e",
    "ur10e-motion",
    "tool0",
    ("20_02_19_14harm50sec", "20_02_05-20sec_12harm", "20_01_31-unload"),
    "20_01_31-load",
    (14.87, 13.26, 11.13, 10.62, 11.03, 11.47),
    ("six other motions", (1.74, 1.57, 0.71, 0.19, 0.24, 0.18)),
)
PANDA = Robot(
    "panda",
    "panda-motion",
    "panda_link8",
    ("first",),
    "",
    None,
    ("the last 40 %", (0.152, 0.177, 0.092, 0.120, 0.034, 0.028, 0.021)),
)


def asked(*words: str) -> Any:
    """What a command of the tool answers as JSON. Raises ValueError with its last line where it has no answer."""
    from linkwright.command_line import outcome  # the one touch of what is judged

    said = io.StringIO()
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
            status = outcome([*words, "--json", str(answer)])
        if status:
            raise ValueError((said.getvalue().strip().splitlines() or [f"exit status {status}"])[-1])
        return json.loads(answer.read_text(encoding="utf-8"))


def even(log: Path, constants: Sequence[float] | None) -> tuple[Array, Array]:
    """Coordinates and torques (N, n) at an even RATE; torque by `constants` where currents are logged."""
    table = pd.read_csv(log).drop_duplicates("t_s")
    time = np.arange(table.t_s.iloc[0], table.t_s.iloc[-1], 1.0 / RATE)
    q, torque = (
        np.stack([np.interp(time, table.t_s, table[name]) for name in table if name.startswith(start)], axis=1)
        for start in ("q", "current" if constants else "tau")
    )
    return q, torque * np.array(constants) if constants else torque


def rigid(urdf: Path) -> Rigid:
    """The URDF's bodies in MuJoCo, free of shapes."""
    root = ElementTree.parse(urdf).getroot()
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    return Rigid(mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode")))


def four(bodies: Rigid, logs: Sequence[Path], constants: Sequence[float] | None) -> list[tuple[Array, Array]]:
    """For each log (N, n, 5), filtered alike: sign, speed, acceleration, the URDF's torque, the measured one; and
    (N, n) where each joint moves."""
    results = []
    for log in logs:
        q, torque = even(log, constants)
        q = low_passed(q, RATE, 2.0 * CUTOFF)
        v = np.gradient(q, 1.0 / RATE, axis=0)
        a = np.gradient(v, 1.0 / RATE, axis=0)
        n, more = q.shape[1], bodies.model.nv - q.shape[1]
        model = bodies.torque(*(np.pad(item, ((0, 0), (0, more))) for item in (q, v, a)))[:, :n]
        columns = low_passed(np.stack([np.tanh(v / 0.01), v, a, model, torque], axis=2), RATE)
        results.append((columns, np.stack([moving(item, RATE) for item in v.T], axis=1)))
    return results


def four_leave(bodies: Rigid, robot: Robot, learned: Sequence[Path], tested: Sequence[Path]) -> tuple[Array, Array]:
    """(n,) twice, N*m: RMS that the URDF leaves of the tested logs, and that four fitted parameters a joint leave."""
    one, two = four(bodies, learned, robot.constants), four(bodies, tested, robot.constants)
    before, after = [], []
    for j in range(one[0][0].shape[1]):
        fit, other = (np.concatenate([c[good[:, j], j] for c, good in part]) for part in (one, two))
        sizes = np.linalg.lstsq(fit[:, :4], fit[:, 4], rcond=None)[0]
        moved = len(other) > 0
        before.append(float(rms(other[:, 4] - other[:, 3])) if moved else np.nan)
        after.append(float(rms(other[:, 4] - other[:, :4] @ sizes)) if moved else np.nan)
    return np.array(before), np.array(after)


def halves(log: Path, folder: Path) -> None:
    """The Panda's log as two files: what is learned on, and the rest."""
    table = pd.read_csv(log)
    cut = int(0.6 * len(table))
    table.iloc[:cut].to_csv(folder / "first.csv", index=False)
    table.iloc[cut:].to_csv(folder / "rest.csv", index=False)


def evaluate(robot: Robot, urdf: Path, logs: Path, out: Path) -> None:
    """Prints what is left of a robot's torques, before and after; what is named; and the payload where there is one."""
    settings = out / f"{robot.name}-recording.yaml"
    said: dict[str, Any] = {"observes": "motion", "filter": {"cutoff": f"{CUTOFF:g} Hz"}}
    if robot.constants:
        said["torque_constants"] = list(robot.constants)
    settings.write_text(yaml.safe_dump(said), encoding="utf-8")
    arm = out / f"{robot.name}.yaml"
    asked("import", str(urdf), "--tip", robot.tip, "--out", str(arm))
    learned = [logs / f"{name}.csv" for name in robot.learned]
    tested = [log for log in sorted(logs.glob("*.csv")) if log.stem not in (*robot.learned, robot.loaded)]
    how, folder = ("--recording-yaml", str(settings)), out / robot.name
    result = asked("diagnose", str(arm), *map(str, learned), *how, "--out", str(folder))
    corrected = str(folder / "arm.yaml") if (folder / "arm.yaml").exists() else str(arm)
    print(f"{robot.name}: {result['verdict']}; learned on {', '.join(robot.learned)}")
    for item in result["missing"]:
        other = ", ".join(str(alternative) for alternative in item.get("alternatives") or [])
        print(f"  {item['effect']} {item['at'] or ''} {_sizes(item)}{f' or {other}' if other else ''}")
    if result.get("unknown"):
        print(f"  unknown: {result['unknown']}")
    for key, title in (
        ("rms_before", "before"),
        ("rms_after", "after"),
        ("rms_after_held_out", "held out by the tool"),
    ):
        _row(title, [joint[key] for joint in result["per_joint"]])
    _row("noise floor", [joint["noise_floor"] for joint in result["per_joint"]])
    bodies = rigid(urdf)
    whole: list[Array] = []
    for test in tested:
        before, after = four_leave(bodies, robot, learned, [test])
        predicted = asked("predict", corrected, str(test), *how)
        written = np.array([joint["rms"] if joint["samples"] else np.nan for joint in predicted["per_joint"]])
        _rows(test.stem, (before, after, written))
        # A motion of a single joint says nothing of the others.
        whole += [] if np.isnan(written).any() else [np.stack((before, after, written))]
    if len(whole) > 1:
        _rows(f"{len(whole)} motions of all joints", rms(np.array(whole)))
    _row(f"to beat, of {robot.beat[0]}", robot.beat[1])
    if robot.loaded:
        _payload(corrected, logs / f"{robot.loaded}.csv", how)


def _payload(arm: str, log: Path, how: tuple[str, str]) -> None:
    """With the arm as learned without a load."""
    result = asked("diagnose", arm, str(log), *how)
    print(f"with a load: {result['verdict']}")
    for item in result["missing"]:
        print(f"  {item['effect']} {item['at'] or ''} {_sizes(item)}")
    masses = [
        m for e in result["missing"] if e["effect"] == "payload" for n, m in e["parameters"].items() if "mass" in n
    ]
    within = any(PAYLOAD[0] <= m["ci95"][0] and m["ci95"][1] <= PAYLOAD[1] for m in masses if m.get("ci95"))
    print(f"  payload within {PAYLOAD[0]} to {PAYLOAD[1]} kg with its interval: {'yes' if within else 'NO'}")


def _sizes(entry: Any) -> str:
    results = []
    for name, size in (entry.get("parameters") or {}).items():
        ends = " to ".join(f"{end:.3g}" for end in size.get("ci95") or [])
        results.append(f"{name} {size['value']:.3g} {size.get('unit') or ''} ({ends})")
    return ", ".join(results)


def _rows(name: str, left: Sequence[Array] | Array) -> None:
    """What the URDF, four parameters a joint and the corrected arm leave, by joint."""
    for title, values in zip((f"{name}: URDF", "  four parameters a joint", "  corrected arm"), left, strict=True):
        _row(title, values)


def _row(title: str, values: Sequence[float | None] | Array) -> None:
    shown = (" " * 8 if value is None or np.isnan(value) else f"{value:8.3f}" for value in values)
    print(f"  {title:34s}" + "".join(shown))


def main() -> int:
    """The robots whose logs and URDF are there; of the others the reason. 1 where the tool has no answer."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.real.logs")
    reader.add_argument("robots", nargs="*", choices=["ur10e", "panda", []], metavar="ROBOT", help="ur10e, panda")
    reader.add_argument("--urdf", type=Path, default=None, help="where ur10e.urdf and panda.urdf are")
    reader.add_argument("--out", type=Path, default=None, help="keeps the arms and reports")
    chosen = reader.parse_args()
    try:
        with tempfile.TemporaryDirectory() as scratch:
            out = chosen.out or Path(scratch)
            out.mkdir(parents=True, exist_ok=True)
            for robot in (UR10E, PANDA):
                if chosen.robots and robot.name not in chosen.robots:
                    continue
                logs = data_folder() / robot.folder
                urdf = (chosen.urdf or logs) / f"{robot.name}.urdf"
                if not urdf.is_file():
                    print(f"{robot.name}: skipped, {urdf} is not there (--urdf FOLDER); docs/real-machines.md")
                    continue
                if robot is PANDA:
                    halves(logs / "exciting_first_60_percent.csv", Path(scratch))
                    logs = Path(scratch)
                evaluate(robot, urdf, logs, out)
    except NoDataError as error:
        print(f"skipped: {error}")
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

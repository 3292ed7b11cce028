"""The repositories, and what of each becomes which column."""

from __future__ import annotations

import io
import json
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
import yaml
from numpy.typing import NDArray
from scipy.signal import decimate

from benchmarks.real.textbook.chain import from_urdf

Array = NDArray[np.float64]
LWR_DATA = "e6c077ea5c09bceb49840f49e83450bb5979029b"
"""The commit of kjyv/FloBaRoID before its logs became pointers to a file store."""
XL330_DATA = "af2260462471ff45ac18af159b1327ea51d8db15"
"""The commit of Rhoban/bam (branch xl330) that has logs and the parameters which its authors found by them."""
XL330_COUNTS = 885.0
"""Of the PWM, all of the supply."""
TX40_RATIOS = (32.0, 32.0, 45.0, -48.0, 45.0, 32.0)
"""Gears of the TX40, motor over joint (TX40_config.yaml)."""
TX40_STEP = 2e-4
TIAGO_FACTORS = (1.0, 13.6, 13.6, -8.7, -8.7, -336 * 0.0613, -336 * 0.0613, -336 * 0.0613)
"""N*m of a joint (N of the torso) per unit of effort: gear ratio times motor constant (identification.py)."""
TIAGO_ROWS = slice(921, 6791)
TIAGO_JOINTS = ("torso_lift_joint", *(f"arm_{k}_joint" for k in range(1, 8)))


class MissingSourceError(FileNotFoundError):
    """A repository or a file of it is not there."""


@dataclass(frozen=True)
class Source:
    """A repository (owner/name), its licence, and what writes its files into a folder."""

    repository: str
    licence: str
    convert: Callable[[Path, Path], None]


def _held(clone: Path, path: str, commit: str = "HEAD") -> bytes:
    """A file of a repository."""
    if not clone.exists():
        raise MissingSourceError(f"{clone} is not there; git clone it")
    asked = subprocess.run(["git", "-C", str(clone), "show", f"{commit}:{path}"], capture_output=True, check=False)
    if asked.returncode:
        raise MissingSourceError(f"{path} is not in {clone}")
    return asked.stdout


def _text(clone: Path, path: str) -> str:
    return _held(clone, path).decode("utf-8")


def _table(clone: Path, path: str, **how: Any) -> pd.DataFrame:
    return pd.read_csv(io.StringIO(_text(clone, path)), **how)


def _said(folder: Path, settings: Mapping[str, Any]) -> None:
    (folder / "recording.yaml").write_text(yaml.safe_dump(dict(settings), sort_keys=False), encoding="utf-8")


def _log(path: Path, time: Array, q: Array, torque: Array, slides: Sequence[int] = (), current: bool = False) -> None:
    """A motion log."""
    columns = {"t_s": time - time[0]}
    for k, values in enumerate(q.T, start=1):
        columns[f"q{k}_m" if k in slides else f"q{k}_rad"] = values
    for k, values in enumerate(torque.T, start=1):
        unit = "A" if current else "N" if k in slides else "Nm"
        columns[f"{'current' if current else 'tau'}{k}_{unit}"] = values
    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.7g")


def _fanuc(clone: Path, folder: Path) -> None:
    """36 poses with three reflectors: places in mm (9 columns), then angles in degrees of which the last six move. The
    third angle is counted from the horizontal, as FANUC does. Lengths: an R-2000iB/165F by its data sheet."""
    rows = np.loadtxt(io.StringIO(_text(clone, "N1N2N3Jval.csv")))
    angles = rows[:, 15:21].copy()
    angles[:, 2] += angles[:, 1]
    for k in range(3):
        table = pd.DataFrame(angles, columns=[f"q{i}_deg" for i in range(1, 7)])
        table[["x_mm", "y_mm", "z_mm"]] = rows[:, 3 * k : 3 * k + 3]
        table.to_csv(folder / f"reflector{k + 1}.csv", index=False)
    spans = [(-180, 180), (-75, 75), (-140, 230), (-360, 360), (-125, 125), (-360, 360)]
    entries = [
        {"joint": {"type": "revolute", "range": [f"{a} deg", f"{b} deg"]}, "link": {"rigid": True, "mass": "unknown"}}
        for a, b in spans
    ]
    offsets = [(0, 0, 0), (312, 0, 670), (0, 0, 1075), (1280, 0, 225), (0, 0, 0), (215, 0, 0), (0, 0, 0)]
    arm = {
        "name": "FANUC R-2000iB/165F",
        "gravity": ["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"],
        "chain": entries,
        "product_of_exponentials": {
            "axes": [[0, 0, 1], [0, 1, 0], [0, -1, 0], [-1, 0, 0], [0, -1, 0], [-1, 0, 0]],
            "offsets": [[f"{value} mm" for value in row] for row in offsets],
        },
    }
    (folder / "arm.yaml").write_text(yaml.safe_dump(arm, sort_keys=False), encoding="utf-8")
    _said(folder, {"frame": "free", "tool": "free"})


def _tx40(clone: Path, folder: Path) -> None:
    """Motor angles and currents at 5 kHz, here at 500 Hz: joint angles and torques by the gears, the wrist's coupling
    and the zeros of staubli_tx40_tools.py."""
    root = "examples/staubli_TX40"
    motor, current = (
        _table(clone, f"{root}/data/{name}.csv").to_numpy(dtype=float) for name in ("pos_read_data", "curr_data")
    )
    ratios = np.diag(TX40_RATIOS)
    turns, forces = ratios.copy(), ratios.copy()
    turns[5, 4] = forces[4, 5] = TX40_RATIOS[5]
    q = motor @ np.linalg.inv(turns).T + np.array([0.0, -np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0])
    q, torque = (decimate(item, 10, axis=0, ftype="fir") for item in (q, current @ forces.T))
    _log(folder / "exciting.csv", 10.0 * TX40_STEP * np.arange(len(q), dtype=float), q, torque)
    (folder / "robot.urdf").write_text(_text(clone, f"{root}/urdf/tx40_mdh_modified.urdf"), encoding="utf-8")
    _said(folder, {"observes": "motion"})


def _tiago(clone: Path, folder: Path) -> None:
    """Positions and efforts of the torso and seven joints. The torso's effort is beside the weight that it carries,
    which is added, as identification.py does."""
    root = "examples/tiago"
    read = {
        kind: _table(clone, f"{root}/data/identification/dynamic/tiago_{kind}.csv") for kind in ("position", "effort")
    }
    q, effort = (
        np.column_stack([read[kind][f"- {joint}_{kind}"] for joint in TIAGO_JOINTS]) for kind in ("position", "effort")
    )
    time = read["position"]["t"].to_numpy()
    rows = TIAGO_ROWS
    model = folder / "robot.urdf"
    model.write_text(_text(clone, f"{root}/urdf/tiago_48_schunk.urdf"), encoding="utf-8")
    torque = effort * TIAGO_FACTORS
    torque[:, 0] += 9.81 * from_urdf(model, TIAGO_JOINTS).mass.sum()
    _log(folder / "exciting.csv", time[rows], q[rows], torque[rows], slides=(1,))
    _said(folder, {"observes": "motion"})


def _airbot(clone: Path, folder: Path) -> None:
    """Angles and torques at 100 Hz: chirps of all joints, and trapezoidal moves."""
    root = "examples/airbot_play/data"
    for kind in ("chirp", "trapezoidal"):
        q, torque = (
            _table(clone, f"{root}/identification/{kind}_motion/identification_{what}_real.csv").to_numpy(dtype=float)
            for what in ("q", "tau")
        )
        count = min(len(q), len(torque))
        _log(folder / f"{kind}.csv", 0.01 * np.arange(count, dtype=float), q[:count, :6], torque[:count, :6])
    (folder / "robot.urdf").write_text(_text(clone, f"{root}/urdf/airbot_play_v3_0_gripper.urdf"), encoding="utf-8")
    _said(folder, {"observes": "motion"})


def _lwr4(clone: Path, folder: Path) -> None:
    """Three exciting motions at 200 Hz; torques 6 and 7 have changed places in all of them and are put back."""
    for k in (1, 2, 3):
        held = np.load(io.BytesIO(_held(clone, f"data/KUKA/HW/measurements_{k}.npz", LWR_DATA)), encoding="latin1")
        torque = held["torques"][:, [0, 1, 2, 3, 4, 6, 5]]
        time, at = np.unique(held["times"], return_index=True)
        _log(folder / f"exciting{k}.csv", time, held["positions"][at], torque[at])
    model = _text(clone, "model/kuka_lwr4.urdf")
    twice = '    <origin rpy="0 0 0" xyz="0 0 0"/>\n    <parent link="box"/>'  # a second origin of the base's joint
    (folder / "robot.urdf").write_text(model.replace(twice, '    <parent link="box"/>'), encoding="utf-8")
    _said(folder, {"observes": "motion"})


UR10E_MOTIONS = ("20_02_05-20sec_8harm", "20_02_06-20sec_10harm", "20_02_10-20sec_7harm", "20_02_12-40sec_12harm")
UR10E_LEARNED = ("20_02_19_14harm50sec", "20_02_05-20sec_12harm", "20_01_31-unload")
UR10E_CONSTANTS = (14.87, 13.26, 11.13, 10.62, 11.03, 11.47)


def _ur10e(clone: Path, folder: Path) -> None:
    """Time, angles, speeds and currents at 100 Hz: the first 19 columns of each table."""
    for name in (*UR10E_LEARNED, *UR10E_MOTIONS):
        rows = _table(clone, f"dataset_ur10e/identification_data/ur-{name}.csv", header=None).to_numpy(dtype=float)
        time, at = np.unique(rows[:, 0], return_index=True)
        _log(folder / f"{name}.csv", time, rows[at, 1:7], rows[at, 13:19], current=True)
    (folder / "robot.urdf").write_text(_text(clone, "URe/urdf/ur10e.urdf"), encoding="utf-8")
    _said(folder, {"observes": "motion", "torque_constants": list(UR10E_CONSTANTS), "filter": {"cutoff": "8 Hz"}})


def _panda(clone: Path, folder: Path) -> None:
    """Angles and joint torque sensors of the exciting motion at 1 kHz, here at 500 Hz: a number a line, seven a sample.
    The model is panda.urdf of Gepetto/example-robot-data, cloned beside it."""
    root = "matlab/data/Exciting_Traj/Trajectory_1/rbt_log/exciting_traj_"
    kinds = ("time", "positions", "torques")
    read = {kind: np.fromstring(_text(clone, f"{root}{kind}.txt"), sep="\n") for kind in kinds}
    count = min(len(read["time"]), len(read["positions"]) // 7, len(read["torques"]) // 7)
    time, at = np.unique(read["time"][:count], return_index=True)
    q, torque = (read[kind][: 7 * count].reshape(count, 7)[at] for kind in ("positions", "torques"))
    _log(folder / "exciting.csv", time[::2], q[::2], torque[::2])
    models = clone.parent / "example-robot-data"
    (folder / "robot.urdf").write_text(_text(models, "robots/panda_description/urdf/panda.urdf"), encoding="utf-8")
    _said(folder, {"observes": "motion", "filter": {"cutoff": "8 Hz"}})


def _xl330(clone: Path, folder: Path) -> None:
    """Sixteen motions of a pendulum on a Dynamixel XL330 at 190 Hz by four gains: angle, goal, PWM and supply, here as
    voltages, while the torque was on. Beside them what the authors of BAM found, of these logs and in all."""
    name = "bam/data.bak/raw/2026-01-15_10h{}.json"
    stamps = "28m10 28m17 28m24 28m32 28m42 28m49 28m57 29m04 29m14 29m21 29m29 29m37 29m47 29m54 30m02 30m10"
    logs = [json.loads(_held(clone, name.format(stamp), XL330_DATA)) for stamp in stamps.split()]
    for log in logs:
        rows = pd.DataFrame(log["entries"])
        rows = rows[rows["torque_enable"].astype(bool)]
        counts = rows["load"].astype(np.int64).astype(np.uint16).astype(np.int16)  # two bytes with a sign, read without
        columns = {
            "t_s": rows["timestamp"],
            "q1_rad": rows["position"],
            "dq1_radps": rows["speed"],
            "c1_rad": rows["goal_position"],
            "voltage1_V": counts / XL330_COUNTS * rows["input_volts"],
        }
        path = folder / f"{log['trajectory']}_{log['kp']}.csv"
        pd.DataFrame(columns).to_csv(path, index=False, float_format="%.7g")
    mass, length = logs[0]["mass"], f"{1e3 * logs[0]['length']:g} mm"
    link = {"length": length, "rigid": True, "mass": f"{mass} kg", "center_of_mass": length}
    arm = {
        "name": "pendulum on an XL330",
        "gravity": ["0 m/s^2", "-9.81 m/s^2", "0 m/s^2"],
        "chain": [{"joint": {"type": "revolute", "zero": "-90 deg"}, "link": link}],
    }
    (folder / "arm.yaml").write_text(yaml.safe_dump(arm, sort_keys=False), encoding="utf-8")
    published = {f"M{k}": json.loads(_held(clone, f"bam/params/xl330/m{k}.json")) for k in range(1, 7)}
    published["M1 of these logs"] = json.loads(_held(clone, "params/xl330/m1.json", XL330_DATA))
    (folder / "published.json").write_text(json.dumps(published, indent=1), encoding="utf-8")
    _said(folder, {"observes": "motion", "torque_constants": "free"})


SOURCES: Mapping[str, Source] = MappingProxyType(
    {
        "fanuc": Source("RABKKK/LaserTrackerPoseData4KinIdent", "none stated", _fanuc),
        "tx40": Source("thanhndv212/figaroh-examples", "Apache-2.0", _tx40),
        "tiago": Source("thanhndv212/figaroh-examples", "Apache-2.0", _tiago),
        "airbot": Source("liuyurong129/figaroh_kinova", "Apache-2.0", _airbot),
        "lwr4": Source("kjyv/FloBaRoID", "LGPL-3.0", _lwr4),
        "ur10e": Source("shamilmamedov/dynamic_calibration", "none stated", _ur10e),
        "xl330": Source("Rhoban/bam", "Apache-2.0", _xl330),
        "panda": Source("marcocognetti/FrankaEmikaPandaDynModel", "GPL-3.0", _panda),
    }
)

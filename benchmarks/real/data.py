"""Where the recordings of real machines are, and how they are read.

The project holds none of them: docs/real-machines.md says where to get them.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "real"
VARIABLE = "LINKWRIGHT_DATA"

MOTOMAN, UR10, SERVO, PRINTER, IRB120 = "motoman-ma2010", "ur10", "sts3215-backlash", "voron-thermal", "irb120-faro"
IIWA7 = "iiwa7-payloads"
"""Folders of the recordings."""
_ARMS = {SERVO: "sts3215", PRINTER: "voron", IRB120: "irb120", IIWA7: "iiwa7"}


class NoDataError(FileNotFoundError):
    """The recordings are not there."""


def data_folder() -> Path:
    """The folder named in LINKWRIGHT_DATA, else ../shared/data from the project's root. Raises `NoDataError`."""
    named = os.environ.get(VARIABLE)
    folder = Path(named) if named else ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        where = f"{VARIABLE}={named}" if named else f"{folder.name} beside the project; set {VARIABLE}"
        raise NoDataError(f"the recordings of real machines are not there ({where}); docs/real-machines.md")
    return folder


def recording_file(machine: str, name: str) -> Path:
    """A recording's file. Raises `NoDataError`."""
    path = data_folder() / machine / name
    if not path.is_file():
        raise NoDataError(f"{machine}/{name} is not in {data_folder()}; docs/real-machines.md says where to get it")
    return path


def nominal(machine: str) -> Arm:
    """The machine's arm file."""
    return read_arm(EXAMPLES / _ARMS.get(machine, machine) / "arm.yaml")


def mapping(machine: str, name: str = "recording") -> Path:
    """The machine's recording.yaml, or another mapping of it."""
    return EXAMPLES / _ARMS.get(machine, machine) / f"{name}.yaml"


def read(machine: str, path: Path, how: str = "recording") -> Recording:
    """A recording of a machine, read with one of its mappings."""
    return read_recording(path, nominal(machine), mapping(machine, how))


def joined(machine: str, paths: list[Path], folder: Path) -> tuple[Recording, np.ndarray]:
    """Recordings in one instrument's frame as one, in the order given, and which file each reading is from."""
    tables = [pd.read_csv(path) for path in paths]
    common = [name for name in tables[0].columns if all(name in table.columns for table in tables)]
    whole = folder / "joined.csv"
    pd.concat([table[common] for table in tables]).to_csv(whole, index=False)
    recording = read(machine, whole)
    ends = np.cumsum([len(table) for table in tables])
    return recording, np.searchsorted(ends, recording.row - 1, side="left")  # row 1 is the header

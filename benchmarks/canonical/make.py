"""Draws the recordings: from both generators by fixed seeds, cells of seven poses, and small inputs of known truth."""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.canonical import cells
from benchmarks.motion.generator.cases import kind_of as motion_kind
from benchmarks.motion.generator.cases import make_case as motion_case
from benchmarks.motion.generator.files import write_case as write_motion
from benchmarks.multibody.cases import kind_of as tips_kind
from benchmarks.multibody.cases import make_case as tips_case
from benchmarks.multibody.files import write_case as write_tips

SEED = 4502
TIPS, CELLED, TORQUES = 22, len(cells.KINDS), 20
SECONDS = 15.0
"""Of a motion log that is kept."""
EARLY = (1980, 1, 1, 0, 0, 0)

Files = dict[str, str]


def of_generators() -> Iterator[tuple[str, Files, dict[str, Any]]]:
    """Name, files and truth of each case of both generators; of a motion, the first log alone."""
    for index in range(TIPS):
        with tempfile.TemporaryDirectory() as folder:
            kind, number = tips_kind(index)
            name = f"tips-{index:02d}-{kind}"
            write_tips(tips_case(name, (SEED, 0, index), "development", kind, number), Path(folder))
            yield name, _files(Path(folder) / "cases" / name), _truth(Path(folder), name)
    for kind in cells.KINDS:
        with tempfile.TemporaryDirectory() as folder:
            table = cells.recording(kind, SEED, Path(folder))
            files = {
                "arm.yaml": cells.arm_text(),
                "recording.csv": table.to_csv(index=False),
                "recording.yaml": "frame: free\ntool: free\n",
            }
            yield f"tips-{kind}", files, cells.truth_of(kind)
    for index in range(TORQUES):
        with tempfile.TemporaryDirectory() as folder:
            kind, family = motion_kind(index)
            name = f"torques-{index:02d}-{kind}"
            write_motion(motion_case(name, (SEED, 0, index), "development", kind, family), Path(folder))
            files = _files(Path(folder) / "cases" / name)
            yield name, _shortened(files), _truth(Path(folder), name)


def _files(folder: Path) -> Files:
    return {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.iterdir()) if path.is_file()}


def _truth(root: Path, name: str) -> dict[str, Any]:
    return json.loads((root / "truth" / f"{name}.json").read_text(encoding="utf-8"))


def _shortened(files: Files) -> Files:
    """The first log of a motion, its first part, at 100 Hz at most."""
    table = pd.read_csv(io.StringIO(files["recording-1.csv"]))
    table = table[table["t_s"] <= SECONDS]
    every = max(1, round(len(table) / SECONDS / 100.0))
    return {
        "arm.yaml": files["arm.yaml"],
        "recording.csv": table.iloc[::every].to_csv(index=False, float_format="%.6g"),
        "recording.yaml": files["recording-1.yaml"],
    }


def of_field(field: Path) -> Iterator[tuple[str, Files, dict[str, Any]]]:
    """Name, files and truth of the small inputs that were made after public reports."""
    for name, (world, folder, recording, every, truth) in FIELD.items():
        table = pd.read_csv(field / folder / recording)
        if world == "tips" and every > 1:
            table = table[(table.index // 7) % every == 0]
        files = {
            "arm.yaml": (field / folder / "arm.yaml").read_text(encoding="utf-8"),
            "recording.csv": table.to_csv(index=False, float_format="%.6g" if world == "torques" else None),
        }
        settings = [path for path in ("recording.yaml", "log.yaml", "plain.yaml") if (field / folder / path).is_file()]
        if settings and settings[0] != "plain.yaml":
            files["recording.yaml"] = (field / folder / settings[0]).read_text(encoding="utf-8")
        yield f"{world}-{name}", files, truth


_SMALL_OF_GRID = tuple(
    (effect, [joint])
    for effect in ("encoder_offset", "clearance", "backlash", "gear_transmission_error")
    for joint in range(1, 7)
)
"""Zeros, play and orders of gears, whose joints are not told."""


def _named(
    *effects: tuple[str, list[int], dict[str, float]],
    kind: str = "many",
    small: Iterable[tuple[str, list[int]]] = (),
) -> dict[str, Any]:
    """Large causes with sizes, and small ones."""
    listed = [
        {
            "effect": effect,
            "at": at,
            "large": True,
            "parameters": {name: {"value": value, "unit": ""} for name, value in sizes.items()},
        }
        for effect, at, sizes in effects
    ]
    listed += [{"effect": effect, "at": at, "large": False, "parameters": {}} for effect, at in small]
    return {"kind": kind, "effects": listed, "unknown": None}


def _refused(*words: str) -> dict[str, Any]:
    """What the columns say is off so far that they are refused, with the line to write."""
    return {"kind": "swapped", "effects": [], "unknown": None, "line": list(words)}


def _unknown(joints: list[int], depends: list[str]) -> dict[str, Any]:
    said = {"class": "field", "joints": joints, "depends_on": depends}
    return {"kind": "unknown", "effects": [], "unknown": said}


_FRICTION = tuple(
    (effect, [joint], {f"{size}_{joint}": value})
    for effect, size, values in (
        ("friction_coulomb", "torque", (3.0, 4.0, 2.0)),
        ("friction_viscous", "coefficient", (4.0, 5.0, 2.0)),
        ("armature", "inertia", (0.5, 0.6, 0.2)),
    )
    for joint, value in enumerate(values, start=1)
)
_SWAPPED: dict[str, Any] = {"kind": "swapped", "effects": [], "unknown": None}
FIELD: dict[str, tuple[str, str, str, int, dict[str, Any]]] = {
    "welding-robot-grid": (
        "tips",
        "welding-robot-grid",
        "grid_day1.csv",
        8,
        _named(
            *(("joint_compliance", [joint], {}) for joint in (2, 3)),
            ("base_compliance", [], {}),
            small=[("axis_misalignment", [3]), *_SMALL_OF_GRID],
        ),
    ),
    "scara-steps-per-degree": (
        "tips",
        "scara-steps-per-degree",
        "recording.csv",
        1,
        _refused("q1_deg: 1.36", "q2_deg: 0.947"),
    ),
    "soft-loop-commands": (
        "tips",
        "soft-loop-commands",
        "recording.csv",
        1,
        _refused("stiffness: 20.0"),
    ),
    "bare-in-phase": ("torques", "bare_in_phase_chirp", "log.csv", 1, _named(*_FRICTION, kind="bare")),
    "bump-of-torque": ("torques", "bump_2", "log.csv", 1, _named(("torque_curve", [2], {}), kind="one")),
    "elastic-drive": (
        "torques",
        "elastic_soft_2",
        "log.csv",
        1,
        _named(("joint_compliance", [2], {"compliance_2": 1.0 / 600.0}), kind="one"),
    ),
    "payload-half-way": (
        "torques",
        "payload_half_way",
        "log.csv",
        1,
        _named(("payload", [], {"mass": 1.2}), kind="one"),
    ),
    "clipped-torques": (
        "torques",
        "sensor_saturated",
        "log.csv",
        1,
        _named(("friction_coulomb", [2], {"torque_2": 1.8}), kind="one"),
    ),
    "swapped-columns": ("torques", "swapped_2_3", "log.csv", 1, _SWAPPED),
    "gear-by-direction": (
        "torques",
        "gear-efficiency-by-direction",
        "recording.csv",
        1,
        _named(("friction_load", [1], {}), ("friction_load", [2], {})),
    ),
    "stribeck-under-load": (
        "torques",
        "stribeck-under-load",
        "recording.csv",
        1,
        _named(
            ("friction_coulomb", [1], {"torque_1": 0.65}),
            ("friction_coulomb", [2], {"torque_2": 0.4}),
            ("friction_load_stribeck", [1], {"share_1": 0.25, "speed_1": 0.1}),
        ),
    ),
    "loaded-log": ("torques", "two-logs-one-loaded", "load.csv", 1, _named(("payload", [], {"mass": 1.2}), kind="one")),
    "unloaded-log": ("torques", "two-logs-one-loaded", "free.csv", 1, {"kind": "null", "effects": [], "unknown": None}),
}


def drawn(archive: Path, field: Path | None) -> dict[str, dict[str, Any]]:
    """All recordings in one archive, the same bytes of the same texts, and their truths by name. Without `field` the
    small inputs are those that the archive holds."""
    held = _held(archive) if field is None else dict[str, Files]()
    kept = ((name, files, FIELD[name.split("-", 1)[1]][-1]) for name, files in held.items())
    small = kept if field is None else of_field(field)
    return stored([*of_generators(), *small], archive)


def _held(archive: Path) -> dict[str, Files]:
    """The small inputs that an archive holds."""
    results: dict[str, Files] = {}
    with zipfile.ZipFile(archive) as whole:
        for path in whole.namelist():
            name, _, file = path.partition("/")
            if name.split("-", 1)[1] in FIELD:
                results.setdefault(name, {})[file] = whole.read(path).decode("utf-8")
    return results


def stored(cases: Iterable[tuple[str, Files, dict[str, Any]]], archive: Path) -> dict[str, dict[str, Any]]:
    """Puts cases into an archive; returns their truths."""
    known: dict[str, dict[str, Any]] = {}
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_LZMA) as into:
        for name, files, truth in cases:
            known[name] = truth
            for file, text in files.items():
                into.writestr(zipfile.ZipInfo(f"{name}/{file}", EARLY), text, zipfile.ZIP_LZMA)
    return known

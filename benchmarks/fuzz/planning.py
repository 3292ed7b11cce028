"""Files that planning and measuring read: sheets, plans, dated series, recordings of instruments."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.plan.written import read_plan
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.face.planning.budget import sheet_of
from linkwright.face.planning.watch import read_dated

from .kind import EXAMPLES, Kind, example

DATED = ("date: 2026-01-{:02}\nsigma: 15 um\n", "date: 2026-02-{:02}\nunit: serial 7\nframe: free\n")
PLAN = """\
q1_deg,q2_deg,q3_deg,dir1,dir2,dir3,payload_kg,time_s,x_mm,y_mm
10,20,30,1,1,-1,0,0,,
10,20,30,-1,1,1,5,2,,
-40,35,0,0,1,1,5,4,,
"""
SHEET = """\
share: 90 %
repeatability: 0.1 mm
temperature: 10 K
tolerances: [{effect: link_length, length: 0.3 mm, at: [1, 2]}]
better: [{part: own, at: 2, joint: {stiffness: 90 kN*m/rad}, price: [800 EUR, 900 EUR]}]
"""
INSTRUMENTS: dict[str, dict[str, Any]] = {
    "along": {"observe": "along", "direction": (0.0, 1.0, 0.0)},
    "distance": {"observe": "distance", "anchor": ("1 m", "0 m", "0 m")},
    "same_point": {"observe": "same_point"},
    "plane": {"observe": "plane"},
    "tilt": {"observe": "tilt", "tilt_link": 2},
    "bar": {"observe": "bar", "bar": ("0 mm", "500 mm"), "poses": 12},
    "camera": {"observe": "camera", "camera": "fixed"},
    "on_tool": {"observe": "camera", "camera": "on_tool"},
}


def planning_kinds(drives: Arm) -> dict[str, Kind]:
    """Kinds by name, with an arm that has drives."""
    hobby = lw.read_arm(EXAMPLES / "hobby-arm/arm.yaml")
    rows = example("hidden-backlash/recording.csv").splitlines()[:12]
    series = {f"week-{k}.csv": "\n".join([rows[0], *rows[1 + k :]]) + "\n" for k in range(3)}
    dated = {f"week-{k}.yaml": tuple(text.format(5 + 7 * k) for text in DATED) for k in range(3)}
    own = lw.Arm.of(drives)
    recordings, settings = _of_instruments()
    space = lw.read_arm(EXAMPLES / "real/ur10/arm.yaml").model
    return {
        "sheet": Kind(
            {"sheet.yaml": (example("hobby-arm/sheet.yaml"), SHEET)}, lambda at: sheet_of(hobby, at / "sheet.yaml"), {}
        ),
        "watch": Kind(dated, lambda at: read_dated([at / name for name in series], own), series),
        "plan": Kind({"plan.csv": (PLAN,)}, lambda at: read_plan(at / "plan.csv", drives), {}),
        "instruments": Kind(
            {"r.csv": recordings, "r.yaml": settings}, lambda at: read_recording(at / "r.csv", space), {}
        ),
    }


def _of_instruments() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """A recording of each instrument and its settings."""
    recordings: list[str] = []
    settings: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, asked in INSTRUMENTS.items():
            file = Path(folder) / f"{name}.csv"
            lw.simulate(EXAMPLES / "real/ur10/arm.yaml", **{"poses": 3, "repeats": 1, **asked}).save(file)
            recordings.append("".join(file.read_text(encoding="utf-8").splitlines(keepends=True)[:14]))
            settings.append(file.with_suffix(".yaml").read_text(encoding="utf-8"))
    return tuple(recordings), tuple(settings)

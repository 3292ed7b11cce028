"""Which instrument shows which effect: sound recordings of one arm, and the smallest sizes that each would have shown.

    python -m benchmarks.instruments [--page docs/recordings.md]

prints a table, and writes it into a page in place of the one there: for each effect and instrument the least size that
is found nine times in ten, `-` where the instrument, with what is free beside it, cannot show the effect at all.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.instruments.page import table, write_table
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.instruments.instrument import KINDS, Instrument
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.simulate import Plan, simulate
from linkwright.core.units.quantities import format_quantity

ARM = """
name: arm of six joints
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {range: [-150 deg, 150 deg], axis: [0, 0, 1]}
    origin: {xyz: [0 mm, 0 mm, 350 mm], rpy: [0 deg, 0 deg, 0 deg]}
    link: {length: 100 mm, rigid: true, mass: 20 kg}
  - joint: {range: [-100 deg, 10 deg], axis: [0, 1, 0]}
    link: {length: 700 mm, rigid: true, mass: 15 kg}
  - joint: {range: [-20 deg, 120 deg], axis: [0, 1, 0]}
    link: {length: 300 mm, rigid: true, mass: 8 kg}
  - joint: {range: [-170 deg, 170 deg], axis: [1, 0, 0]}
    link: {length: 350 mm, rigid: true, mass: 5 kg}
  - joint: {range: [-110 deg, 110 deg], axis: [0, 1, 0]}
    link: {length: 80 mm, rigid: true, mass: 2 kg}
  - joint: {range: [-170 deg, 170 deg], axis: [1, 0, 0]}
    origin: {xyz: [0 mm, 0 mm, 90 mm], rpy: [0 deg, 0 deg, 0 deg]}
    link: {length: 60 mm, rigid: true, mass: 1 kg}
payload: {mass: 0 kg}
"""
NOISE = 20e-6
PLAN = Plan(poses=60, repeats=2, payloads=(0.0, 10.0), sides="random", noise=NOISE)
INSTRUMENTS = {
    "tracker, frame free": replace(PLAN, free_frame=True),
    "camera above: x, y": replace(PLAN, slots=(0, 1)),
    "height gauge: z": replace(
        PLAN, slots=KINDS["along"], instrument=Instrument(("along",), direction=(0.0, 0.0, 1.0))
    ),
    "wire, known anchor": replace(
        PLAN, slots=KINDS["distance"], instrument=Instrument(("distance",), anchor=(1.2, -0.8, 0.2))
    ),
    "ballbar, free anchor": replace(
        PLAN, slots=KINDS["distance"], instrument=Instrument(("distance",), anchor=(1.2, -0.8, 0.2)), anchor_free=True
    ),
    "sockets": replace(PLAN, slots=KINDS["same_point"], instrument=Instrument(("same_point",))),
    "plates": replace(PLAN, slots=KINDS["plane"], instrument=Instrument(("plane",))),
    "bar of 0.5 m": replace(PLAN, slots=KINDS["bar"], instrument=Instrument(("bar",)), bar=(0.0, 0.5)),
    "level on link 3": replace(PLAN, slots=KINDS["tilt"], instrument=Instrument(("tilt",), tilt_link=3)),
    "camera, target on the tool": replace(PLAN, slots=KINDS["camera"], instrument=Instrument(("camera",))),
    "camera on the tool": replace(PLAN, slots=KINDS["camera"], instrument=Instrument(("camera",), camera="on_tool")),
}
EFFECTS = (
    ("zero of joint 1", "encoder_offset", (1,)),
    ("zero of joint 2", "encoder_offset", (2,)),
    ("zero of joint 3", "encoder_offset", (3,)),
    ("zero of joint 5", "encoder_offset", (5,)),
    ("length of link 2", "link_length", (2,)),
    ("compliance of drive 2", "joint_compliance", (2,)),
    ("compliance of drive 5", "joint_compliance", (5,)),
    ("backlash of joint 1", "backlash", (1,)),
    ("backlash of joint 2", "backlash", (2,)),
    ("windup by friction, joint 3", "friction_windup", (3,)),
    ("tool offset", "tool_offset", ()),
    ("base not plumb", "base_tilt", ()),
)


def shown(diagnosis: Diagnosis, effect: str, at: tuple[int, ...]) -> str:
    """The least size of an effect that a recording would have shown, `-` where there is none."""
    swallowed = {(name, places) for name, places in diagnosis.invisible}
    found = [each for each in diagnosis.detectable if each.effect == effect and each.at == at]
    if not found or (effect, at) in swallowed or found[0].visible < 1e-3:
        return "-"
    return format_quantity(found[0].value, found[0].kind, digits=2)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path, help="the page whose table is written anew")
    asked = parser.parse_args(arguments)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "arm.yaml"
        file.write_text(ARM, encoding="utf-8")
        arm = read_arm(file)
    results = [diagnose(arm, plan.declared_in(simulate(arm, plan).recording)) for plan in INSTRUMENTS.values()]
    head = ("effect", *INSTRUMENTS)
    rows = [(name, *(shown(each, effect, at) for each in results)) for name, effect, at in EFFECTS]
    print("\n".join(table(head, rows)))
    if asked.page is not None:
        write_table(asked.page, head, rows)


if __name__ == "__main__":
    main()

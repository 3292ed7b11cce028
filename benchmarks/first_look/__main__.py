"""The table of the first look: python -m benchmarks.first_look [--each N] [--sound N] [--only WORD] [--show]

Recordings made wrong in many ways, alone and in pairs, beside sound ones, of tips and of motion logs: for each way how
many get the right line, and how many sound ones are accused. A line is right where it names what was done; where the
settings that it writes mend the recording, it counts as mended.
"""

from __future__ import annotations

import argparse
import functools
import re
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.units.quantities import InputError

from .mistakes import LOGS, PAIRS, TIPS
from .recordings import Case, Spoil, logs, tips

_ACCUSED = re.compile(
    r"other way|another zero|changed places|seem|holds q|left-handed|the tips stand|turns [\d.]+ times|gives"
    r" way|gravity acts|gear|another frame|frame turned|/1000|clipped|lag |belong together|is -?[\d.]+ times"
)


def said(case: Case, folder: Path, settings: str | None = None) -> tuple[str, str]:
    """The refusal of a case (empty where it is read), and the warnings."""
    (folder / "arm.yaml").write_text(case.arm)
    (folder / "r.yaml").write_text(case.settings if settings is None else settings)
    lines = [",".join(case.columns)]
    lines += [",".join(f"{x:.8g}" for x in row) for row in zip(*case.columns.values(), strict=True)]
    (folder / "r.csv").write_text("\n".join(lines) + "\n")
    arm = read_arm(folder / "arm.yaml")
    try:
        read = read_log if case.motion else read_recording
        result = read(folder / "r.csv", arm, folder / "r.yaml")
    except InputError as error:
        return str(error), ""
    return "", " ".join(result.warnings)


def after(case: Case, line: str, folder: Path) -> tuple[str, str] | None:
    """What is said of a case once the settings that a line writes are written; None where it writes none."""
    first = line.partition("; write ")[2].partition(" or `")[0]
    remedies = re.findall(r"`((?:columns|gear_ratios|frame|tool): [^`]*)`", first)
    if not remedies:
        return None
    new = {item.partition(":")[0] for item in remedies}
    kept = [item for item in case.settings.splitlines() if item.partition(":")[0] not in new]
    return said(case, folder, "\n".join([*kept, *remedies]) + "\n")


def right_line(case: Case, line: str) -> bool:
    """Whether all that was done is named, and sized."""
    sizes = [[float(item) for item in re.findall(pattern, line)] for pattern, _ in case.sizes]
    near = [
        any(abs(item / value - 1.0) < 0.05 for item in items)
        for items, (_, value) in zip(sizes, case.sizes, strict=True)
    ]
    return all(near) and all(re.search(pattern, line) for pattern in case.says)


def main() -> None:
    """Print the table."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.first_look")
    reader.add_argument("--each", type=int, default=6)
    reader.add_argument("--sound", type=int, default=100, help="of each world")
    reader.add_argument("--only", default="")
    reader.add_argument("--show", action="store_true")
    asked = reader.parse_args()
    ways: list[tuple[str, Callable[[np.random.Generator], Case], tuple[Spoil, ...]]] = []
    ways += [(f"tips: {name}", tips, (spoil,)) for name, spoil in TIPS.items()]
    ways += [(f"logs: {name}", logs, (spoil,)) for name, spoil in LOGS.items()]
    for motion, one, other in PAIRS:
        world = LOGS if motion else TIPS
        ways.append(
            (f"{'logs' if motion else 'tips'}: {one} + {other}", logs if motion else tips, (world[one], world[other]))
        )
    right_all = mended_all = total = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for way, make, spoils in ways:
            if asked.only not in way:
                continue
            right = mended = 0
            for number in range(asked.each):
                rng = np.random.default_rng([number, zlib.crc32(way.encode())])
                case = functools.reduce(lambda case, spoil, rng=rng: spoil(case, rng), spoils, make(rng))
                refused, warned = said(case, folder)
                then = after(case, refused, folder) if refused else None
                line = f"{refused} {warned}"
                if right_line(case, line) or (then and right_line(case, f"{line} {then[0]} {then[1]}")):
                    right += 1
                elif then and not then[0] and not _ACCUSED.search(then[1]):
                    mended += 1
                    if asked.show:
                        print(f"    mended {number}: {case.says} {case.sizes} {line[:300]}")
                elif asked.show:
                    print(f"    WRONG {number}: {case.says} {case.sizes} {line[:500]}")
            right_all, mended_all, total = right_all + right, mended_all + mended, total + asked.each
            print(f"{way:45} {right:3} named, {mended:3} mended of {asked.each}", flush=True)
        accused = refused_count = 0
        for world, make in (("tips", tips), ("logs", logs)):
            for number in range(asked.sound):
                rng = np.random.default_rng([number, 7])
                refused, warned = said(make(rng), folder)
                if refused or _ACCUSED.search(warned):
                    accused, refused_count = accused + 1, refused_count + bool(refused)
                    if asked.show:
                        print(f"    ACCUSED {world} {number}: {refused or warned}"[:400])
    if total:
        print(f"named {right_all}, mended {mended_all} of {total}: {100 * (right_all + mended_all) / total:.1f} %")
    print(f"sound ones accused: {accused} of {2 * asked.sound}, refused {refused_count}")


if __name__ == "__main__":
    main()

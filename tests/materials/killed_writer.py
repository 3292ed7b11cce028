"""Run by test_store.py: writers that are killed before a line of the code that writes, every line in its turn.

Prints a line for each kill, as JSON: the line that never ran, and whether the new content stands.
"""

import json
import os
import re
import shutil
import signal
import sys
from collections.abc import Callable
from functools import partial
from itertools import count
from linecache import getline
from pathlib import Path
from types import FrameType
from typing import Any

from linkwright.core.catalogues import editor
from linkwright.core.materials.catalogue import load_layer
from linkwright.core.units import files
from linkwright.core.units.files import locked

WATCHED = {editor.__file__, files.__file__}


def edit(path: Path, density: int) -> None:
    def change(text: str | None) -> tuple[str, str]:
        return re.sub(r"density: \d+ ", f"density: {density} ", text or ""), f"density {density}"

    editor.edit_text(path, change)


def density_in(path: Path) -> float:
    return load_layer(path).materials["x"].need("density")


def last_line_before(step: int, work: Callable[[], object]) -> str | None:
    """Do the work in a child that kills itself before its `step`-th watched line; that line, None where it ended."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        left = step

        def trace(frame: FrameType, event: str, argument: Any) -> Any:
            nonlocal left
            del argument
            if frame.f_code.co_filename not in WATCHED:
                return None
            if event == "line":
                left -= 1
                if left == 0:
                    os.write(writer, getline(frame.f_code.co_filename, frame.f_lineno).strip().encode())
                    os.kill(os.getpid(), signal.SIGKILL)
            return trace

        sys.settrace(trace)
        work()
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as told:
        line = told.read().decode()
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == (-signal.SIGKILL if line else 0)
    return line or None


def main(folder: Path) -> None:
    given = folder / "given"
    edit(given / "c.yaml", 3)
    for step in count(1):
        place = folder / f"edit-{step}"
        shutil.copytree(given, place)
        path = place / "c.yaml"
        line = last_line_before(step, partial(edit, path, 4))
        now, text = density_in(path), path.read_bytes()
        assert now in (3, 4), (line, now)
        assert text == (given / "c.yaml").read_bytes().replace(b"density: 3 ", b"density: %d " % now), line
        with locked(path, wait=False):  # nobody holds it any more
            pass
        edit(path, 5)
        assert path.read_bytes() == text.replace(b"density: %d " % now, b"density: 5 "), line
        names = {item.name for item in place.iterdir()}
        assert names <= {"c.yaml", ".c.yaml.lock", ".c.yaml.new"}, names
        print(json.dumps([line, now == 4]))
        if line is None:
            break


if __name__ == "__main__":
    main(Path(sys.argv[1]))

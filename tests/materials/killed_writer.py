"""Run by test_store.py: a writer that is killed at random instants, over and over, and a look at the file each time."""

import os
import random
import signal
import sys
import time
from pathlib import Path

from materials.catalogue import load_layer
from materials.edit import set_key
from materials.store import journal, undo


def main(path: Path, kills: int) -> None:
    chance = random.Random(7)
    started = time.perf_counter()
    set_key(path, "x", "density", "1 kg/m^3")
    longest = 1.5 * (time.perf_counter() - started)
    landed = 0
    for number in range(2, kills + 2):
        old = path.read_bytes()
        child = os.fork()
        if child == 0:
            set_key(path, "x", "density", f"{number} kg/m^3")
            time.sleep(60)
            os._exit(0)
        time.sleep(chance.uniform(0.0, longest))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        now = path.read_bytes()
        density = load_layer(path).materials["x"].need("density")
        assert now == old or density == number, (number, density)
        assert b"# a comment" in now
        landed += now != old
    print("landed", landed)
    set_key(path, "x", "density", "5000 kg/m^3")  # no lock is left behind
    undone = 0
    while journal(path):
        if journal(path)[-1].before is None:
            break
        undo(path)
        undone += 1
        if undone > 50:
            break
        load_layer(path)
    print("undone", undone)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))

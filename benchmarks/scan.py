"""How fast a scan over random poses runs: python -m benchmarks.scan [poses]

The size of a planar 3R arm's tip error (bending, slopes, axial strain, drives; distributed gravity and a
payload) at random poses, computed by NumPy written by hand for this arm and by what `arm.compiled.vectorise` makes of
the symbolic expression.  First all results are compared with each other, then all ways are timed in turn,
round after round in one run; the best of the rounds counts, and only ratios are to be trusted.

Two versions by hand compete: with NumPy's sine and cosine, as anybody would write it, and with both taken
from one tangent of half the angle, which is what the generated NumPy code does where it pays.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial

import casadi as ca
import numpy as np

from benchmarks.compiled.c_build import CompilerError
from benchmarks.compiled.function import compiled
from benchmarks.planar_by_hand import EXAMPLE, Array, planar_error_numpy, planar_error_sx, planar_symbols
from benchmarks.trigonometric_quadratic import TrigQuadratic
from linkwright.core.arm.compiled.vectorise import VectorFunction, vectorise

ROUNDS = 7
AGREEMENT = 1e-12
BLOCKS = (1024, 2048, 4096, 8192, 16384)


def scan(poses: int = 1_000_000, rounds: int = ROUNDS) -> None:
    """Check, time and print."""
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (poses, 3))
    ways, preparing = _ways(q)
    results = {name: way() for name, way in ways.items()}
    reference = results["by hand"]
    for name, result in results.items():
        off = float(np.max(np.abs(result / reference - 1.0)))
        if not off <= AGREEMENT:
            raise SystemExit(f"{name} is off by {off:.1e} (relative): there is nothing to compare")
    print(f"{poses} poses; all results agree to {AGREEMENT:.0e} (relative)")

    best = dict.fromkeys(ways, np.inf)
    for _ in range(rounds):
        for name, way in ways.items():
            best[name] = min(best[name], _seconds(way))
    print(f"{'':44}{'ms':>9}{'of by hand':>12}{'of half angles':>16}")
    for name, seconds in best.items():
        ratios = seconds / best["by hand"], seconds / best["by hand, half angles"]
        print(f"{name:44}{1e3 * seconds:9.1f}{ratios[0]:12.3f}{ratios[1]:16.3f}")
    for text in preparing:
        print(text)


def _ways(q: Array) -> tuple[dict[str, Callable[[], Array]], list[str]]:
    """Everything that is timed, by name, and notes on what making it took."""
    symbols, arm, columns = planar_symbols(3)
    error = planar_error_sx(symbols, EXAMPLE)
    size = ca.sqrt(ca.sumsqr(error))
    general_size = ca.sqrt(ca.sumsqr(planar_error_sx(symbols, arm)))
    design = [
        np.atleast_1d(np.array(value, dtype=np.float64))
        for value in (EXAMPLE.EI, EXAMPLE.EA, EXAMPLE.weight, EXAMPLE.length, EXAMPLE.K, EXAMPLE.payload)
    ]
    notes: list[str] = []
    start = time.perf_counter()
    quadratic = TrigQuadratic.detect(error, symbols)
    notes.append(f"finding the quadratic form took {1e3 * (time.perf_counter() - start):.0f} ms")

    ways: dict[str, Callable[[], Array]] = {
        "by hand": _best_block(q, half_angle=False),
        "by hand, half angles": _best_block(q, half_angle=True),
        "tape to NumPy": _sizes(vectorise([symbols], [size]), q),
        "tape to NumPy, design as arguments": _sizes(vectorise(columns, [general_size]), q, *design),
        "quadratic form, NumPy": _sizes(vectorise([symbols], [quadratic.size(symbols)]), q),
    }
    for threads in (1, 2):
        name = f"C, {threads} thread{'s' * (threads > 1)}"
        start = time.perf_counter()
        try:
            whole = compiled([symbols], [size], threads=threads)
            fewer = compiled([symbols], [quadratic.size(symbols)], threads=threads)
        except CompilerError as error_:
            notes.append(f"no C: {error_}")
            break
        notes.append(f"making (or finding) both C libraries took {time.perf_counter() - start:.2f} s")
        ways[f"tape to {name}"] = _sizes(whole, q)
        ways[f"quadratic form, {name}"] = _sizes(fewer, q)
    interpreted = ca.Function("size", [symbols], [size])
    ways["CasADi's interpreter, mapped"] = lambda: np.array(interpreted.map(len(q))(q.T)).ravel()
    return ways, notes


def _sizes(function: VectorFunction, *arguments: Array) -> Callable[[], Array]:
    return lambda: function(*arguments)[0][:, 0]


def _best_block(q: Array, *, half_angle: bool) -> Callable[[], Array]:
    """The version by hand with the block size that suits this machine best."""
    versions = [partial(planar_error_numpy, q, EXAMPLE, block=block, half_angle=half_angle) for block in BLOCKS]
    times = [min(_seconds(version) for _ in range(3)) for version in versions]
    print(f"by hand{', half angles' * half_angle}: best in blocks of {BLOCKS[int(np.argmin(times))]} rows")
    return versions[int(np.argmin(times))]


def _seconds(way: Callable[[], Array]) -> float:
    start = time.perf_counter()
    way()
    return time.perf_counter() - start


if __name__ == "__main__":
    scan(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)

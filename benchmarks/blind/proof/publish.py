"""From folders of cases and answers to docs/proof.md: scores, the further parts, pictures, page."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.blind.proof.asked_again import next_poses
from benchmarks.blind.proof.drawing import power
from benchmarks.blind.proof.figures import Figures, Results, asks_for_poses, figures
from benchmarks.blind.proof.halves import Half, read_half, sample, shown
from benchmarks.blind.proof.page import POWER, page
from benchmarks.blind.proof.parts import FAILED, Piece, done
from benchmarks.blind.proof.prediction import predicted
from benchmarks.multibody.page import kept_section

_GOALS = ((0.5, 0.9), (1.0, 0.95), (2.0, 0.99))


@dataclass(frozen=True)
class Sizes:
    """How many cases each further part takes at most."""

    predicted: int = 72
    next_poses: int = 40


def parts(half: Half, work: Path, jobs: int, sizes: Sizes) -> Mapping[str, Results]:
    """The further parts of a half; those that ask the tool anew only of a disclosed one."""
    open_half = half.name == "disclosed"

    def run(part: str, call: Callable[..., dict[str, Any]], pieces: list[Piece]) -> Results:
        return done(f"{half.name}, {part}", call, pieces, work / half.name / part, jobs)

    some = sample(half, sizes.predicted, lambda t, _: shown(t, ("single", "pair"), 0.5))
    tied = sample(half, sizes.next_poses, asks_for_poses) if open_half else []

    def piece(case: str, *more: object) -> Piece:
        return Piece(case, half.key(case), (*more,))

    names = {truth["case"]: str(half.folder(truth["case"])) for truth in half.truths}
    return {
        "prediction": run(
            "prediction",
            predicted,
            [piece(t["case"], dict(t), names[t["case"]], str(half.corrected(t["case"])), open_half) for t in some],
        ),
        "next_poses": run(
            "next_poses",
            next_poses,
            [piece(t["case"], dict(t), names[t["case"]], dict(half.said[t["case"]].diagnosis or {})) for t in tied],
        ),
    }


def publish(
    folders: list[tuple[Path, Path]], work: Path, docs: Path, jobs: int = 2, sizes: Sizes | None = None
) -> list[Path]:
    """Writes docs/proof.md and its pictures from (cases, answers) of each half; gives what was written. The section
    of the second generator, which benchmarks.multibody writes, stays as it is.

    Raises FileNotFoundError where answers are wanting, benchmarks.blind.seal.BrokenSealError where truths were touched.
    """
    both: list[tuple[Half, Figures]] = []
    for cases, answers in folders:
        half = read_half(cases, answers)
        print(f"{half.name}: {len(half.truths)} cases scored", file=sys.stderr)
        found = parts(half, work, jobs, sizes or Sizes())
        for part, results in found.items():
            for case, result in results.items():
                if FAILED in result:
                    print(f"{half.name}, {part}, {case}: {result[FAILED]}", file=sys.stderr)
        both.append((half, figures(half, found)))
    pictures = docs / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    curves = {f"class named, {h.name}": [(float(d), rate) for d, rate in h.score.class_by_dose] for h, _ in both}
    texts = {
        pictures / POWER: power(curves, _GOALS),
        docs / "proof.md": page(both) + (f"\n{kept}" if (kept := kept_section(docs / "proof.md")) else ""),
    }
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8", newline="\n")
    return list(texts)

"""Rows set aside, asked again once names are known, and whether they are chance blunders.

A rough model sets rows aside before anything is named, and these may be all that tells a shape of what is named then: a
few rows on the other side of a play. So what was named judges all rows anew, by the bounds that the rough model judged
by, and where that makes others lie far off the search is made again; a form, which only describes, judges nothing.
Blunders hit any row and point anywhere; rows that are alike are something that is not named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.diagnose.fitting.prepare import set_aside_beside
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import Alike
from linkwright.core.sections.numeric import Array

from .calibrate import p_value
from .large_motions import candidates_of
from .naming import Named, Namer

_DRAWS = 999


@dataclass(frozen=True)
class Asked:
    """The rows `aside` beside what was named, and that in the `shaped` forms that suit the others; `same` where these
    are the rows that were set aside before."""

    aside: tuple[RejectedRow, ...]
    shaped: tuple[Candidate, ...]
    same: bool


def asked_again(namer: Namer, named: Named, whole: Observed, options: Options, noise_floor: float | None) -> Asked:
    """All readings that were searched and set aside, `whole`, judged by what was named."""
    candidates = candidates_of(namer, named.members)
    aside, shaped = set_aside_beside(candidates, whole, options, noise_floor)
    same = {item.row for item in aside} == {item.row for item in namer.prepared.rejected}
    return Asked(aside, shaped, same)


def with_figures(namer: Namer, aside: tuple[RejectedRow, ...]) -> Namer:
    """The namer whose rows set aside say how far off what was named they are."""
    return namer.with_prepared(replace(namer.prepared, rejected=aside))


def alike(whole: Observed, aside: Sequence[RejectedRow], seed: int) -> Alike | None:
    """What rows set aside have most in common, one of each visit, and how often as many rows drawn at random, off in
    directions drawn at random, have as much in common of anything looked at; None of fewer than two."""
    place = {row: index for index, row in enumerate(whole.recording.row.tolist())}
    if len(place) < whole.rows:
        return None  # numbers of one row are readings of their own
    _, first, visit = np.unique(whole.block, return_index=True, return_inverse=True)
    visit = visit.reshape(-1)
    rows = np.array([place[item.row] for item in aside], dtype=np.int64)
    visits, at = np.unique(visit[rows], return_index=True)
    if len(visits) < 2:
        return None
    rows = rows[at]
    off = np.array([aside[index].off for index in at.tolist()])
    rng = np.random.default_rng(seed)
    drawn = np.argsort(rng.random((_DRAWS, len(first))), axis=1)[:, : len(visits)]
    words, scores = list[str](), list[Array]()
    for what, values in _ordinates(whole):
        rank = np.argsort(np.argsort(values[first], kind="stable"), kind="stable")
        chosen = rank[np.concatenate([visits[None], drawn])]
        apart = np.mean(np.abs(chosen - np.median(chosen, axis=1)[:, None]), axis=1)
        words.append(f"they lie together in {what}")
        scores.append(-np.log(apart + 1.0 / len(first)))
    if whole.view is None:
        length = np.linalg.norm(off, axis=1)
        directions = rng.standard_normal((_DRAWS, *off.shape))
        directions /= np.linalg.norm(directions, axis=2)[:, :, None]
        every = np.concatenate([(off / np.where(length > 0.0, length, 1.0)[:, None])[None], directions])
        words.append("they are off the same way")
        scores.append(-np.log1p(-np.minimum(np.linalg.norm(every.mean(axis=1), axis=1), 1.0 - 1e-9)))
        for joint in range(whole.arm.size):
            moved = whole.drive_moved(joint)[rows, : whole.components]
            unit = moved / np.maximum(np.linalg.norm(moved, axis=1), 1e-12)[:, None]
            along = np.minimum(np.abs(np.einsum("rnd,nd->rn", every, unit)), 1.0)
            # The share of all directions that are as near: of the plane, of space.
            share = np.arccos(along) / (0.5 * np.pi) if whole.components == 2 else 1.0 - along
            words.append(f"they are off the way joint {joint + 1} moves them")
            scores.append(-np.mean(np.log(np.maximum(share, 1e-9)), axis=1))
    table = np.array(scores)
    spread = table[:, 1:].std(axis=1) + 1e-12
    beyond = (table - table[:, 1:].mean(axis=1)[:, None]) / spread[:, None]
    best = int(np.argmax(beyond[:, 0]))
    return Alike(words[best], p_value(float(beyond[best, 0]), beyond[:, 1:].max(axis=0)))


def _ordinates(whole: Observed) -> list[tuple[str, Array]]:
    """What rows may lie together in, each (N,)."""
    ordinates = [("time", np.arange(whole.rows, dtype=float))]
    for joint in range(whole.arm.size):
        load = np.broadcast_to(np.asarray(whole.state.joints[joint].drive_load, dtype=float), (whole.rows,))
        ordinates.append((f"the coordinate of joint {joint + 1}", whole.recording.q[:, joint]))
        ordinates.append((f"the load of joint {joint + 1}", load))
    return [(what, values) for what, values in ordinates if np.ptp(values) > 0.0]

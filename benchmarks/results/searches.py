"""The cost of the error by the number of links, and of certificates."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import SHAPES

from .row import Row, at_most

_POSES = 50_000


def rods(count: int, *, backlash: float = 0.0) -> Arm:
    """A planar arm of round bars."""
    circle, aluminium = SHAPES["circle"](diameter=0.08), load_catalogue(user=False).find("aluminium-6061-t6")
    joints = tuple(Joint(range=(-2.5, 2.5), stiffness=6e4, mass=2.0, backlash=backlash) for _ in range(count))
    links = tuple(Link(1.2 / count, section=circle, material=aluminium) for _ in range(count))
    return Arm("rods", joints=joints, links=links, payload=LoadCase(mass=3.0))


def links(*, quick: bool) -> list[Row]:
    """From 3 links to 10, over what a cost in proportion to their number would be."""
    poses, instructions = {}, {}
    for count in (3, 10):
        arm = rods(count)
        model, p = error_model(arm), beam_values(beams_of(arm))
        q = np.random.default_rng(1).uniform(-2.5, 2.5, (_POSES, count))
        case = model.cases[0]
        poses[count] = _least(lambda case=case, q=q, p=p: case.arrays(q, p), 2 if quick else 5)
        instructions[count] = case.function.n_instructions()
    return [
        at_most(f"error at {what}, from 3 links to 10, over in proportion", 0.3 * found[10] / found[3], "times", 1.5)
        for what, found in {f"{_POSES} poses (CPU)": poses, "one pose (instructions)": instructions}.items()
    ]


def certificates(*, quick: bool) -> list[Row]:
    """Worst case of a 3R arm with a certificate of 1e-4, and of the next design after it."""
    three = [
        LoadCase(mass=3.0),
        LoadCase(mass=1.0, force=(20.0, 5.0, 0.0)),
        LoadCase(mass=0.0, force=(-30.0, 20.0, 0.0)),
    ]
    asked = {
        "3R, one load case": (rods(3), three[:1], 0.1),
        "3R, three load cases, backlash in every joint": (rods(3, backlash=3e-4), three, 1.0),
        "4R, one load case": (rods(4), three[:1], None),
    }
    rows: list[Row] = []
    for what, (arm, cases, target) in asked.items():
        model, p = error_model(arm, cases), beam_values(beams_of(arm, cases))
        began = time.process_time()
        search = WorstSearch(model, Workspace())
        result = search.worst(p)
        first = time.process_time() - began
        if not result.certified:
            raise SystemExit(f"{what}: not certified")
        again = _least(lambda search=search, p=p: search.worst(p), 2 if quick else 5)
        bare = _least(lambda search=search, p=p: search.worst(p, certify=False), 2 if quick else 5)
        note = f"the next design's takes {1e3 * again:.0f} ms, without its certificate {1e3 * bare:.1f} ms"
        rows.append(at_most(f"worst case certified to 1e-4, {what}", first, "s of CPU", target, note))
    return rows


def _least(work: Callable[[], object], rounds: int) -> float:
    results: list[float] = []
    for _ in range(rounds + 1):
        began = time.process_time()
        work()
        results.append(time.process_time() - began)
    return min(results)

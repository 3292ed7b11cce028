"""Diagnoses of simulated recordings: python -m benchmarks.diagnosis_simulated [--cases N] [--jobs N]

Singles: one linear effect of the library, at a random place and three times the size that the recording could just
have shown; right is one finding whose name or alternatives hold the truth. Nulls: nothing but noise. All seeded, half
of them in the plane and half in space. The recordings come from the library's own physics, so this proves consistency
and the tests' level, not the physics. `--cases` is the number of singles (200); nulls are half as many again. Exit
status 1 where a target is missed: 95 % of singles right, at most 2 of 300 nulls (in proportion) called anything.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.detectable import detectable
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.result import Detectable, Diagnosis
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.simulate import Plan, simulate
from linkwright.core.executors import Processes, plain
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Tube

_DOSE = 3.0
_RIGHT = 0.95
_FALSE = 2.0 / 300.0


@dataclass(frozen=True)
class Case:
    """What became of one recording: what was in it, what was said, and whether that is right."""

    space: bool
    truth: str
    verdict: str
    said: str
    right: bool
    p_value: float


def bench_arm(space: bool) -> Arm:
    """Three turning joints; in space the first turns about the vertical axis."""
    material = load_catalogue(user=False).find("aluminium-6061-t6")
    joint = Joint(range=(-math.pi / 2, math.pi / 2), stiffness=60e3)
    joints = [joint, joint, replace(joint, range=(-1.0, 2.0))]
    gravity = (0.0, -9.81, 0.0)
    if space:
        joints = [joint, replace(joint, axis=(0.0, 1.0, 0.0)), replace(joints[2], axis=(0.0, 1.0, 0.0))]
        gravity = (0.0, 0.0, -9.81)
    links = tuple(Link(length, section=Tube(0.08, 0.004), material=material) for length in (0.4, 0.42, 0.3))
    return Arm("bench", tuple(joints), links, gravity=gravity, payload=LoadCase(2.0))


def plan_of(seed: int) -> Plan:
    """128 readings with two payloads, both sides, repeats and warming; every third has a target on the base."""
    return Plan(16, repeats=2, payloads=(0.0, 5.0), temperature=(293.15, 303.15), seed=seed, base_target=seed % 3 == 0)


def linear(effect: str) -> bool:
    """Whether an effect moves the tip in proportion to its sizes and has no shape to be found."""
    return bool(EFFECTS[effect].sizes) and not EFFECTS[effect].shapes


def to_be_shown(arm: Arm, plan: Plan) -> tuple[Detectable, ...]:
    """The sizes of linear effects that a recording of the plan could just have shown, those that can be."""
    prepared = prepare(observe(arm, simulate(arm, plan).recording), Options())
    gate = Namer(prepared, thorough=False, seed=1).test(())[0]
    unit = math.sqrt(float(prepared.vector @ prepared.vector) / prepared.criterion.count)
    found: list[Detectable] = []
    for each in detectable(prepared, gate, unit, RULES.search.false_alarm):
        alone = len(each.at) <= 1
        if linear(each.effect) and alone and _possible(each):
            found.append(each)
    return tuple(found)


def _possible(each: Detectable) -> bool:
    parameter = next(p for p in EFFECTS[each.effect].parameters if p.name == each.parameter)
    return _DOSE * each.value <= 0.5 * parameter.upper


def with_effect(arm: Arm, effect: str, at: tuple[int, ...], **values: float) -> Arm:
    """The arm with one more effect."""
    return replace(arm, effects=(*arm.effects, EffectEntry(effect, at, MappingProxyType(values))))


def said_of(diagnosis: Diagnosis) -> str:
    """The findings in short."""
    parts = [f"{f.effect}@{','.join(map(str, f.at))}" for f in diagnosis.findings]
    if diagnosis.unknown is not None:
        parts.append(f"unknown: {diagnosis.unknown.shape}")
    return " + ".join(parts) or "nothing"


def single(seed: int) -> Case:
    """One linear effect at a random place."""
    space, random = seed % 2 == 1, np.random.default_rng(seed)
    arm, plan = bench_arm(space), plan_of(seed)
    able = to_be_shown(arm, plan)
    effects = sorted({each.effect for each in able})
    effect = effects[int(random.integers(len(effects)))]
    places = [each for each in able if each.effect == effect]
    chosen = places[int(random.integers(len(places)))]
    true = with_effect(arm, effect, chosen.at, **{chosen.parameter: _DOSE * chosen.value})
    found = diagnose(arm, simulate(true, replace(plan, seed=seed + 10_000)).recording)
    names = {(each.effect, each.at) for f in found.findings for each in (f, *f.alternatives)}
    right = len(found.findings) == 1 and found.unknown is None and (effect, chosen.at) in names
    truth = f"{effect}@{','.join(map(str, chosen.at))}"
    return Case(space, truth, found.verdict, said_of(found), right, found.gate_p)


def null(seed: int) -> Case:
    """Nothing but noise."""
    space = seed % 2 == 1
    arm = bench_arm(space)
    found = diagnose(arm, simulate(arm, plan_of(seed)).recording)
    return Case(space, "null", found.verdict, said_of(found), found.verdict == "none", found.gate_p)


def report(singles: Sequence[Case], nulls: Sequence[Case]) -> list[str]:
    """Print the table; what misses its target, as lines."""
    total, right = Counter[str](), Counter[str]()
    for case in singles:
        total[case.truth.partition("@")[0]] += 1
        right[case.truth.partition("@")[0]] += case.right
    print(f"{'effect':28}{'cases':>7}{'right':>7}")
    for effect in sorted(total):
        print(f"{effect:28}{total[effect]:7d}{right[effect]:7d}")
    for case in [*singles, *nulls]:
        if not case.right:
            where = "space" if case.space else "plane"
            print(f"  wrong in {where}: {case.truth} -> {case.verdict}: {case.said} (gate p {case.p_value:.2g})")
    share = sum(case.right for case in singles) / len(singles)
    called = sum(not case.right for case in nulls)
    allowed = math.floor(_FALSE * len(nulls))
    print(f"singles right: {100.0 * share:.1f} % of {len(singles)} (at least {100.0 * _RIGHT:.0f} %)")
    print(f"nulls called anything: {called} of {len(nulls)} (at most {allowed})")
    missed: list[str] = []
    if share < _RIGHT:
        missed.append(f"singles: {100.0 * share:.1f} % right")
    if called > allowed:
        missed.append(f"nulls: {called} called")
    return missed


def main() -> int:
    """Run, print, and say which targets were missed."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.diagnosis_simulated", description="Simulated diagnoses")
    asked.add_argument("--cases", type=int, default=200, help="singles; nulls are half as many again")
    asked.add_argument("--jobs", type=int, default=2)
    options = asked.parse_args()
    began = time.perf_counter()
    with Processes(options.jobs, patience=0.0) as processes:
        singles = processes.map(plain(single), range(options.cases))
        nulls = processes.map(plain(null), range(20_000, 20_000 + options.cases + options.cases // 2))
    missed = report(singles, nulls)
    print(f"{time.perf_counter() - began:.0f} s")
    for line in missed:
        print(f"MISSED  {line}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

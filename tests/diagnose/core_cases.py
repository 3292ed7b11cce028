"""Random pools and small recordings for the tests of the diagnosis' core."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, seen_of_model
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.patterns.pool import make_pool
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.residual.observe import observe
from tests.diagnose.made_diagnosis import made_arm

SMALL = Plan(12, repeats=2, payloads=(0.0, 5.0), temperature=(293.15, 303.15))
SIGMA = SMALL.noise


def pattern(name, width=1, shapes=None):
    """A candidate without physics."""
    return Candidate(name, (), ("size",) * width, MappingProxyType(shapes or {}), outside=True)


def random_pool(rng, ranks, rows=60, nuisances=3, names=None, columns=None):
    """A pool of random groups with their columns (n, d), and the nuisances (n, b)."""
    beside = rng.standard_normal((rows, nuisances))
    columns = columns or [rng.standard_normal((rows, rank)) for rank in ranks]
    names = names or [f"group {k}" for k in range(len(columns))]
    patterns = [
        (pattern(name, part.shape[1], {"variant": float(k)}), part, None)
        for k, (name, part) in enumerate(zip(names, columns, strict=True))
    ]
    return make_pool(beside, patterns), columns, beside


def with_effects(arm, *entries):
    """The arm with effects (id, at from 1, values)."""
    added = tuple(EffectEntry(effect, at, MappingProxyType(values)) for effect, at, values in entries)
    return replace(arm, effects=(*arm.effects, *added))


def recorded(arm, plan=SMALL, **changed):
    """A simulated recording."""
    return simulate(arm, replace(plan, **changed)).recording


def prepared_null(space=False, **changed):
    """A recording of nothing but noise, ready to be searched."""
    arm = made_arm(space)
    return prepare(observe(arm, recorded(arm, **changed)), Options())


def with_residual(prepared, residual):
    """The same arm's recording with another residual (N, C), m and rad, and the tips that have it; the frame known."""
    width, before = prepared.observed.components, prepared.observed.recording
    moved = (residual - prepared.observed.residual)[:, :width]
    observed = replace(prepared.observed, residual=residual, recording=replace(before, tip=before.tip + moved))
    vector = prepared.pool.projected(observed.whitened(residual))
    return replace(prepared, observed=observed, vector=vector)


def noise_of(prepared, rng):
    """Noise (N, C) of the prepared scatter."""
    return prepared.observed.scale * rng.standard_normal(prepared.observed.residual.shape)


def group_of(prepared, effect, at=(), **shapes):
    """The number of an effect's group at places from 0, of the variant with these shapes."""
    for number, group in enumerate(prepared.pool.groups):
        candidate = group.candidate
        named = (candidate.effect, candidate.at) == (effect, at)
        if named and all(candidate.shapes[name] == value for name, value in shapes.items()):
            return number
    raise AssertionError(f"{effect} at {at} is not in the pool")


def pushed(arm, recording, force, rng):
    """The recording as it would be with a force (N, 3), N, at the tip that no column tells of, noise included."""
    q, parts = recording.q, np.asarray(force, dtype=float)
    state = solve(
        arm,
        list(q.T),
        beams_of(arm),
        payload_mass=recording.payload_mass,
        tip_force=(parts[:, 0], parts[:, 1], parts[:, 2]),
    )
    width = recording.tip.shape[1]
    moved = seen_of_model(state, active_effects(arm), Asked(len(q))).tip
    tip = (tip_position(arm, q) + moved)[:, :width]
    return replace(recording, tip=tip + rng.normal(0.0, SIGMA, tip.shape))

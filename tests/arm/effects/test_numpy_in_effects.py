"""An effect written with NumPy's functions is one written with the project's, and nothing warns of it."""

from __future__ import annotations

import subprocess
import sys

from tests.test_house import ROOT

PROGRAM = """
import numpy as np
import linkwright as lw
from linkwright.core.arm.effects import Effect, Parameter
from linkwright.core.arm.effects.effect import drive_motion
from linkwright.core.sections import numeric


def made(name, wave):
    def twists(state, settings):
        size = settings.values.get("amplitude", 0.0)
        for index, joint in enumerate(state.joints):
            if settings.acts_at(index):
                yield from drive_motion(state, index, size * wave(joint.coordinate))

    amplitude = Parameter("amplitude", "angle", "amplitude", -1e-2, 1e-2, (1e-5, 1e-3), "makers", role="size")
    told = dict(formula="sum J_i a f(q_i)", place="joint", cause="angle errors", automatic=False, needs="wide travel")
    told |= dict(source="made here", aliases=(), parameters=(amplitude,), twists=twists, linear=True)
    return Effect(id=name, title=name, **told)


def by_numpy(q):
    return np.sin(q) * np.cos(2.0 * q) + np.where(q > 0.0, np.sqrt(np.abs(q)), np.tanh(q)) + np.arctan2(np.exp(q), 2.0)


def by_numeric(q):
    root, tanh = numeric.sqrt(numeric.absolute(q)), numeric.tanh(q)
    above = 0.5 * (1.0 + np.sign(q))
    angle = numeric.atan2(numeric.exp(q), 2.0)
    return numeric.sin(q) * numeric.cos(2.0 * q) + above * root + (1.0 - above) * tanh + angle


found = []
for name, wave in (("by_numpy", by_numpy), ("by_numeric", by_numeric)):
    lw.effects.register(made(name, wave))
    arm = lw.read_arm("examples/welding-arm/arm.yaml").replace("leave_out", ["link_bending"])
    own = [{"effect": name, "at": [1, 2], "amplitude": 0.001}]
    found.append(lw.evaluate(arm.replace("effects", own)).max_error_mm)
print(*found)
"""


def test_numpys_functions_serve_in_an_effect_without_a_warning() -> None:
    """In a process of its own, where any warning ends it: CasADi's own says so once for a process."""
    command = [sys.executable, "-W", "error", "-c", PROGRAM]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env={"PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr[-2000:]
    assert not done.stderr
    one, other = map(float, done.stdout.split())
    assert one > 0.0
    assert abs(one - other) <= 1e-9 * other

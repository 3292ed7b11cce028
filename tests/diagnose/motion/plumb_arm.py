"""Two links that turn in a plumb plane, in closed form, and logs of them."""

import numpy as np

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.motion.log import MotionLog

UPPER, FORE, MID, HAND = 0.4, 0.3, 6.0, 3.0
"""Lengths of the links (m) and the point masses at their ends (kg)."""
NOISE = 0.05
"""N*m, of each sample's torque."""
ARM = f"""name: plumb
gravity: [0 m/s^2, -9.81 m/s^2, 0 m/s^2]
chain:
  - joint: {{axis: z, range: [-3 rad, 3 rad]}}
    link:
      {{length: {UPPER} m, rigid: true, mass: 0 kg, masses: [{{mass: {MID} kg, at: [{UPPER} m, 0 m, 0 m], on: joint}}]}}
  - joint: {{axis: z, range: [-3 rad, 3 rad]}}
    link:
      {{length: {FORE} m, rigid: true, mass: 0 kg, masses: [{{mass: {HAND} kg, at: [{FORE} m, 0 m, 0 m], on: joint}}]}}
"""


def torques(q, v, a, hand):
    """In closed form (M. W. Spong et al., Robot Modeling and Control, 2006, section 7.3), `hand` (N,) kg at the tip."""
    both, far = hand * UPPER * FORE * np.cos(q[1]), hand * FORE**2
    pull = hand * UPPER * FORE * np.sin(q[1])
    near = (MID + hand) * UPPER**2 + far + 2.0 * both
    weight = 9.81 * hand * FORE * np.cos(q[0] + q[1])
    first = near * a[0] + (far + both) * a[1] - pull * (2.0 * v[0] * v[1] + v[1] ** 2)
    second = (far + both) * a[0] + far * a[1] + pull * v[0] ** 2
    return np.array([first + 9.81 * (MID + hand) * UPPER * np.cos(q[0]) + weight, second + weight])


def plumb_arm(folder):
    """The arm as its file says it."""
    (folder / "arm.yaml").write_text(ARM, encoding="utf-8")
    return read_arm(folder / "arm.yaml")


def logged(seed, hand_of, more_of, file="log.csv", pace=1.0):
    """Thirty seconds at 100 Hz: `hand_of` time at the tip, `more_of` angles and speeds beside (2, N); all at a pace."""
    rng = np.random.default_rng(seed)
    time = np.arange(3000) / 100.0
    rates = pace * 2.0 * np.pi * rng.uniform(0.1, 0.5, (2, 5))
    phases, swings = rng.uniform(0.0, 6.28, (2, 5)), rng.uniform(0.3, 0.8, (2, 5))
    turned = rates[:, :, None] * time + phases[:, :, None]
    q = np.sum(swings[:, :, None] * np.sin(turned), axis=1)
    v = np.sum((swings * rates)[:, :, None] * np.cos(turned), axis=1)
    a = -np.sum((swings * rates**2)[:, :, None] * np.sin(turned), axis=1)
    torque = torques(q, v, a, hand_of(time)) + NOISE * rng.standard_normal(q.shape) + more_of(q, v)
    return MotionLog(file, time, q.T, torque.T, np.arange(1, 3001))


def rough(seed, joint=slice(None)):
    """Friction that nobody models: dry, and again as much with a memory of half a second (2, N)."""
    rng = np.random.default_rng(seed)

    def more(_, v):
        noise = rng.standard_normal(v.shape)
        for k in range(1, v.shape[1]):
            noise[:, k] = 0.98 * noise[:, k - 1] + 0.2 * noise[:, k]
        torque = np.zeros_like(v)
        torque[joint] = ((1.0 + 0.3 * noise) * np.tanh(v / 0.01))[joint]
        return torque

    return more

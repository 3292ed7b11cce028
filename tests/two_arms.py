"""Two arms on a torso by plain matrices, sharing no code with the product: point masses, one soft pitch axis."""

from __future__ import annotations

import numpy as np

GRAVITY = np.array([0.0, 0.0, -9.81])
IDENTITY = np.eye(3)
AXES = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}
TORSO = [("z", (0, 0, 0.5), 8.0), ("y", (0, 0, 0.4), 10.0)]
"""Axis, the link's vector (m) in its frame, and its mass (kg), a point in its middle."""
LEFT = ((0.0, 0.2, 0.05), [("y", (0.3, 0, 0), 2.5), ("z", (0.3, 0, 0), 1.5), ("y", (0.2, 0, 0), 0.5)], 1.0)
RIGHT = ((0.0, -0.25, 0.0), [("y", (0.35, 0, 0), 3.0), ("z", (0.3, 0, 0), 1.5)], 2.0)
"""Where each arm stands on the torso's end, its joints and links, its payload (kg)."""
RANGES = [(-170, 170), (-30, 60), (-110, 60), (-90, 90), (-100, 100), (-110, 60), (-90, 90)]
"""Degrees: the torso's two, the left arm's three, the right arm's two."""


def arm_text() -> str:
    """The arm file of it, with nothing that gives."""
    lines = ["name: two arms", "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "chain:"]
    ranges = iter(RANGES)

    def entries(chain, indent: str) -> None:
        for axis, vector, mass in chain:
            low, high = next(ranges)
            length = float(np.linalg.norm(vector))
            direction = [float(part) / length for part in vector]
            lines.append(f"{indent}- joint: {{type: revolute, axis: {axis}, range: [{low} deg, {high} deg]}}")
            link = f"length: {length} m, direction: {direction}, rigid: true, mass: {mass} kg"
            lines.append(f"{indent}  link: {{{link}}}")

    entries(TORSO, "  ")
    lines.append("branches:")
    for name, (at, chain, payload) in (("left", LEFT), ("right", RIGHT)):
        lines.append(f"  - name: {name}")
        lines.append(f"    origin: {{xyz: [{at[0]} m, {at[1]} m, {at[2]} m]}}")
        lines.append(f"    payload: {{mass: {payload} kg}}")
        lines.append("    chain:")
        entries(chain, "      ")
    return "\n".join(lines) + "\n"


def mujoco_text() -> str:
    """The same as a model of MuJoCo: each mass is a ball of a tenth of a millimetre."""

    def bodies(chain, at, payload):
        text, close = "", ""
        for number, (axis, vector, mass) in enumerate(chain):
            x, y, z = (float(part) for part in AXES[axis])
            middle = " ".join(str(0.5 * part) for part in vector)
            geoms = f'<geom type="sphere" size="0.0001" pos="{middle}" mass="{mass}"/>'
            if number == len(chain) - 1 and payload:
                geoms += f'<geom type="sphere" size="0.0001" pos="{" ".join(map(str, vector))}" mass="{payload}"/>'
            text += f'<body pos="{" ".join(map(str, at))}"><joint axis="{x} {y} {z}"/>{geoms}'
            close, at = close + "</body>", vector
        return text, close

    torso, close = bodies(TORSO, (0, 0, 0), 0.0)
    end = np.array(TORSO[-1][1])
    arms = ["".join(bodies(chain, end + np.array(at), mass)) for at, chain, mass in (LEFT, RIGHT)]
    return f'<mujoco><compiler angle="radian"/><worldbody>{torso}{"".join(arms)}{close}</worldbody></mujoco>'


def turn(axis: str, angle: float) -> np.ndarray:
    """Rodrigues' rotation."""
    x, y, z = AXES[axis]
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew


def _walk(place, frame, chain, q):
    masses = []
    for (axis, vector, mass), angle in zip(chain, q, strict=True):
        frame = frame @ turn(axis, angle)
        step = frame @ np.array(vector, dtype=float)
        masses.append((mass, place + 0.5 * step))
        place = place + step
    return place, frame, masses


def posture(q, carries=True, mount=IDENTITY):
    """Tips of both arms, the left one turned on the torso by `mount`, all point masses (kg, place), and where the pitch
    axis is; q (7,) rad."""
    end, frame, masses = _walk(np.zeros(3), np.eye(3), TORSO, q[:2])
    tips = []
    for (at, chain, payload), own, turned in ((LEFT, q[2:5], mount), (RIGHT, q[5:7], IDENTITY)):
        tip, _, more = _walk(end + frame @ np.array(at), frame @ turned, chain, own)
        tips.append(tip)
        masses += [*more, (payload, tip)] if carries else []
    pitch = np.array([0.0, 0.0, 0.5])
    return tips, masses, (pitch, turn("z", q[0]) @ AXES["y"])


def pitch_torque(q, mount=IDENTITY) -> float:
    """What weighs about the pitch axis (N*m), all beyond it."""
    _, masses, (at, axis) = posture(q, mount=mount)
    return float(sum(axis @ np.cross(place - at, mass * GRAVITY) for mass, place in masses[1:]))


def tips(q, compliance=0.0, offsets=(), mount=IDENTITY) -> list[np.ndarray]:
    """Both tips where the pitch axis gives (rad/(N*m)) under all weights, in equilibrium, and zeros are off by
    `offsets` (joint from 0, rad)."""
    true = np.array(q, dtype=float)
    for joint, off in offsets:
        true[joint] += off
    given = true.copy()
    for _ in range(30):
        given[1] = true[1] + compliance * pitch_torque(given, mount)
    return posture(given, mount=mount)[0]


def recorded(tip: str, visits: int, seed: int, *, noise: float = 10e-6, hide: tuple[str, ...] = (), **hidden) -> str:
    """A recording (CSV) of one arm's tip while both move, every visit read twice; columns of the arms of `hide` are
    left out. Further keywords are those of `tips`."""
    random = np.random.default_rng(seed)
    low, high = np.radians(np.array(RANGES)).T
    names = ["q1", "q2", *(f"left_q{k}" for k in (1, 2, 3)), *(f"right_q{k}" for k in (1, 2))]
    shown = [k for k, name in enumerate(names) if name.split("_")[0] not in hide]
    rows = [",".join([*(f"{names[k]}_deg" for k in shown), "x_mm", "y_mm", "z_mm"])]
    for _ in range(visits):
        q = np.radians(np.round(np.degrees(random.uniform(low, high)), 5))
        true = tips(q, **hidden)[("left", "right").index(tip)]
        for _ in range(2):
            read = 1e3 * (true + noise * random.standard_normal(3))
            rows.append(",".join([*(f"{np.degrees(q[k]):.6f}" for k in shown), *(f"{item:.5f}" for item in read)]))
    return "\n".join(rows) + "\n"

"""Make log.csv and other.csv: MuJoCo moves robot.xml with physics that the file lacks; nothing here is Linkwright's.

python make.py [FOLDER]
"""

import sys
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).parent
RATE = 100.0
STEP = 0.0005

# What the file does not say, by joint: friction (N m; N m s/rad), inertia of the rotors behind the gears (kg m2), and a
# gripper that nobody entered (kg, m in the wrist's frame, kg m2).
COULOMB = (7.0, 9.0, 4.0, 1.2)
VISCOUS = (5.0, 6.0, 2.5, 0.4)
ROTOR = (0.0, 0.9, 0.0, 0.0)
GRIPPER = (1.6, (0.12, 0.0, 0.0), 0.012)

CENTRE = np.array([0.0, -0.8, 0.9, 0.0])
REACH = np.array([1.0, 0.7, 0.9, 1.6])


def real_arm() -> mujoco.MjModel:
    """The arm as it is."""
    spec = mujoco.MjSpec.from_string((HERE / "robot.xml").read_text())
    for joint, coulomb, viscous, rotor in zip(spec.joints, COULOMB, VISCOUS, ROTOR, strict=True):
        joint.frictionloss, joint.armature = coulomb, rotor
        joint.damping[0] = viscous
        # As hard as dry friction is; MuJoCo's default creeps.
        joint.solref_friction[:] = (0.002, 1.0)
        joint.solimp_friction[:] = (0.99, 0.999, 0.001, 0.5, 2.0)
    mass, place, inertia = GRIPPER
    body = spec.body("wrist").add_body(name="gripper", pos=place)
    body.mass, body.inertia, body.explicitinertial = mass, 3 * [inertia], True
    spec.option.timestep = STEP
    return spec.compile()


def course(seconds: float, seed: int):
    """A trajectory: coordinates and speeds of the joints at any time."""
    draw = np.random.default_rng(seed)
    order = np.arange(1, 6)
    sine, cosine = draw.standard_normal((2, 5, 4)) / np.sqrt(order)[:, None]
    turn = 2.0 * np.pi * order / 10.0
    fine = np.linspace(0.0, 10.0, 2000)
    raw = np.sin(np.outer(fine, turn)) @ sine + np.cos(np.outer(fine, turn)) @ cosine
    scale = REACH / np.abs(raw).max(axis=0)

    def at(time: float):
        ramp = min(1.0, time / 2.0, (seconds - time) / 2.0)
        ramp = max(0.0, ramp) ** 2 * (3.0 - 2.0 * max(0.0, ramp))
        value = np.sin(time * turn) @ sine + np.cos(time * turn) @ cosine
        return CENTRE + ramp * scale * value

    return at


def log(seconds: float, seed: int) -> np.ndarray:
    """Time, coordinates and drive torques under a controller that knows the file alone."""
    model = real_arm()
    data = mujoco.MjData(model)
    at, draw = course(seconds, seed), np.random.default_rng(seed + 1000)
    data.qpos[:] = at(0.0)
    mujoco.mj_forward(model, data)
    stiff, damp = np.array([4000.0, 5000.0, 3000.0, 600.0]), np.array([250.0, 300.0, 120.0, 15.0])
    rows, every = [], round(1.0 / (RATE * STEP))
    for step in range(round(seconds / STEP)):
        now = step * STEP
        wanted, ahead = at(now), at(now + STEP)
        data.ctrl[:] = stiff * (wanted - data.qpos) + damp * ((ahead - wanted) / STEP - data.qvel)
        if step % every == 0:
            q = data.qpos + 2e-5 * draw.standard_normal(4)
            torque = data.ctrl + np.array([0.15, 0.2, 0.1, 0.03]) * draw.standard_normal(4)
            rows.append([now, *q, *torque])
        mujoco.mj_step(model, data)
    return np.array(rows)


def main() -> None:
    """Write both logs."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    head = ",".join(["t_s", *(f"q{n}_rad" for n in range(1, 5)), *(f"tau{n}_Nm" for n in range(1, 5))])
    for name, seconds, seed in (("log.csv", 25.0, 1), ("other.csv", 12.0, 7)):
        rows = log(seconds, seed)
        kinds = ["%.2f"] + ["%.5f"] * 4 + ["%.2f"] * 4
        np.savetxt(folder / name, rows, fmt=kinds, delimiter=",", header=head, comments="")


if __name__ == "__main__":
    main()

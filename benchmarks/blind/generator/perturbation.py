"""Departures of an arm and its measurement from the nominal: what concealed physics adds, and how the arm answers."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.generator.mechanics import Arm, Inputs, Solution, nominal_inputs, solve, stacked, with_changes
from benchmarks.blind.generator.vectors import Array, cross, turned


@dataclass(frozen=True)
class Departure:
    """Additions to the nominal, SI; n joints, m rows. A sum of departures is their field-wise sum."""

    joint: Array  # (n, m) rad or m
    axial: Array  # (n, m) strain
    curvature: Array  # (n, m) 1/m
    shift: Array  # (n, 3, m) of pins
    line_mass: Array  # (n, m) kg/m
    softness: Array  # (n, m) relative flexibility added to each link with a section
    bending: Array  # (n, m) 1/(N*m^2) bending flexibility given to a rigid link, both planes
    payload: Array  # (m,)
    force: Array  # (3, m) at the tip
    tilt: Array  # (3, m) rotation of gravity
    tool: Array  # (3, m)
    reading: Array  # (3, m) of the measured point

    def plus(self, other: Departure) -> Departure:
        """Both at once."""
        return Departure(**{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(Departure)})

    def times(self, factor: float) -> Departure:
        """All scaled."""
        return Departure(**{f.name: getattr(self, f.name) * factor for f in fields(Departure)})


def nothing(arm: Arm, rows: int) -> Departure:
    """No departure."""
    each = np.zeros((arm.count, rows))
    vector = np.zeros((3, rows))
    return Departure(
        joint=each,
        axial=each,
        curvature=each,
        shift=np.zeros((arm.count, 3, rows)),
        line_mass=each,
        softness=each,
        bending=each,
        payload=np.zeros(rows),
        force=vector,
        tilt=vector,
        tool=vector,
        reading=vector,
    )


def departed(inputs: Inputs, departure: Departure) -> Inputs:
    """Inputs with a departure in them (all but the reading's)."""
    soft = inputs.flexibility * (1.0 + departure.softness[:, None, :])
    soft[:, 4:6] += departure.bending[:, None, :]
    return with_changes(
        inputs,
        joint=inputs.joint + departure.joint,
        axial=inputs.axial + departure.axial,
        curvature=inputs.curvature + departure.curvature,
        shift=inputs.shift + departure.shift,
        line_mass=inputs.line_mass + departure.line_mass,
        flexibility=soft,
        payload=inputs.payload + departure.payload,
        force=inputs.force + departure.force,
        gravity=inputs.gravity + cross(departure.tilt, inputs.gravity),
        tool=inputs.tool + departure.tool,
    )


STEPS = (
    ("joint", 1e-5),
    ("axial", 1e-5),
    ("curvature", 1e-5),
    ("line_mass", 0.1),
    ("softness", 0.01),
    ("bending", 1e-7),
)


@dataclass(frozen=True)
class Response:
    """The arm on each row, and the derivatives of its tip by differences of the generator itself, shape (n, 3, m)."""

    nominal: Solution
    joint: Array
    axial: Array
    curvature: Array
    line_mass: Array
    softness: Array
    bending: Array
    payload: Array  # (3, m)
    force: Array  # (3, 3, m)
    tilt: Array  # (3, 3, m)
    slope: Array  # (n, 3, m) what each link's end slope does to the tip
    shear: Array  # (3, m) the part of shear deformation, all links


def respond(arm: Arm, q: Array, payload: Array, force: Array) -> Response:
    """All first-order sensitivities from one stacked solve over the distinct rows."""
    key = np.round(np.concatenate([q, payload[None], force]), 12)
    distinct, first, back = np.unique(key, axis=1, return_index=True, return_inverse=True)
    back = np.reshape(back, -1)
    m, n = distinct.shape[1], arm.count
    base = nominal_inputs(arm, q[:, first], payload[first], force[:, first])
    none = nothing(arm, m)
    parts = [base]
    for name, step in STEPS:
        for i in range(n):
            field = np.zeros((n, m))
            field[i] = step
            parts.append(departed(base, replace(none, **{name: field})))
    parts.append(departed(base, replace(none, payload=np.full(m, 0.1))))
    for name, step in (("force", 1.0), ("tilt", 1e-3)):
        for axis in range(3):
            field = np.zeros((3, m))
            field[axis] = step
            parts.append(departed(base, replace(none, **{name: field})))
    stiff_in_shear = base.flexibility.copy()
    stiff_in_shear[:, 1:3] = 0.0
    parts.append(with_changes(base, flexibility=stiff_in_shear))
    solution = solve(arm, stacked(parts), 2)
    tips = solution.tip.reshape(3, len(parts), m)
    change = np.moveaxis(tips - tips[:, :1], 1, 0)  # (parts, 3, m)
    grads: dict[str, Array] = {}
    at = 1
    for name, step in STEPS:
        grads[name] = change[at : at + n][:, :, back] / step
        at += n
    nominal = _rows(solution, back)
    slope = np.stack([cross(nominal.link_turn[i], nominal.tip - nominal.end_at[i]) for i in range(n)])
    return Response(
        nominal=nominal,
        payload=change[at][:, back] / 0.1,
        force=change[at + 1 : at + 4][:, :, back],
        tilt=change[at + 4 : at + 7][:, :, back] / 1e-3,
        shear=-change[at + 7][:, back],
        slope=slope,
        **grads,
    )


def _rows(solution: Solution, rows: NDArray[np.intp]) -> Solution:
    """The first rows of a stacked solution, one for each row of the recording."""
    return Solution(*(getattr(solution, f.name)[..., rows] for f in fields(Solution)))


def first_order(response: Response, departure: Departure) -> Array:
    """Change of the reading by first-order theory, (3, m)."""
    change = departure.reading + departure.shift.sum(axis=0) + turned(response.nominal.rotation, departure.tool)
    for name, _ in STEPS:
        change = change + np.einsum("icm,im->cm", getattr(response, name), getattr(departure, name))
    change = change + response.payload * departure.payload
    for name in ("force", "tilt"):
        change = change + np.einsum("icm,im->cm", getattr(response, name), getattr(departure, name))
    return change

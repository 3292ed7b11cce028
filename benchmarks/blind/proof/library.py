"""The truth in the words of an arm file: what the tool's own formulas make of the parameters that were concealed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import yaml

from benchmarks.blind.generator.cases import Case
from benchmarks.blind.generator.concealed import UNIFORM, Effect
from benchmarks.blind.generator.mechanics import material_frame

Entry = dict[str, Any]
Words = Mapping[str, str | float]

_SOFT, _PER_H, _ANGLE_PER_H = "rad/(N*m)", "m/hour", "rad/hour"


def _plain(**units: str) -> Callable[[Mapping[str, float], Case, Effect], Words]:
    """Parameters as they are, under `theirs=ours_unit`, written name=unit or name='new_name unit'."""

    def words(p: Mapping[str, float], _: Case, __: Effect) -> Words:
        results: dict[str, str | float] = {}
        for name, text in units.items():
            new, unit = text.rpartition(":")[::2]
            results[new or name] = f"{p[name]!r} {unit}" if unit != "1" else p[name]
        return results

    return words


def _hardening(p: Mapping[str, float], _: Case, __: Effect) -> Words:
    c, knee = p["compliance"], p["knee"]
    if p["zones"] < 0.5:
        return {"compliance": f"{c!r} {_SOFT}", "knee": f"{knee!r} N*m"}
    stiff = {f"stiffness_{k}": f"{1.0 / (c * share)!r} N*m/rad" for k, share in ((1, 1.0), (2, 0.45), (3, 0.2))}
    return stiff | {"torque_1": f"{0.6 * knee!r} N*m", "torque_2": f"{1.6 * knee!r} N*m"}


def _counterbalance(p: Mapping[str, float], case: Case, effect: Effect) -> Words:
    """The generator's angle is from the first joint's zero, the library's in space from the vertical."""
    size = p["spring"] * case.arm.joints[effect.at[0] - 1].compliance
    sine, cosine = size * math.cos(p["phase"]), -size * math.sin(p["phase"])
    if not case.arm.planar:
        sine, cosine = -cosine, sine
    return {"sine": f"{sine!r} rad", "cosine": f"{cosine!r} rad"}


def _thermal_bending(p: Mapping[str, float], case: Case, effect: Effect) -> Words:
    link = case.arm.links[effect.at[0] - 1]
    size = link.expansion * p["gradient"] / link.depth
    return {"curvature": f"{size!r} 1/(m*K)", "lag": f"{p['lag']!r} s"}


def _axes(length: str, angle: str, turn: float) -> Callable[[Mapping[str, float], Case, Effect], Words]:
    def words(p: Mapping[str, float], case: Case, _: Effect) -> Words:
        results = {axis: f"{p[axis]!r} {length}" for axis in ("xy" if case.arm.planar else "xyz")}
        return results | {"about_z": f"{turn * p['rotation']!r} {angle}"}

    return words


def _tool(p: Mapping[str, float], case: Case, _: Effect) -> Words:
    """The generator's axes are the last joint's, the library's lie along the last link and across it."""
    own = material_frame(case.arm.joints[-1], case.arm.links[-1])
    along = own.T @ np.array([p["a"], p["b"], p["c"]])
    names = ("along", "across", "out")[: 2 if case.arm.planar else 3]
    return {name: f"{float(value)!r} m" for name, value in zip(names, along, strict=False)}


def _tilt(p: Mapping[str, float], case: Case, _: Effect) -> Words:
    """A base turned one way sees gravity turned the other."""
    return {f"about_{axis}": f"{-p[axis]!r} rad" for axis in ("z" if case.arm.planar else "xyz")}


_WORDS: Mapping[str, Callable[[Mapping[str, float], Case, Effect], Words]] = MappingProxyType(
    {
        "joint_compliance": _plain(compliance=_SOFT),
        "servo_droop": _plain(compliance=_SOFT),
        "base_compliance": _plain(compliance=_SOFT),
        "joint_hardening": _hardening,
        "backlash": _plain(total="rad", held_below="N*m"),
        "friction_windup": _plain(coulomb="windup:rad", proportional=f"windup_per_load:{_SOFT}"),
        "clearance": _plain(radius="m"),
        "encoder_offset": _plain(offset="rad"),
        "encoder_eccentricity": _plain(sine="rad", cosine="rad"),
        "encoder_scale": _plain(scale="1"),
        "gear_transmission_error": _plain(sine="rad", cosine="rad", harmonic="order:1"),
        "joint_coupling": _plain(ratio="coupling:1"),
        "link_bending": _plain(flexibility="1/(N*m^2)"),
        "link_modulus": lambda p, _, __: {"excess": 1.0 / (1.0 + p["softness"]) - 1.0},
        "link_mass": _plain(mass="kg"),
        "link_length": _plain(length="m"),
        "payload": _plain(mass="kg"),
        "tool_offset": _tool,
        "thermal_expansion": _plain(expansion="1/K", lag="s"),
        "thermal_bending": _thermal_bending,
        "gearbox_thermal": _plain(rate="per_kelvin:rad/K", lag="s"),
        "creep": lambda p, _, __: {
            "compliance": f"{p['compliance']!r} {_SOFT}",
            "time_constant": f"{p['time']!r} s",
            "anew": 0.0,
        },
        "base_tilt": _tilt,
        "frame_misalignment": _axes("m", "rad", 1.0),
        "frame_drift": _axes(_PER_H, _ANGLE_PER_H, 1.0),
        "instrument_scale": _plain(scale="1"),
        "counterbalance": _counterbalance,
        "latency": _plain(delay="s"),
    }
)
KNOWN = frozenset(_WORDS) | UNIFORM


_SIDED = frozenset({"backlash", "friction_windup"})


def tellable(truth: Mapping[str, Any]) -> bool:
    """Whether an arm file can say what is concealed, and the recording holds what its formulas ask for: sides."""
    names = {effect["effect"] for effect in truth["effects"]}
    return names <= KNOWN and (truth["design"] != "poor" or not names & _SIDED)


def entries(case: Case) -> list[Entry]:
    """The concealed effects as entries of an arm file. Raises KeyError for one that the library does not have."""
    results: list[Entry] = []
    for effect in case.effects:
        if effect.effect in UNIFORM:
            continue
        turning = [i for i, joint in enumerate(case.arm.joints, 1) if not joint.prismatic]
        at = turning if effect.effect == "latency" else list(effect.at)
        values = {name: float(value) for name, value in effect.parameters.items()}
        words = _WORDS[effect.effect](values, case, effect)
        results.append({"effect": effect.effect} | ({"at": at} if at else {}) | dict(words))
    return results


def true_arm(case: Case, folder: Path, target: Path) -> None:
    """Writes the case's arm file with the concealed physics in it, at its true size."""
    content: dict[str, Any] = yaml.safe_load((folder / "arm.yaml").read_text(encoding="utf-8"))
    hidden = {effect.effect for effect in case.effects}
    content["leave_out"] = [name for name in content.get("leave_out", []) if name not in hidden]
    content["effects"] = [*content.get("effects", []), *entries(case)]
    target.write_text(yaml.safe_dump(content, sort_keys=False, width=200), encoding="utf-8")

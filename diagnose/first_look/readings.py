"""Checks of a recording that name rows: what was read before it is believed.

Rows that cannot be right are set aside with the reason; what is odd but possible is said; an `InputError` is raised
only where nothing sensible can follow.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.residual.robust_scale import resolution
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError, format_quantity

from .rows import motion_checked
from .units import refuse_grams


def checked(recording: Recording, arm: Arm, headers: Headers, *, rules: Rules = RULES) -> Recording:
    """The recording less the rows that cannot be right, which join `rejected`, with sentences in `warnings`.

    `headers` gives the header of each column (`q1`: `q1_deg`) for messages. Raises `InputError` where a whole column
    contradicts its header or the frame is another than the base's.
    """
    for check in (_sides, _covariates, _pasted, _time, _duplicates):
        recording = check(recording, headers, rules)
    refuse_grams(recording.file, recording.payload_mass, arm, headers, rules)
    recording = _whole_turns(recording, arm, headers)
    recording = motion_checked(recording, arm, headers, rules=rules)
    for check in (_beyond_range, _constant):
        recording = replace(recording, warnings=(*recording.warnings, *check(recording, arm, headers)))
    return recording


def _rejecting(recording: Recording, bad: NDArray[np.bool_], reason: str) -> Recording:
    return recording.without([RejectedRow(int(row), reason) for row in recording.row[bad]])


def _saying(recording: Recording, sentence: str) -> Recording:
    return replace(recording, warnings=(*recording.warnings, sentence))


def _sides(recording: Recording, headers: Headers, rules: Rules) -> Recording:
    del rules
    if recording.sides is None:
        return recording
    for index in range(recording.sides.shape[1]):
        wrong = ~np.isin(recording.sides[:, index], (-1.0, 0.0, 1.0))
        if wrong.any():
            name, row = headers.get(f"dir{index + 1}", f"dir{index + 1}"), recording.row[wrong][0]
            value = recording.sides[wrong, index][0]
            if wrong.mean() > 0.5:
                would_do = "it is +1 where the joint last moved towards increasing q, else -1"
                raise InputError(recording.file, name, f"holds {value:g} in row {row}; {would_do}")
            recording = _rejecting(recording, wrong, f"{name} is {value:g}, neither +1 nor -1 (0: unknown)")
            assert recording.sides is not None
        sides = recording.sides[:, index]
        if (sides == 1.0).any() and (sides == 0.0).any() and not (sides == -1.0).any():
            name = headers.get(f"dir{index + 1}", f"dir{index + 1}")
            hint = f"if 0 is the other side, {headers.write({'columns': {name: f'2*{name} - 1'}})}"
            recording = _saying(recording, f"{name} is 1 or 0 and never -1: 0 counts as unknown ({hint}).")
            assert recording.sides is not None
    return recording


def _covariates(recording: Recording, headers: Headers, rules: Rules) -> Recording:
    if recording.payload_mass is not None:
        name = headers.get("payload", "payload_kg")
        negative = recording.payload_mass < 0.0
        if negative.all():
            raise InputError(recording.file, name, "is negative in every row; a mass cannot be")
        recording = _rejecting(recording, negative, f"{name} is negative")
    if recording.temperature is not None:
        header = headers.get("temperature", "temperature_degC")
        recording = _temperature(recording, recording.temperature, header, rules)
    links = recording.link_temperature
    for index in range(0 if links is None else links.shape[1]):
        name = f"temperature_link{index + 1}"
        if name in headers and recording.link_temperature is not None:
            recording = _temperature(recording, recording.link_temperature[:, index], headers[name], rules)
    return recording


def _temperature(recording: Recording, kelvin: Array, name: str, rules: Rules) -> Recording:
    coldest, hottest = rules.mistakes.surroundings
    wrong = (kelvin < coldest) | (kelvin > hottest)
    if not wrong.any():
        return recording
    first = format_quantity(max(float(kelvin[wrong][0]), 0.0), "temperature", digits=4)
    if wrong.mean() > 0.5:
        other = name.replace("_degC", "_K") if name.endswith("_degC") else name.replace("_K", "_degC")
        kind = "in kelvin" if name.endswith("_degC") else "in degrees Celsius"
        hint = f"; is it {kind} (header {other})?" if other != name else ""
        raise InputError(recording.file, name, f"says {first} in row {recording.row[wrong][0]}{hint}")
    return _rejecting(recording, wrong, f"{name} says {first}")


def _time(recording: Recording, headers: Headers, rules: Rules) -> Recording:
    """Time runs from the first reading on; a stray stamp costs its row, a clock that was set back costs the times."""
    if recording.time is None:
        return recording
    name = headers.get("time", "time_s")
    time = recording.time
    back = np.flatnonzero(np.diff(time) < 0.0) + 1
    if len(back):
        stray = ~longest_run(time)
        if stray.sum() <= max(1.0, rules.mistakes.few_stray * len(time)):
            recording = _rejecting(recording, stray, f"{name} runs backwards against the rows around it")
        elif len(back) <= max(1.0, 0.5 * rules.mistakes.few_stray * len(time)):
            rows = rows_text(recording.row[back])
            sentence = f"{name} starts again in {rows}: times before and after do not compare"
            recording = _saying(recording, f"{sentence}, so it is not used.")
            return replace(recording, time=None)
        else:
            sentence = f"{name} goes back {len(back)} times, first in row {recording.row[back[0]]}"
            recording = _saying(recording, f"{sentence}: the rows do not stand in the order of their visits.")
    assert recording.time is not None
    started = float(recording.time[0])
    return replace(recording, time=recording.time - started, started=started)


def longest_run(time: Array) -> NDArray[np.bool_]:
    """The rows of a longest subsequence in which time does not decrease (patience sorting)."""
    tails: list[float] = []
    ends: list[int] = []
    before = np.full(len(time), -1)
    for index, value in enumerate(time.tolist()):
        place = bisect_right(tails, value)
        before[index] = ends[place - 1] if place else -1
        if place == len(tails):
            tails.append(value)
            ends.append(index)
        else:
            tails[place], ends[place] = value, index
    member = np.zeros(len(time), dtype=bool)
    index = ends[-1]
    while index >= 0:
        member[index] = True
        index = int(before[index])
    return member


def _pasted(recording: Recording, headers: Headers, rules: Rules) -> Recording:
    """Rows that stand in the file twice, in the same order: a part of it pasted in again.

    An instrument of few steps may say the same again of the same poses, so only a fine one is believed to have not.
    """
    del headers
    spread = [(float(np.ptp(column)), resolution(column)) for column in recording.tip.T]
    if not any(reach > rules.mistakes.fine_steps * (step or 0.0) for reach, step in spread):
        return recording
    table = np.ascontiguousarray(np.column_stack([part.reshape(recording.size, -1) for part in _read(recording)]))
    first: dict[bytes, int] = {}
    earlier = np.array([first.setdefault(row.tobytes(), number) for number, row in enumerate(table)])
    number = np.arange(recording.size)
    # Of a stay at one pose each copy follows its original at once: that is a logger's doing, see `_duplicates`.
    again = earlier < number - 1
    starts = np.flatnonzero(again & ~np.concatenate([[False], again[:-1] & (np.diff(earlier) == 1)]))
    rejected: list[RejectedRow] = []
    for start in starts.tolist():
        length = 1
        while (
            start + length < recording.size
            and again[start + length]
            and (earlier[start + length] == earlier[start] + length)
        ):
            length += 1
        if length >= rules.mistakes.pasted_rows:
            rejected += [
                RejectedRow(int(recording.row[k]), f"stands in the file already, as row {recording.row[earlier[k]]}")
                for k in range(start, start + length)
            ]
    return recording.without(rejected)


def _read(recording: Recording) -> list[Array]:
    """All that the file says of each reading."""
    of_order = ("row", "last_moves")
    parts = [value for name, value in vars(recording).items() if isinstance(value, np.ndarray) and name not in of_order]
    return [*parts, *recording.other.values()]


def _duplicates(recording: Recording, headers: Headers, rules: Rules) -> Recording:
    """Rows that say again what the row before said, to the last digit: a logger's copies, or readings too coarse."""
    del headers
    if recording.size < 2:
        return recording
    same_q = (np.diff(recording.q, axis=0) == 0.0).all(axis=1)
    same = same_q & (np.diff(recording.tip, axis=0) == 0.0).all(axis=1)
    held = (recording.payload_mass, recording.sides, recording.force, recording.commanded, recording.joint_side)
    seen = (recording.temperature, recording.link_temperature, recording.torque, recording.orientation)
    for item in (*held, *seen, recording.velocity, recording.base_target):
        if item is not None:
            same &= (np.diff(item.reshape(recording.size, -1), axis=0) == 0.0).all(axis=1)
    if not same.any():
        return recording
    copied = same.copy()
    if recording.time is not None and (np.diff(recording.time) > 0.0).mean() > 0.5:
        copied &= np.diff(recording.time) == 0.0
        # Who touches reads the joints' coordinates, and encoders say the same twice.
        same &= ~copied & (recording.touches is None)
    else:
        same[:] = copied
        copied[:] = False
    if same.any():
        few = same.mean() <= rules.mistakes.few_rows or same.sum() <= 0.5 * same_q.sum()
        if few and not _coarse(recording, same_q, rules):
            copied |= same
        else:
            rows = rows_text(recording.row[1:][same])
            recording = _saying(recording, f"Repeats are alike to the last digit in {rows}: they show no noise.")
    rejected = [
        RejectedRow(int(recording.row[index + 1]), f"repeats row {recording.row[index]} to the last digit")
        for index in np.flatnonzero(copied)
    ]
    return recording.without(rejected)


def _coarse(recording: Recording, same_q: NDArray[np.bool_], rules: Rules) -> bool:
    """Whether repeats differ by so few of the instrument's steps that some must be alike."""
    steps = [resolution(recording.tip[:, axis]) for axis in range(recording.tip.shape[1])]
    counts = [
        np.abs(np.diff(recording.tip[:, axis])[same_q]) / step for axis, step in enumerate(steps) if step is not None
    ]
    if not counts:
        return False
    largest = np.max(counts, axis=0)
    moved = largest[largest > 0.5]
    return bool(len(moved)) and float(np.median(moved)) <= rules.mistakes.coarse


def _whole_turns(recording: Recording, arm: Arm, headers: Headers) -> Recording:
    """Angles that count from 0 to 360 deg brought into the declared range, and what was read beside them to them:
    what grows with an angle (the scale of an encoder) must not jump by a turn."""
    q, turn, sentences = recording.q.copy(), 2.0 * math.pi, list[str]()
    taken = np.zeros_like(q)
    for index, joint in enumerate(arm.joints):
        low, high = joint.range
        if not joint.revolute or high - low > turn + 1e-9:
            continue
        values, slack = q[:, index], 1e-6
        turns = np.where(values > high + slack, 1.0, np.where(values < low - slack, -1.0, 0.0))
        moved = values - turn * turns
        inside = (moved >= low - slack) & (moved <= high + slack)
        if turns.any() and inside.all() and np.ptp(moved) < np.ptp(values):
            q[:, index], taken[:, index] = moved, turns
            name = headers.get(f"q{index + 1}", f"q{index + 1}")
            rows = rows_text(recording.row[turns != 0.0])
            sentences.append(f"{name} is taken a whole turn back into the declared range in {rows}.")
    changed: dict[str, Array] = {"q": q}
    if recording.last_moves is not None:
        changed["last_moves"] = recording.last_moves - turn * np.diff(taken, axis=0, prepend=taken[:1])
    revolute = np.array([joint.revolute for joint in arm.joints])
    for name, values in (("commanded", recording.commanded), ("joint_side", recording.joint_side)):
        if values is not None:
            turns = np.where(revolute, np.round((values - q) / turn), 0.0)
            if turns.any():
                changed[name] = values - turn * turns
                bases = [f"{name[0]}{k + 1}" for k in np.flatnonzero(turns.any(axis=0))]
                columns = ", ".join(headers.get(base, base) for base in bases)
                sentences.append(f"{columns}: whole turns beside the encoder are taken off.")
    if not sentences:
        return recording
    return replace(recording, **changed, warnings=(*recording.warnings, *sentences))  # pyright: ignore[reportArgumentType]


def _beyond_range(recording: Recording, arm: Arm, headers: Headers) -> list[str]:
    sentences: list[str] = []
    for index, joint in enumerate(arm.joints):
        low, high = joint.range
        slack = 1e-6 * max(abs(low), abs(high), 1.0)
        values = recording.q[:, index]
        beyond = (values < low - slack) | (values > high + slack)
        if beyond.any():
            kind = "angle" if joint.revolute else "length"
            limits = f"{format_quantity(low, kind, digits=4)} to {format_quantity(high, kind, digits=4)}"
            name = headers.get(f"q{index + 1}", f"q{index + 1}")
            rows = rows_text(recording.row[beyond])
            sentences.append(f"{name} is beyond the range that the arm file declares ({limits}) in {rows}.")
    return sentences


def _constant(recording: Recording, arm: Arm, headers: Headers) -> list[str]:
    if recording.size < 2:
        return []
    still = [
        headers.get(f"q{index + 1}", f"q{index + 1}")
        for index in range(arm.size)
        if np.ptp(recording.q[:, index]) == 0.0
    ]
    for name, values in (("payload", recording.payload_mass), ("temperature", recording.temperature)):
        if values is not None and np.ptp(values) == 0.0:
            still.append(headers.get(name, name))
    if recording.sides is not None:
        given = [index for index in range(arm.size) if f"dir{index + 1}" in headers]
        still += [headers[f"dir{index + 1}"] for index in given if np.ptp(recording.sides[:, index]) == 0.0]
    if not still:
        return []
    verb = "never changes" if len(still) == 1 else "never change"
    return [f"{', '.join(still)} {verb}: what depends on that alone cannot be seen."]

"""A recording into a CSV file with its units in the header, and its settings beside it."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator, Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.avoid import avoid_to_list
from linkwright.core.diagnose.instruments.instrument import Slots
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, kind_at, labels, slots_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.temperature import ZERO_CELSIUS


def recording_text(recording: Recording, arm: Arm) -> str:
    """The recording as CSV: s, deg, mm, kg, degC, N, N*m. Lengths are written to 0.01 um, angles to 1e-6 deg."""
    return csv_text(list(recording_columns(recording, arm)), list(label_columns(recording)))


def csv_text(columns: Sequence[tuple[str, Array, int]], labels: Sequence[tuple[str, Sequence[str]]]) -> str:
    """Columns of numbers (name, values, decimals; nan is blank) and of labels as CSV."""
    stream = io.StringIO()
    stream.write(",".join([*(name for name, _, _ in columns), *(name for name, _ in labels)]) + "\n")
    for row in range(len(columns[0][1])):
        cells = [cell(values[row], digits) for _, values, digits in columns]
        stream.write(",".join([*cells, *(_quoted(values[row]) for _, values in labels)]) + "\n")
    return stream.getvalue()


def settings_text(recording: Recording) -> str:
    """The recording.yaml that says what the header cannot: sigma where it is declared, frame and tool."""
    lines = [f"frame: {recording.frame}\n", f"tool: {recording.tool}\n"]
    if recording.orientation is not None:
        lines.append(f"orientation: {recording.seat}\n")
    if recording.sigma_angle is not None:
        lines.insert(0, f"sigma_angle: {format_quantity(recording.sigma_angle, 'angle')}\n")
    if recording.sigma_axes is not None:
        sigmas = ", ".join(format_quantity(value, "length") for value in recording.sigma_axes)
        lines.insert(0, f"sigma: [{sigmas}]\n")
    elif recording.sigma is not None:
        lines.insert(0, f"sigma: {format_quantity(recording.sigma, 'length')}\n")
    lines += [
        f"{key}: {json.dumps(value, ensure_ascii=False)}\n"
        for key, value in (("tip", recording.branch), ("unit", recording.unit), ("date", recording.date))
        if value
    ]
    if recording.avoid:
        lines.append(f"avoid: {json.dumps(avoid_to_list(recording.avoid))}\n")
    return "".join([*lines, *_instrument(recording)])


def _instrument(recording: Recording) -> list[str]:
    """The lines that say what was observed, none for the whole place."""
    if recording.slots is None:
        return []
    instrument = recording.instrument
    kinds = ", ".join(instrument.kinds)
    lines = [f"observes: {kinds if len(instrument.kinds) == 1 else f'[{kinds}]'}\n"]
    said = [line for kind in INSTRUMENTS if kind in instrument.kinds for line in INSTRUMENTS[kind].lines(instrument)]
    return [*lines, *dict.fromkeys(said)]


def _quoted(label: str) -> str:
    return '"' + label.replace('"', '""') + '"' if any(sign in label for sign in ',"\n;') else label


def label_columns(recording: Recording) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Name and text of each column of labels, blank where a row touches none of that kind."""
    if recording.slots is None or recording.touches is None:
        return
    for kind, name in labels().items():
        touched = np.asarray(np.isin(recording.slots, slots_of(kind)).any(axis=1), dtype=np.bool_)
        if touched.any():
            which = zip(recording.touches.tolist(), touched.tolist(), strict=True)
            yield name, tuple(recording.instrument.labels[at] if there else "" for at, there in which)


def _read_in_part(recording: Recording, slots: Slots) -> Iterator[tuple[str, Array, int]]:
    """The numbers of a recording that does not hold the whole place; nan where a row holds none."""
    for slot in np.unique(slots[slots >= 0]).tolist():
        kind, number = kind_at(slot)
        if not number.column:
            continue
        rows = slots == slot
        values = kind.to_file(np.where(rows, recording.tip, 0.0).sum(axis=1))
        unit, factor, digits = ("deg", np.degrees(1.0), 6) if number.quantity == "angle" else ("mm", 1e3, 5)
        yield f"{number.column}_{unit}", np.where(rows.any(axis=1), factor * values, np.nan), digits
    if recording.bar_at is not None:
        on_bar = np.isin(slots, slots_of("bar")).any(axis=1)
        yield "bar_mm", np.where(on_bar, 1e3 * recording.bar_at, np.nan), 5


def cell(value: float, digits: int) -> str:
    """A number with so many decimals at most, nothing where there is none."""
    if value != value:  # nothing was read
        return ""
    text = f"{value:.{digits}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def recording_columns(recording: Recording, arm: Arm) -> Iterator[tuple[str, Array, int]]:
    """Name, values in the unit of the name, and decimals of each column."""
    of_links = [f"{arm.column('temperature_link', index)}_degC" for index in range(arm.size)]
    torques = [f"{arm.column('tau', k)}_{'Nm' if joint.revolute else 'N'}" for k, joint in enumerate(arm.joints)]
    yield from _columns(recording.time, ["time_s"], 3)
    yield from _joints("q", recording.q, arm)
    yield from _columns(recording.sides, [arm.column("dir", index) for index in range(arm.size)], 0)
    yield from _joints("c", recording.commanded, arm)
    yield from _joints("j", recording.joint_side, arm)
    yield from _joints("v", recording.velocity, arm, "_s")
    yield from _joints("a", recording.acceleration, arm, "_s2")
    yield from _columns(recording.torque, torques, 6)
    yield from _columns(recording.payload_mass, ["payload_kg"], 6)
    yield from _columns(recording.force, ["fx_N", "fy_N", "fz_N"], 6)
    yield from _columns(recording.temperature, ["temperature_degC"], 4, nothing=ZERO_CELSIUS)
    yield from _columns(recording.link_temperature, of_links, 4, nothing=ZERO_CELSIUS)
    if recording.slots is None:
        yield from _columns(recording.tip, ["x_mm", "y_mm", "z_mm"], 5, factor=1e3)
    else:
        yield from _read_in_part(recording, recording.slots)
    yield from _columns(recording.base_target, ["basex_mm", "basey_mm", "basez_mm"], 5, factor=1e3)
    if recording.orientation is not None:
        from scipy.spatial.transform import Rotation

        quaternion = Rotation.from_matrix(recording.orientation).as_quat(canonical=True)
        yield from _columns(quaternion[:, [3, 0, 1, 2]], ["qw", "qx", "qy", "qz"], 9)


def _columns(
    values: Array | None, names: Sequence[str], digits: int, *, factor: float = 1.0, nothing: float = 0.0
) -> Iterator[tuple[str, Array, int]]:
    """Columns of values (N,) or (N, k), SI, by name: `factor` times what is there, less `nothing`; none for None."""
    for name, column in zip(names, () if values is None else values.reshape(len(values), -1).T, strict=False):
        yield name, factor * column - nothing, digits


def _joints(base: str, values: Array | None, arm: Arm, suffix: str = "") -> Iterator[tuple[str, Array, int]]:
    for index, joint in enumerate(arm.joints if values is not None else ()):
        assert values is not None
        if joint.revolute:
            yield f"{arm.column(base, index)}_deg{suffix}", np.degrees(values[:, index]), 6
        else:
            yield f"{arm.column(base, index)}_mm{suffix}", 1e3 * values[:, index], 5

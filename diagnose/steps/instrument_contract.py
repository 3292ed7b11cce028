"""The contract of every kind of instrument, shipped or registered: its entry is complete, its numbers as declared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import MappingProxyType
from typing import cast

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.diagnose.instruments.instrument import Instrument, Slots
from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Scene
from linkwright.core.diagnose.instruments.observes import observed_by, read_instrument
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, kind_at, slots_of
from linkwright.core.diagnose.instruments.view import View
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, parse_yaml

_POSES = 40
_EXACT = MappingProxyType({"length": 1e-6, "angle": 1e-4})
"""m, or what an angle shows in a metre; so much of a recording without noise may be left. An arm in the plane turns a
level about one axis, which tells how it sits about the others to first order only."""
_STEP, _LINEAR, _SMALLEST = 1e-6, 1e-3, 1e-9
"""m or rad by which arms are moved, and the share by which what they show may be other than first order says; below
the smallest it is rounding."""
_UNIT = 30.0
"""How far from 1 what 1 m or 1 rad shows may be, as a factor: grazing beams show some times more, millimetres (1000)
and degrees (57) are other units."""


def check_instrument(kind: InstrumentKind) -> None:
    """Raise `InputError` with one line that lists all that is wrong with a kind of instrument, which is registered.

    The entry: words, numbers, columns that no other kind has, settings that are written as they are read. Its numbers,
    on an arm in the plane and one in space: what it reads of an arm without noise leaves nothing; what moves the tip or
    turns the tool shows as `shown` and `turning` say, in m and rad; what a file holds is what is read.
    """
    faults = [*_entry(kind)]
    # What the entry says wrongly makes no sense to try.
    if not faults:
        faults = [f"{arm.name}: {fault}" for arm in _arms() for fault in _behaviour(kind, arm)]
    if faults:
        raise InputError("", f"instrument {kind.name or '?'}", "; ".join(dict.fromkeys(faults)))


def _entry(kind: InstrumentKind) -> Iterator[str]:
    if not kind.title:
        yield "has no title"
    if not kind.numbers:
        yield "has no numbers"
    if kind.label and kind.columns:
        yield "names what it touches and has numbers in columns; it is one or the other"
    if not kind.label and len(kind.columns) < len(kind.numbers):
        yield "has a number without a column"
    if [number.in_plane for number in kind.numbers] != sorted((n.in_plane for n in kind.numbers), reverse=True):
        yield "has a number of the plane behind one out of it"
    others = {name for other in INSTRUMENTS.values() if other.name != kind.name for name in other.columns}
    shared = [name for name in kind.columns if name in others and not kind.alone and not kind.framed]
    if shared:
        yield f"has a column of another kind: {', '.join(shared)}"
    values = np.linspace(0.01, 1.0, 7)
    if np.abs(kind.of_file(kind.to_file(values)) - values).max() > 1e-12:
        yield "does not read what it writes"


def _behaviour(kind: InstrumentKind, arm: Arm) -> Iterator[str]:
    words = {"direction": None, "anchor": None, **kind.example}
    known = {name: words.pop(name) for name in ("direction", "anchor", "tilt_link", "bar", "camera") if name in words}
    try:
        asked = observed_by(kind.name, arm=arm, anchor_free=False, settings=words, **known)
    except InputError:
        if arm.planar() and kind.count(flat=True) in (0, len(kind.numbers)):
            return  # not of an arm in the plane
        raise
    made = simulate(arm, Plan(_POSES, noise=0.0, repeats=1, **asked)).recording
    if made.slots is None:
        return
    again = _read_back(made.instrument)
    if again is not None and replace(again, labels=made.instrument.labels) != made.instrument:
        yield f"is {made.instrument} and reads back from its settings as {again}"
    observed = observe(arm, made, rules=RULES)
    left = float(np.abs(observed.residual[:, : observed.components]).max())
    if left > _EXACT[kind.numbers[0].quantity]:
        yield f"leaves {left:.2g} of what it reads of a sound arm"
    if observed.view is None:
        return
    yield from _units(made.slots, observed.view)
    touches = np.full(made.size, -1) if made.touches is None else made.touches
    axes = np.tile(np.eye(3), (made.size, 1, 1))
    random = np.random.default_rng(3)
    turns = Rotation.from_rotvec(random.uniform(-0.5, 0.5, (made.size, 3)))
    scene = Scene(
        made.instrument, made.slots, made.tip, observed.view.at, turns.as_matrix() @ axes, None, touches, made.bar_at,
        False, np.zeros(made.slots.shape, dtype=bool), arm.planar(), RULES.residual,
    )  # fmt: skip
    yield from _slopes(kind, scene, random)


def _units(slots: Slots, view: View) -> Iterator[str]:
    """Numbers that 1 mm of the tip and 1 mrad of what the instrument stands on change by far more or less than that."""
    for slot in np.unique(slots[slots >= 0]).tolist():
        number, marked = kind_at(slot)[1], slots == slot
        moved, turned = (float(np.median(np.linalg.norm(item[marked], axis=1))) for item in (view.shown, view.turned))
        # What turns shows in a length by levers of any length, so it counts only where no displacement shows.
        size = moved if moved > 0.0 and number.quantity == "length" else max(moved, turned)
        if not 1.0 / _UNIT <= size <= _UNIT:
            by = "1 mm at the tip" if size == moved else "a turn of 1 mrad"
            unit = "mm" if number.quantity == "length" else "mrad"
            yield f"`{number.name}` changes by {size:.4g} {unit} with {by}; readings are in SI (m; of angles the sine)"


def _slopes(kind: InstrumentKind, scene: Scene, random: np.random.Generator) -> Iterator[str]:
    """What displacements and turns show, by differences of what is modelled."""
    first, frame = (
        slots_of(kind.name)[0],
        Frame(Rotation.from_rotvec([0.3, -0.2, 0.4]).as_matrix(), np.array([0.1, 0.2, 0.3])),
    )
    part = kind.part(first, scene)
    if part is None:
        return
    state, width = part.start(), scene.width
    moved = np.zeros(scene.tips.shape)
    moved[:, :width] = _STEP * random.standard_normal((len(moved), width))
    model, there = part.model(state, scene.tips, frame), part.model(state, scene.tips + moved, frame)
    yield from _differ("shown", there.values - model.values, np.einsum("nka,na->nk", model.shown, moved))
    if kind.turns_with != "tool":
        return
    turned = _STEP * random.standard_normal(scene.tips.shape)
    if scene.flat:
        turned[:, :2] = 0.0
    after = kind.part(first, replace(scene, directions=Rotation.from_rotvec(turned).as_matrix() @ scene.directions))
    if after is None:
        return
    yield from _differ(
        "turning",
        after.model(state, scene.tips, frame).values - model.values,
        np.einsum("nka,na->nk", model.turning, turned),
    )


def _differ(name: str, differences: Array, said: Array) -> Iterator[str]:
    size = max(float(np.abs(differences).max()), float(np.abs(said).max()))
    if float(np.abs(differences - said).max()) > _LINEAR * max(size, _SMALLEST):
        yield f"`{name}` is not what it shows"


def _read_back(instrument: Instrument) -> Instrument | None:
    """The instrument by the lines that its kinds write."""
    lines = [line for kind in instrument.kinds for line in INSTRUMENTS[kind].lines(instrument)]
    text = f"observes: [{', '.join(instrument.kinds)}]\n" + "".join(lines)
    return read_instrument(Mapping(cast(dict[str, object], parse_yaml(text, file="")), file=""))


def _arms() -> tuple[Arm, Arm]:
    """An arm in the plane and one in space, rigid links on springs."""
    payload = LoadCase(3.0)
    planar = Arm(
        "plane",
        tuple(Joint(range=(-1.5, 1.5), stiffness=4e4, mass=1.0) for _ in range(3)),
        tuple(Link(length, mass=2.0) for length in (0.6, 0.5, 0.3)),
        payload=payload,
    )
    axes = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    spatial = Arm(
        "space",
        tuple(Joint(range=(-1.5, 1.5), axis=axis, stiffness=5e4) for axis in axes),
        tuple(Link(length, mass=2.0) for length in (0.2, 0.5, 0.4, 0.1, 0.1)),
        gravity=(0.0, 0.0, -9.81),
        payload=payload,
    )
    return planar, spatial

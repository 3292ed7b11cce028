"""Every kind of instrument keeps the contract, and the contract tells those that do not."""

import importlib.util
import tomllib

import numpy as np
import pytest

import linkwright as lw
from handbook.instruments import PAGE, instrument_page
from handbook.sources import ROOT
from linkwright.core.diagnose.instruments import INSTRUMENTS, Frame, InstrumentKind, Modelled, Number, Part
from linkwright.core.diagnose.instruments.registry import kind_at, slots_of
from linkwright.core.diagnose.steps.instrument_contract import check_instrument


@pytest.mark.parametrize("name", list(INSTRUMENTS))
def test_every_kind_keeps_the_contract(name):
    check_instrument(INSTRUMENTS[name])


def test_slots_are_numbered_through():
    slots = [slot for name in INSTRUMENTS for slot in slots_of(name)]
    assert slots == list(range(len(slots)))
    assert [kind_at(slot)[0].name for slot in slots_of("bar")] == ["bar"] * 3
    assert slots_of("same_point", flat=True) == slots_of("same_point")[:2]


class _Part(Part):
    factor = 1.0

    def model(self, state, at, frame: Frame) -> Modelled:
        del state, frame
        return Modelled.of_place(at[:, :1] ** 2, self.factor * 2.0 * at[:, None, :] * np.array([1.0, 0.0, 0.0]))


class Squared(InstrumentKind):
    """The square of x, which no instrument reads."""

    name = "squared"
    title = "the square of x"
    numbers = (Number("squared", "squared"),)

    def part(self, first, scene):
        return _Part(self, first, scene)

    def simulated(self, stood, instrument, random):
        del instrument, random
        return stood.tips[:, :1] ** 2


class Slanted(_Part):
    factor = 1.1


@pytest.fixture
def squared():
    kind = Squared()
    lw.instruments.register(kind)
    yield kind
    lw.instruments.withdraw("squared")


def test_a_registered_kind_is_simulated_read_and_planned(squared, tmp_path):
    lw.instruments.check(squared)
    arm = "examples/welding-arm/arm.yaml"
    made = lw.simulate(arm, poses=12, observe="squared")
    made.save(tmp_path / "r.csv")
    assert (tmp_path / "r.yaml").read_text().endswith("observes: squared\n")
    read = lw.read_recording(tmp_path / "r.csv", arm)
    assert read.found.tip == pytest.approx(made.found.tip, abs=1e-8)
    assert len(lw.plan(arm, poses=10, for_=["backlash:2"], repeats=1, instrument="squared").visits) == 10


class OfAnotherSlope(Squared):
    def part(self, first, scene):
        return Slanted(self, first, scene)


class OfAnotherUnit(Squared):
    def to_file(self, values):
        return 2.0 * values


class NotAsModelled(Squared):
    def simulated(self, stood, instrument, random):
        del instrument, random
        return stood.tips[:, :1]


class _InMillimetres(_Part):
    def model(self, state, at, frame: Frame) -> Modelled:
        del state, frame
        return Modelled.of_place(1e3 * at[:, :1], np.broadcast_to([[[1e3, 0.0, 0.0]]], (len(at), 1, 3)))


class InMillimetres(Squared):
    """x in mm, in the model as in the readings."""

    def part(self, first, scene):
        return _InMillimetres(self, first, scene)

    def simulated(self, stood, instrument, random):
        del instrument, random
        return 1e3 * stood.tips[:, :1]


class _InDegrees(_Part):
    def model(self, state, at, frame: Frame) -> Modelled:
        del state, frame
        axes = self.scene.directions[:, :, 0]
        turning = np.cross(axes, [0.0, 1.0, 0.0])
        return Modelled(np.degrees(axes[:, 1:2]), np.zeros((len(at), 1, 3)), np.degrees(turning)[:, None, :])


class InDegrees(Squared):
    """How far the last link's x turns towards y, in degrees."""

    numbers = (Number("heading", "heading", "angle"),)
    turns_with = "tool"

    def part(self, first, scene):
        return _InDegrees(self, first, scene)

    def simulated(self, stood, instrument, random):
        del instrument, random
        return np.degrees(stood.axes[:, 1:2, 0])


class Untitled(Squared):
    title = ""


class Unwritten(Squared):
    numbers = (Number("squared"),)


class TwiceWritten(Squared):
    numbers = (Number("squared", "along"),)


def test_the_page_is_what_the_kinds_say():
    assert PAGE.read_text(encoding="utf-8") == instrument_page(), "make instruments-docs"


def test_a_package_from_outside_keeps_the_contract():
    """The example's, by the object of its entry point."""
    place = ROOT / "examples" / "range-difference"
    module, _, name = tomllib.loads((place / "pyproject.toml").read_text())["project"]["entry-points"][
        "linkwright.instruments"
    ]["range_difference"].partition(":")
    made = importlib.util.spec_from_file_location(module, place / f"{module}.py")
    brought = importlib.util.module_from_spec(made)
    made.loader.exec_module(brought)
    kind = getattr(brought, name)
    lw.instruments.register(kind)
    try:
        lw.instruments.check(kind)
        reads = {"first": (2.0, 0.0, 0.0), "second": (0.0, 2.0, 0.0)}
        zero = {"effect": "encoder_offset", "at": 2, "offset": "0.1 deg"}
        arm = "examples/welding-arm/arm.yaml"
        read = lw.simulate(arm, poses=20, observe="range_difference", reads=reads, with_=[zero], repeats=2)
        (found,) = lw.diagnose(arm, read).found.findings
        assert (found.effect, found.at) == ("encoder_offset", (2,))
    finally:
        lw.instruments.withdraw(kind.name)


BROKEN = {
    OfAnotherSlope: "`shown` is not",
    OfAnotherUnit: "does not read what it writes",
    NotAsModelled: "of what it reads of a sound arm",
    InMillimetres: "`squared` changes by 1000 mm with 1 mm at the tip; readings are in SI",
    InDegrees: "`heading` changes by .* mrad with a turn of 1 mrad; readings are in SI",
    Untitled: "has no title",
    Unwritten: "without a column",
    TwiceWritten: "column of another kind",
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_kind_that_breaks_the_contract_is_told(what):
    kind, words = what(), BROKEN[what]
    lw.instruments.register(kind)
    try:
        with pytest.raises(lw.InputError, match=words) as told:
            lw.instruments.check(kind)
        assert "\n" not in str(told.value)
    finally:
        lw.instruments.withdraw("squared")

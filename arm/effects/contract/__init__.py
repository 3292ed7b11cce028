"""The contract of every effect, shipped or registered: its entry is complete, and its physics behaves as declared."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import Effect
from linkwright.core.units.quantities import InputError

from .behaviour import behaviour_faults
from .entry import entry_faults
from .torques import torque_faults


def check(effect: Effect) -> None:
    """Raise `InputError` with one line that lists all that is wrong with an effect.

    The entry: words, place, cause, parameters with kinds, bounds, typical sizes and grids, roles that go together,
    aliases that exist. The physics, on four chains in the plane and in space with everything that a recording can hold:
    it moves nothing at sizes of 0, where it cannot act and without what it requires; it is linear where it promises so;
    floats, arrays and CasADi's symbols give the same; all is finite; play is made of intervals and discs; every size
    moves something. Its torques, on a motion of each chain: nothing at sizes of 0 or where it cannot act, linear,
    finite, one array a joint. Takes some tenths of a second. An effect need not be registered.
    """
    faults = entry_faults(effect)
    # What the entry says wrongly makes no sense to try.
    faults = faults or [*behaviour_faults(effect), *torque_faults(effect)]
    if faults:
        raise InputError("", f"effect {effect.id or '?'}", "; ".join(faults))

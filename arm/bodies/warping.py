"""How much stiffer a link is against twisting where its ends hold the warping of its cuts (Vlasov's torsion).

With G J the rigidity of Saint-Venant, E C_w that of warping and k^2 = G J / (E C_w), the twist v along a link under the
torque T(x) obeys G J v' - E C_w v''' = T(x); v' is zero at an end that is held, v'' at one that is free (V. Z. Vlasov,
Thin-walled Elastic Beams, 2nd ed., Jerusalem 1961; W. D. Pilkey, Formulas for Stress, Strain, and Structural Matrices,
2nd ed., Wiley 2005, ch. 14). With a = k L, of the twist T L / (G J) a torque at the far end keeps

    1 - tanh(a) / a (held at its joint alone),   1 - tanh(a/2) / (a/2) (held at both ends),

and an even torque t along the link, whose twist would be t L^2 / (2 G J), keeps
1 - 2 tanh(a) / a + 2 (1 - 1/cosh(a)) / a^2 (held at its joint alone), or the same as one at the far end (held at both).

A joint or flange holds a cut flat; where nothing follows (the tip) a cut is free. For floats, arrays and symbols.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.sections.numeric import exp, is_symbol, sqrt, tanh

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm

_LEAST = 1e-3
"""An `a` below this counts as this: a link then keeps some 3e-7 of its twist."""


@dataclass(frozen=True)
class Warping:
    """Which ends of a link hold the warping of its cuts."""

    at_joint: bool = False
    at_far_end: bool = False


FREE = Warping()
"""Neither end does: Saint-Venant's torsion."""


def warping_of(arm: Arm, index: int) -> Warping:
    """Which ends of a link (from 0) hold its warping: its joint does, but for a sleeve in which it slides; so does what
    follows at its far end, but nothing follows at a tip."""
    if arm.links[index].runs_out:
        return FREE
    last = index == arm.size - 1 or any(branch.end == index + 1 for branch in arm.branches)
    return Warping(at_joint=True, at_far_end=not last)


def is_nothing(value: Any) -> bool:
    """Whether a figure of a section is zero whatever its dimensions: a float, an array of zeros or a constant."""
    if is_symbol(value):
        return bool(value.is_zero())
    return not np.any(np.asarray(value, dtype=float))


def held_torsion(length: Scalar, free: Any, warping_rigidity: Any, warping: Warping) -> tuple[Any, Any]:
    """Torsional rigidity (N*m^2) under a torque at the far end, and how much more an even torque along the link twists
    it than half of that at its end; from `free` (G J, N*m^2) and `warping_rigidity` (E C_w, N*m^4)."""
    if warping == FREE or is_nothing(warping_rigidity) or (isinstance(length, float) and length == 0.0):
        return free, 1.0
    a = sqrt(times(length, length) * free / warping_rigidity + _LEAST**2)
    if warping.at_far_end:
        return free / _kept(0.5 * a), 1.0
    kept = _kept(a)
    even = 2.0 * kept - 1.0 + 2.0 * (1.0 - _over_cosh(a)) / a**2
    return free / kept, even / kept


def _kept(a: Any) -> Any:
    return 1.0 - tanh(a) / a


def _over_cosh(a: Any) -> Any:
    """1 / cosh(a), also where cosh is beyond all numbers."""
    shrunk = exp(-a)
    return 2.0 * shrunk / (1.0 + shrunk * shrunk)

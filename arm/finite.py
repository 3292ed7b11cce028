"""What small displacements and turns leave out where they are not small: the same twists as finite motions.

To first order the twists along a chain add up. As finite motions each carries all that lies beyond it, turned as it has
been turned by those before it: a product of exponentials (R. W. Brockett, in: Mathematical Theory of Networks and
Systems, Springer 1984, 120, doi:10.1007/BFb0031048). For a joint's angle that is exact.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .effects import Twist
from .error import carried_to_tip, rotation_at_tip
from .statics import PoseState
from .vectors import Vector

Array = NDArray[np.float64]


def beyond_first_order(state: PoseState, twists: Iterable[Twist], rows: int) -> tuple[Array, Array]:
    """What finite motions move and turn the tip by beyond the first-order sum of the twists, (rows, 3), m and rad.

    Twists at one node are added up first. `state` holds numbers or arrays of `rows` of them, not symbols.
    """
    given = list(twists)
    moved: dict[tuple[str, int], tuple[Array, Array]] = {}
    for twist in given:
        key = (twist.node, twist.index if twist.node in ("joint", "link") else 0)
        translation, rotation = moved.get(key, (np.zeros((rows, 3)), np.zeros((rows, 3))))
        moved[key] = (translation + _columns(twist.translation, rows), rotation + _columns(twist.rotation, rows))
    place, turned = np.zeros((rows, 3)), np.broadcast_to(np.eye(3), (rows, 3, 3))

    def passed(key: tuple[str, int]) -> None:
        nonlocal place, turned
        if key in moved:
            translation, rotation = moved[key]
            place = place + _turned(turned, translation)
            turned = turned @ Rotation.from_rotvec(rotation).as_matrix()

    def along(vector: Vector) -> None:
        nonlocal place
        own = _columns(vector, rows)
        place = place + _turned(turned, own) - own

    passed(("base", 0))
    for index, link in enumerate(state.links):
        along(state.leads[index])
        passed(("joint", index))
        along(link.vector)
        passed(("link", index))
    along(state.tool)
    passed(("tip", 0))
    turn = Rotation.from_matrix(turned).as_rotvec()
    first = carried_to_tip(state, given), rotation_at_tip(state, given)
    return place - _columns(first[0], rows), turn - _columns(first[1], rows)


def _columns(vector: Vector, rows: int) -> Array:
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (rows,)) for part in vector], axis=1)


def _turned(matrices: Array, vectors: Array) -> Array:
    return np.einsum("nij,nj->ni", matrices, vectors)

"""Whether names are parts of a form that none of them is."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.diagnose.rules.answer_rules import AnswerRules


def balance_each_other(parts: Sequence[tuple[Sequence[int], float]], mismatch: float, *, rules: AnswerRules) -> bool:
    """Whether names at one joint move the tip by far more one by one than is missing.

    Causes that have nothing to do with each other add up in squares, to no more than they explain together.

    Args:
        parts: The joints (from 1) of each name, and how far it moves the tip by itself (RMS, m).
        mismatch: What is left without names (RMS, m).
        rules: How far is far.
    """
    squares: dict[int, float] = {}
    for joints, moved in parts:
        for joint in joints:
            squares[joint] = squares.get(joint, 0.0) + moved**2
    return max(squares.values(), default=0.0) > rules.balanced * mismatch**2

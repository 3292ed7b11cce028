"""Arm files that the program writes, each read back as it is read anywhere."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.read_back import differences
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.materials.catalogue import Catalogue

from .read_back import ReadBack

if TYPE_CHECKING:
    from linkwright.core.arm.evaluation import Evaluation


def arm_file(arm: Arm, catalogue: Catalogue, promised: Evaluation | None = None, *, text: str = "") -> ReadBack:
    """An arm's file, which has to say the same arm when it is read with the same `catalogue`, and one that has the
    figures `promised` of it. `text` is the file where it holds more than the arm, comments for one."""
    return ReadBack(text or arm_to_yaml(arm), partial(_unlike, arm, catalogue, promised))


def _unlike(arm: Arm, catalogue: Catalogue, promised: Evaluation | None, path: Path) -> Iterator[str]:
    back = read_arm(path, catalogue, tip=None if arm.every_tip else arm.tip)
    yield from differences(arm, back)
    if promised is not None:
        from linkwright.core.arm.promised import missed

        yield from missed(promised, back)

"""The arm file that a diagnosis writes, read again: what counts on another recording is the file."""

from __future__ import annotations

import tempfile
from pathlib import Path

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.diagnose.result import Diagnosis


def written(diagnosis: Diagnosis) -> Arm:
    """The corrected arm as `linkwright diagnose --out` writes it, read again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.yaml"
        write_arm(diagnosis.corrected, path)
        return read_arm(path)

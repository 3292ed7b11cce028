"""Every arm file that a diagnosis writes is read back and applied to the recording that it stems from."""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.loads.unknown_weight import unit_weights
from linkwright.core.arm.files.read import arm_from
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.diagnose.answer.sentences import name_of
from linkwright.core.diagnose.predict import residual_under
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.result import Diagnosis, OfRecording, WrittenArm
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.units.reading import Mapping, parse_yaml

from .files import DESIGN


def with_written(found: Diagnosis, catalogue: Catalogue) -> Diagnosis:
    """The diagnosis with what its `arm.yaml` is worth on its own recording, as `linkwright predict` says it: frame and
    tool as the recording declares them, nothing else fitted; of several arms, what each one's own file is worth too."""
    rms = _left(found.corrected, found.recording, catalogue)
    found = replace(found, written=WrittenArm(rms, found.rms_promised, _lacks(found, found.corrected)))
    if not isinstance(found.recording, Several):
        return found
    parts = zip(found.recordings, found.recording.parts(), strict=True)
    return replace(found, recordings=tuple(_with_own(found, one, part, catalogue) for one, part in parts))


def _with_own(found: Diagnosis, one: OfRecording, recording: Recording, catalogue: Catalogue) -> OfRecording:
    """A recording with what the file of its own arm is worth on it."""
    if one.corrected is None:
        return one
    rms = _left(one.corrected, recording, catalogue)
    return replace(one, written=WrittenArm(rms, one.rms_promised, _lacks(found, one.corrected, one.name)))


def _left(arm: Arm, recording: Recording, catalogue: Catalogue) -> float:
    """The RMS (m) that an arm leaves of a recording once it has been written and read back."""
    text = Mapping(parse_yaml(arm_to_yaml(arm), file=DESIGN), file=DESIGN)
    back = arm_from(text, catalogue, tip=arm.tip)
    return rms_length(residual_under(back, recording))


def _lacks(found: Diagnosis, corrected: Arm, own: str = "") -> tuple[str, ...]:
    """What an arm's file cannot carry of what was found in all recordings and in one that is its `own`, in words."""
    held = {(entry.effect, tuple(entry.at)) for entry in corrected.effects}
    regained = found.arm.leave_out - corrected.leave_out
    lost = [
        name_of(each.effect, each.at, each.recording)
        for each in found.findings
        if not (own and each.recording not in ("", own))
        and ((each.recording and not own) or ((each.effect, each.at) not in held and each.effect not in regained))
    ]
    weightless = [
        str(number)
        for number, link in enumerate(corrected.links, start=1)
        if link.section is None and link.mass is None
    ]
    if weightless and not unit_weights(corrected):
        lost.append(f"the weight of link{'s' if len(weightless) > 1 else ''} {', '.join(weightless)}, which is unknown")
    if found.unknown is not None:
        lost.append("what nothing in the library explains")
    return tuple(lost)

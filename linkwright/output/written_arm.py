"""Every arm file that a diagnosis writes is read back and applied to the recording that it stems from."""

from __future__ import annotations

from dataclasses import replace

from arm.effects.loads.unknown_weight import unit_weights
from arm.files.read import arm_from
from arm.files.write import arm_to_yaml
from diagnose.answer.sentences import name_of
from diagnose.predict import residual_under
from diagnose.residual.observed import rms_length
from diagnose.result import Diagnosis, WrittenArm
from materials.catalogue import Catalogue
from units.reading import Mapping, parse_yaml

from .files import DESIGN


def with_written(found: Diagnosis, catalogue: Catalogue) -> Diagnosis:
    """The diagnosis with what its `arm.yaml` is worth on its own recording, as `linkwright predict` says it: frame and
    tool as the recording declares them, nothing else fitted."""
    text = Mapping(parse_yaml(arm_to_yaml(found.corrected), file=DESIGN), file=DESIGN)
    back = arm_from(text, catalogue, tip=found.corrected.tip)
    rms = rms_length(residual_under(back, found.recording))
    return replace(found, written=WrittenArm(rms, found.rms_promised, _lacks(found)))


def _lacks(found: Diagnosis) -> tuple[str, ...]:
    """What the file cannot carry of what was found, in words."""
    held = {(entry.effect, tuple(entry.at)) for entry in found.corrected.effects}
    regained = found.arm.leave_out - found.corrected.leave_out
    lost = [
        name_of(each.effect, each.at, each.recording)
        for each in found.findings
        if each.recording or ((each.effect, each.at) not in held and each.effect not in regained)
    ]
    weightless = [
        str(number)
        for number, link in enumerate(found.corrected.links, start=1)
        if link.section is None and link.mass is None
    ]
    if weightless and not unit_weights(found.corrected):
        lost.append(f"the weight of link{'s' if len(weightless) > 1 else ''} {', '.join(weightless)}, which is unknown")
    if found.unknown is not None:
        lost.append("what nothing in the library explains")
    return tuple(lost)

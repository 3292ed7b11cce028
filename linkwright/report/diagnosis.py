"""The report page of a diagnosis: the plain sentence first, then where it sits, how sure it is, what else it is not."""

from __future__ import annotations

from pathlib import PurePath

from diagnose.result import Diagnosis
from linkwright.diagnosis_words import explained_share, p_words, share_words, verdict_words
from linkwright.redesign import Redesign
from linkwright.words import mm

from . import diagnosis_parts as parts
from .covariates import small_multiples
from .page import page, section, table
from .parts import tiles
from .redesign import redesign_part
from .residual_map import arrow_maps, hover_maps

_WITHOUT = "Without JavaScript the maps to hover over are missing; all else is here. diagnosis.json has the figures."


def diagnosis_page(diagnosis: Diagnosis, redesign: Redesign | None = None) -> str:
    """The page as one HTML file that loads nothing."""
    places, figures = hover_maps(diagnosis)
    body = [tiles(_tiles(diagnosis))]
    if diagnosis.findings:
        body.append(section("What is missing", parts.findings(diagnosis)))
    if diagnosis.unknown is not None:
        lead = "What remains, and what it depends on; nothing here is a cause."
        body.append(section("What nothing in the library explains", parts.unknown(diagnosis.unknown), lead=lead))
    anything = bool(diagnosis.findings) or diagnosis.unknown is not None
    if anything:
        body.append(section("Where it sits", parts.location(diagnosis), parts.dependences(diagnosis)))
    else:
        body += _could_have_shown(diagnosis)
    body.append(section("Residuals over the workspace", arrow_maps(diagnosis), places))
    if diagnosis.ladder:
        lead = "Each model is fitted and then tried on readings that it has not seen."
        body.append(section("The ladder of models", parts.ladder(diagnosis), lead=lead))
    body.append(section("Residuals against what was recorded", small_multiples(diagnosis)))
    if diagnosis.rejected_forms:
        lead = "How much more of the mismatch each would explain, and why it is not named."
        rejected = parts.rejected(diagnosis.rejected_forms)
        body.append(section("Considered and rejected", rejected, lead=lead))
    if anything:
        body += _could_have_shown(diagnosis)
    if diagnosis.next_poses or diagnosis.next_poses_note:
        body.append(section("What to record next", parts.next_poses(diagnosis)))
    if diagnosis.figures:
        lead = "Where the recording has enough visits; the standards ask for thirty (ISO 9283) and five (ISO 230-2)."
        body.append(section("In the words of the standards", parts.standards(diagnosis), lead=lead))
    if redesign is not None:
        body.append(section("The design with the corrected physics", redesign_part(redesign)))
    if anything:
        body.append(section("What to do with it", parts.to_do(diagnosis)))
    body.append(section("Rows set aside", parts.set_aside(diagnosis)))
    body.append(section("Notes", parts.sentences(_notes(diagnosis)), table(("", ""), _asked(diagnosis))))
    return page(f"{diagnosis.arm.name}: what the model leaves out", diagnosis.sentence, body, figures, _WITHOUT)


def _could_have_shown(diagnosis: Diagnosis) -> list[str]:
    """The answer where nothing is missing, a caution elsewhere."""
    if not (diagnosis.detectable or diagnosis.invisible):
        return []
    lead = "The smallest size that this recording would have shown nine times in ten, where it shows least."
    return [section("What this recording could have shown", parts.detectable(diagnosis), lead=lead)]


def _tiles(diagnosis: Diagnosis) -> list[tuple[str, str, str]]:
    entries = [
        ("mismatch", mm(diagnosis.rms_before, 3), f"RMS over {diagnosis.recording.size} readings"),
        ("noise floor", mm(diagnosis.noise_floor, 3), "what repeats scatter by"),
    ]
    if diagnosis.findings or diagnosis.unknown is not None:
        share = explained_share(diagnosis)
        described = "beside the form that fits best" if diagnosis.unknown is not None else ""
        explained = described if share is None else f"{share_words(share)} of the mismatch explained"
        entries.insert(1, ("what remains", mm(diagnosis.rms_after, 3), explained))
        entries.insert(2, ("on readings not fitted", mm(diagnosis.rms_after_held_out, 3), "RMS, held out"))
    gate = f"any mismatch at all: p {p_words(diagnosis.gate_p)}".replace("p < ", "p\u00a0<\u00a0")
    entries.append(("verdict", verdict_words(diagnosis.verdict, short=True), gate))
    return entries


def _notes(diagnosis: Diagnosis) -> list[str]:
    return list(dict.fromkeys((*diagnosis.notes, *diagnosis.null_vectors, *diagnosis.recording.warnings)))


def _asked(diagnosis: Diagnosis) -> list[list[str]]:
    recording, arm = diagnosis.recording, diagnosis.arm
    rows = [
        ["recording", PurePath(recording.file).name],
        ["readings used", str(recording.size)],
        ["measuring frame", recording.frame],
        ["tool", recording.tool],
    ]
    if arm.leave_out:
        rows.append(["left out of the model by the arm file", ", ".join(sorted(arm.leave_out))])
    rows.append(["time taken", f"{diagnosis.seconds:.1f} s"])
    return rows

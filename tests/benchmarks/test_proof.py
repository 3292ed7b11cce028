"""What docs/proof.md says, proved: cases made again, rates known by hand."""

import ast
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks.blind.answers import Answer, rate
from benchmarks.blind.commands import main
from benchmarks.blind.generator.cases import kind_of, make_case
from benchmarks.blind.generator.draws import SINGLES
from benchmarks.blind.generator.files import truth_of, write_case
from benchmarks.blind.generator.mechanics import Arm, Joint, Link
from benchmarks.blind.proof.drawing import power
from benchmarks.blind.proof.figures import confusion, figures
from benchmarks.blind.proof.halves import read_half, sample, shown
from benchmarks.blind.proof.library import true_arm
from benchmarks.blind.proof.model import left
from benchmarks.blind.proof.page import page
from benchmarks.blind.proof.parts import Piece, done
from benchmarks.blind.proof.prediction import direction
from benchmarks.blind.proof.remade import NotTheCaseError, Visit, continued, remade, rng_of, session, table_of
from benchmarks.blind.proof.targets import TARGETS, Cause, causes
from benchmarks.blind.seal import write_seal
from benchmarks.blind.staging import exact

pytestmark = pytest.mark.slow

PACKAGE = Path(__file__).resolve().parents[2] / "benchmarks" / "blind" / "proof"
PROJECT = {"units", "registries", "sections", "materials", "catalogues", "arm", "optimize", "diagnose", "linkwright"}


def test_one_module_uses_the_tool_as_a_library():
    """All the rest asks it by its command line, or not at all."""
    touches = set()
    for path in PACKAGE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            judged = [name for name in names if name != "linkwright.core.executors"]
            touches |= {path.name for name in judged if name.split(".")[0] in PROJECT}
    assert touches == {"model.py"}


# Cases made again


def case_of(effect: str, seed: int = 5, least: float = 4.0):
    """A case with this single effect at a large dose."""
    for index in range(4000):
        kind, number = kind_of(index)
        if kind == "single" and SINGLES[(number // 6 + 5 * number) % len(SINGLES)] == effect and number % 6 >= 4:
            case = make_case(f"{index:05d}", (seed, 0, index), kind, number)
            if case.projected_snr >= least:
                return case
    raise LookupError(effect)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A case with a soft drive on file, and its truth."""
    root = tmp_path_factory.mktemp("half")
    case = case_of("joint_compliance")
    write_case(case, root)
    return case, root / "cases" / case.name, truth_of(case)


def test_case_made_again_is_the_one_on_file(written, tmp_path):
    case, folder, truth = written
    again = remade(truth, folder)
    assert np.array_equal(again.readings, case.readings)
    other = tmp_path / "other"
    other.mkdir()
    text = (folder / "recording.csv").read_text(encoding="utf-8")
    (other / "recording.csv").write_text(text.replace("1", "2", 1), encoding="utf-8")
    with pytest.raises(NotTheCaseError, match="another recording"):
        remade(truth, other)


def test_session_is_where_it_says(written):
    """Inside within the ranges, outside beyond at least one, the unseen payload unseen; the tip exact."""
    case, _, truth = written
    made = session(case, rng_of(truth, 1))
    low, high = case.design.q.min(axis=1)[:, None], case.design.q.max(axis=1)[:, None]
    region = np.array(made.region)
    beyond = ((made.design.q < low - 1e-4) | (made.design.q > high + 1e-4)).any(axis=0)
    assert not beyond[region != "outside"].any()
    assert np.mean(beyond[region == "outside"]) > 0.95  # a grain of the rounding may fall on the edge
    known = set(case.design.payload.tolist())
    assert set(made.design.payload[region != "payload"].tolist()) == known
    assert made.design.payload[region == "payload"].min() == pytest.approx(1.5 * max(known), abs=0.01)
    assert made.tip == pytest.approx(exact(case.arm, made.design, case.effects)[: len(made.tip)])
    assert made.design.time[-1] == pytest.approx(case.design.time[-1], abs=0.1)


def test_continued_recording_keeps_what_was_measured(written):
    case, _, truth = written
    visits = [Visit(tuple(case.design.q[:, 0]), 0.0, -1.0), Visit(tuple(case.design.q[:, 5]), None, 1.0)]
    longer = continued(case, visits, rng_of(truth, 3))
    old, new = case.design.time.size, longer.design.time.size
    repeats = (new - old) // 2
    assert np.array_equal(longer.readings[:, :old], case.readings)
    assert (longer.design.side[:, old:] == np.repeat([[-1.0, 1.0]], repeats, axis=1)).all()
    assert longer.design.payload[old] == 0.0
    assert longer.design.payload[-1] == case.arm.payload
    rest = longer.readings - exact(case.arm, longer.design, case.effects)[: case.readings.shape[0]]
    assert np.sqrt(np.mean(rest[:, old:] ** 2)) < 4.0 * case.tracker.sigma
    assert (np.diff(longer.design.time) > 0.0).all()


# The counterbalance and the tool in space have other axes in the library than in the generator.
@pytest.mark.parametrize("effect", ["joint_compliance", "backlash", "counterbalance", "tool_offset"])
def test_truth_in_the_librarys_words_leaves_little(effect, tmp_path):
    """The tool's model with the true parameters predicts the generator to a tenth of the noise at any pose."""
    case = case_of(effect)
    write_case(case, tmp_path)
    folder = tmp_path / "cases" / case.name
    made = session(case, np.random.default_rng(1), each=12)
    table_of(case, made).to_csv(tmp_path / "recording.csv", index=False)
    true_arm(case, folder, tmp_path / "true.yaml")
    noise = case.tracker.sigma * math.sqrt(len(made.tip))
    before, after = (left(arm, tmp_path / "recording.csv") for arm in (folder / "arm.yaml", tmp_path / "true.yaml"))
    assert np.sqrt(np.mean(np.sum(before**2, axis=1))) > 2.0 * noise
    assert np.sqrt(np.mean(np.sum(after**2, axis=1))) < 0.1 * noise


def test_direction_of_a_stretched_link_is_outward():
    """One link, longer than the file says: radial; its encoder off: tangential."""
    case = case_of("link_length")
    link = Link(0.5, (1, 0, 0), 2.0)
    one = Arm("one", "one", (Joint(False, (0, 0, 1)),), (link,), (0, -9.81, 0), 1.0, True)
    q, known = case.design.q[:1], replace(case.design, frame_free=False)
    alone = replace(known, q=q, side=known.side[:1], speed=known.speed[:1])
    length, offset = (case_of(name).effects[0] for name in ("link_length", "encoder_offset"))
    bare = replace(case, arm=one, design=alone)
    assert direction(replace(bare, effects=(replace(length, at=(1,)),))) == "radial"
    assert direction(replace(bare, effects=(replace(offset, at=(1,)),))) == "tangential"


# Parts kept on file


def half_of_it(number: int, base: int) -> dict[str, float]:
    """A piece of work that fails at 3."""
    if number == 3:
        raise ValueError("three")
    return {"half": number / base}


def test_parts_are_kept_and_failures_tried_again(tmp_path):
    pieces = [Piece(str(k), "key", (k, 2)) for k in range(4)]
    first = done("halves", half_of_it, pieces, tmp_path, 1)
    assert first["2"] == {"half": 1.0}
    assert "three" in first["3"]["failed"]
    changed = [Piece(str(k), "key" if k else "new", (k, 4)) for k in range(3)]
    second = done("halves", half_of_it, changed, tmp_path, 1)
    assert second == {"0": {"half": 0.0}, "1": {"half": 0.5}, "2": {"half": 1.0}}


# Figures and page, from truths and answers with rates known by hand


def a_truth(name: str, kind: str, effect: str = "", at: tuple[int, ...] = (), snr: float = 1.0, **more) -> dict:
    effects = [{"effect": effect, "at": list(at), "parameters": {}, "aliases": []}] if effect else []
    return {
        "case": name,
        "seed": [1, 0, 7],
        "kind": kind,
        "arm": "planar_3r",
        "design": "full",
        "effects": effects,
        "projected_snr": snr,
        "effect_snr": [snr],
        "snr_beyond_library": None,
        "noise_rms_mm": 0.02,
        "since_s": None,
        "aliases": [],
        "aliases_given_geometry": [],
        "visible": bool(effect),
        "hostility": [],
        **more,
    }


def an_answer(verdict: str, *names: tuple[str, list[int]], others: tuple = ()) -> dict:
    missing = [{"effect": e, "at": at, "alternatives": [list(o) for o in others], "parameters": {}} for e, at in names]
    keys = {"noise_floor_mm": 0.02, "rms_after_held_out_mm": 0.02, "where": {"joint": 2, "direction": "radial"}}
    return {"verdict": verdict, "missing": missing, "next_poses": [], **keys}


@pytest.fixture
def small(tmp_path):
    """Ten nulls, one alarm; four soft drives: right, by its alternative, wrong, silent; one slip, called unknown."""
    soft = ("joint_compliance", [2])
    rows = [(a_truth(f"{k:05d}", "null"), an_answer("none")) for k in range(10)]
    rows[3] = (rows[3][0], an_answer("named", soft))
    said = (
        an_answer("named", soft),
        an_answer("alias_class", ("servo_droop", [2]), others=(soft,)),
        an_answer("named", ("backlash", [2])),
        an_answer("none"),
    )
    rows += [(a_truth(f"{10 + k:05d}", "single", "joint_compliance", (2,)), item) for k, item in enumerate(said)]
    rows.append((a_truth("00014", "outside", "slip", (2,), snr_beyond_library=1.0, since_s=5.0), an_answer("unknown")))
    for truth, answer in rows:
        name = truth["case"]
        (tmp_path / "half" / "cases" / name).mkdir(parents=True)
        for folder in ("half/truth", "answers"):
            (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / "half" / "truth" / f"{name}.json").write_text(json.dumps(truth))
        record = {"case": name, "status": 0, "seconds": 1.0, "error": "", "diagnosis": answer}
        (tmp_path / "answers" / f"{name}.json").write_text(json.dumps(record))
    write_seal(tmp_path / "half", "disclosed")
    return read_half(tmp_path / "half", tmp_path / "answers")


def parts_of() -> dict:
    """Results of all parts with known figures, one of them failed."""

    def ratios(x):
        return {"inside": x, "outside": 2.0 * x, "payload": None}

    ways = {"model as given": ratios(2.0), "linkwright": ratios(0.0), "true parameters": ratios(0.3)}
    predicted = {
        case: {
            "ratios": ways,
            "direction": "radial" if case != "00013" else "tangential",
        }
        for case in ("00010", "00011", "00012", "00013")
    }

    def asked(*names, verdict="named", others=()):
        answer = an_answer(verdict, *names, others=others)
        return {"status": 0, "seconds": 1.0, "diagnosis": answer, "error": ""}

    soft = ("joint_compliance", [2])
    poses = {
        "00011": {
            "poses": 6,
            "designed": asked(soft),
            "random": asked(("servo_droop", [2]), verdict="alias_class", others=(soft,)),
        }
    }
    return {
        "prediction": predicted,
        "next_poses": poses | {"00009": {"failed": "ValueError: no"}},
    }


def test_figures_count_what_they_say(small):
    result = figures(small, parts_of())
    ways = {prediction.way: prediction for prediction in result.predictions}
    assert ways["true parameters"].whole[0].median == pytest.approx(math.sqrt(1.09))
    assert ways["true parameters"].whole[0].within == 1.0
    assert ways["true parameters"].whole[1].within == 0.0
    assert ways["linkwright, rightly named"].whole[0].count == 2
    assert ways["model as given"].error[2].count == 0
    assert (result.direction.count, result.direction.total) == (3, 4)
    designed, chance = result.poses
    assert result.promised == ()
    assert (designed.resolved.count, chance.stayed.count) == (1, 1)
    assert result.posed == (1, 1)
    assert result.failed == 1
    assert dict(result.confusion)["joint_compliance"] == (("joint_compliance", 2), ("backlash", 1), ("none", 1))
    assert dict(result.confusion)["slip"] == (("unknown", 1),)


def test_page_prints_a_miss_as_a_miss(small):
    result = figures(small, parts_of())
    text = page([(small, result)], {"false_alarms": Cause("Too few draws.", "12 %")})
    line = next(line for line in text.splitlines() if line.startswith("| false alarms |"))
    assert "**MISSED** 10.0 % (1/10;" in line
    assert "- **false alarms**: Too few draws." in text
    assert "- false alarms, before: 12 %" in text
    assert "| unknown physics called unknown, from 1 on | >= 95 % | 100.0 % (1/1;" in text
    assert "| class named at 1 | 50 % (2/4)" not in text
    assert "| class named | 50 % (2/4) |" in text
    assert "The sealed half is not in this report." in text
    assert "| joint compliance | 4 | backlash 1, none 1 |" in text


def test_targets_are_judged_by_their_figures(small):
    result = figures(small, parts_of())
    met = {target.key: target.met([(small, result)], 0) for target in TARGETS}
    assert met["false_alarms"] is False
    assert met["unknown"] is True
    assert met["class_at_two"] is None
    assert met["inside"] is True
    assert met["nulls"] is False
    enough = next(target for target in TARGETS if target.key == "nulls")
    assert enough.met([(small, result)] * 60, 0) is True
    assert set(causes()) <= set(met)


def test_cause_of_no_target_is_an_error(tmp_path):
    (tmp_path / "causes.yaml").write_text("luck: {why: bad}\n", encoding="utf-8")
    with pytest.raises(ValueError, match="luck"):
        causes(tmp_path / "causes.yaml")


def test_samples_are_seeded_and_within_what_is_wanted(small):
    drawn = sample(small, 2, lambda t, _: shown(t, ("single",), 0.9))
    assert drawn == sample(small, 2, lambda t, _: shown(t, ("single",), 0.9))
    assert len(drawn) == 2
    assert all(t["kind"] == "single" for t in drawn)
    assert sample(small, 2, lambda t, _: shown(t, ("single",), 2.0)) == []


def test_pictures_hold_their_figures():
    curve = [(0.5, rate([True, False])), (1.0, rate([True] * 3))]
    drawn = power({"class named, disclosed": curve}, [(1.0, 0.95)])
    assert drawn.count('r="3.5"') == 2
    assert "projected signal over noise" in drawn


def test_confusion_leaves_small_ones_out():
    truth = a_truth("x", "single", "backlash", (1,), snr=0.4)
    assert confusion([truth], {"x": Answer("x", 0, 1.0, an_answer("none"))}) == ()


# Commands


def test_remake_records_anew_and_sealed_truths_stay_shut(written, tmp_path, capsys):
    case, folder, _ = written
    root = folder.parents[1]
    write_seal(root, "disclosed")
    out = tmp_path / "new.csv"
    assert main(["remake", str(root), case.name, "--out", str(out)]) == 0
    assert "outside: " in capsys.readouterr().out
    assert len(pd.read_csv(out)) > 40
    write_seal(root, "sealed")
    assert main(["remake", str(root), case.name, "--out", str(out)]) == 2
    assert "shut until they are scored" in capsys.readouterr().err


def test_publish_without_a_half_is_an_error(tmp_path, capsys):
    assert main(["publish", "--work", str(tmp_path), "--docs", str(tmp_path)]) == 2
    assert "at least one half" in capsys.readouterr().err

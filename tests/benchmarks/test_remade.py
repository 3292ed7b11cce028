"""Cases of the proof made again from their seeds, and recorded anew at other poses."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.blind.commands import main
from benchmarks.blind.generator.cases import kind_of, make_case
from benchmarks.blind.generator.draws import SINGLES
from benchmarks.blind.generator.files import truth_of, write_case
from benchmarks.blind.remade import NotTheCaseError, remade, rng_of, session
from benchmarks.blind.seal import write_seal
from benchmarks.blind.staging import exact

pytestmark = pytest.mark.slow


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

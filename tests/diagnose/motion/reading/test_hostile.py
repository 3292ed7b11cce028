"""Whatever a motion log's file holds: a log, or one line that says what is wrong, never a traceback."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from linkwright.core.diagnose.columns.proposed_file import Proposal, propose
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.reading.read import is_motion_log, logs_from, read_log
from linkwright.core.diagnose.reading.files import table_of
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.units.quantities import InputError
from tests.diagnose.motion.reading.test_conventions import arm, motion
from tests.diagnose.motion.reading.test_other_files import EXPORTS, states
from tests.diagnose.reading.bags_written import write_bag, write_mcap

CELLS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from(["", "nan", "1e282", "-", "1,5", "x", "'", "`", "\N{MINUS SIGN}1", "0x1", "1_0", "9" * 400]),
    st.text(max_size=6),
)
HEADERS = st.one_of(
    st.sampled_from([*EXPORTS["ur"], *EXPORTS["franka"], *EXPORTS["stamps"], *EXPORTS["plotjuggler"], *motion()]),
    st.sampled_from(
        ["q0_rad", "q999_deg", "tau1_", "current1_A", "t_s", "position[99]", "/a//position", "[0]", "x[", "q[]"]
    ),
    st.text(max_size=12),
)


def one_line(read) -> str:
    """What is said of a file: nothing where it is read, and then every sample of a log is a number at its own time, and
    a proposal has a column for each of the file's, and one line where it could not be read with them; else one line."""
    try:
        result = read()
    except InputError as error:
        said = str(error)
        assert said.strip()
        assert "\n" not in said
        return said
    if isinstance(result, MotionLog):
        assert result.size > 0
        assert np.isfinite(result.q).all()
        assert (np.diff(result.time) > 0.0).all()
        assert not np.isinf(result.torque).any()
    elif isinstance(result, Proposal):
        assert result.meanings
        assert "\n" not in result.wrong
    else:
        assert isinstance(result, bool)
    return ""


@settings(max_examples=150, deadline=None)
@given(
    names=st.lists(HEADERS, min_size=1, max_size=9),
    cells=st.lists(CELLS, min_size=1, max_size=30),
    rows=st.integers(1, 40),
)
def test_tables(names, cells, rows):
    """Any headers over any cells."""
    values = {name: [cells[(k + 7 * j) % len(cells)] for k in range(rows)] for j, name in enumerate(names)}
    frame = pd.DataFrame(values, dtype=object)
    one_line(lambda: logs_from([(table_of(frame, "DataFrame"), ReadingSettings())], arm())[0])


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_logs_with_cells_of_anything(data):
    """A good log with some cells replaced, columns dropped or repeated in others."""
    columns = {name: values[:120].astype(object) for name, values in motion().items()}
    changes = data.draw(st.integers(0, 6))
    for _ in range(changes):
        name, row = data.draw(st.sampled_from(list(columns))), data.draw(st.integers(0, 119))
        columns[name][row : row + data.draw(st.integers(1, 60))] = data.draw(CELLS)
    dropped = data.draw(st.lists(st.sampled_from(list(columns)), max_size=2, unique=True))
    frame = pd.DataFrame({name: values for name, values in columns.items() if name not in dropped})
    said = one_line(lambda: logs_from([(table_of(frame, "DataFrame"), ReadingSettings())], arm())[0])
    joints = [name for name in dropped if name.startswith("q")]
    assert bool(said) >= bool(joints), "a joint that was not logged is no log of this arm"
    assert not said or changes or dropped


@pytest.mark.parametrize("apart", [0.0, 7.9e-158, 1e-9])
def test_stamps_nearer_than_those_of_any_log_are_one(apart):
    """Else joints went at speeds whose square is no number."""
    columns = {name: values[:120].copy() for name, values in motion().items()}
    columns["t_s"][1] = columns["t_s"][0] + apart
    log = logs_from([(table_of(pd.DataFrame(columns), "DataFrame"), ReadingSettings())], arm())[0]
    assert [item.row for item in log.rejected] == [2]


def a_bag(kind: str) -> tuple[str, bytes]:
    """The name and the content of a small bag of a kind."""
    with tempfile.TemporaryDirectory() as folder:
        root, few = Path(folder), states()[:60]
        if kind == "mcap":
            return "log.mcap", write_mcap(root / "log.mcap", few).read_bytes()
        messages = {"/joint_states": [(t, names, p, e) for t, names, p, _, e in few]}
        if kind == "ros1":
            return "log.bag", write_bag(root / "log.bag", messages, ros=1).read_bytes()
        return "log.db3", next(write_bag(root / "log", messages).glob("*.db3")).read_bytes()


BAGS = {kind: a_bag(kind) for kind in ("mcap", "ros1", "ros2")}


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(kind=st.sampled_from(sorted(BAGS)), data=st.data())
def test_damaged_bags(kind, data):
    """Bytes turned, cut out, or cut off."""
    name, content = BAGS[kind]
    damaged = bytearray(content)
    for _ in range(data.draw(st.integers(1, 8))):
        place = data.draw(st.integers(0, len(damaged) - 1))
        damaged[place : place + data.draw(st.integers(0, 9))] = data.draw(st.binary(max_size=9))
    damaged = damaged[: data.draw(st.integers(1, len(damaged)))] if data.draw(st.booleans()) else damaged
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(bytes(damaged))
        one_line(lambda: is_motion_log(path, arm()))
        one_line(lambda: read_log(path, arm()))


@settings(max_examples=60, deadline=None)
@given(content=st.binary(max_size=300), ending=st.sampled_from(["csv", "parquet", "xlsx", "mcap", "bag", "db3"]))
def test_files_of_anything(content, ending):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"log.{ending}"
        path.write_bytes(content)
        one_line(lambda: read_log(path, arm()))
        one_line(lambda: propose(path, arm()))
        one_line(lambda: propose(path, None))


def test_numbers_beyond_all_measure():
    """Angles of 1e282 in every row of a joint: it holds no numbers."""
    columns = motion() | {"q1_rad": np.full(2000, 1e282)}
    said = one_line(lambda: logs_from([(table_of(pd.DataFrame(columns), "DataFrame"), ReadingSettings())], arm())[0])
    assert said.startswith("DataFrame: q1_rad: holds no numbers in most samples")

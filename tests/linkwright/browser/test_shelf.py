"""What is kept, and what is said where it cannot be: a base locked, full, gone, garbled, or written by others."""

import asyncio
import os
import resource
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.browser.server.folder import Folder
from linkwright.browser.server.jobs import Jobs
from linkwright.browser.server.shelf import Kept, Shelf
from linkwright.core.units.quantities import InputError

SCRIPT = b"".join(b"%06d." % number for number in range(60_000))
"""420 kB that hardly compress, as plotly in a report."""


def page_with(text):
    return b"<html><script>" + SCRIPT + b"</script><p>" + text + b"</p></html>"


def keep(shelf, **files):
    results = {name.replace("_", "."): content for name, content in files.items()}
    return shelf.keep("evaluate", "an arm", "a line", results, complete=True, seconds=1.0)


@pytest.mark.parametrize("look", [Shelf.all, Shelf.runs, lambda shelf: shelf.find(1), lambda shelf: shelf.file(1, "a")])
def test_a_locked_base_says_so(tmp_path, look):
    """It is sound, so nobody is told to move it away."""
    shelf = Shelf(tmp_path)
    with closing(sqlite3.connect(shelf.path, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        with pytest.raises(InputError, match="is locked by another program"):
            look(shelf)
    look(shelf)


def test_a_full_disk_says_so(tmp_path):
    """A limit on the size of files stands for it; what was kept before stays."""
    shelf = Shelf(tmp_path)
    number = keep(shelf, arm_yaml=b"chain")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (shelf.size() + 8192, hard))
    try:
        with pytest.raises(InputError, match=r"full|room") as refused:
            keep(shelf, report_html=page_with(b""))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "move it away" not in str(refused.value)
    assert shelf.file(number, "arm.yaml") == b"chain"
    assert len(shelf.all()) == 1


def test_a_base_that_was_taken_away_is_made_anew(tmp_path):
    """While the server runs."""
    shelf = Shelf(tmp_path)
    shelf.path.unlink()
    number = keep(shelf, arm_yaml=b"chain")
    assert [item.id for item in shelf.all()] == [number]


def test_a_garbled_base_is_one_line(tmp_path):
    shelf = Shelf(tmp_path)
    shelf.path.write_bytes(b"something else" * 1000)
    with pytest.raises(InputError, match="move it away, and a new one is made"):
        keep(shelf)


def test_rows_of_others_are_shown_or_refused_in_a_line(tmp_path):
    """Content that is no zlib, words where numbers are due, bytes that are no text: the other results stay."""
    shelf = Shelf(tmp_path)
    number = keep(shelf, arm_yaml=b"chain", poses_json=b"[]")
    with closing(sqlite3.connect(shelf.path)) as base, base:
        base.execute("UPDATE files SET content = 'no zlib' WHERE name = 'arm.yaml'")
        base.execute("UPDATE files SET content = x'0102' WHERE name = 'poses.json'")
        base.execute(
            "INSERT INTO results (made, kind, title, line, complete, seconds) "
            "VALUES ('then', 1, CAST(x'ff' AS TEXT), 'x', 'yes', 'long')"
        )
    for name in ("arm.yaml", "poses.json"):
        with pytest.raises(InputError, match=f"{name} of result {number}: is damaged"):
            shelf.file(number, name)
    assert [item.id for item in shelf.all()] == [number + 1, number]
    for none in (10**30, -1, 2**63):
        assert shelf.find(none) is None
        assert shelf.names(none) == []
        assert shelf.file(none, "arm.yaml") is None


def test_a_script_is_kept_once(tmp_path):
    """Of two reports the second takes its own text; it reads back to the last byte, also once the first is removed."""
    shelf = Shelf(tmp_path)
    empty = shelf.size()
    first = keep(shelf, report_html=page_with(b"one"))
    alone = shelf.size()
    second = keep(shelf, report_html=page_with(b"two"))
    assert shelf.size() < 1.1 * alone
    shelf.remove(first)
    assert shelf.file(second, "report.html") == page_with(b"two")
    shelf.remove_all()
    assert shelf.all() == []
    assert shelf.size() == empty


@settings(max_examples=30)
@given(st.lists(st.one_of(st.binary(max_size=20), st.just(page_with(b"x")), st.just(b"<script>")), max_size=6))
def test_pages_read_back_as_they_were(tmp_path_factory, pieces):
    shelf = Shelf(tmp_path_factory.mktemp("shelf"))
    content = b"".join(pieces)
    assert shelf.file(keep(shelf, report_html=content), "report.html") == content


def test_what_a_kill_cut_off_is_listed(tmp_path):
    """By a process that is gone, or that had this one's number; not what another server is at, nor what is done."""
    shelf = Shelf(tmp_path)
    host = Jobs(shelf)._name.partition(" on ")[2]
    gone = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, check=True)
    cut = [shelf.begin("optimize", "a problem", f"{pid} on {host}") for pid in (int(gone.stdout), os.getpid())]
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        shelf.begin("optimize", "elsewhere", f"{other.pid} on {host}")
        done = shelf.begin("optimize", "done", f"{os.getpid()} on {host}")
        shelf.keep("optimize", "done", "found", {}, complete=True, seconds=1.0, run=done)
        assert sorted(item.id for item in Jobs(shelf).cut_off()) == cut
        other.communicate(b"\n")


ARM = """\
chain:
  - joint: {range: [0 deg, 90 deg], stiffness: 5 kN*m/rad, mass: 1 kg}
    link: {length: 300 mm, section: {shape: tube, diameter: 40 mm, thickness: 3 mm}, material: steel-s355}
payload: {mass: 1 kg}
"""


async def ended(jobs, *, killed=False):
    """A job that evaluates an arm, once it is at its end."""
    job = jobs.start("evaluate", "an arm", {"arm.yaml": ARM.encode()}, {"arm": "arm.yaml"})
    while job.state == "running":
        if killed and job.process is not None and job.process.returncode is None:
            os.kill(job.process.pid, signal.SIGKILL)
        await asyncio.sleep(0.02)
    return job


def test_a_worker_that_is_killed_says_so(tmp_path):
    """Nobody here asked for it, so the system did."""
    shelf = Shelf(tmp_path)
    job = asyncio.run(ended(Jobs(shelf), killed=True))
    assert job.state == "refused"
    assert "killed by the system, most likely for want of memory" in job.message
    assert shelf.runs() == []


@pytest.fixture
def deaf():
    """A server that a script began in the background: it ignores interrupts, and so do its processes."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    "ready",
    [lambda _: True, lambda job: job.process is not None, lambda job: job.begun],
    ids=["at once", "made", "begun"],
)
@pytest.mark.usefixtures("deaf")
def test_what_is_stopped_before_anything_was_found_says_which_it_was(tmp_path, ready):
    """Every tab hears of it, those too that did not begin it."""

    async def stopped(jobs):
        job = jobs.start("evaluate", "an arm", {"arm.yaml": ARM.encode()}, {"arm": "arm.yaml"})
        while not ready(job):
            await asyncio.sleep(0.01)
        job.stop()
        while job.state == "running":
            await asyncio.sleep(0.02)
        return job

    job = asyncio.run(stopped(Jobs(Shelf(tmp_path))))
    assert job.state == "refused"
    assert job.message == ("Evaluation of an arm was stopped before anything was finished, so there is nothing to keep")


def test_an_answer_that_cannot_be_kept_is_there_and_can_be_kept_again(tmp_path):
    """The base is garbled while it is computed; its files stay until it is kept."""
    shelf = Shelf(tmp_path)
    jobs = Jobs(shelf)
    sound = shelf.path.read_bytes()
    shelf.path.write_bytes(b"something else" * 1000)

    async def flow():
        job = await ended(jobs)
        assert job.state == "unkept"
        assert "move it away" in job.message
        assert job.answer.startswith("Worst position error")
        report = (job.left / "out" / "report.html").read_bytes()
        await jobs.keep(job)
        assert job.state == "unkept"
        shelf.path.write_bytes(sound)
        await jobs.keep(job)
        assert job.state == "done"
        assert job.left is None
        return job, report

    job, report = asyncio.run(flow())
    assert shelf.find(job.result).line == job.answer
    assert shelf.file(job.result, "report.html") == report
    assert jobs.unkept == []


def test_no_file_is_written_over_unseen(tmp_path):
    """Not one that changed since it was read, not one of that name that was never read."""
    folder = Folder(tmp_path)
    (tmp_path / "arm.yaml").write_text("chain: 1\npayload: 2\n", encoding="utf-8")
    known = folder.read("arm.yaml")
    folder.write("arm.yaml", "chain: 3\n", known=known)
    (tmp_path / "arm.yaml").write_text("chain: 3\npayload: 4\n", encoding="utf-8")
    with pytest.raises(InputError, match="was changed by another program from line 2 on"):
        folder.write("arm.yaml", "chain: 5\n", known="chain: 3\n")
    with pytest.raises(InputError, match="is there already"):
        folder.write("arm.yaml", "chain: 5\n")
    assert folder.read("arm.yaml") == "chain: 3\npayload: 4\n"
    folder.write("arm.yaml", "chain: 5\n", whatever=True)
    assert folder.read("arm.yaml") == "chain: 5\n"


@given(st.lists(st.from_regex(r"[A-Z][a-z0-9. ]{0,80}mm\.", fullmatch=True), min_size=1, max_size=6))
def test_a_long_answer_has_a_head(sentences):
    """Whole sentences, as many as there is room for; the rest follows, and no word is lost."""
    kept = Kept(1, "", "optimize", "", " ".join(sentences), complete=True, seconds=1.0)
    assert f"{kept.head} {kept.rest}".strip() == kept.line
    assert kept.head.endswith("mm.")
    assert kept.rest == "" or kept.rest[0].isupper()
    assert len(kept.head) <= max(160, len(sentences[0]))

"""Jobs: long computations in processes of their own, with progress, a stop and stored results."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import signal
import socket
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from linkwright.core.units.quantities import InputError

from .asked import ASKED, Asked, asked_of
from .folder import put
from .shelf import Run, Shelf

State = Literal["running", "done", "unkept", "refused"]
MOST_AT_ONCE = 3
_LINES = 400
_LONGEST_LINE = 1024 * 1024
_PATIENCE = 10.0
"""Seconds that work which is to end is given to leave its best so far."""


_NOUNS: Mapping[str, str] = MappingProxyType(
    {"evaluate": "Evaluation", "optimize": "Optimisation", "tradeoff": "Trade-off", "diagnose": "Diagnosis"}
)


def noun(kind: str) -> str:
    """What a kind of job is called."""
    return _NOUNS.get(kind, kind)


@dataclass(eq=False)
class Job:
    """One piece of work: what it is, how far it is, what came of it.

    `answer` is the line that says the result, known before its files are written; `result` is its number on the
    shelf. Where it could not be kept it is `unkept`, `message` says why, and its files stay in `left`. `asked` is what
    it answers.
    """

    number: int
    kind: str
    title: str
    began: float = field(default_factory=time.monotonic)
    text: str = "starting"
    share: float = 0.0
    lines: list[str] = field(default_factory=list)
    state: State = "running"
    message: str = ""
    answer: str = ""
    complete: bool = True
    took: float = 0.0
    result: int | None = None
    left: Path | None = None
    run: int | None = None
    stopping: bool = False
    begun: bool = False
    """Whether its process was heard of: before, it hears no interrupt and has nothing to leave."""
    process: asyncio.subprocess.Process | None = None
    asked: Asked | None = None

    @property
    def name(self) -> str:
        """Which work it is, for whoever did not begin it."""
        return f"{noun(self.kind)} of {self.title}"

    @property
    def seconds(self) -> float:
        """How long it has been at work."""
        return time.monotonic() - self.began

    def stop(self) -> None:
        """Ask it to end with the best so far; asked again, or before it has begun, it ends at once."""
        at_once = self.stopping or not self.begun
        self.stopping, self.text = True, "stopping"
        if self.process is not None and self.process.returncode is None:
            with suppress(ProcessLookupError):
                if at_once:
                    os.killpg(self.process.pid, signal.SIGKILL)
                else:
                    self.process.send_signal(signal.SIGINT)


class Jobs:
    """The work of a server."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf
        self._all: dict[int, Job] = {}
        self.ended: list[Job] = []
        """What is at its end, the last one last."""
        self._tasks: set[asyncio.Task[None]] = set()
        self._name = f"{os.getpid()} on {socket.gethostname()}"

    @property
    def running(self) -> list[Job]:
        """What is being done."""
        return [job for job in self._all.values() if job.state == "running"]

    @property
    def unkept(self) -> list[Job]:
        """What was found and could not be kept."""
        return [job for job in self._all.values() if job.state == "unkept"]

    def find(self, number: int) -> Job | None:
        """A job by its number."""
        return self._all.get(number)

    def cut_off(self) -> list[Run]:
        """What was begun, here or by another server of this folder, and ended with its server. Raises `InputError`."""
        runs = {job.run for job in self._all.values()}
        return [run for run in self._shelf.runs() if run.id not in runs and not _alive(run.server)]

    def start(self, kind: str, title: str, inputs: Mapping[str, bytes], asked: Mapping[str, Any]) -> Job:
        """Begin; `inputs` are the files that it reads, by name. Raises `InputError` where too much is at work."""
        if len(self.running) >= MOST_AT_ONCE:
            raise InputError("", "", f"{MOST_AT_ONCE} are at work already; stop one of them, or wait")
        job = Job(len(self._all) + 1, kind, title, asked=asked_of(kind, inputs, asked))
        self._all[job.number] = job
        task = asyncio.get_running_loop().create_task(self._done(job, dict(inputs), dict(asked)))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return job

    async def keep(self, job: Job) -> None:
        """Keep what was found and is left in a separate folder; where that fails, it stays there."""
        assert job.left is not None
        try:
            files = await asyncio.to_thread(_files, job.left / "out")
            files |= {} if job.asked is None else {ASKED: job.asked.content()}
            job.result = await asyncio.to_thread(
                self._shelf.keep,
                job.kind,
                job.title,
                job.answer,
                files,
                complete=job.complete,
                seconds=job.took,
                run=job.run,
            )
        except (InputError, OSError) as error:
            job.message, job.state = _said(error), "unkept"
            return
        job.message, job.share, job.state = job.answer, 1.0, "done"
        self._cleared(job)

    async def _done(self, job: Job, inputs: Mapping[str, bytes], request: Mapping[str, Any]) -> None:
        with suppress(InputError):  # a base that cannot be written to now may be by the end
            job.run = await asyncio.to_thread(self._shelf.begin, job.kind, job.title, self._name)
        try:
            job.left = Path(tempfile.mkdtemp(prefix="linkwright-"))
            root, out = job.left / "in", job.left / "out"
            root.mkdir()
            await asyncio.to_thread(put, root, inputs)
            wrong = await self._run_process(job, {**request, "kind": job.kind, "root": str(root), "out": str(out)})
        except (InputError, OSError) as error:
            wrong = _said(error)
        job.took = job.seconds
        if job.answer and not wrong:
            await self.keep(job)
        elif job.answer:
            job.message, job.state = wrong, "unkept"
        else:
            # Who sees a job at its end may end the server, which should then not be told that it was cut off.
            with suppress(InputError):
                await asyncio.to_thread(self._shelf.end, job.run or 0)
            job.message, job.state = wrong, "refused"
            self._cleared(job)
        self.ended.append(job)

    def _cleared(self, job: Job) -> None:
        if job.left is not None:
            shutil.rmtree(job.left, ignore_errors=True)
            job.left = None

    async def _run_process(self, job: Job, request: Mapping[str, Any]) -> str:
        """Run the process and hear it; gives what went wrong, empty where nothing did."""
        # A separate session: Ctrl-C at the terminal is the server's, which passes it on.
        job.process = process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "linkwright.browser.server.work"),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
            limit=_LONGEST_LINE,
        )
        if job.stopping:  # it was stopped while its process was being made
            job.stop()
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        errors = asyncio.create_task(process.stderr.read())
        with suppress(BrokenPipeError, ConnectionResetError):
            process.stdin.write(json.dumps(request).encode())
            await process.stdin.drain()
            process.stdin.close()
        last: dict[str, Any] = {}
        async for line in process.stdout:
            with suppress(json.JSONDecodeError):
                last = json.loads(line)
                _hear(job, last)
        await process.wait()
        message = (await errors).decode(errors="replace").strip()
        if "done" in last:
            return ""
        if "refused" in last:
            return str(last["refused"])
        if job.stopping or "stopped" in last:
            return f"{job.name} was stopped before anything was finished, so there is nothing to keep"
        if process.returncode == -signal.SIGKILL:
            return "was killed by the system, most likely for want of memory; ask for less at once, or give it more"
        return message.splitlines()[-1] if message else f"ended with status {process.returncode}"

    async def end(self) -> None:
        """End all that is at work, with what it has."""
        for job in self.running:
            job.stop()
        if self._tasks:
            await asyncio.wait(set(self._tasks), timeout=_PATIENCE)
        for job in self.running:
            job.stop()
        if self._tasks:
            await asyncio.wait(set(self._tasks), timeout=_PATIENCE)


def _hear(job: Job, event: Mapping[str, Any]) -> None:
    job.begun = True
    if "text" in event and not job.stopping:
        job.text, job.share = str(event["text"]), float(event["share"])
    if "line" in event:
        job.lines.append(str(event["line"]))
        del job.lines[:-_LINES]
    if "answer" in event:
        job.answer, job.complete = str(event["answer"]), bool(event["complete"])


def _alive(server: str) -> bool:
    """Whether the server of a run is at work, as far as can be told: another one, of this machine."""
    process, _, host = server.partition(" on ")
    another = process.isdecimal() and int(process) != os.getpid() and host == socket.gethostname()
    if not another or sys.platform == "win32":
        return False
    try:
        os.kill(int(process), 0)
    except PermissionError:
        return True
    except (OSError, OverflowError):
        return False
    return True


def _said(error: InputError | OSError) -> str:
    if isinstance(error, InputError):
        return str(error)
    return ": ".join(str(part) for part in (error.filename, error.strerror or error) if part)


def _files(out: Path) -> dict[str, bytes]:
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}

"""Results with their files for the pages, running or stored, and the content of files as a browser gets it."""

from __future__ import annotations

import asyncio
import io
import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import ParamSpec, TypeVar
from urllib.parse import quote

from fastapi import FastAPI, Response

from linkwright.browser.server.folder import Folder
from linkwright.browser.server.jobs import Job, Jobs
from linkwright.browser.server.shelf import Kept, Shelf
from linkwright.core.units.quantities import InputError

Given = ParamSpec("Given")
Looked = TypeVar("Looked")


@dataclass(frozen=True)
class Desk:
    """The folder, the results in it, and what is at work."""

    folder: Folder
    shelf: Shelf
    jobs: Jobs
    _readers: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(4, "shelf"))

    async def looked_up(self, look: Callable[Given, Looked], *given: Given.args, **named: Given.kwargs) -> Looked:
        """What a look at the shelf gives. A base that another program holds keeps its threads waiting alone, not
        the pages and not what they draw."""
        return await asyncio.get_running_loop().run_in_executor(self._readers, lambda: look(*given, **named))


@dataclass(frozen=True)
class Answer:
    """The result of a job; `names` lists its files, `file` gives the content of one (None where there is none). Both
    read the disk, and raise `InputError`."""

    place: str
    number: int
    names: Callable[[], list[str]]
    file: Callable[[str], bytes | None]

    def address(self, name: str) -> str:
        """Where a file is to be had."""
        return f"/{self.place}/{self.number}/{quote(name)}"


def on_shelf(shelf: Shelf, number: int) -> Answer:
    """A result that is kept."""
    return Answer("kept", number, lambda: shelf.names(number), lambda name: shelf.file(number, name))


def left_behind(job: Job) -> Answer:
    """The answer of a job that could not be kept."""

    def names() -> list[str]:
        root = None if job.left is None else job.left / "out"
        return [] if root is None else sorted(p.relative_to(root).as_posix() for p in root.rglob("*") if p.is_file())

    def file(name: str) -> bytes | None:
        if job.left is None or name not in names():
            return None
        try:
            return (job.left / "out" / name).read_bytes()
        except OSError as error:
            raise InputError(name, "", f"cannot be read: {error.strerror or error}") from None

    return Answer("left", job.number, names, file)


def as_kept(job: Job) -> Kept:
    """What the shelf would say of a job."""
    made = datetime.now(UTC).isoformat(sep=" ", timespec="seconds").removesuffix("+00:00")
    return Kept(job.number, made, job.kind, job.title, job.answer, job.complete, job.took)


_SANDBOX = (
    "sandbox allow-scripts allow-downloads allow-modals; default-src 'none'; script-src 'unsafe-inline' blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:"
)
"""A report runs its script and reaches nothing, neither these pages nor the network; it may hand over and print
pictures."""


def add_files(app: FastAPI, desk: Desk) -> None:
    """Add the addresses of files: /kept/NUMBER/NAME, and with ?view to look at; /kept/NUMBER/ of all of them, packed;
    /left/NUMBER/NAME of what could not be kept."""

    def kept(number: int, name: str, view: bool = False) -> Response:
        return _sent(number, name, on_shelf(desk.shelf, number).file, view)

    def left(number: int, name: str, view: bool = False) -> Response:
        job = desk.jobs.find(number)
        return _sent(number, name, lambda name: None if job is None else left_behind(job).file(name), view)

    def bundle(number: int) -> Response:
        """All files of a result."""
        answer, packed = on_shelf(desk.shelf, number), io.BytesIO()
        try:
            with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as made:
                for name in answer.names():
                    made.writestr(name, answer.file(name) or b"")
        except InputError as error:
            return Response(f"{error}\n", 503, media_type="text/plain")
        return _sent(number, "linkwright.zip", lambda _: packed.getvalue(), view=False)

    app.add_api_route("/kept/{number}/", bundle, methods=["GET"])
    app.add_api_route("/kept/{number}/{name:path}", kept, methods=["GET"])
    app.add_api_route("/left/{number}/{name:path}", left, methods=["GET"])


def _sent(number: int, name: str, read: Callable[[str], bytes | None], view: bool) -> Response:
    try:
        content = read(name)
    except InputError as error:
        return Response(f"{error}\n", 503, media_type="text/plain")
    if content is None:
        return Response("there is no such file\n", 404, media_type="text/plain")
    if view and name.endswith(".html"):
        return Response(content, media_type="text/html", headers={"content-security-policy": _SANDBOX})
    plain = "".join(item if item.isascii() and (item.isalnum() or item in "._-") else "-" for item in name)
    headers = {
        "content-disposition": f'attachment; filename="{number}-{plain}"',
        "content-security-policy": _SANDBOX,
    }
    return Response(content, media_type="application/octet-stream", headers=headers)

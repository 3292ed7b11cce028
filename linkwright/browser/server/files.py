"""The files of results, as a browser gets them: reports to look at in a sandbox, all others to download."""

from __future__ import annotations

from collections.abc import Callable

from fastapi import FastAPI, Response

from linkwright.core.units.quantities import InputError

from .answers import left_behind, on_shelf
from .desk import Desk

_SANDBOX = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline' blob:; style-src 'unsafe-inline'; "
    "img-src data: blob:"
)
"""A report runs its own script and reaches nothing: neither these pages nor the network."""


def add_files(app: FastAPI, desk: Desk) -> None:
    """Add the addresses of files: /kept/NUMBER/NAME, and with ?view to look at; /left/NUMBER/NAME of what could not be
    kept."""

    def kept(number: int, name: str, view: bool = False) -> Response:
        return _sent(number, name, on_shelf(desk.shelf, number).file, view)

    def left(number: int, name: str, view: bool = False) -> Response:
        job = desk.jobs.find(number)
        return _sent(number, name, lambda name: None if job is None else left_behind(job).file(name), view)

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
    plain = "".join(each if each.isascii() and (each.isalnum() or each in "._-") else "-" for each in name)
    headers = {
        "content-disposition": f'attachment; filename="{number}-{plain}"',
        "content-security-policy": _SANDBOX,
    }
    return Response(content, media_type="application/octet-stream", headers=headers)

"""The files of results, as a browser gets them: reports to look at in a sandbox, all others to download."""

from __future__ import annotations

from fastapi import FastAPI, Response

from .shelf import Shelf

_SANDBOX = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline' blob:; style-src 'unsafe-inline'; "
    "img-src data: blob:"
)
"""A report runs its own script and reaches nothing: neither these pages nor the network."""


def add_files(app: FastAPI, shelf: Shelf) -> None:
    """Add the addresses of files: /kept/NUMBER/NAME, and with ?view to look at."""

    def kept(number: int, name: str, view: bool = False) -> Response:
        content = shelf.file(number, name)
        if content is None:
            return Response("there is no such file\n", 404, media_type="text/plain")
        if view and name.endswith(".html"):
            return Response(content, media_type="text/html", headers={"content-security-policy": _SANDBOX})
        plain = "".join(letter if letter.isalnum() or letter in "._-" else "-" for letter in name.replace("/", "-"))
        headers = {
            "content-disposition": f'attachment; filename="{number}-{plain}"',
            "content-security-policy": _SANDBOX,
        }
        return Response(content, media_type="application/octet-stream", headers=headers)

    app.add_api_route("/kept/{number}/{name:path}", kept, methods=["GET"])

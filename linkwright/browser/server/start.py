"""The server: an address to listen at, the guard before the pages, Ctrl-C as its end."""

from __future__ import annotations

import errno
import ipaddress
import secrets
import socket
import threading
import webbrowser
from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import uvicorn
from fastapi import FastAPI
from nicegui import app as pages
from nicegui import ui

from linkwright.browser.pages.site import add_pages
from linkwright.browser.server.answers import Desk, add_files
from linkwright.browser.server.guard import PagePolicy
from linkwright.core.units.quantities import InputError

from .folder import Folder
from .guard import Guard
from .jobs import Jobs
from .shelf import Shelf

_LOOPBACK = ("127.0.0.1", "localhost", "::1")


def serve(
    folder: Path, *, host: str, port: int, token: str, announce: Callable[[str], None], open_it: bool = False
) -> None:
    """Serve a folder until an interrupt. `announce` hears the lines to show: where it is, what it serves.

    Beyond this machine a token is due, which is made up where none is given. Raises `InputError` for a folder, a host
    or a port that cannot be used.
    """
    served = Folder(folder)
    shelf = Shelf(served.root)
    desk = Desk(served, shelf, Jobs(shelf))
    with _listening(host, port) as listening:
        bound: int = listening.getsockname()[1]
        address: str = listening.getsockname()[0]
        here = ipaddress.ip_address(address).is_loopback
        anywhere = ipaddress.ip_address(address).is_unspecified
        due = token or ("" if here else secrets.token_urlsafe(18))
        app = _application(desk)
        names = {address, host.lower(), *(_LOOPBACK if here or anywhere else ())}
        if anywhere:
            names |= {socket.gethostname().lower(), socket.getfqdn().lower()}
        guard = Guard(app, frozenset(names), bound, due, anywhere)
        shown = socket.gethostname() if anywhere else f"[{address}]" if ":" in address else address
        place = f"http://{shown}:{bound}/"
        entry = f"{place}?token={due}" if due else place
        announce(f"serving {served.root} at {entry}")
        announce("Ctrl-C ends it")
        if open_it:
            threading.Timer(1.0, webbrowser.open, [entry]).start()
        config = uvicorn.Config(
            guard,  # pyright: ignore[reportArgumentType]
            log_level="error",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=3,
            proxy_headers=False,
        )
        with suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
    for job in desk.jobs.unkept:
        announce(f"not kept: {job.answer} ({job.message}); its files are in {job.left}")
    announce("stopped")


def _application(desk: Desk) -> FastAPI:

    @asynccontextmanager
    async def until_the_end(_: FastAPI) -> AsyncGenerator[None]:
        yield
        await desk.jobs.end()

    app = FastAPI(lifespan=until_the_end, openapi_url=None, docs_url=None, redoc_url=None)
    add_files(app, desk)
    add_pages(desk)
    pages.add_middleware(PagePolicy)
    # A page that was silent for less than this (a busy machine, a laptop's lid) goes on where it was; else it is empty.
    ui.run_with(app, title="Linkwright", dark=None, show_welcome_message=False, reconnect_timeout=60.0)
    return app


def _listening(host: str, port: int) -> socket.socket:
    """A socket that listens there; the port is free, or this is said at once. Raises `InputError`."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except (OSError, UnicodeError, OverflowError):
        raise InputError("", "--host", f"there is no host {host!r}; 127.0.0.1 is this machine alone") from None
    made = socket.socket(family, kind, protocol)
    try:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(address)
        made.listen(128)
    except OSError as error:
        made.close()
        if error.errno == errno.EADDRINUSE:
            message = f"{port} is taken; name another one, or 0 for any that is free"
        elif error.errno == errno.EACCES:
            message = f"{port} may not be used (permission); name one above 1023"
        else:
            raise InputError("", "--host", f"{host} cannot be listened at: {error.strerror or error}") from None
        raise InputError("", "--port", message) from None
    return made

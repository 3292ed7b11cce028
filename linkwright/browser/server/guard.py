"""Who may ask: this server by its name, from its pages, with the token; and what a page may run."""

from __future__ import annotations

import base64
import hashlib
import hmac
import html
import ipaddress
import re
import secrets
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]

_INLINE = re.compile(rb"<script(?![^>]*\ssrc=)[^>]*>(.*?)</script>", re.DOTALL | re.IGNORECASE)
HEADER = b"content-security-policy"


def policy(scripts: Iterable[bytes] = ()) -> bytes:
    """The Content-Security-Policy of what this server sends, where these inline scripts may run and no others.

    NiceGUI's pages compile their components in the browser (`unsafe-eval`) and carry styles in attributes; neither lets
    markup run anything.
    """
    digests = (base64.b64encode(hashlib.sha256(script).digest()).decode() for script in scripts)
    sources = " ".join(["'self'", *(f"'sha256-{digest}'" for digest in digests), "'unsafe-eval'", "blob:"])
    return (
        f"default-src 'self'; script-src {sources}; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
        "font-src 'self' data:; worker-src 'self' blob:; connect-src 'self'; frame-src 'self'; object-src 'none'; "
        "base-uri 'self'; form-action 'self'; frame-ancestors 'self'"
    ).encode()


class PagePolicy:
    """Wraps an ASGI application: each page of its is sent with a policy that names the scripts in it."""

    def __init__(self, app: App) -> None:
        self._app = app

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Hold a page back until it is whole."""
        start: Message | None = None
        body = b""

        async def named(message: Message) -> None:
            nonlocal start, body
            if message["type"] == "http.response.start" and _is_page(message):
                start = message
                return
            if start is not None and message["type"] == "http.response.body":
                body += message.get("body", b"")
                if message.get("more_body"):
                    return
                scripts = [script.replace(b"\r\n", b"\n") for script in _INLINE.findall(body)]
                headers = [*start["headers"], (HEADER, policy(scripts))]
                await send({**start, "headers": headers})
                message = {**message, "body": body}
                start = None
            await send(message)

        await self._app(scope, receive, named)


def _is_page(message: Message) -> bool:
    headers = {bytes(name).lower(): bytes(value) for name, value in message["headers"]}
    return headers.get(b"content-type", b"").startswith(b"text/html") and HEADER not in headers


MOST_UPLOADED = 50 * 1024 * 1024
"""Bytes of a file that can be dropped."""
_ROOM = 64 * 1024
"""What a form needs around the file."""
_HEADERS = (
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"same-origin"),
    (b"x-frame-options", b"SAMEORIGIN"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
_HOST = re.compile(r"(?P<name>\[[0-9A-Fa-f:.]+\]|[^\[\]:]+)(?::(?P<port>[0-9]{1,5}))?")
"""A name or an address, one of IPv6 in brackets, and the port."""


class TooMuch(Exception):
    """More came than may be uploaded."""


@dataclass(frozen=True)
class Guard:
    """Wraps an ASGI application. `names` are the hosts that it is called by (any address where `anywhere`), on `port`;
    `token` is due once, where there is one, and a cookie afterwards."""

    app: App
    names: frozenset[str]
    port: int
    token: str = ""
    anywhere: bool = False
    _session: str = field(default_factory=lambda: secrets.token_urlsafe(32))

    @property
    def cookie(self) -> str:
        """The cookie's name: cookies do not know ports, so it does."""
        return f"linkwright-{self.port}"

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Pass on what may pass."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = [(bytes(name).lower(), bytes(value)) for name, value in scope["headers"]]
        refused = self._stranger(headers)
        if refused:
            await _refuse(scope, receive, send, 403, refused)
            return
        if self.token and not self._known(headers):
            await self._ask(scope, receive, send)
            return
        length = _one(headers, b"content-length")
        if length and (not length.isdecimal() or int(length) > MOST_UPLOADED + _ROOM):
            await _refuse(scope, receive, send, 413, f"larger than {MOST_UPLOADED // 1024**2} MB")
            return
        await self._passed(scope, receive, send)

    def _stranger(self, headers: list[tuple[bytes, bytes]]) -> str:
        """Why a request comes from elsewhere, empty where it does not."""
        host = _one(headers, b"host")
        if host is None or not self._is_this_machine(host):
            return "this server is not known by that name (Host)"
        origin = _one(headers, b"origin") if _has(headers, b"origin") else f"http://{host}"
        if origin is None or origin.lower() not in (f"http://{host}".lower(), f"https://{host}".lower()):
            return "the request comes from another page (Origin)"
        return ""

    def _is_this_machine(self, host: str) -> bool:
        host_match = _HOST.fullmatch(host)
        if host_match is None:
            return False
        name, port = host_match["name"].lower().strip("[]"), int(host_match["port"] or 80)
        if name in self.names:
            return port == self.port
        # A name that somebody else may point here (DNS rebinding) is none; an address is what it says.
        return self.anywhere and port == self.port and _address(name)

    def _known(self, headers: list[tuple[bytes, bytes]]) -> bool:
        jar: SimpleCookie = SimpleCookie()
        try:
            jar.load("; ".join(value.decode("latin-1") for name, value in headers if name == b"cookie"))
        except CookieError:
            return False
        held = jar.get(self.cookie)
        return held is not None and hmac.compare_digest(held.value.encode(), self._session.encode())

    async def _ask(self, scope: Message, receive: Receive, send: Send) -> None:
        """Take the token, from the address at first or from the form that asks for it, and give a cookie for it."""
        if scope["type"] == "http":
            token = parse_qs(bytes(scope.get("query_string", b"")).decode("latin-1")).get("token", [""])[0]
            if scope["method"] == "POST" and scope["path"] == "/enter":
                token = parse_qs((await _body(receive, 4096)).decode("latin-1")).get("token", [""])[0]
            if token and hmac.compare_digest(token.encode(), self.token.encode()):
                cookie = f"{self.cookie}={self._session}; Path=/; HttpOnly; SameSite=Strict"
                await _answer(send, 303, "", [(b"location", b"/"), (b"set-cookie", cookie.encode())])
                return
        await _refuse(scope, receive, send, 401, "the token that `linkwright serve` printed is due", form=True)

    async def _passed(self, scope: Message, receive: Receive, send: Send) -> None:
        came, began, gone = 0, False, False

        async def counted() -> Message:
            nonlocal came, gone
            message = await receive()
            gone |= message["type"] == "http.disconnect"
            if scope["type"] == "http":
                came += len(message.get("body", b""))
                if came > MOST_UPLOADED + _ROOM:
                    raise TooMuch
            return message

        async def guarded(message: Message) -> None:
            nonlocal began
            if message["type"] == "http.response.start":
                began = True
                there = {bytes(name).lower() for name, _ in message["headers"]}
                added = [pair for pair in _HEADERS if pair[0] not in there]
                if HEADER not in there:
                    added.append((HEADER, policy()))
                message = {**message, "headers": [*message["headers"], *added]}
            await send(message)

        try:
            await self.app(scope, counted, guarded)
        except TooMuch:
            if not began:
                await _answer(send, 413, f"larger than {MOST_UPLOADED // 1024**2} MB\n")
        except RuntimeError:
            # What a page in the making says where nobody waits for it any more (starlette: "No response returned"),
            # also after NiceGUI has begun a page that says so.
            if not gone:
                raise


def _address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _has(headers: list[tuple[bytes, bytes]], name: bytes) -> bool:
    return any(item == name for item, _ in headers)


def _one(headers: list[tuple[bytes, bytes]], name: bytes) -> str | None:
    values = [value for item, value in headers if item == name]
    return values[0].decode("latin-1") if len(values) == 1 else None


async def _body(receive: Receive, most: int) -> bytes:
    body = b""
    while len(body) <= most:
        message = await receive()
        body += message.get("body", b"")
        if not message.get("more_body"):
            break
    return body[:most]


async def _refuse(scope: Message, receive: Receive, send: Send, status: int, why: str, *, form: bool = False) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": why})
        return
    if not form:
        await _answer(send, status, f"refused: {why}\n")
        return
    page = (
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        "<title>Linkwright</title><style>body{font:16px/1.5 system-ui,sans-serif;max-width:30rem;margin:4rem auto;"
        "padding:0 1rem}input,button{font:inherit;padding:.5rem;width:100%;box-sizing:border-box;"
        "margin:.3rem 0}</style>"
        f"<h1>Linkwright</h1><p>{html.escape(why[:1].upper() + why[1:])}.</p>"
        '<form method="post" action="/enter"><input name="token" type="password" autocomplete="off" '
        'aria-label="token"><button>Enter</button></form></html>'
    )
    await _answer(send, status, page, [(b"content-type", b"text/html; charset=utf-8")])


async def _answer(send: Send, status: int, text: str, more: list[tuple[bytes, bytes]] | None = None) -> None:
    headers = list(more or ())
    if not _has(headers, b"content-type"):
        headers.append((b"content-type", b"text/plain; charset=utf-8"))
    headers += [*_HEADERS, (b"cache-control", b"no-store"), (b"content-length", str(len(text.encode())).encode())]
    headers.append((HEADER, policy()))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": text.encode()})

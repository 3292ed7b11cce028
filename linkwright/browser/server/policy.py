"""What a page may run: the scripts that stand in it as it is sent, and those of this server; nothing put in later."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from typing import Any

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
    digests = (base64.b64encode(hashlib.sha256(each).digest()).decode() for each in scripts)
    own = " ".join(["'self'", *(f"'sha256-{each}'" for each in digests), "'unsafe-eval'", "blob:"])
    return (
        f"default-src 'self'; script-src {own}; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
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
                scripts = [found.replace(b"\r\n", b"\n") for found in _INLINE.findall(body)]
                headers = [*start["headers"], (HEADER, policy(scripts))]
                await send({**start, "headers": headers})
                message = {**message, "body": body}
                start = None
            await send(message)

        await self._app(scope, receive, named)


def _is_page(message: Message) -> bool:
    headers = {bytes(name).lower(): bytes(value) for name, value in message["headers"]}
    return headers.get(b"content-type", b"").startswith(b"text/html") and HEADER not in headers

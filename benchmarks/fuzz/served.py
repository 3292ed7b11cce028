"""What the server is sent: requests, dropped recordings, and names and problems that may lead out of its folder."""

from __future__ import annotations

import asyncio
import tempfile
from pathlib import Path
from typing import Any

from fastapi import FastAPI

import linkwright as lw
from linkwright.browser.server.answers import Desk, add_files
from linkwright.browser.server.dropped import Dropped, plain_name
from linkwright.browser.server.folder import Folder
from linkwright.browser.server.guard import Guard
from linkwright.browser.server.jobs import Jobs
from linkwright.browser.server.shelf import Shelf
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import InputError

from .kind import Kind, each_of, example

PORT = 8765
REQUESTS = (
    "GET /kept/1/report.html?view=1\nHost: localhost:8765\nOrigin: http://localhost:8765\n\n",
    "GET /kept/1/arm.yaml\nHost: 127.0.0.1:8765\nCookie: linkwright-8765=abc; a=b\n\n",
    "POST /enter?token=abc\nHost: [::1]:8765\nContent-Length: 9\n\ntoken=abc",
    "GET /kept/1/../../etc/passwd\nHost: evil.example:8765\nOrigin: null\n\n",
    "PUT /kept/1/%2e%2e%2fetc%2fpasswd\nHost: localhost:8765\nTransfer-Encoding: chunked\n\nx",
)
NAMES = "arm.yaml\n../secret.yaml\n/etc/passwd\na/../b.yaml\nlink.yaml\n.hidden.yaml\nfolder\\arm.yaml\n"
SECRET = "chain: what nobody may read\n"
_OWN = ("localhost", "127.0.0.1", "[::1]")


def served_kinds(drives: Arm) -> dict[str, Kind]:
    """Kinds by name, with an arm that recordings are of."""
    rows = example("hidden-backlash/recording.csv").splitlines(keepends=True)[:12]
    foreign = (
        "Axis 1 [deg];Axis 2 [deg];Axis 3 [deg];X;Y\n",
        *(";".join(row.split(",")[1:6]) + "\n" for row in rows[1:]),
    )
    own = lw.Arm.of(drives)
    return {
        "request": Kind({"request.txt": REQUESTS}, _Asked(), {}),
        "dropped": Kind(
            {"name.txt": ("run 7.csv", "C:\\runs\\7.xlsx"), "r.csv": ("".join(rows), "".join(foreign))},
            lambda at: _dropped(at, own),
            {},
        ),
        "folder": Kind(
            {"names.txt": ("arm.yaml\n", NAMES), "problem.yaml": (example("welding-arm/problem.yaml"),)},
            _folder,
            {"secret.yaml": SECRET},
        ),
    }


class _Asked:
    """Asks the guarded files by requests as they come through the wire, the application made when it is first asked."""

    def __init__(self) -> None:
        self._guards: tuple[Guard, ...] = ()

    def __call__(self, at: Path) -> None:
        """Who calls the server by another name gets nothing, and no request is a failure of the server's."""
        if not self._guards:
            self._guards = _guards()
        head, _, body = (at / "request.txt").read_bytes().partition(b"\n\n")
        line, *rest = head.split(b"\n")
        words = [*line.decode("latin-1").split(" "), "", ""]
        path, _, query = words[1].partition("?")
        pairs = (item.partition(b":") for item in rest)
        headers = [(name.strip().lower(), value.strip()) for name, _, value in pairs]
        scope = {
            "type": "http",
            "asgi": {"version": "3.0"},
            "http_version": "1.1",
            "method": words[0] or "GET",
            "scheme": "http",
            "path": path or "/",
            "raw_path": path.encode("latin-1"),
            "query_string": query.encode("latin-1"),
            "root_path": "",
            "headers": headers,
            "client": ("127.0.0.1", 1),
            "server": ("127.0.0.1", PORT),
        }
        plain, due = self._guards
        status = self._ask(plain, scope, body)
        assert self._ask(due, scope, body) in (303, 401, 403)
        if status >= 400:
            raise InputError("", "", f"{status}")

    def _ask(self, guard: Guard, scope: dict[str, Any], body: bytes) -> int:
        status, text = asyncio.run(_answer(guard, dict(scope), body))
        assert 200 <= status < 500, status
        hosts = [value.decode("latin-1").lower() for name, value in scope["headers"] if name == b"host"]
        ours = len(hosts) == 1 and hosts[0].rpartition(":")[0] in _OWN and hosts[0].endswith(f":{PORT}")
        assert ours or status == 403
        assert SECRET.encode() not in text or (ours and not guard.token)
        return status


def _guards() -> tuple[Guard, ...]:
    """The files of one kept result, with and without a token."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-shelf-"))
    shelf = Shelf(folder)
    kept = {"report.html": SECRET.encode(), "arm.yaml": SECRET.encode()}
    shelf.keep("evaluate", "arm.yaml", "found", kept, complete=True, seconds=1.0)
    app: Any = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
    add_files(app, Desk(Folder(folder), shelf, Jobs(shelf)))
    names = frozenset({"localhost", "127.0.0.1", "::1"})
    return Guard(app, names, PORT), Guard(app, names, PORT, token="a token that is due")


async def _answer(guard: Guard, scope: dict[str, Any], body: bytes) -> tuple[int, bytes]:
    pieces = [{"type": "http.request", "body": body, "more_body": False}]
    answers: list[Any] = []

    async def receive() -> Any:
        return pieces.pop(0) if pieces else {"type": "http.disconnect"}

    async def send(message: Any) -> None:
        answers.append(message)

    await guard(scope, receive, send)
    return answers[0]["status"], b"".join(answer.get("body", b"") for answer in answers[1:])


def _dropped(at: Path, arm: lw.Arm) -> None:
    """What the page says of a dropped file is one line. Raises it."""
    name = plain_name((at / "name.txt").read_bytes().decode("utf-8", "replace"))
    assert "/" not in name
    assert len(name.encode()) < 100
    result = Dropped(name, (at / "r.csv").read_bytes())
    result.propose(arm)
    if not result.problem:
        result.check(arm)
    if result.problem:
        raise InputError("", "", result.problem)


def _folder(at: Path) -> None:
    """No name and no problem leads to what lies beside the folder."""
    root = at / "designs"
    root.mkdir(exist_ok=True)
    if not (root / "link.yaml").is_symlink():
        (root / "link.yaml").symlink_to(at / "secret.yaml")
    (root / "arm.yaml").write_text("chain: []\n", encoding="utf-8")
    folder = Folder(root)
    names = (at / "names.txt").read_bytes().decode("utf-8", "replace").splitlines()
    text = (at / "problem.yaml").read_bytes().decode("utf-8", "replace")

    def tried(name: str) -> None:
        assert folder.read(name) != SECRET

    def written(name: str) -> None:
        folder.write(name, text, whatever=True)

    def named(name: str) -> None:
        assert SECRET.encode() not in folder.with_named(name, text).values()

    try:
        each_of(*(lambda do=do, name=name: do(name) for name in names[:6] for do in (tried, written, named)))
    finally:
        assert (at / "secret.yaml").read_text(encoding="utf-8") == SECRET

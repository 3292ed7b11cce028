"""Who may ask the server, and for what: by plain requests."""

import asyncio
import base64
import hashlib
import http.client
import re
import signal
import socket
import sqlite3

import pytest

import linkwright as lw
from linkwright.browser.server.folder import Folder, staged
from linkwright.browser.server.guard import MOST_UPLOADED, Guard
from linkwright.core.units.quantities import InputError
from tests.linkwright.conftest import ROOT

from .conftest import Server

KEY = "dGhlIHNhbXBsZSBub25jZQ=="
UPGRADE = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Key": KEY, "Sec-WebSocket-Version": "13"}
SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"


def ask(server, path="/", method="GET", body=None, **headers):
    """Status, headers and text of an answer."""
    made = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
    made.request(method, path, body=body, headers={name.replace("_", "-"): value for name, value in headers.items()})
    answer = made.getresponse()
    result = (
        answer.status,
        dict(answer.getheaders()),
        answer.read().decode(errors="replace") if answer.status != 101 else "",
    )
    made.close()
    return result


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:{port}"},
        {"Host": "127.0.0.1:1"},
        {"Host": "127.0.0.1.evil.example:{port}"},
        {"Host": "localhost:{port}@evil.example"},
        {"Host": "::1]:{port}"},
        {"Host": "[localhost:{port}"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://localhost:1"},
        {"Origin": "http://127.0.0.1:{port}.evil.example"},
    ],
)
@pytest.mark.parametrize("path", ["/", "/kept/1/report.html", SOCKET])
def test_strangers_are_refused(server, headers, path):
    """Pages, files and the websocket alike."""
    given = {name: value.format(port=server.port) for name, value in headers.items()}
    status, _, text = ask(server, path, **(UPGRADE if path == SOCKET else {}), **given)
    assert status == 403
    assert "script" not in text


def test_its_own_names_may_ask(server):
    """The check above would pass on a server that refuses all."""
    for host in (f"127.0.0.1:{server.port}", f"LOCALHOST:{server.port}", f"[::1]:{server.port}"):
        assert ask(server, Host=host, Origin=f"http://{host}")[0] == 200
        assert ask(server, SOCKET, Host=host, Origin=f"http://{host}", **UPGRADE)[0] == 101


def test_no_script_runs_but_those_of_the_page(server):
    """Markup that comes in later, an `onerror` say, is none of theirs. Each inline script is named by its digest."""
    for path in ("/", "/results", "/results/" + "9" * 30, "/nowhere"):
        _, headers, text = ask(server, path)
        allowed = next(part for part in headers["content-security-policy"].split("; ") if part.startswith("script-src"))
        assert "'unsafe-inline'" not in allowed
        inline = re.findall(r"<script(?![^>]* src=)[^>]*>(.*?)</script>", text, re.DOTALL)
        for script in inline:
            assert base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() in allowed
        assert inline or path == "/nowhere"


def test_an_address_of_this_machine_is_its_own_name(tmp_path):
    """The whole of 127.0.0.0/8 is this machine. SIGTERM ends it as Ctrl-C does."""
    made = Server(tmp_path, "--host", "127.0.0.2")
    own = f"127.0.0.2:{made.port}"
    answer = http.client.HTTPConnection("127.0.0.2", made.port, timeout=30)
    answer.request("GET", "/", headers={"Host": own, "Origin": f"http://{own}"})
    assert answer.getresponse().status == 200
    answer.close()
    status, out, complaints = made.end(signal.SIGTERM)
    assert (status, complaints) == (0, "")
    assert out.endswith("stopped\n")


def test_only_this_machine_can_reach_it(server):
    """The port listens on the loopback address alone."""
    own = socket.gethostbyname(socket.gethostname())
    if own.startswith("127."):
        pytest.skip("this machine has no address beside the loopback one")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((own, server.port), timeout=5)


def test_uploads_are_bounded(server):
    """By what is announced, and by what comes."""
    status, _, text = ask(server, "/", "POST", Content_Length=str(MOST_UPLOADED + 10**6))
    assert (status, text) == (413, "refused: larger than 50 MB\n")
    answers, pieces = [], iter([{"type": "http.request", "body": b"x" * 2**20, "more_body": True}] * 60)

    async def reader(_, receive, send):
        while (await receive()).get("more_body"):
            pass
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive():
        return next(pieces)

    async def send(message):
        answers.append(message)

    scope = {"type": "http", "method": "POST", "path": "/", "headers": [(b"host", b"localhost:1")]}
    asyncio.run(Guard(reader, frozenset({"localhost"}), 1)(scope, receive, send))
    assert answers[0]["status"] == 413


@pytest.mark.parametrize("begun", [True, False])
@pytest.mark.parametrize("gone", [True, False])
def test_who_goes_before_the_answer_leaves_no_traceback(gone, begun):
    """A page that nobody waits for any more has no answer, or one that says so; one that is waited for and has none is
    a fault."""

    async def left(_, receive, send):
        await receive()
        if begun:
            await send({"type": "http.response.start", "status": 500, "headers": []})
        raise RuntimeError("No response returned.")

    async def receive():
        return {"type": "http.disconnect" if gone else "http.request", "body": b""}

    async def send(message):
        assert message["status"] == 500

    scope = {"type": "http", "method": "GET", "path": "/", "headers": [(b"host", b"localhost:1")]}
    asked = Guard(left, frozenset({"localhost"}), 1)(scope, receive, send)
    if gone:
        asyncio.run(asked)
        return
    with pytest.raises(RuntimeError, match="No response"):
        asyncio.run(asked)


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "../secret.yaml", "a/../../secret.yaml", "link.yaml", ".hidden.yaml", "9" * 4000]
)
@pytest.mark.parametrize("how", ["read", "write"])
def test_no_name_leaves_the_folder(tmp_path, name, how):
    """Not by dots, not from the root, not by a link."""
    folder = tmp_path / "designs"
    folder.mkdir()
    (tmp_path / "secret.yaml").write_text("chain: secret", encoding="utf-8")
    (folder / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    held = Folder(folder)
    with pytest.raises(InputError, match="is not in the folder that is served"):
        held.read(name) if how == "read" else held.write(name, "chain: mine")
    assert (tmp_path / "secret.yaml").read_text(encoding="utf-8") == "chain: secret"
    assert held.names("arm") == []


def test_robots_of_the_folder_are_arms_with_what_they_are_read_with(tmp_path):
    """URDF and MJCF by their root, not by their ending; an MJCF with the meshes and parts that it names, none of them
    from outside."""
    folder = tmp_path / "designs"
    (folder / "parts").mkdir(parents=True)
    (tmp_path / "secret.stl").write_text("secret")
    (folder / "z.yaml").write_text("chain: []")
    (folder / "launch.xml").write_text('<launch><node robot="a"/></launch>')
    (folder / "a.urdf").write_text('<?xml version="1.0"?>\n<!-- <x> -->\n<robot name="a"><link name="b"/></robot>')
    (folder / "parts" / "more.xml").write_text('<mujocoinclude><asset><mesh file="two.STL"/></asset></mujocoinclude>')
    for name in ("one.stl", "two.STL", "other.stl"):
        (folder / "parts" / name).write_bytes(name.encode())
    (folder / "b.xml").write_text("""<mujoco><compiler meshdir="parts"/><include file='parts/more.xml'/>
      <asset><mesh file="one.stl"/><mesh file="../secret.stl"/><mesh file="gone.stl"/></asset></mujoco>""")
    held = Folder(folder)
    assert held.names("arm", "description") == ["z.yaml", "a.urdf", "b.xml"]
    assert held.names("arm") == ["z.yaml"]
    assert set(held.arm("z.yaml")) == {"z.yaml"}
    assert set(held.arm("b.xml")) == {"b.xml", "parts/more.xml", "parts/one.stl", "parts/two.STL"}
    assert held.arm("b.xml")["parts/one.stl"] == b"one.stl"


@pytest.mark.parametrize("file", ["../secret.yaml", "{root}/secret.yaml", "link.yaml", "a/../../secret.yaml"])
@pytest.mark.parametrize("key", ["arm: {}", "workspace: {{poses: {}}}"])
def test_no_problem_names_a_file_outside(tmp_path, key, file):
    """A problem file is a way to other files too."""
    folder = tmp_path / "designs"
    folder.mkdir()
    (tmp_path / "secret.yaml").write_text("chain: secret", encoding="utf-8")
    (folder / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    with pytest.raises(InputError, match="is not in the folder that is served"):
        Folder(folder).with_named("problem.yaml", key.format(file.format(root=tmp_path)) + "\n")


def test_what_a_problem_names_comes_with_it(tmp_path):
    """Its arm and its table of poses, from where it stands."""
    for name in ("arm.yaml", "by-link.yaml", "poses.csv"):
        (tmp_path / "bench" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "bench" / name).write_bytes((ROOT / "examples" / "bench-arm" / name).read_bytes())
    held = Folder(tmp_path)
    inputs = held.with_named("bench/by-link.yaml", held.read("bench/by-link.yaml"))
    assert sorted(inputs) == ["bench/arm.yaml", "bench/by-link.yaml", "bench/poses.csv"]
    with staged(inputs) as root:
        assert len(lw.read_problem(root / "bench" / "by-link.yaml").model.workspace.poses) == 3


def test_kept_files_are_by_name_alone(server):
    """They are rows, so no path leads anywhere."""
    for path in (
        "/kept/1/../../etc/passwd",
        "/kept/1/%2e%2e%2f%2e%2e%2fetc%2fpasswd",
        "/kept/x/report.html",
        "/kept/" + "9" * 40 + "/a",
    ):
        assert ask(server, path)[0] in (404, 422)


def test_a_token_is_due_beyond_this_machine(tmp_path):
    """It is printed, taken once for a cookie, and never asked of an address again; Ctrl-C ends cleanly."""
    made = Server(tmp_path, "--host", "0.0.0.0")
    token = made.line.partition("?token=")[2].strip()
    host = f"127.0.0.1:{made.port}"
    assert len(token) >= 20
    assert ask(made, Host=host)[0] == 401
    assert ask(made, "/?token=wrong-token", Host=host)[0] == 401
    assert ask(made, SOCKET, Host=host, **UPGRADE)[0] == 403
    status, headers, _ = ask(made, f"/?token={token}", Host=host)
    cookie = headers["set-cookie"]
    assert (status, headers["location"]) == (303, "/")
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert token not in cookie
    assert ask(made, Host=host, Cookie=cookie.partition(";")[0])[0] == 200
    assert ask(made, "/enter", "POST", f"token={token}", Host=host, Origin=f"http://{host}")[0] == 303
    assert ask(made, Host=f"evil.example:{made.port}", Cookie=cookie.partition(";")[0])[0] == 403
    status, out, complaints = made.end()
    assert (status, complaints) == (0, "")
    assert out.endswith("stopped\n")


@pytest.mark.slow
def test_a_taken_port_is_one_line(server, process):
    """And so are a folder that is none, a host that is none, a token that guesses itself."""
    for line, said in (
        (f"--port {server.port}", "--port: "),
        ("nowhere", "nowhere: is no folder"),
        ("--host no.such.host.invalid --port 0", "--host: there is no host"),
        ("--token short", "--token: needs 8 letters"),
    ):
        result = process(f"$PYTHON -m linkwright serve {line}")
        assert result.returncode == 2
        assert result.stderr.count("\n") == 1
        assert said in result.stderr


def test_what_is_no_shelf_is_one_line(linkwright, tmp_path):
    """A file of that name that is something else."""
    (tmp_path / "linkwright-results.sqlite").write_text("something else, long enough to be looked at" * 40)
    status, _, error = linkwright("serve", "--port", "0")
    assert (status, error.count("\n")) == (2, 1)
    assert "linkwright-results.sqlite: cannot be used" in error
    with pytest.raises(sqlite3.DatabaseError):
        sqlite3.connect(tmp_path / "linkwright-results.sqlite").execute("SELECT * FROM results")

"""What people see of results that are foreign, damaged, cut off or could not be kept, and of files that changed."""

import json
import os
import sqlite3
from contextlib import closing

import pytest

from linkwright.browser.server.folder import Folder
from linkwright.browser.server.jobs import Jobs
from linkwright.browser.server.shelf import Shelf

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("browser")]
RUNS = "window.taken = true"
EVIL = (
    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9" onload="{RUNS}">'
    f'<circle class="joint" r="2" onclick="{RUNS}"/><foreignObject><img src="data:," onerror="{RUNS}">'
    f'<iframe srcdoc="&lt;script&gt;parent.taken = true&lt;/script&gt;"></iframe></foreignObject>'
    f'<a href="javascript:{RUNS}"><text>a link</text></a></svg>'
)


def test_script_in_a_kept_result_never_runs(server, page):
    """A base may come from anybody: pictures, words and names of files are shown, and nothing in them is obeyed."""
    shelf = Shelf(server.folder)
    words = f'<img src="data:," onerror="{RUNS}">'
    trace = {"x": [1], "y": [1], "name": words, "customdata": [1], "hovertemplate": words}
    design = {"svg": EVIL, "file": f'x" onclick="{RUNS}', "figures": [{"figure": words, "value": words}], "links": []}
    front = {"figure": {"data": [trace], "layout": {"title": {"text": words}}}, "designs": {"1": design}}
    files = {
        "poses.json": json.dumps([{"words": words, "svg": EVIL}]).encode(),
        "front.json": json.dumps(front).encode(),
        f'a" :onclick="{RUNS}" onclick="{RUNS}': b"",
    }
    number = shelf.keep("evaluate", words, words, files, complete=True, seconds=1.0)
    page.goto(f"{server.url}results/{number}")
    page.locator(".lw-poses svg circle.joint").wait_for()
    page.locator(".js-plotly-plot .scatterlayer").wait_for()
    for picture in (".lw-poses svg", ".lw-panel svg:has(circle.joint)"):
        page.locator(picture).first.dispatch_event("click")
        page.locator(f"{picture} circle").first.dispatch_event("click")
    for link in page.locator(".lw-page a").all():
        link.evaluate("each => each.addEventListener('click', event => event.preventDefault())")
        link.dispatch_event("click")
    page.wait_for_timeout(300)
    assert page.evaluate("window.taken") is None
    assert page.locator(".lw-page :is([onload], [onerror], [onclick], iframe, script)").count() == 0
    page.goto(f"{server.url}results")
    page.get_by_text(words).first.wait_for()
    assert page.evaluate("window.taken") is None
    shelf.remove(number)


def test_what_is_not_there_or_damaged_is_a_line(server, page):
    """A number of thirty digits, a row that is no zlib, a picture that is no picture."""
    shelf = Shelf(server.folder)
    page.goto(server.url + "results/" + "9" * 30)
    page.get_by_role("alert").filter(has_text="There is no result 999999").wait_for()
    poses = json.dumps([{"words": "", "svg": f"<svg><script>{RUNS}</script></svg>"}]).encode()
    for content, said in ((b"no zlib", "is damaged"), (None, "the worst poses cannot be shown")):
        number = shelf.keep("evaluate", "t", "a line", {"poses.json": poses}, complete=True, seconds=1.0)
        if content is not None:
            with closing(sqlite3.connect(shelf.path)) as base, base:
                base.execute("UPDATE files SET content = ? WHERE result = ?", (content, number))
        page.goto(f"{server.url}results/{number}")
        page.get_by_role("alert").filter(has_text=said).wait_for()
        page.get_by_text("a line", exact=True).wait_for()
        shelf.remove(number)


def test_a_locked_base_loses_no_answer(server, page):
    """Another program holds it while an arm is evaluated: the answer and its report are there, and kept by a click."""
    Folder(server.folder).add_examples()
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    shelf = Shelf(server.folder)
    before = {item.id for item in shelf.all()}
    with closing(sqlite3.connect(shelf.path, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        page.get_by_role("button", name="Evaluate").click()
        page.get_by_role("alert").filter(has_text="This answer is not kept: ").wait_for()
        page.get_by_role("alert").filter(has_text="is locked by another program").wait_for()
        page.get_by_text("Worst position error").wait_for()
        page.frame_locator("iframe").get_by_role("heading", level=1).wait_for()
        page.goto(server.url + "results")
        page.get_by_text("Worst position error").first.wait_for()
    page.get_by_role("button", name="Keep again").click()
    page.get_by_role("button", name="Keep again").wait_for(state="detached")
    # The page asks for the kept report now, which must not be gone before it is answered.
    page.frame_locator("iframe").get_by_role("heading", level=1).wait_for()
    (fresh,) = {item.id for item in shelf.all()} - before
    assert "report.html" in shelf.names(fresh)
    shelf.remove(fresh)


def test_a_run_that_was_cut_off_is_listed(server, page):
    """Until somebody has seen it."""
    shelf = Shelf(server.folder)
    host = Jobs(shelf)._name.partition(" on ")[2]
    run = shelf.begin("optimize", "a long problem", f"{server.process.pid} on {host}")
    page.goto(server.url + "results")
    page.get_by_text("Optimisation (cut off)").wait_for()
    page.get_by_text("a long problem").wait_for()
    page.get_by_role("button", name=f"forget run {run}", exact=True).click()
    page.get_by_text("Optimisation (cut off)").wait_for(state="detached")
    assert shelf.runs() == []


def test_all_results_are_removed(server, page):
    """Asked once more before; the size of them all stands above."""
    shelf = Shelf(server.folder)
    shelf.keep("evaluate", "t", "to be removed", {"a": os.urandom(3_000_000)}, complete=True, seconds=1.0)
    page.goto(server.url + "results")
    shown = page.get_by_text("MB on the disk")
    shown.wait_for()
    assert float(shown.inner_text().split()[2]) == pytest.approx(shelf.size() / 1024**2, abs=0.06)
    page.get_by_role("button", name="Remove all").click()
    page.get_by_role("button", name="Leave them").click()
    page.get_by_text("to be removed").wait_for()
    page.get_by_role("button", name="Remove all").click()
    page.get_by_role("button", name="Remove them").click()
    page.get_by_text("Nothing yet").wait_for()
    assert shelf.all() == []
    assert shelf.size() < 1_000_000


def test_an_arm_that_another_program_changed_is_not_written_over(server, page):
    """Save says so and where; it is written over by another button only."""
    Folder(server.folder).add_examples()
    arm = server.folder / "example-arm.yaml"
    text = arm.read_text(encoding="utf-8")
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    page.get_by_label("length", exact=True).first.fill("650 mm")
    page.get_by_label("length", exact=True).first.press("Enter")
    page.get_by_text("reach 1050 mm").wait_for()
    arm.write_text(text + "# mine\n", encoding="utf-8")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("alert").filter(has_text="was changed by another program from line").wait_for()
    assert arm.read_text(encoding="utf-8") == text + "# mine\n"
    page.get_by_role("button", name="Write over it").click()
    page.get_by_text("saved as example-arm.yaml").wait_for()
    assert "650 mm" in arm.read_text(encoding="utf-8")
    arm.write_text(text, encoding="utf-8")

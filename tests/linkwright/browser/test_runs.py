"""Where an answer is seen, that every tab and a reload show what runs, and what becomes of a result afterwards."""

import zipfile

import pytest

from linkwright.browser.server.folder import Folder
from linkwright.browser.server.shelf import Shelf
from linkwright.core.units.quantities import InputError

from .conftest import ROOT

pytestmark = pytest.mark.xdist_group("browser")


@pytest.mark.slow
def test_the_answer_is_in_view_beside_or_below_its_form(server, page):
    """Its line on the screen without a touch of the wheel; to the right of the form where there is room."""
    Folder(server.folder).add_examples()
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    page.get_by_role("button", name="Evaluate").click()
    line = page.locator(".lw-answer .lw-done")
    line.wait_for()
    page.wait_for_function(
        "() => { const box = document.querySelector('.lw-answer .lw-done').getBoundingClientRect();"
        "return box.top >= 0 && box.bottom <= window.innerHeight }"
    )
    form, answer = page.locator(".q-tab-panels").first.bounding_box(), line.bounding_box()
    wide = page.viewport_size["width"] > 900
    assert (answer["x"] >= form["x"] + form["width"]) is wide
    page.reload()
    line.wait_for()
    page.wait_for_load_state("networkidle")  # its report is a frame of its own, and is not to be gone when asked for
    for item in Shelf(server.folder).all():
        Shelf(server.folder).remove(item.id)
    page.reload()
    page.get_by_text("reach 900 mm").wait_for()
    page.wait_for_timeout(500)
    assert line.count() == 0


@pytest.mark.slow
def test_every_tab_and_a_reload_show_what_runs(server, page):
    """A search is begun in one tab and stopped in another; its answer is in the first after a reload."""
    for name in ("arm.yaml", "problem.yaml"):
        (server.folder / name).write_bytes((ROOT / "examples" / "welding-arm" / name).read_bytes())
    (server.folder / "example-problem.yaml").unlink(missing_ok=True)
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of cathode-bus welding arm").wait_for()
    page.get_by_role("button", name="Optimise", exact=True).click()
    page.get_by_role("button", name="Stop").wait_for()
    page.reload()
    page.locator(".lw-log", has_text="poses").wait_for()
    other = page.context.browser.new_page()
    other.set_default_timeout(120_000)
    for place in ("diagnosis", "catalogues", ""):
        other.goto(server.url + place)
        other.get_by_role("status").filter(has_text="Optimisation of problem.yaml: ").wait_for()
    other.get_by_role("button", name="Stop").click()
    other.get_by_text("Optimisation of problem.yaml, stopped: the best so far").wait_for()
    answer = other.get_by_role("link", name="worst error")
    page.locator(".lw-answer .lw-note", has_text="stopped, so this is the best so far").wait_for()
    answer.click()
    other.get_by_text("stopped, so this is the best so far").wait_for()
    other.close()
    page.get_by_role("button", name="Stop").wait_for(state="detached")
    page.reload()
    page.locator(".lw-answer .lw-note", has_text="stopped, so this is the best so far").wait_for()
    for name in ("arm.yaml", "problem.yaml"):
        (server.folder / name).unlink()


@pytest.mark.slow
def test_a_result_is_named_noted_and_downloaded(server, page):
    """In the list and on its own page; all of its files come in one."""
    files = {"arm.yaml": b"chain", "arms/more.yaml": b"more", "poses.json": b"[]"}
    beside, number = (
        Shelf(server.folder).keep("evaluate", "an arm", line, files, complete=True, seconds=1.0)
        for line in ("another line", "a line")
    )
    page.goto(server.url + "results")
    stays = page.get_by_role("button", name=f"name result {beside}", exact=True).element_handle()
    page.get_by_role("button", name=f"name result {number}", exact=True).click()
    page.get_by_label("Name", exact=True).fill("with <b>longer</b> links")
    page.get_by_label("Note", exact=True).fill("for Monday\nand Tuesday")
    page.get_by_role("button", name="Keep", exact=True).click()
    page.get_by_role("link", name="with <b>longer</b> links").wait_for()
    page.get_by_text("for Monday").wait_for()
    assert stays.evaluate("button => button.isConnected")  # or a click on it in the meantime would not be heard
    page.get_by_role("button", name=f"remove result {beside}", exact=True).click()
    page.get_by_text("another line").wait_for(state="detached")
    with page.expect_download() as download:
        page.get_by_role("button", name=f"download result {number}", exact=True).click()
    with zipfile.ZipFile(download.value.path()) as packed:
        assert {name: packed.read(name) for name in packed.namelist()} == files
    page.get_by_role("link", name="with <b>longer</b> links").click()
    page.get_by_role("heading", name="with <b>longer</b> links").wait_for()
    page.get_by_role("button", name="Name and note").click()
    page.get_by_label("Name", exact=True).fill("")
    page.get_by_role("button", name="Keep", exact=True).click()
    page.get_by_role("heading", name="with <b>longer</b> links").wait_for(state="detached")
    result = Shelf(server.folder).find(number)
    assert (result.name, result.note) == ("", "for Monday\nand Tuesday")
    page.get_by_role("button", name="Name and note").click()
    Shelf(server.folder).remove(number)
    page.get_by_role("button", name="Keep", exact=True).click()
    page.get_by_role("alert").filter(has_text=f"result {number}: is not there").wait_for()


def test_a_base_of_before_takes_names(tmp_path):
    """One that has no place for them yet; a name goes with its result."""
    import sqlite3
    from contextlib import closing

    shelf = Shelf(tmp_path)
    number = shelf.keep("evaluate", "t", "l", {}, complete=True, seconds=1.0)
    with closing(sqlite3.connect(shelf.path)) as base, base:
        base.execute("DROP TABLE labels")
    assert (shelf.find(number).name, shelf.find(number).note) == ("", "")
    shelf.label(number, "a name", "a note")
    assert [(item.name, item.note) for item in shelf.all()] == [("a name", "a note")]
    shelf.remove(number)
    with closing(sqlite3.connect(shelf.path)) as base:
        assert base.execute("SELECT count(*) FROM labels").fetchone() == (0,)
    with pytest.raises(InputError, match="is not there"):
        shelf.label(number, "a name", "")

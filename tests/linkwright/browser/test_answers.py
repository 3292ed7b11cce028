"""An answer never stands beside another arm, whether that is opened, edited, or answered in another tab."""

import json

import pytest

import linkwright as lw
from linkwright.browser.server.asked import ASKED, asked_from
from linkwright.browser.server.folder import Folder
from linkwright.browser.server.shelf import Shelf

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("browser")]


@pytest.fixture(autouse=True)
def arms(server):
    """The example arm, and another that comes after it in the list."""
    Folder(server.folder).add_examples()
    text = (server.folder / "example-arm.yaml").read_text(encoding="utf-8")
    (server.folder / "other.yaml").write_text(text.replace("500 mm", "800 mm").replace("example arm", "other arm"))
    yield
    for name in ("example-arm.yaml", "other.yaml"):
        (server.folder / name).unlink(missing_ok=True)
    for item in Shelf(server.folder).all():
        Shelf(server.folder).remove(item.id)


def choose(page, label, option):
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=True).click()


def shown_length(page, text):
    page.get_by_text(f"reach {text}").wait_for()


def test_an_answer_of_another_file_is_grey_and_opens_its_own(server, page):
    """Its card has the verdict of its report; a reload, and its page, open the file that it is of."""
    page.goto(server.url)
    shown_length(page, "900 mm")
    choose(page, "Arm file", "other.yaml")
    shown_length(page, "1200 mm")
    page.get_by_role("button", name="Evaluate").click()
    verdict = lw.evaluate(server.folder / "other.yaml").description.headline
    line = page.locator(".lw-answer .lw-done")
    line.wait_for()
    assert line.inner_text().split() == verdict.split()
    page.frame_locator("iframe").locator(".headline").wait_for()
    said = page.frame_locator("iframe").locator(".headline").inner_text()
    assert said.split() == verdict.split()
    assert page.locator(".lw-stale").count() == 0
    page.reload()  # the first file of the list is another
    shown_length(page, "1200 mm")
    line.wait_for()
    other = page.get_by_role("status").filter(has_text="This answer is of other.yaml")
    other.wait_for(state="hidden")
    choose(page, "Arm file", "example-arm.yaml")
    shown_length(page, "900 mm")
    other.wait_for()
    assert float(page.locator(".lw-stale > *").first.evaluate("each => getComputedStyle(each).opacity")) < 0.6
    page.get_by_role("button", name="Open other.yaml").click()
    shown_length(page, "1200 mm")
    other.wait_for(state="hidden")
    number = Shelf(server.folder).all()[0].id
    page.goto(f"{server.url}results/{number}")
    page.get_by_role("link", name="open its file and ask again").click()
    shown_length(page, "1200 mm")
    line.wait_for()


def test_an_answer_from_before_a_change_says_so(server, page):
    """Comments count as no change; the text that was asked about is a click away, and never saved by that."""
    arm = server.folder / "other.yaml"
    page.goto(server.url)
    shown_length(page, "900 mm")
    choose(page, "Arm file", "other.yaml")
    shown_length(page, "1200 mm")
    page.get_by_role("button", name="Evaluate").click()
    page.locator(".lw-answer .lw-done").wait_for()
    asked = asked_from(Shelf(server.folder).file(Shelf(server.folder).all()[0].id, ASKED))
    assert (asked.file, asked.text) == ("other.yaml", arm.read_text(encoding="utf-8"))
    arm.write_text(arm.read_text(encoding="utf-8") + "# a comment\n", encoding="utf-8")
    page.reload()
    page.locator(".lw-answer .lw-done").wait_for()
    changed = page.get_by_role("status").filter(
        has_text="This answer is of other.yaml as it was before it was changed."
    )
    changed.wait_for(state="hidden")
    arm.write_text(arm.read_text(encoding="utf-8").replace("800 mm", "700 mm"), encoding="utf-8")
    page.reload()
    shown_length(page, "1100 mm")
    changed.wait_for()
    page.get_by_role("button", name="Open it as it was").click()
    shown_length(page, "1200 mm")
    changed.wait_for(state="hidden")
    page.get_by_text("Changes are not saved.").wait_for()
    assert "700 mm" in arm.read_text(encoding="utf-8")
    page.evaluate("window.onbeforeunload = null")


def test_another_tab_leaves_a_link_not_its_answer(server, page):
    """What is asked of another arm there does not take the place of the answer here."""
    page.goto(server.url)
    shown_length(page, "900 mm")
    page.get_by_role("button", name="Evaluate").click()
    here = page.locator(".lw-answer .lw-done")
    here.wait_for()
    said = here.inner_text()
    other = page.context.browser.new_page()
    other.set_default_timeout(120_000)
    other.goto(server.url)
    shown_length(other, "900 mm")
    choose(other, "Arm file", "other.yaml")
    shown_length(other, "1200 mm")
    other.get_by_role("button", name="Evaluate").click()
    answer = lw.evaluate(server.folder / "other.yaml").description.headline
    other.locator(".lw-answer .lw-done").filter(has_text=answer.split()[-2]).wait_for()
    page.get_by_role("link", name=answer.split()[-2]).wait_for()
    assert here.inner_text() == said
    other.close()


def test_what_a_base_says_of_a_question_is_no_more_than_text():
    """It may come from anybody: what is no question is none."""
    assert asked_from(None) is None
    assert asked_from(b"[]") is None
    assert asked_from(json.dumps({"file": 3, "texts": {}, "settings": {}}).encode()) is None

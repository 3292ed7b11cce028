"""What people do in the browser, at the width of a desk and of a phone."""

import re

import pytest

import linkwright as lw

from .conftest import ROOT

pytestmark = pytest.mark.xdist_group("browser")


@pytest.fixture(autouse=True)
def examples(server):
    """The example arm and problem as they were."""
    from linkwright.browser.server.folder import Folder

    for name in ("example-arm.yaml", "example-problem.yaml"):
        (server.folder / name).unlink(missing_ok=True)
    Folder(server.folder).add_examples()


def test_an_arm_is_edited_drawn_and_evaluated(server, page):
    """A wrong value is one line and stops the question; the worst error is that of the Python face."""
    page.goto(server.url)
    length = page.get_by_label("length", exact=True).first
    page.locator(".lw-picture svg .joint").first.wait_for()
    length.fill("650")
    length.press("Enter")
    page.get_by_role("alert").filter(has_text="chain[1].link.length: needs a unit").wait_for()
    assert page.get_by_role("button", name="Evaluate").is_disabled()
    length.fill("650 mm")
    length.press("Enter")
    page.get_by_text("reach 1050 mm").wait_for()
    page.get_by_role("tab", name="Text").click()
    assert "length: 650 mm, section:" in page.locator(".cm-content").inner_text()
    assert "An example to change" in page.locator(".cm-content").inner_text()  # comments stay
    page.get_by_label("Keep as").fill("longer.yaml")
    page.get_by_role("button", name="Save").click()
    page.get_by_text("saved as longer.yaml").wait_for()
    page.get_by_role("button", name="Evaluate").click()
    expected = lw.evaluate(server.folder / "longer.yaml")
    page.get_by_text(f"worst position error {expected.max_error_mm:.4g} mm").wait_for()
    page.locator(".lw-poses svg .bent").first.wait_for()
    report = page.frame_locator("iframe")
    report.get_by_role("heading", level=1).wait_for()
    (server.folder / "longer.yaml").unlink()


def test_a_problem_is_optimised_and_reopened(server, page):
    """Progress is seen, the arm file can be put into the folder, and the result is there after a reload."""
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    page.get_by_role("button", name="Optimise", exact=True).click()
    page.get_by_role("button", name="Stop").wait_for()
    line = page.locator(".lw-done", has_text="Optimization: worst error")
    line.wait_for()
    said = line.inner_text()
    page.get_by_label("Put the arm into the folder as").fill("best.yaml")
    page.get_by_role("button", name="Put").click()
    page.get_by_text("saved as best.yaml").wait_for()
    problem = lw.read_problem(server.folder / "example-problem.yaml")
    promised = float(re.search(r"before, ([\d.]+) mm after", said)[1])
    assert lw.evaluate(server.folder / "best.yaml", problem).max_error_mm == pytest.approx(promised, rel=1e-3)
    page.goto(server.url + "results")
    page.get_by_role("link", name=said).first.click()
    page.frame_locator("iframe").get_by_role("heading", level=1).wait_for()
    with page.expect_download() as download:
        page.get_by_role("link", name="arm.yaml", exact=True).click()
    assert download.value.path().read_text() == (server.folder / "best.yaml").read_text()
    (server.folder / "best.yaml").unlink()


def test_stop_leaves_the_best_so_far(server, page):
    """A search over the shapes of three links, stopped after its first round."""
    for name in ("arm.yaml", "problem.yaml"):
        (server.folder / name).write_bytes((ROOT / "examples" / "welding-arm" / name).read_bytes())
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    page.get_by_label("Problem file").click()
    page.get_by_role("option", name="problem.yaml", exact=True).click()
    page.get_by_text("least worst error of cathode-bus welding arm").wait_for()
    page.get_by_role("button", name="Optimise", exact=True).click()
    page.locator(".lw-log", has_text="poses").wait_for()
    page.get_by_role("button", name="Stop").click()
    page.get_by_text("Optimization: interrupted").wait_for()
    page.get_by_text("stopped, so this is the best until then").wait_for()
    for name in ("arm.yaml", "problem.yaml"):
        (server.folder / name).unlink()

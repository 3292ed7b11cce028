"""Every picture comes as PNG, SVG and (printed alone on a page of its size) PDF: of the pages and of a report."""

from xml.etree import ElementTree

import pytest

import linkwright as lw
from linkwright.browser.server.folder import Folder
from linkwright.browser.server.shelf import Shelf

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("browser")]


def saved(page, button):
    """Width, height and colours of what a button saves."""
    from PIL import Image

    with page.expect_download() as download:
        button.click()
    assert download.value.suggested_filename.endswith(".png")
    with Image.open(download.value.path()) as picture:
        assert picture.format == "PNG"
        return (*picture.size, len(picture.convert("RGB").getcolors(1 << 24)))


def saved_svg(page, button):
    """The shapes of what a button saves, each in a colour of its own style."""
    with page.expect_download() as download:
        button.click()
    assert download.value.suggested_filename.endswith(".svg")
    drawn = ElementTree.parse(download.value.path()).getroot()
    assert drawn.tag == "{http://www.w3.org/2000/svg}svg"
    return [item for item in drawn.iter() if "fill:" in item.get("style", "")]


def test_drawings_and_charts_are_saved(server, page):
    """In colours, and three times as large as they are seen; charts by their own button."""
    Folder(server.folder).add_examples()
    page.goto(server.url)
    page.get_by_role("tab", name="From the side").click()
    drawing = page.locator(".lw-picture:not(.lw-section) svg").first
    drawing.locator(".joint").first.wait_for()
    box = drawing.bounding_box()
    width, height, colours = saved(page, page.get_by_role("button", name="PNG of ").first)
    assert (width, height) == (pytest.approx(3 * box["width"], abs=3), pytest.approx(3 * box["height"], abs=3))
    assert colours > 3
    assert len(saved_svg(page, page.get_by_role("button", name="SVG of ").first)) > 3
    result = lw.evaluate(server.folder / "example-arm.yaml")
    result.save(server.folder / "made")
    report = (server.folder / "made" / "report.html").read_bytes()
    number = Shelf(server.folder).keep("evaluate", "t", "l", {"report.html": report}, complete=True, seconds=1.0)
    page.goto(f"{server.url}results/{number}")
    inside = page.frame_locator("iframe")
    assert saved(page, inside.get_by_role("button", name="PNG of ").first)[2] > 3
    chart = inside.locator(".js-plotly-plot").first
    chart.wait_for()
    assert saved(page, chart.locator(".modebar-btn").first)[2] > 3
    assert len(saved_svg(page, inside.get_by_role("button", name="SVG of ").first)) > 3
    assert len(saved_svg(page, chart.locator(".modebar-btn").nth(1))) > 3
    inside.get_by_role("button", name="PDF of ").first.click()
    printed = inside.frame_locator("iframe").locator("svg")
    printed.wait_for(state="attached")
    assert printed.locator("*").count() > 3
    chart.locator(".modebar-btn").nth(2).click()
    drawn = inside.frame_locator("iframe >> nth=-1").locator("img")
    drawn.wait_for(state="attached")
    assert drawn.get_attribute("src").startswith("data:image/svg+xml")
    Shelf(server.folder).remove(number)
    for item in (server.folder / "made").iterdir():
        item.unlink()
    (server.folder / "made").rmdir()


LUMINANCES = """button => {
    const light = text => {
        const part = text.match(/[0-9.]+/g).slice(0, 3).map(value => value / 255);
        const linear = part.map(value => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    };
    return [light(getComputedStyle(button).color), light(getComputedStyle(document.body).backgroundColor)];
}"""


def test_a_button_is_read_in_the_dark(server, page):
    """Its text against the page as WCAG 2 has it, 1.4.3: at least 4.5."""
    page.emulate_media(color_scheme="dark")
    page.goto(server.url)
    button = page.get_by_role("button", name="New arm")
    button.wait_for()
    page.locator("body.body--dark").wait_for()
    text, ground = button.evaluate(LUMINANCES)
    assert (text + 0.05) / (ground + 0.05) >= 4.5

"""What is seen: in which order on a phone, where the keyboard is, and in which colours."""

import pytest

from linkwright.browser.server.folder import Folder

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("browser")]


def test_columns_stand_above_the_button_on_a_phone(server, page):
    """Beside it at a desk. Files are chosen by a button with a name."""
    Folder(server.folder).add_examples()
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    page.get_by_role("button", name="Choose recordings").wait_for()
    page.get_by_role("button", name="Try a simulated recording").click()
    columns = page.locator(".lw-map")
    columns.last.wait_for()
    below = columns.last.bounding_box()
    button = page.get_by_role("button", name="Diagnose").bounding_box()
    if page.viewport_size["width"] < 900:
        assert below["y"] + below["height"] < button["y"]
    else:
        assert columns.first.bounding_box()["x"] > button["x"] + button["width"]


def test_the_keyboard_shows_where_it_is(server, page):
    """Each link and button that it comes to has a mark of its own, 3 px wide."""
    Folder(server.folder).add_examples()
    page.goto(server.url)
    page.locator(".lw-scene canvas").wait_for()
    marked = set()
    for _ in range(10):
        page.keyboard.press("Tab")
        kind, mark = page.evaluate(
            "() => { const e = document.activeElement; return [e.tagName, getComputedStyle(e).boxShadow]; }"
        )
        if kind in ("A", "BUTTON"):
            assert mark.endswith("0px 0px 0px 3px")
            marked.add(kind)
    assert marked == {"A", "BUTTON"}


def test_the_arm_in_space_follows_the_colours_of_the_page(server, page):
    """Also when they change while it is looked at."""
    shade = """() => {
        const drawn = document.querySelector(".lw-scene"), scene = drawn && window["scene_" + drawn.id];
        const joints = scene ? scene.children.filter(each => each.name === "joint 1") : [];
        return joints.map(each => each.material.color.getHexString())[0];
    }"""
    Folder(server.folder).add_examples()
    page.emulate_media(color_scheme="light")
    page.goto(server.url)
    page.wait_for_function(f"() => ({shade})() === '56616f'")
    page.emulate_media(color_scheme="dark")
    page.wait_for_function(f"() => ({shade})() === 'aab4c0'")

"""The arm in space: what is drawn at a pose, and the error that is told there."""

import math

import numpy as np
import pytest

import linkwright as lw
from linkwright.browser.server.folder import Folder, arm_from_text, templates
from linkwright.browser.server.posed import Posed
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.worst.workspace import Workspace

ARM = "linkwright/browser/starters/example-arm.yaml"


@pytest.mark.parametrize("q", [(0.2, -0.9), (1.3, -2.0)])
def test_the_error_is_that_of_the_pose_alone(q):
    """As a workspace of that one pose has it."""
    arm = lw.read_arm(ARM).model
    look = Posed(arm).at(q)
    assert look.worst.error == pytest.approx(evaluate(arm, Workspace("poses", poses=(q,))).max_error, rel=1e-9)
    assert look.tip == pytest.approx(place(arm, q).tip(), abs=1e-12)
    assert look.bent[0][-1] == pytest.approx(look.tip, abs=1e-12)


@pytest.mark.parametrize("name", ["six-axis arm", "hobby arm of six bus servos", "machine-tending arm"])
def test_links_are_solids_that_end_at_the_next(name):
    """Each stands right-handed, on a joint, and is as long as the file says; its outline is the section's, whose area
    no mirroring changes."""
    arm = arm_from_text("a.yaml", templates()[name]).model
    posed = Posed(arm)
    look = posed.at([0.3] * arm.size)
    for number, (link, pieces, placed) in enumerate(zip(arm.links, posed.pieces, look.links, strict=True)):
        assert np.linalg.det(placed.rotation) == pytest.approx(1.0)
        assert placed.start == pytest.approx(look.joints[number][0], abs=1e-12)
        assert placed.length == pytest.approx(link.length, abs=1e-12)
        if link.section is not None:
            ring = np.array(link.section.outline()[0])
            assert np.ptp(np.vstack([piece.outline for piece in pieces]), axis=0) == pytest.approx(np.ptp(ring, axis=0))
    assert posed.size >= np.linalg.norm(look.tip) * 0.99


PLACES = """() => {
    const scene = window["scene_" + document.querySelector(".lw-scene").id];
    const named = name => scene.children.filter(each => each.name === name).map(each => each.position.toArray());
    return {link: named("link 2"), error: named("error"), bent: named("bent").length};
}"""


@pytest.mark.slow
@pytest.mark.xdist_group("browser")
def test_sliders_move_the_arm_and_its_error(server, page):
    """By keys alone; what is told is the error there, what is drawn has moved with it."""
    Folder(server.folder).add_examples()
    page.goto(server.url)
    page.locator(".lw-scene canvas").wait_for()
    page.wait_for_function(f"() => ({PLACES})().error.length === 1")
    before = page.evaluate(PLACES)
    assert (len(before["link"]), before["bent"]) == (1, 2)
    words = page.get_by_role("status").filter(has_text="Error at this pose")
    said = words.inner_text()
    slider = page.locator(".q-slider [tabindex]").first
    slider.press("ArrowRight")
    page.get_by_text("36°", exact=True).wait_for()  # it has the focus, and no key is lost from here on
    for _ in range(9):
        slider.press("ArrowRight")
    page.get_by_text("48°", exact=True).wait_for()
    page.wait_for_function("said => document.querySelector('.lw-page').innerText.indexOf(said) < 0", arg=said)
    arm = lw.read_arm(server.folder / "example-arm.yaml").model
    there = (math.radians(-30.0 + 0.6 * 130.0), math.radians(-75.0))
    assert f"{1e3 * Posed(arm).at(there).worst.error:.3g} mm" in words.inner_text()
    page.wait_for_function(f"before => ({PLACES})().link[0][1] !== before", arg=before["link"][0][1])
    page.get_by_role("button", name="Above view").press("Enter")
    page.get_by_role("tab", name="From the side").press("Enter")
    page.locator(".lw-picture svg .joint").first.wait_for()


@pytest.mark.slow
@pytest.mark.xdist_group("browser")
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

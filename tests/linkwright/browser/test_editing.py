"""How files are edited: nothing that is not saved is lost without a word."""

import pytest
from playwright.sync_api import expect

import linkwright as lw
from linkwright.browser.server.folder import Folder

from .conftest import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("browser")]


def save(page):
    """Save what was changed: the page says that there is something a moment after, and no longer once it is written."""
    unsaved = page.get_by_text("Changes are not saved.")
    unsaved.wait_for()
    page.get_by_role("button", name="Save", exact=True).click()
    unsaved.wait_for(state="hidden")


@pytest.fixture(autouse=True)
def examples(server):
    """The example arm as it was, and another."""
    Folder(server.folder).add_examples()
    text = (server.folder / "example-arm.yaml").read_text(encoding="utf-8")
    (server.folder / "other.yaml").write_text(text.replace("example arm", "other arm"), encoding="utf-8")
    yield
    (server.folder / "example-arm.yaml").unlink()
    (server.folder / "other.yaml").unlink()


def choose(page, label, option):
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=True).click()


def test_what_is_not_saved_is_said_before_it_is_lost(server, page):
    """By a line, before another file is opened, and by the browser before another page is."""
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    unsaved = page.get_by_text("Changes are not saved.")
    length = page.get_by_label("length", exact=True).first
    length.fill("650")
    length.press("Enter")
    unsaved.wait_for()
    choose(page, "Arm file", "other.yaml")
    page.get_by_text("The changes of example-arm.yaml are not saved.").wait_for()
    page.get_by_role("button", name="Stay here").click()
    page.get_by_text("Arm: example arm, 2 joints, reach 1050 mm").wait_for()
    asked = []

    def stay(dialog):
        asked.append(dialog.type)
        dialog.dismiss()

    page.once("dialog", stay)
    page.get_by_role("link", name="Catalogues").click()
    page.get_by_text("reach 1050 mm").wait_for()
    assert asked == ["beforeunload"]
    choose(page, "Arm file", "other.yaml")
    page.get_by_role("dialog").get_by_role("button", name="Save", exact=True).click()
    page.get_by_text("Arm: other arm, 2 joints, reach 900 mm").wait_for()
    unsaved.wait_for(state="hidden")
    assert "650 mm" in (server.folder / "example-arm.yaml").read_text(encoding="utf-8")
    length.fill("700")
    length.press("Enter")
    unsaved.wait_for()
    choose(page, "Arm file", "example-arm.yaml")
    page.get_by_role("button", name="Discard them").click()
    page.get_by_text("Arm: example arm, 2 joints, reach 1050 mm").wait_for()
    assert "700 mm" not in (server.folder / "other.yaml").read_text(encoding="utf-8")
    page.get_by_role("link", name="Catalogues").click()
    page.get_by_role("heading", name="Catalogues").wait_for()
    assert asked == ["beforeunload"]


def test_names_and_keys_are_chosen_by_a_part_of_them(server, page):
    """Of materials, sizes and drives; keys with what they mean; what is wrong is said at its field."""
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    material = page.get_by_label("material", exact=True).first
    material.click()
    material.fill("s355")
    page.get_by_role("option", name="steel-s355", exact=True).click()
    page.get_by_text("Changes are not saved.").wait_for()
    page.get_by_role("button", name="2 revolute joint, link 400 mm, tube").press("Enter")
    key = page.get_by_label("Add to joint or link 2")
    key.click()
    key.fill("joint.actu")
    page.get_by_role("option", name="joint.actuator", exact=True).click()
    page.get_by_text("a name of linkwright actuators list").wait_for()
    value = page.locator(".lw-pair").nth(1).get_by_label("Value (leave empty to remove)")
    value.click()
    value.fill("RV-20E")
    page.get_by_role("option", name="RV-20E", exact=True).click()
    page.locator(".lw-pair").nth(1).get_by_role("button", name="Set", exact=True).click()
    page.get_by_label("actuator", exact=True).wait_for()
    page.get_by_text("reach 900 mm").wait_for()
    page.get_by_label("length", exact=True).first.fill("65 kg")
    page.get_by_label("length", exact=True).first.press("Enter")
    page.locator(".q-field--error", has=page.get_by_label("length", exact=True)).get_by_text("is a mass").wait_for()
    page.get_by_label("length", exact=True).first.fill("0.65 m")
    page.get_by_label("length", exact=True).first.press("Enter")
    page.locator(".q-field--error").wait_for(state="detached")
    save(page)
    arm = lw.read_arm(server.folder / "example-arm.yaml").model
    assert (arm.links[0].material.name, arm.links[0].length, arm.joints[1].actuator.name) == (
        "steel-s355",
        pytest.approx(0.65),
        "RV-20E",
    )


def test_lists_of_a_problem_are_chosen_one_by_one(server, page):
    """Names that are there stand as chips; the file has the list."""
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    material = page.get_by_label("material", exact=True)
    material.click()
    material.fill("steel-s355")
    page.get_by_role("option", name="steel-s355", exact=True).click()
    page.keyboard.press("Escape")
    save(page)
    text = (server.folder / "example-problem.yaml").read_text(encoding="utf-8")
    assert "material: [aluminium-6061-t6, steel-s355]" in text
    (server.folder / "example-problem.yaml").unlink()


def test_each_link_is_given_its_own_choice(server, page):
    """By a click; each list is chips again, and another click makes them one."""
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    page.get_by_role("button", name="Section by link").click()
    second = page.locator(".q-select", has=page.get_by_label("section 2", exact=True))
    second.get_by_label("Remove").first.press("Enter")
    expect(second.get_by_label("Remove")).to_have_count(1)
    save(page)
    problem = lw.read_problem(server.folder / "example-problem.yaml").model
    assert problem.shapes_of(0) == ("tube", "rectangular_tube")
    assert len(problem.shapes_of(1)) == 1
    page.get_by_role("button", name="One section list for all links").click()
    page.get_by_label("section", exact=True).wait_for()
    save(page)
    (server.folder / "example-problem.yaml").unlink()


def test_a_problem_that_is_wrong_shows_no_other(server, page):
    """Neither its drawing nor its button stay beside another file's fields."""
    wrong = (server.folder / "example-problem.yaml").read_text(encoding="utf-8") + "\nunknown: 1\n"
    (server.folder / "wrong.yaml").write_text(wrong, encoding="utf-8")
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    choose(page, "Problem file", "wrong.yaml")
    page.get_by_role("alert").filter(has_text="wrong.yaml: unknown").wait_for()
    page.get_by_text("least worst error of example arm").wait_for(state="hidden")
    (server.folder / "wrong.yaml").unlink()


def test_numbers_have_room_beside_relation_and_unit(server, page):
    """`<= 6 kg` on a phone: a number of six digits is read whole."""
    page.goto(f"{server.url}optimise")
    mass = page.get_by_label("mass", exact=True).first
    mass.wait_for()
    assert mass.bounding_box()["width"] > 48


def test_a_new_arm_begins_as_a_shipped_one_or_a_urdf(server, page):
    """Under a name that none has; of a URDF's ends the tip is taken; nothing is written before Save."""
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    before = {item.name for item in server.folder.iterdir()}
    page.get_by_role("button", name="New arm").click()
    choose(page, "One that is shipped", "six-axis arm")
    page.get_by_text("Arm: six-axis arm, 6 joints").wait_for()
    page.get_by_text("Changes are not saved.").wait_for()
    page.get_by_role("button", name="New arm").click()
    page.set_input_files("input[type=file]", ROOT / "examples" / "urdf" / "tabletop.urdf")
    page.get_by_role("button", name="Discard them").click()
    # The question fades, and has a Save as well.
    page.get_by_role("button", name="Discard them").wait_for(state="hidden")
    page.get_by_text(", 3 joints, ").wait_for()
    assert {item.name for item in server.folder.iterdir()} == before
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_text("saved as tabletop.yaml").wait_for()
    made = lw.read_arm(server.folder / "tabletop.yaml").model
    (server.folder / "tabletop.yaml").unlink()
    given = lw.import_arm(ROOT / "examples" / "urdf" / "tabletop.urdf", tip="tip").arm.model
    assert [joint.name for joint in made.joints] == [joint.name for joint in given.joints]
    assert [link.length for link in made.links] == pytest.approx([link.length for link in given.links], abs=1e-9)


def test_numbers_have_units_and_pairs_fold(server, page):
    """A bare number keeps its unit, another unit is typed or chosen; a pair's fields are there once it is opened, and
    a fault in a folded one opens it."""
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    assert page.get_by_label("length", exact=True).count() == 1  # the second pair is folded
    length, unit = page.get_by_label("length", exact=True), page.get_by_label("unit of length")
    length.fill("650")
    length.press("Enter")
    page.get_by_text("reach 1050 mm").wait_for()
    length.fill("0.7 m")
    length.press("Enter")
    page.get_by_text("reach 1100 mm").wait_for()
    assert (length.input_value(), unit.input_value()) == ("0.7", "m")
    unit.click()
    page.get_by_role("option", name="cm", exact=True).click()
    page.get_by_text("reach 407 mm").wait_for()
    page.get_by_label("range from").first.fill("-90")
    page.get_by_label("range from").first.press("Enter")
    page.get_by_role("tab", name="Text").click()
    assert "range: [-90 deg, 100 deg]" in page.locator(".cm-content").inner_text()
    assert "length: 0.7 cm" in page.locator(".cm-content").inner_text()
    text = (server.folder / "other.yaml").read_text(encoding="utf-8")
    (server.folder / "other.yaml").write_text(text.replace("length: 400 mm", "length: 400 kg"), encoding="utf-8")
    page.evaluate("window.onbeforeunload = null")
    page.reload()
    page.get_by_text("reach 900 mm").wait_for()
    choose(page, "Arm file", "other.yaml")
    page.locator(".lw-pair").nth(1).locator(".q-field--error").get_by_text("is a mass").wait_for()


def test_a_section_is_drawn_as_it_is_chosen(server, page):
    """A shape gets dimensions about as large, a stock size is one name; both are arms at once."""
    page.goto(server.url)
    page.get_by_text("reach 900 mm").wait_for()
    drawn = page.locator(".lw-section svg").first
    drawn.wait_for()
    before = drawn.get_attribute("aria-label")
    section = page.get_by_label("section", exact=True).first
    section.click()
    section.fill("tube")
    page.get_by_role("option", name="tube", exact=True).click()
    page.get_by_label("diameter", exact=True).first.wait_for()
    page.wait_for_function(
        "before => document.querySelector('.lw-section svg')?.getAttribute('aria-label') !== before", arg=before
    )
    page.get_by_role("tab", name="Text").click()
    assert "section: {shape: tube, diameter: 120 mm, thickness: 5 mm}" in page.locator(".cm-content").inner_text()
    page.get_by_role("tab", name="Fields").click()
    section = page.get_by_label("section", exact=True).first
    section.click()
    section.fill("IPE 80")
    page.get_by_role("option", name="IPE 80", exact=True).click()
    page.get_by_label("diameter", exact=True).wait_for(state="detached")
    page.locator(".lw-section svg[aria-label*='IPE 80'], .lw-section svg[aria-label*='46']").first.wait_for()
    page.evaluate("window.onbeforeunload = null")

"""What people do in the browser, at the width of a desk and of a phone."""

import re

import pytest
from playwright.sync_api import TimeoutError as NotSeen

import linkwright as lw
from linkwright.browser.server.folder import Folder
from linkwright.browser.server.shelf import Shelf

from .conftest import ROOT, Server

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def examples(server):
    """The example arm and problem as they were."""
    for name in ("example-arm.yaml", "example-problem.yaml"):
        (server.folder / name).unlink(missing_ok=True)
    Folder(server.folder).add_examples()


def test_an_arm_is_edited_drawn_and_evaluated(server, page):
    """A wrong value is one line and stops the question; the worst error is that of the Python face."""
    page.goto(server.url)
    length = page.get_by_label("length", exact=True).first
    page.get_by_role("tab", name="From the side").click()
    page.locator(".lw-picture svg .joint").first.wait_for()
    before = page.locator(".lw-picture:has(.joint)").first.inner_html()
    page.locator(".q-slider [tabindex]").first.press("ArrowRight")
    page.get_by_text("36°", exact=True).wait_for()
    page.wait_for_function(
        "before => document.querySelector('.lw-picture:has(.joint)').innerHTML !== before", arg=before
    )
    length.fill("650 kg")
    length.press("Enter")
    page.get_by_role("alert").filter(has_text="chain[1].link.length: '650 kg' is a mass").wait_for()
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
    page.locator(".lw-answer .lw-done", has_text=f"{expected.max_error_mm:.5g} mm").wait_for()
    page.locator(".lw-poses svg .bent").first.wait_for()
    report = page.frame_locator("iframe")
    report.get_by_role("heading", level=1).wait_for()
    (server.folder / "longer.yaml").unlink()


def test_an_empty_folder_says_where_to_begin(page, tmp_path):
    """Instead of empty boxes; the examples take its place."""
    empty = Server(tmp_path)
    try:
        for question in ("optimise", "tradeoff", ""):
            page.goto(empty.url + question)
            page.get_by_role("heading", name="Where to begin").wait_for()
            assert not page.get_by_role("button", name="Save").is_visible()
        page.get_by_role("button", name="Add the examples").click()
        page.get_by_text("reach 900 mm").wait_for()
        assert page.get_by_role("button", name="Save").is_visible()
        assert not page.get_by_role("heading", name="Where to begin").is_visible()
        page.goto("about:blank")
    finally:
        empty.end()


def test_a_robot_of_the_folder_is_an_arm(page, tmp_path):
    """A new arm begins from it, a diagnosis takes it as it is; without any the page says so. A page that was closed
    early leaves nothing in the server's log."""
    bare = Server(tmp_path)
    try:
        page.goto(bare.url + "diagnosis")
        page.get_by_text("The folder has no arm file, URDF or MJCF.").wait_for()
        assert page.get_by_role("button", name="Try a simulated recording of this arm").is_disabled()
        (tmp_path / "robot.urdf").write_text((ROOT / "examples" / "urdf" / "tabletop.urdf").read_text())
        page.goto(bare.url)
        page.get_by_role("heading", name="Where to begin").wait_for()
        page.get_by_label("Arm file").click()
        page.get_by_role("option", name="robot.urdf").click()
        page.get_by_text("Arm: tabletop, 3 joints").wait_for()
        page.get_by_role("button", name="Save").click()
        page.get_by_text("saved as robot.yaml").wait_for()
        (tmp_path / "robot.yaml").unlink()
        page.goto(bare.url + "diagnosis")
        page.locator("input[value='robot.urdf']").or_(page.get_by_text("robot.urdf")).first.wait_for()
        page.get_by_role("button", name="Try a simulated recording of this arm").click()
        page.get_by_text("Recording: simulated.csv").wait_for()
        Folder(tmp_path).add_examples()
        early = page.context.browser.new_page()
        early.goto(bare.url)
        early.close()
        page.goto("about:blank")
        page.wait_for_timeout(11_000)  # as long as the server waits for what the page prefers
    finally:
        assert bare.end()[2] == ""


def test_a_problem_is_optimised_and_reopened(server, page):
    """Progress is seen, the arm file can be put into the folder, and the result is there after a reload."""
    page.goto(server.url + "optimise")
    page.get_by_text("least worst error of example arm").wait_for()
    page.get_by_role("button", name="Optimise", exact=True).click()
    page.get_by_role("button", name="Stop").wait_for()
    line = page.locator(".lw-answer .lw-done", has_text="Worst error")
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
    page.goto(server.url + "optimise")  # which opens the problem of the answer before, where there is one
    page.get_by_text("least worst error of").first.wait_for()
    page.get_by_label("Problem file").click()
    page.get_by_role("option", name="problem.yaml", exact=True).click()
    page.get_by_text("least worst error of cathode-bus welding arm").wait_for()
    page.get_by_role("button", name="Optimise", exact=True).click()
    page.locator(".lw-log", has_text="poses").wait_for()
    page.get_by_role("button", name="Stop").click()
    page.get_by_text("stopped, so this is the best so far").wait_for()
    for name in ("arm.yaml", "problem.yaml"):
        (server.folder / name).unlink()


def test_a_front_is_traced_and_clicked(server, page):
    """Each point gives its design, and that an arm file to download."""
    problem = """\
arm: example-arm.yaml
workspace: {path: [[600 mm, 100 mm], [600 mm, 200 mm]]}
subject_to: {mass: "<= 20 kg", max_error: "<= 0.5 mm", section_size: [40 mm, 100 mm]}
choose: {section: [circle], same: [size, material], material: [aluminium-6061-t6]}
"""
    (server.folder / "example-problem.yaml").write_text(problem, encoding="utf-8")
    page.goto(server.url + "tradeoff")
    page.get_by_text("least worst error of example arm").wait_for()
    earlier = [kept.id for kept in Shelf(server.folder).all() if kept.kind == "tradeoff"]
    if earlier:  # traced at another width: opened again, which is shown in the same way
        page.goto(f"{server.url}results/{earlier[0]}")
    else:
        page.get_by_label("Accuracy").click()
        page.get_by_role("option", name="30 %: a first look").click()
        page.get_by_role("button", name="Trade-off", exact=True).click()
    page.get_by_role("heading", name="Design 1", exact=True).wait_for()
    points = page.locator(".js-plotly-plot .scatterlayer .trace").first.locator(".point")
    points.last.wait_for()
    heading = page.get_by_role("heading", name=re.compile(r"Design ([2-9]|\d\d)"))
    _click_until(page, points.last, heading)
    number = int(heading.inner_text().split()[1])
    told = dict(zip(*[iter(page.locator(".lw-table").first.locator("td").all_inner_texts())] * 2, strict=True))
    with page.expect_download() as download:
        page.get_by_role("link", name=f"arm file of design {number}").click()
    arm = server.folder / "clicked.yaml"
    arm.write_bytes(download.value.path().read_bytes())
    result = lw.evaluate(arm, server.folder / "example-problem.yaml")
    assert float(told["mass of the links"].split()[0]) == pytest.approx(result.mass_kg, rel=1e-3)
    assert float(told["worst error"].split()[0]) == pytest.approx(result.max_error_mm, rel=1e-3)
    arm.unlink()
    page.emulate_media(color_scheme="dark")
    page.locator("body.body--dark").wait_for()
    shade = page.locator(".js-plotly-plot .xtick text").first.evaluate("text => getComputedStyle(text).fill")
    assert min(int(part) for part in re.findall(r"\d+", shade)[:3]) > 150  # read in the dark


def _click_until(page, point, seen):
    """Click a point of a plot, and again as people do where the plot was drawn anew under the first click.

    A drag surface lies over the points, so that Playwright cannot itself wait for a point that holds still.
    """
    for _ in range(3):
        page.locator(".js-plotly-plot .nsewdrag").scroll_into_view_if_needed()
        box = point.bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        try:
            seen.wait_for(timeout=20_000)
        except NotSeen:
            continue
        return
    seen.wait_for()


def test_a_dropped_recording_is_diagnosed(server, page, tmp_path):
    """Foreign columns are proposed; one that is read wrongly is corrected; the report names what was put in."""
    offset = {"effect": "encoder_offset", "at": 2, "offset": "0.3 deg"}
    made = lw.simulate(server.folder / "example-arm.yaml", poses=12, repeats=2, with_=[offset], sides="one").table
    foreign = made.rename(
        columns={"q1_deg": "Axis 1", "q2_deg": "Axis 2 [deg]", "x_mm": "TCP X", "y_mm": "Height", "time_s": "Time (s)"}
    )
    (tmp_path / "tracker export.csv").write_text(foreign.to_csv(index=False), encoding="utf-8")
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    page.set_input_files("input[type=file]", tmp_path / "tracker export.csv")
    page.get_by_role("alert").filter(has_text="tracker export.csv: y: is missing").wait_for()
    assert page.get_by_role("button", name="Diagnose").is_disabled()
    row = page.locator(".lw-map").filter(has_text="Height")
    row.get_by_role("combobox").first.click()
    page.get_by_role("option", name="y", exact=True).click()
    page.get_by_text("Recording: tracker export.csv, 24 readings").wait_for()
    page.get_by_text("TCP X: mm is a guess by the size of its numbers").wait_for()
    page.get_by_role("button", name="Diagnose").click()
    page.locator(".lw-done", has_text="joint 2").wait_for()
    page.frame_locator("iframe").get_by_role("heading", level=1).wait_for()
    with page.expect_download() as download:
        page.get_by_role("link", name="recording.yaml", exact=True).click()
    settings = tmp_path / "settings.yaml"
    settings.write_bytes(download.value.path().read_bytes())
    read = lw.read_recording(tmp_path / "tracker export.csv", server.folder / "example-arm.yaml", settings=settings)
    assert read.table["y_mm"].to_numpy() == pytest.approx(made["y_mm"].to_numpy())


def test_a_dropped_motion_log_is_diagnosed(server, page, tmp_path):
    """The same drop, the same button: what is left out of the torques of the arm that is chosen."""
    arm = server.folder / "four-axis.yaml"
    lw.import_arm(ROOT / "examples" / "motion-log" / "robot.urdf").save(arm)
    text = (ROOT / "examples" / "motion-log" / "log.csv").read_text(encoding="utf-8")
    (tmp_path / "bag.csv").write_text(text.replace("t_s", "Time [s]").replace("tau", "torque "), encoding="utf-8")
    page.goto(server.url + "diagnosis")
    page.get_by_label("Arm file").click()
    page.get_by_role("option", name="four-axis.yaml", exact=True).click()
    page.set_input_files("input[type=file]", tmp_path / "bag.csv")
    page.get_by_text("Log: bag.csv, 2500 samples in 25 s, torques of 4 joints").wait_for()
    page.get_by_label("Tool point").wait_for(state="hidden")  # which no torque depends on
    page.get_by_role("button", name="Diagnose").click()
    page.locator(".lw-answer .lw-done").wait_for()
    report = page.frame_locator("iframe")
    report.get_by_role("heading", name="four-axis arm: what the model lacks in the torques").wait_for()
    report.locator(".torques .js-plotly-plot").first.wait_for()
    with page.expect_download() as download:
        page.get_by_role("link", name="arm.yaml", exact=True).click()
    corrected = tmp_path / "corrected.yaml"
    corrected.write_bytes(download.value.path().read_bytes())
    other = ROOT / "examples" / "motion-log" / "other.csv"
    assert lw.predict(corrected, other).rms < 0.01 * lw.predict(arm, other).rms
    arm.unlink()


def test_what_the_checker_proposes_is_taken_by_a_click(server, page, tmp_path):
    """A joint that counts the other way; a column's sign, factor and zero in its own fields."""
    arm = server.folder / "example-arm.yaml"
    made = lw.simulate(arm, poses=12, repeats=1, sides="one").table
    odd = made.assign(q2_deg=-made["q2_deg"], x_mm=made["x_mm"] / 2.0)
    odd.to_csv(tmp_path / "odd.csv", index=False)
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    page.set_input_files("input[type=file]", tmp_path / "odd.csv")
    page.get_by_role("alert").filter(has_text="odd.csv").wait_for()
    row = page.locator(".lw-map").filter(has_text="x_mm")
    factor = row.get_by_label("factor of ", exact=False)
    factor.fill("two")
    factor.press("Enter")
    row.get_by_text("needs a number").wait_for()
    factor.fill("2")
    factor.press("Enter")
    page.get_by_role("button", name="Take columns: {q2_deg: -q2_deg}").click()
    page.get_by_text("Recording: odd.csv, 12 readings").wait_for()
    row = page.locator(".lw-map").filter(has_text="q2_deg")
    assert row.get_by_label("factor of ", exact=False).input_value() == "-1"
    row.get_by_role("button", name="other sign of ", exact=False).click()
    page.get_by_role("alert").filter(has_text="q2_deg counts the other way").wait_for()
    row.get_by_role("button", name="other sign of ", exact=False).click()
    page.get_by_text("Recording: odd.csv, 12 readings").wait_for()


def test_several_recordings_are_diagnosed_at_once(server, page, tmp_path):
    """Dropped one after the other: each has its columns and settings, what is wrong with any stops the question, and
    the report tells of both."""
    offset = {"effect": "encoder_offset", "at": 2, "offset": "0.3 deg"}
    arm = server.folder / "example-arm.yaml"
    for number, name in enumerate(("monday", "tuesday"), start=1):
        made = lw.simulate(arm, poses=10, repeats=2, with_=[offset], sides="one", seed=number).table
        text = made.rename(columns={"y_mm": "Height"}).to_csv(index=False)
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    page.set_input_files("input[type=file]", tmp_path / "monday.csv")
    page.get_by_role("alert").filter(has_text="monday.csv: y: is missing").wait_for()
    column = page.locator(".lw-map").filter(has_text="Height")
    column.get_by_role("combobox").first.click()
    page.get_by_role("option", name="y", exact=True).click()
    page.get_by_text("Recording: monday.csv, 20 readings").wait_for()
    page.set_input_files("input[type=file]", tmp_path / "tuesday.csv")
    page.get_by_text("Recording: tuesday.csv, 20 readings").wait_for()  # what was said of the one before holds
    page.get_by_text("What the columns of tuesday.csv are").wait_for()
    page.get_by_label("Lines above the header").fill("3")
    page.get_by_label("Lines above the header").press("Enter")
    page.get_by_role("alert").filter(has_text="tuesday.csv").wait_for()
    assert page.get_by_role("button", name="Diagnose").is_disabled()
    page.get_by_label("Lines above the header").fill("")
    page.get_by_label("Lines above the header").press("Enter")
    page.get_by_role("alert").filter(has_text="tuesday.csv: y: is missing").wait_for()
    column.get_by_role("combobox").first.click()
    page.get_by_role("option", name="y", exact=True).click()
    page.get_by_label("Recording", exact=True).click()
    page.get_by_role("option", name="monday.csv", exact=True).click()
    page.get_by_text("What the columns of monday.csv are").wait_for()
    page.get_by_role("button", name="Diagnose").click()
    page.locator(".lw-answer .lw-done").wait_for()
    report = page.frame_locator("iframe")
    report.get_by_text("tuesday.csv").first.wait_for()
    for name in ("recording-1.yaml", "recording-2.yaml"):
        page.get_by_role("link", name=name, exact=True).wait_for()
    page.get_by_role("button", name="Take out").click()
    page.get_by_label("Recording", exact=True).wait_for(state="hidden")
    page.get_by_text("Recording: tuesday.csv, 20 readings").wait_for()


def test_who_has_no_recording_tries_a_simulated_one(server, page):
    """It is read, its columns are shown, and the diagnosis finds what was put into it."""
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    tried = page.get_by_role("button", name="Try a simulated recording of this arm")
    page.wait_for_timeout(1000)
    if page.locator(".lw-answer .lw-done").count():  # answered at another width: what a recording is, is known
        assert not tried.is_visible()
        return
    tried.click()
    page.get_by_text("Recording: simulated.csv").wait_for()
    tried.wait_for(state="hidden")
    page.get_by_role("button", name="Diagnose").click()
    page.locator(".lw-done", has_text="ncoder").first.wait_for()
    page.get_by_text("Diagnosis of example-arm.yaml by simulated.csv").wait_for()


def test_an_actuator_is_edited_in_place(server, page):
    """A price stands alone; another figure copies the shipped entry; zones are a list."""
    page.goto(server.url + "catalogues")
    page.get_by_role("tab", name="Actuators").click()
    grid = page.get_by_role("tabpanel")
    grid.locator(".ag-row").first.wait_for()
    grid.get_by_label("Show only").fill("RV-20E")
    row = grid.locator(".ag-row[row-id='RV-20E']")

    def write(column, text):
        cell = row.locator(f"[col-id={column}]")
        cell.scroll_into_view_if_needed()
        cell.dblclick()
        page.keyboard.press("Control+A")
        page.keyboard.type(text)
        page.keyboard.press("Enter")
        return cell

    write("cost", "900 EUR")
    grid.get_by_role("alert").filter(has_text="say where the price is from").wait_for()
    grid.get_by_label("Source of your figures").fill("Offer 12")
    write("cost", "900 EUR")
    grid.get_by_text("set the price of RV-20E").wait_for()
    own = server.folder.parent / "no-configuration" / "linkwright" / "actuators.yaml"
    assert "actuators: {}" in own.read_text(encoding="utf-8")
    write("mass", "-1 kg")
    grid.get_by_role("alert").filter(has_text="actuators.RV-20E.mass: must be positive").wait_for()
    write("stiffness", "[40 N*m/arcmin, 50 N*m/arcmin]")
    grid.get_by_role("alert").filter(has_text="zone_torques").wait_for()
    write("mass", "4900 g")
    grid.get_by_text("set RV-20E.mass, copied from the shipped catalogue").wait_for()
    row.locator("[col-id=mass]").get_by_text("4.9 kg").wait_for()
    assert "mass: Offer 12" in own.read_text(encoding="utf-8")
    own.unlink()  # the next width begins with the shipped catalogue


def test_a_material_is_edited_in_place(server, page):
    """The command line's checks; a shipped one is copied."""
    page.goto(server.url + "catalogues")
    page.locator(".ag-row").first.wait_for()
    page.get_by_label("Show only").fill("steel-s355")
    cell = page.locator(".ag-row[row-id='steel-s355'] [col-id=density]")

    def write(text):
        cell.dblclick()
        page.keyboard.press("Control+A")
        page.keyboard.type(text)
        page.keyboard.press("Enter")

    write("7 m")
    page.get_by_role("alert").filter(has_text="'7 m' is a length, not a density").wait_for()
    cell.get_by_text("7850 kg/m^3").wait_for()
    page.get_by_label("Source of your figures").fill("weighed by us")
    write("7.9 g/cm^3")
    cell.get_by_text("7900 kg/m^3").wait_for()
    own = server.folder.parent / "no-configuration" / "linkwright" / "materials.yaml"
    assert "7.9 g/cm^3" in (text := own.read_text(encoding="utf-8"))
    assert "weighed by us" in text
    own.unlink()


def test_a_result_is_removed(server, page):
    """From the list, and from the disk."""
    number = Shelf(server.folder).keep("evaluate", "a title", "a line <b>of</b> text", {}, complete=True, seconds=1.0)
    page.goto(server.url + "results")
    page.get_by_text("a line <b>of</b> text").wait_for()
    page.get_by_role("button", name=f"remove result {number}", exact=True).click()
    page.get_by_text("a line <b>of</b> text").wait_for(state="detached")
    assert Shelf(server.folder).find(number) is None


def test_columns_stand_above_the_button_on_a_phone(server, page, tmp_path):
    """Beside it at a desk. Files are chosen by a button with a name."""
    page.goto(server.url + "diagnosis")
    page.get_by_text("example-arm.yaml").or_(page.locator("input[value='example-arm.yaml']")).first.wait_for()
    page.get_by_role("button", name="Choose recordings").wait_for()
    made = lw.simulate(server.folder / "example-arm.yaml", poses=12, repeats=1, sides="one").table
    made.to_csv(tmp_path / "tips.csv", index=False)
    page.set_input_files("input[type=file]", tmp_path / "tips.csv")
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

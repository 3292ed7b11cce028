"""What is said of keys, and what a new arm can begin as, without a browser."""

import linkwright as lw
from linkwright.browser.server.folder import arm_from_text, templates
from linkwright.browser.server.parts import known_keys, meaning, to_choose


def test_keys_are_those_of_the_page_on_files():
    """Top, joints, links, limits and choices; every one of them with a meaning."""
    arm, problem = known_keys("arm", 2), known_keys("problem", 0)
    assert {"gravity", "chain[1].joint.backlash", "chain[2].link.section"} <= set(arm)
    assert not any(item.startswith("chain[3]") for item in arm)
    assert {"workspace", "subject_to.mass", "subject_to.thickness", "choose.material"} <= set(problem)
    assert meaning("arm", ("chain", 0, "joint", "clearance")).startswith("radius within which the pin's centre")
    assert "N*m/rad" in meaning("arm", ("chain", 0, "joint", "stiffness"))
    assert meaning("arm", ("chain", 0, "link", "section", "thickness"), "tube") == "wall thickness"
    assert meaning("problem", ("subject_to", "mass")) == "mass of the links, kg: <= or == or >="
    for key in arm:
        place = tuple(part for part in key.replace("[1]", "").replace("[2]", "").split("."))
        assert meaning("arm", place), key
    for key in problem:
        assert meaning("problem", tuple(key.split("."))), key


def test_names_are_those_of_the_catalogues():
    assert set(to_choose(("chain", 0, "link", "material"))) == set(lw.materials)
    assert set(to_choose(("chain", 0, "link", "section"))) == set(lw.sections)
    assert set(to_choose(("choose", "section"))) == set(lw.shapes)
    assert to_choose(("chain", 0, "link", "length")) == []


def test_templates_are_arms():
    """Each is read, and under its own name."""
    result = templates()
    assert len(result) >= 5
    assert {name: arm_from_text("a.yaml", text).name for name, text in result.items()} == {
        name: name for name in result
    }

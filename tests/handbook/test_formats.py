"""docs/formats.md has every key that a file of each kind may hold; what people write by hand stays short."""

import re
from pathlib import Path

import pytest

import linkwright as lw
from handbook.sources import ROOT, project_files
from linkwright.core.arm.files.read import arm_from
from linkwright.core.diagnose.reading.settings import read_settings
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.budget.sheet import read_sheet
from linkwright.core.units.reading import Mapping, load_yaml, parse_yaml
from tests.handbook.pages import FENCED

PAGE = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
YAML = re.findall(r"^```yaml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
OTHER_PAGES = re.compile(r"section|material|effects|tolerances|choose\.sizes")
"""Parts of a file whose keys stand on another page: shapes, materials, effects."""


@pytest.fixture
def asked(monkeypatch):
    """Every key that a reader asks of a file that a user writes, there or not."""
    names = set()
    has = Mapping.has

    def noting(self, name):
        own = str(self.file).startswith((str(ROOT / "examples"), "formats.md", "recording.yaml"))
        if own and not OTHER_PAGES.search(self.key):
            names.add(name)
        return has(self, name)

    monkeypatch.setattr(Mapping, "has", noting)
    return names


def untold(names):
    """The keys that the page does not name as code."""
    code = " ".join([*re.findall(r"`([^`\n]+)`", PAGE), *YAML])
    return sorted(name for name in names if not re.search(rf"\b{re.escape(name)}\b", code))


def test_keys_of_arms(asked):
    """All that is asked for where the examples and the page's own arm are read."""
    files = [ROOT / name for name in project_files() if re.fullmatch(r"examples/.*arm[^/]*\.yaml", name)]
    for path in files:
        lw.read_arm(path)
    arm_from(Mapping(parse_yaml(YAML[0], file="formats.md"), file="formats.md"), load_catalogue())
    assert {"tilting_stiffness", "balancer", "bends_over", "clearance", "machining"} <= asked
    assert untold(asked) == []


def test_keys_of_problems(asked):
    """The same of problems; every limit is on the page of limits."""
    for name in project_files():
        if re.fullmatch(r"examples/.*problem[^/]*\.yaml", name):
            lw.read_problem(ROOT / name)
    limits = (ROOT / "docs" / "how-to" / "limits.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` |" in limits for name in lw.limits)
    assert {"relative_to", "robust", "choose"} <= asked
    assert untold(asked - set(lw.limits)) == []


def test_keys_of_recordings(asked, tmp_path, monkeypatch):
    """Every setting."""
    monkeypatch.chdir(tmp_path)
    Path("recording.yaml").write_text("frame: free\n", encoding="utf-8")
    read_settings(Path("recording.yaml"))
    assert {"time_format", "observes", "sigma"} <= asked
    assert untold(asked) == []


def test_keys_of_sheets(asked):
    """And of data sheets."""
    arm = lw.read_arm(ROOT / "examples" / "hobby-arm" / "arm.yaml")
    other = arm.replace("chain[1].joint.backlash", "9 deg").model
    read_sheet(load_yaml(ROOT / "examples" / "hobby-arm" / "sheet.yaml"), arm.model, lambda _: other)
    assert {"share", "better", "draws"} <= asked
    assert untold(asked) == []


def test_a_key_that_is_not_told_is_seen():
    """The check checked."""
    assert untold({"stiffness", "no_such_key"}) == ["no_such_key"]


MADE = {"docs/rules.md", "docs/effects.md", "docs/instruments.md"}
"""Pages that a command writes."""


def typed(block):
    """What a reader is to type: a plain block without what is printed, any other as it is."""
    lines = block[3].splitlines()
    return "\n".join(lines if block[2].strip() else [line for line in lines if line.startswith(("$ ", "linkwright "))])


def by_hand(path):
    """The words of a page without what commands print: a part between marks, what stands beneath a command, tables and
    cases of the proof and of real machines."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"<!-- begin:.*?<!-- end:[^>]*>", "", text, flags=re.DOTALL)
    lines = FENCED.sub(typed, text).splitlines()
    if path.name in ("proof.md", "real-machines.md"):
        lines = [line for line in lines if not re.match(r"\||- [0-9]{5} ", line)]
    return sum(len(line.split()) for line in lines)


def test_what_is_written_by_hand_stays_short():
    """README at most 900 words, with the pages of docs/ at most 22,000. Shorten a page before you lengthen one."""
    pages = [name for name in project_files() if re.fullmatch(r"docs/.*\.md", name) and name not in MADE]
    assert by_hand(ROOT / "README.md") <= 900
    assert by_hand(ROOT / "README.md") + sum(by_hand(Path(ROOT / name)) for name in pages) <= 22_000


def test_pages_open_with_a_sentence():
    """What one can do after reading a page stands below its title, before any command, table or list."""
    pages = [ROOT / name for name in project_files() if re.fullmatch(r"README.md|docs/.*\.md", name)]
    firsts = {page.name: page.read_text(encoding="utf-8").split("\n", 2)[2] for page in pages}
    assert [name for name, text in firsts.items() if not re.match(r"(?!```)[A-Z`][^\n]*\w", text)] == []

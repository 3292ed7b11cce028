"""One description of a result, rendered for the screen, as HTML and as Markdown: all say the same."""

import io
from dataclasses import replace

import pytest
from markdown_it import MarkdownIt
from rich.console import Console

from linkwright.core.arm.compensation import table_over
from linkwright.core.diagnose.compare.compare import compare
from linkwright.face import compensation
from linkwright.face.planning import comparison
from linkwright.markdown.described import escaped
from linkwright.markdown.described import markdown as written
from linkwright.report.described import page_of
from linkwright.results import evaluation as evaluations
from linkwright.results import optimization
from linkwright.results.diagnoses import described as diagnoses
from linkwright.results.diagnoses.answer import to_do
from linkwright.results.document import (
    Bars,
    Description,
    Facts,
    Lines,
    Paragraph,
    Section,
    Table,
    amount,
    table,
    words,
)
from linkwright.screen.described import show
from tests.diagnose.made_diagnosis import made_arm, made_diagnosis
from tests.linkwright.reports.test_report import Page

KINDS = (
    "evaluation",
    "optimisation",
    "named",
    "alias_class",
    "unknown",
    "none",
    "insufficient_data",
    "compensation",
    "comparison",
)


@pytest.fixture(scope="module", params=KINDS)
def described(request, evaluation, result):
    """(a result, its description)."""
    if request.param == "evaluation":
        return evaluation, evaluations.describe(evaluation)
    if request.param == "optimisation":
        return result, optimization.describe(result)
    if request.param == "compensation":
        found = table_over(evaluation.arm, 4, (1.0,))
        return found, compensation.describe(found)
    if request.param == "comparison":
        found = compare(made_arm(), made_diagnosis("named"), made_diagnosis("alias_class"))
        return found, comparison.describe(found)
    found = made_diagnosis(request.param)
    return found, diagnoses.describe(found)


def _screen(description):
    out = io.StringIO()
    show(Console(file=out, width=400, highlight=False, markup=False), description)
    return out.getvalue()


def test_gravity_that_nobody_gave_is_warned_of_first():
    """Of an arm in space whose links weigh something, where something was found; not where the file gives it."""
    arm = made_arm(space=True)
    given, none = (made_diagnosis("named", arm=replace(arm, gravity_given=is_given)) for is_given in (True, False))
    first = next(item for item in diagnoses.describe(none).items if isinstance(item, Paragraph))
    assert (first.tone, first.text.partition(":")[0]) == ("warning", "No gravity is given")
    assert "WARNING: No gravity is given" in _screen(diagnoses.describe(none))
    assert "`gravity`" in to_do(none)[0]
    assert "gravity" not in _screen(diagnoses.describe(given))


def _one_line(text):
    return " ".join(text.replace("\u00a0", " ").split())


def _sentences(items, *, brief):
    """Everything that is said beside tables."""
    for item in items:
        if brief and getattr(item, "detail", False):
            continue
        if isinstance(item, Section):
            yield from _sentences(item.items, brief=brief)
        elif isinstance(item, Paragraph):
            yield item.text
        elif isinstance(item, Lines):
            yield from item.lines


def tables(items):
    """All tables, in order, those of the figures among them."""
    for item in items:
        if isinstance(item, Section):
            yield from tables(item.items)
        elif isinstance(item, Facts | Table):
            yield item.table if isinstance(item, Facts) else item


def _said(description):
    """Every cell of every table, and every sentence."""
    cells = {words(cell) for item in tables(description.items) for row in item.rows for cell in row}
    return {_one_line(text) for text in (description.headline, *_sentences(description.items, brief=False), *cells)}


def _read(source):
    """Markdown read by a parser of its own: its headings, cells and sentences, and each table's rows."""
    result, rows, row = [], [], []
    for token in MarkdownIt("commonmark").enable("table").parse(source):
        if token.type == "inline":
            text = "".join(child.content for child in token.children or () if child.type in ("text", "text_special"))
            result.append(_one_line(text))
            row.append(result[-1])
        elif token.type == "tr_open":
            row = []
        elif token.type == "tr_close":
            rows.append(row)
            row = []
    return result, rows


def test_page_says_all_of_it(described):
    """Every cell and every sentence of the description, and no cell that it has not."""
    _, description = described
    page = Page(page_of(description))
    assert page.open == []
    for text in _said(description) - {_one_line(description.headline)}:
        assert text in page.text, text


def test_markdown_says_all_of_it(described):
    """Read back by a parser: every sentence, and every table cell for cell."""
    _, description = described
    result, rows = _read(written(description))
    for text in _said(description):
        assert not text or text in result or any(text in item for item in result), text
    for each in tables(description.items):
        kept = [k for k in range(len(each.columns)) if not any(isinstance(row[k], Bars) for row in each.rows)]
        for row in each.rows:
            assert [_one_line(words(row[k])) for k in kept] in rows


def test_screen_says_what_is_no_detail(described):
    """Brief rows of every table that it shows, and the sentences, whole."""
    _, description = described
    text = _one_line(_screen(description))
    for sentence in _sentences(description.items, brief=True):
        assert _one_line(sentence) in text, sentence
    for item in tables(description.items):
        shown = item.shortened()
        for row in () if item.detail else shown.rows:
            for cell in row:
                if not _inside_detail(description.items, item):
                    assert _one_line(words(cell)) in text, words(cell)


def _inside_detail(items, wanted):
    return any(
        isinstance(item, Section)
        and ((item.detail and wanted in list(tables([item]))) or _inside_detail(item.items, wanted))
        for item in items
    )


ODD = "a|b <i>&amp; [red]*x*_y_`z`\\ \x1b[31m\n# c"


def test_odd_names_stay_text_everywhere():
    """Markup of any kind is shown as it stands; control characters are taken out, line feeds become blanks."""
    shown = "a|b <i>&amp; [red]*x*_y_`z`\\ \ufffd[31m # c"
    rows = [(ODD, amount(1.0, "mm"))]
    description = Description(ODD, ODD, (Paragraph(ODD), Lines((ODD,)), table((ODD, "size"), rows)))
    assert "\x1b" not in _screen(description) + written(description) + page_of(description)
    assert _screen(description).count(_one_line(shown)) >= 2
    page = Page(page_of(description))
    assert page.text.count(_one_line(shown)) == 6  # the title, twice, and all four places of the body
    assert "i" not in {tag for tag, _ in page.tags}
    result, cells = _read(written(description))
    assert result.count(_one_line(shown)) == 6
    assert [_one_line(shown), "1 mm"] in cells


@pytest.mark.parametrize("line", ["# no heading", "1. no list", "- no list", "+ no list", "=", "---", "0.63 mm", "-5"])
def test_no_line_opens_a_block(line):
    """A sentence is a sentence, whatever it begins with; a number is left as it is."""
    tokens = MarkdownIt("commonmark").enable("table").parse(f"before\n\n{escaped(line)}\n")
    assert [token.type for token in tokens if token.type.endswith("_open")] == ["paragraph_open"] * 2
    text = "".join(child.content for child in tokens[-2].children)
    assert text == line
    assert escaped("0.63 mm") == "0.63 mm"


def test_a_long_table_is_short_on_the_screen():
    """Its first rows, and where the others are; a page folds them; Markdown has them all."""
    rows = [(f"row {k}", amount(float(k), "mm")) for k in range(60)]
    made = table(("what", "size"), rows, first=3, rest="and 57 more, in result.json")
    description = Description("t", "h", (made,))
    text = _screen(description)
    assert "row 2" in text
    assert "row 3 " not in text
    assert "and 57 more" in text
    page = Page(page_of(description))
    assert "57 more" in page.text
    assert "row 59" in page.text
    assert "row 59" in written(description)


def test_command_writes_markdown(linkwright, bench):
    """Beside the other files, named on the screen; never over an input."""
    status, out, err = linkwright("evaluate", "arm.yaml", "--markdown", "arm.md", "--json", "arm.json")
    assert (status, err) == (0, "")
    assert out.splitlines()[-2:] == ["written: arm.json", "written: arm.md"]
    source = (bench / "arm.md").read_text(encoding="utf-8")
    assert source.startswith("# bench &lt;arm&gt; &amp; co\n")
    assert "| mass of the links |" in source
    status, _, err = linkwright("evaluate", "arm.yaml", "--markdown", "arm.yaml")
    assert status == 2
    assert "input" in err

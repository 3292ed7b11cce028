"""What the site is put together from: every command and option, every public name, links that lead somewhere."""

import re

import linkwright as lw
from handbook.commands import command_named, command_pages
from handbook.docstrings import fenced
from handbook.links import relinked
from handbook.python_face import python_pages
from handbook.sources import ROOT, sources_here
from linkwright.command_line import commands

SOURCES = sources_here()


def test_every_option_of_every_command_is_told():
    """With what it says itself."""
    pages = command_pages()
    for name in commands():
        page = pages[f"commands/{name}.md"]
        command = command_named(name)
        for item in getattr(command, "commands", {"": command}).values():
            for parameter in item.params:
                assert " ".join(parameter.help.split()).replace("|", "\\|") in page
                assert all(f"`{word}" in page for word in parameter.opts if word.startswith("--"))


def test_every_public_name_has_its_place():
    """Once, with the results that it gives."""
    text = "\n".join(python_pages().values())
    told = re.findall(r"^::: \S+\.(\w+)$", text, flags=re.MULTILINE)
    assert set(lw.__all__) <= set(told)
    assert {"Evaluation", "Optimization", "Diagnosis", "Tradeoff", "Result"} <= set(told)
    assert len(told) == len(set(told))


def test_links_lead_to_the_same_place_on_the_site():
    """Files, folders and places on pages, from a page in docs/ and from one outside; code and addresses are left."""
    text = (
        "[a](../examples/hidden-backlash) [b](model.md#the-effects) [c](https://example.com/x.md) [d](#here)\n"
        "```\n[a](../examples/hidden-backlash)\n```"
    )
    assert relinked(text, "docs/model.md", "model.md", SOURCES.place) == text.replace(
        "../examples/hidden-backlash", "examples/hidden-backlash.md", 1
    )
    readme = "![x](docs/pictures/diagnosis.png) [f](docs/formats.md)"
    assert relinked(readme, "README.md", "index.md", SOURCES.place) == "![x](pictures/diagnosis.png) [f](formats.md)"
    example = "[w](../welding-arm/arm.yaml) [d](../../docs/paper.md)"
    moved = relinked(example, "examples/left-out-slopes/README.md", "examples/left-out-slopes.md", SOURCES.place)
    assert moved == "[w](welding-arm/arm.yaml) [d](../paper.md)"


def test_what_is_not_on_the_site_stays_a_broken_link():
    """So that the build names it."""
    assert relinked("[x](../nothing.md)", "docs/model.md", "model.md", SOURCES.place) == "[x](../nothing.md)"


def test_examples_in_docstrings_become_code():
    """From the first prompt to the next empty line."""
    assert fenced("What.\n>>> 1 + 1\n2\n\nMore.") == "What.\n\n```pycon\n>>> 1 + 1\n2\n```\n\nMore."
    assert fenced("What.\n\n>>> 1 + 1\n2").endswith("2\n```")


def test_every_page_of_the_docs_is_in_the_navigation():
    """The build says so too; here without building."""
    config = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    pages = [page for source, page in SOURCES.pages.items() if source.startswith("docs/")]
    assert [page for page in pages if f": {page}\n" not in config] == []

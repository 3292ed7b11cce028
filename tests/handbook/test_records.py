"""The changelog and the citation, held to their forms."""

import re
import tomllib

import yaml

from handbook.sources import ROOT
from linkwright.command_line import commands

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
KINDS = ["Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"]


def test_changelog_keeps_its_form():
    """Keep a Changelog 1.1.0: versions newest first, each with its date but the one to come; the six kinds in order."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## (.*)$", text, flags=re.MULTILINE)
    assert versions[0] == "[Unreleased]"
    assert all(re.fullmatch(r"\[\d+\.\d+\.\d+\] - \d{4}-\d\d-\d\d", version) for version in versions[1:])
    for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        kinds = re.findall(r"^### (.*)$", part, flags=re.MULTILINE)
        assert kinds
        assert kinds == [kind for kind in KINDS if kind in kinds]


def test_changelog_tells_of_every_command():
    """A new command is news."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert [name for name in commands() if f"`linkwright {name}`" not in text] == []


def test_citation_keeps_its_schema():
    """Citation File Format 1.2.0: what must be there, nothing that it does not know, the version that is built."""
    content = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    known = {
        *("cff-version", "message", "title", "authors", "type", "version", "abstract", "keywords", "license", "url"),
        *("date-released", "doi", "identifiers", "repository-code", "references", "preferred-citation", "contact"),
    }
    assert {"cff-version", "message", "title", "authors"} <= set(content) <= known
    assert (content["cff-version"], content["type"], content["version"]) == ("1.2.0", "software", VERSION)
    assert all(isinstance(word, str) for word in (content["message"], content["title"], *content["keywords"]))
    # An author is a person by family or given names, or an entity by its name.
    assert all({"name"} <= set(item) or {"family-names"} <= set(item) for item in content["authors"])

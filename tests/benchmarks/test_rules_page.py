"""The page of the rules is what the rules say."""

from pathlib import Path

from benchmarks.rules.page import page

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_page_is_up_to_date():
    """`make rules-docs` writes it."""
    assert (DOCS / "rules.md").read_text(encoding="utf-8") == page()

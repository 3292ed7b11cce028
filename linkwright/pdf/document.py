"""A report as a PDF, by Typst (https://typst.app), which the extra `pdf` installs."""

from __future__ import annotations

from importlib.util import find_spec

from linkwright.core.units.quantities import InputError, shown
from linkwright.pdf.markup import markup
from linkwright.report.contents import Contents
from linkwright.report.origin import Origin


def need_typst() -> None:
    """Raises `InputError`, one line, where Typst is not installed: before anything is computed."""
    if find_spec("typst") is None:
        message = "a PDF needs typst, which is not installed: pip install 'linkwright[pdf]', or print the page"
        raise InputError("", "--pdf", message)


def pdf_of(contents: Contents, origin: Origin) -> bytes:
    """The document, A4. It holds no time but the date of its `origin`, and the fonts that Typst brings along, so that
    the same report gives the same bytes. Raises `InputError` where Typst is not installed."""
    need_typst()
    import typst

    source = markup(contents, origin.rows)
    try:
        return typst.compile(source.encode(), format="pdf", ignore_system_fonts=True, timestamp=0)
    except typst.TypstError as error:
        raise InputError("", "--pdf", f"Typst cannot set this report: {shown(str(error))}") from None

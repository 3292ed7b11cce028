"""What every result has in common: a line, a page for a notebook, JSON as the command writes it, and a folder."""

from __future__ import annotations

import html
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from linkwright.core.units.quantities import InputError
from linkwright.output.files import (
    DESIGN,
    OUTPUT,
    REPORT,
    RESULT,
    ReadBack,
    claim_folder,
    json_text,
    write_file,
    write_folder,
)
from linkwright.report.described import origin_of, page_of, signed
from linkwright.results.document import Description
from linkwright.results.document import plain as plain_words
from linkwright.version import program_version

from .plain_input import File

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_MOST_ROWS = 20
"""Rows of a table that a notebook shows."""
T = TypeVar("T")


class Field(Generic[T]):
    """A field of `found` as the result has it: `rms_mm` is the field `rms` in mm, any other name that field itself.

    `meaning` is what it means; `field` its name in `found`, where that is another one (`recording.size`).
    """

    def __init__(self, meaning: str, field: str = "") -> None:
        self.__doc__, self._field = meaning, field

    def __set_name__(self, owner: type, name: str) -> None:
        """Hear of the attribute's name."""
        self._factor = 1e3 if name.endswith("_mm") else None
        self._field = self._field or name.removesuffix("_mm")

    def __get__(self, result: Any, owner: type | None = None) -> T:
        """Its value; of the class the field."""
        if result is None:
            return self  # pyright: ignore[reportReturnType] - as a property does
        value: Any = reduce(getattr, self._field.split("."), result.found)
        return cast(T, value if value is None or self._factor is None else self._factor * value)


class Result(ABC):
    """A frozen result. `repr` is one line; `to_json()` is what the command's `--json` writes; tables are pandas
    DataFrames with the unit in each column's name."""

    _command = ""
    """The command that makes the same; its name stands in the files."""
    _signed = True
    """Whether the JSON says so."""
    _folder_files: tuple[str, ...] = (RESULT, REPORT, DESIGN)
    """The files that a folder of it may hold."""
    _describe: Callable[[Any], Description]
    """What describes the field `found`."""

    @property
    def description(self) -> Description:
        """What screen, page and Markdown say of it."""
        return type(self)._describe(getattr(self, "found", None))

    def _line(self) -> str:
        """The result, in a line."""
        described = self.description
        stopped = "interrupted, " if getattr(getattr(self, "found", None), "interrupted", False) else ""
        return stopped + plain_words(described.brief or described.headline)

    @abstractmethod
    def _content(self) -> Mapping[str, Any]:
        """What `--json` writes."""

    @abstractmethod
    def _tables(self) -> Mapping[str, pd.DataFrame]:
        """The tables that a notebook shows, by their headings."""

    @abstractmethod
    def plot(self) -> go.Figure:
        """The result as a plotly figure."""

    def _files(self) -> Mapping[str, str | bytes | ReadBack]:
        """What `--out` writes beside the result, text by name."""
        return {}

    def to_json(self) -> str:
        """The result as the command's `--json` writes it."""
        made_by = {"made_by": f"linkwright {self._command} {program_version()}"} if self._signed else {}
        return json_text({**made_by, **self._content()})

    def save(self, folder: File) -> Sequence[Path]:
        """Write what the command's `--out` writes; gives which files. Raises `InputError` for a folder that holds
        anything else."""
        return self._saved(Path(folder), {})

    def _saved(self, place: Path, first: Mapping[str, str]) -> Sequence[Path]:
        claim_folder(place, self._command, self._folder_files)
        files = {**first, **self._files(), RESULT: self.to_json()}
        write_folder(place, files)
        return [place / name for name in files]

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__}: {' '.join(self._line().split())}>"

    def _repr_html_(self) -> str:
        """The line and the tables, for a notebook."""
        parts = [f"<p><b>{html.escape(type(self).__name__)}</b>: {html.escape(self._line())}</p>"]
        for heading, table in self._tables().items():
            parts.append(f"<h4>{html.escape(heading)}</h4>")
            parts.append(table.head(_MOST_ROWS).to_html(index=False, border=0, float_format="{:.6g}".format))
            if len(table) > _MOST_ROWS:
                parts.append(f"<p>and {len(table) - _MOST_ROWS} more rows</p>")
        return "\n".join(parts)


class Reported(Result):
    """A result with a report: a page beside the result, or a PDF."""

    def save(
        self, folder: File, *, made_from: Iterable[File] = (), author: str = "", comment: str = ""
    ) -> Sequence[Path]:
        """Write what the command's `--out` writes; gives which files. The report says when it was made, and of the
        files that it was `made_from` their names and SHA-256 sums; `author` and `comment` stand beside that. Raises
        `InputError` for a folder that holds anything else."""
        return self._saved(Path(folder), {REPORT: self._page(made_from, author, comment)})

    def save_pdf(self, file: File, *, made_from: Iterable[File] = (), author: str = "", comment: str = "") -> None:
        """Write the report as a PDF of A4 pages, as Chromium, Chrome or Edge prints it. Raises `InputError` where none
        of them is installed or the file cannot be written."""
        if Path(file) == OUTPUT:
            raise InputError("", "save_pdf", "needs the name of a file; a PDF is nothing for standard output")
        from linkwright.report.page import pdf_of

        write_file(Path(file), pdf_of(self._page(made_from, author, comment)))

    def _page(self, made_from: Iterable[File], author: str, comment: str) -> str:
        return signed(page_of(self.description), origin_of(map(Path, made_from), author=author, comment=comment))


def figure_of(data: Mapping[str, Any]) -> go.Figure:
    """A plotly figure of what the reports draw."""
    import plotly.graph_objects as go

    return go.Figure(dict(data))


def drawn(
    x: Sequence[Any],
    lines: Mapping[str, Sequence[Any]],
    across: str = "",
    up: str = "",
    *,
    mode: str = "markers",
    **of_up: Any,
) -> go.Figure:
    """A plotly figure of values over `x`, by name: bars (`mode` "bar"), or marks and lines as plotly's modes say;
    `across` and `up` are the titles of the axes, `of_up` what else the second one is."""
    kind = {"type": "bar"} if mode == "bar" else {"type": "scatter", "mode": mode}
    data = [
        {**kind, "x": list(x), "y": list(values), **({"name": name} if name else {})} for name, values in lines.items()
    ]
    axes = {"xaxis": {"title": {"text": across}}, "yaxis": {"title": {"text": up}, **of_up}}
    return figure_of({"data": data, "layout": axes})

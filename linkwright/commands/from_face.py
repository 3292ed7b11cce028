"""The commands that are made of the functions of `linkwright`: what each does beside calling one."""

from __future__ import annotations

import io
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.api.recording import MOTION
from linkwright.commands import options
from linkwright.commands.made import Made, Out, Targets
from linkwright.commands.options import write_content
from linkwright.core.units.files import left_over_of, read_bytes
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.core.units.reading import read_text
from linkwright.output.files import (
    DESIGN,
    REPORT,
    RESULT,
    check_target,
    made_folder,
    refuse_strangers,
    write_file,
    write_markdown,
)

if TYPE_CHECKING:
    from linkwright.core.executors import Executor
    from linkwright.core.optimize.result import Iteration


class Optimize(Made):
    """`optimize`: rounds are told as they come, and what no design keeps is answered too."""

    def call(self, given: dict[str, Any], targets: Targets, crew: Executor) -> Any:
        """Optimise (and round), with a line for each round and a bar while combinations are tried."""
        from linkwright.screen.progress import Steps

        steps = Steps("preparing the problem")
        try:
            return lw.optimize(**given, **_heard(given["problem"], steps), progress=steps, executor=crew)
        except KeyboardInterrupt:
            steps.close()
            words = "no design was finished yet, so there is none to keep"
            options.stop(crew, words)
        except NoAnswer as error:
            if error.infeasible is not None:
                steps.close()
                _tell_infeasible(error.infeasible, Path(given["problem"].model.file), targets)
            raise
        finally:
            steps.close()


def _heard(problem: lw.Problem, steps: Any) -> dict[str, Any]:
    """What `optimize` tells of on the way, shown beside its bar."""
    from linkwright.results.design import rigid_links_words
    from linkwright.results.figures_in_words import mm
    from linkwright.results.optimization import iteration_line
    from linkwright.screen.console import console, loudness

    screen = console()

    def say(text: str) -> None:
        with steps.aside():
            screen.print(text, soft_wrap=True)

    def begun(before: Any) -> None:
        if problem.model.minimize == "max_error":
            for item in rigid_links_words(before.found):
                say(f"arm as given: {mm(before.found.max_error)}. {item.text}")

    def log(iteration: Iteration) -> None:
        say(iteration_line(iteration, problem.model.objective))

    content: dict[str, Any] = {"out_of_reach": say}
    return content if loudness() == "answer" else {**content, "log": log, "begun": begun}


def _tell_infeasible(infeasibility: Any, problem: Path, targets: Targets) -> None:
    """Write and show why no design keeps all limits, and what each would have to be."""
    from linkwright.json.design import infeasible_json
    from linkwright.results.optimization import describe_infeasible
    from linkwright.screen.console import console
    from linkwright.screen.described import show

    described = describe_infeasible(infeasibility)
    with options.not_lost(lambda: show(console(), described)):
        write_content(targets.json, "optimize", infeasible_json(infeasibility, problem))
        write_markdown(targets.markdown, described)
    show(console(), described)


class Tradeoff(Made):
    """`tradeoff`: a table of its points, and a folder of its own files."""

    def claim(self, folder: Path) -> None:
        """As a trade-off claims it."""
        from linkwright.output.tradeoff_folder import claim_tradeoff

        claim_tradeoff(folder)

    def call(self, given: dict[str, Any], targets: Targets, crew: Executor) -> Any:
        """Trace the fronts; of one that is stopped the points until there are the result."""
        try:
            return super().call(given, targets, crew)
        except KeyboardInterrupt:
            options.stop(crew, "no point was solved yet, so there is none to keep")

    def write(self, result: Any, targets: Targets, read: Sequence[Path]) -> list[Path]:
        """The table of points too."""
        if targets.csv is not None:
            result.save_table(targets.csv)
        return super().write(result, targets, read) + ([] if targets.csv is None else [targets.csv])


CsvFile = Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the points: .csv, .parquet or .md.")]


class Diagnose(Made):
    """`diagnose`: its folder holds files of several arms' own."""

    def claim(self, folder: Path) -> None:
        """As a diagnosis claims it."""
        from linkwright.output.diagnosis_folder import claim_diagnosis

        claim_diagnosis(folder)


class Plan(Made):
    """`plan`: of visits it is to be said how many; a motion has none."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """How many visits, where there are visits."""
        if words["poses"] is None and words["instrument"] != MOTION:
            raise InputError("", "--poses", "is missing; say how many visits there are to be")
        return super().checked(targets, words, inputs)


class Simulate(Made):
    """`simulate`: settings are written beside the recording."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """Settings of somebody's own stay."""
        from linkwright.face.recording import settings_beside

        if words["poses"] is None and words["at"] is None and words["motion"] is None:
            raise InputError(
                "", "--poses", "is missing; say how many, name a plan with --at, or a motion with --motion"
            )
        checked_targets = super().checked(targets, words, inputs)
        if targets.out is not None:
            others = [path for path in (targets.json, targets.markdown) if path is not None]
            check_target(settings_beside(targets.out), *inputs, *others)
        return checked_targets


class Written(Made):
    """A command that writes a file whether one is named or not, but over none that is there unasked."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The file to write, by default a new one."""
        if targets.out is None:
            name = self.named(words)
            if name.exists():
                raise InputError(name, "", "is there already; name the file to write with --out")
            targets = replace(targets, out=name)
        return super().checked(targets, words, inputs)

    def named(self, words: dict[str, Any]) -> Path:
        """What the file is called by default."""
        del words
        return Path(DESIGN)


class Export(Written):
    """`export`: the file is called after the arm's."""

    def named(self, words: dict[str, Any]) -> Path:
        """After the arm file, or after the one that it is written into. Raises `InputError`."""
        from linkwright.face.exchange import SUFFIXES, format_of

        arm, into = words["arm"], words["into"]
        to = format_of(words["to"], into)
        return Path(f"{into.stem}-corrected{into.suffix}") if to is None else Path(arm.stem + SUFFIXES[to])


KEYS = (
    *("clearance", "backlash", "backlash_direction", "material", "shape"),
    *("shapes_at_their_best", "materials_compared"),
)
"""The tables' names in Python and of the CSV files."""


class TableKind(StrEnum):
    """How a table is written."""

    CSV = "csv"
    PARQUET = "parquet"
    MARKDOWN = "md"


_SIGNATURES = MappingProxyType(
    {
        TableKind.CSV: "label,paper_",
        TableKind.PARQUET: "PAR1",
        TableKind.MARKDOWN: "| label | paper_",
    }
)
"""What the first table begins with."""


TABLES: Mapping[str, Any] = MappingProxyType(
    {
        "csv": Annotated[
            Path | None, typer.Option("--csv", metavar="DIR", help="Write each table there, as CSV or what --as names.")
        ],
        "kind": Annotated[TableKind | None, typer.Option("--as", help="How the tables in --csv DIR are written.")],
        "markdown": Annotated[
            Path | None,
            typer.Option(
                "--markdown", metavar="FILE", help="Write as Markdown, between the marks of a file that has them."
            ),
        ],
    }
)
"""The options of `tables`."""


class Tables(Made):
    """`tables`: each can be written as a file of its own, and all into a page of Markdown that is there."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The folder of tables too."""
        from linkwright.output.table_file import check_table

        json, csv, kind = targets.json, targets.csv, targets.kind or TableKind.CSV
        checked_targets = super().checked(replace(targets, csv=None), words, inputs)
        if json is not None and targets.markdown is not None and json.absolute() == targets.markdown.absolute():
            raise InputError(json, "", "is named for JSON and for Markdown; name two files")
        if csv is not None:
            names = [f"{key}.{kind.value}" for key in KEYS]
            check_table(csv / names[0])
            _claim(csv, names, names[0], _SIGNATURES[kind])
        return replace(checked_targets, csv=csv, kind=kind)

    def write(self, result: Any, targets: Targets, read: Sequence[Path]) -> list[Path]:
        """Each table, and the page between its marks."""
        from linkwright.markdown.described import markdown as written_as
        from linkwright.paper.output.pages import into

        markdown = targets.markdown
        written = super().write(result, replace(targets, markdown=None), read)
        if targets.csv is not None:
            written += _write_each(result, targets.csv, targets.kind)
        if markdown is not None:
            text = read_text(markdown) if os.path.isfile(markdown) else ""
            write_file(markdown, into(text, written_as(result.description, 2)))
            written.append(markdown)
        return written

    def answer(self, result: Any) -> None:
        """On lines as wide as a screen: they are read, not searched."""
        from linkwright.screen.console import console
        from linkwright.screen.described import show

        show(console(broken=True), result.description)


def _write_each(made: Any, folder: Path, kind: TableKind) -> list[Path]:
    """Write each table as a file of its kind."""
    import pandas as pd

    from linkwright.output.table_file import write_table
    from linkwright.paper.output.pages import table_csv

    written: list[Path] = []
    for table in made.book.tables:
        file = folder / f"{table.key}.{kind.value}"
        if kind is TableKind.CSV:
            write_file(file, table_csv(table))
        else:
            write_table(pd.read_csv(io.StringIO(table_csv(table))), file)
        written.append(file)
    for table in made.extended:
        written.append(folder / f"{table.key}.{kind.value}")
        write_table(made[table.key], written[-1])
    return written


def _claim(folder: Path, names: Collection[str], signed: str, signature: str) -> None:
    """Make the folder, or take one that holds nothing but `names`, where the file `signed` opens with `signature`.

    A folder that holds anything else is refused, so that nobody's files are written over. Raises `InputError`.
    """
    there = made_folder(folder)
    refuse_strangers(folder, there, names)
    if any(left_over_of(name) is None for name in there) and not _opens_with(folder / signed, signature):
        message = f"holds files that are not of this command ({min(there)}); name a new or empty folder"
        raise InputError(folder, "", message)


def _opens_with(path: Path, signature: str) -> bool:
    try:
        return signature.encode() in read_bytes(path)[:200]
    except InputError:
        return False


class Drawings(Made):
    """`figures`: drawings stand in the folder."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """A folder, where there are drawings."""
        if words["formats"] and targets.out is None:
            raise InputError("", "--format", "needs the folder to write to; name it with --out")
        return super().checked(targets, words, inputs)


FOLDER = Out("Write report.html, picture, CSV, JSON, and an arm file a point.")
FIGURES = (RESULT, REPORT, *(f"figure-{n}.{kind}" for n in range(5, 10) for kind in ("csv", "svg", "pdf")))
NOTHING = "Nothing is written without --out DIR or --json FILE."


def commands() -> Mapping[str, Made]:
    """These commands by name."""
    watched = Out(files=(RESULT, REPORT))
    table = Out("Write the table: .csv, .parquet or .md.", ())
    plan = Out("The plan: a recording whose tip is still blank.", (), beside=True)
    recording = Out("The recording to write, a CSV file.", (), beside=True, required=True)
    read = Out("The arm file to write. Default: a new arm.yaml.", ())
    settings = Out("The recording.yaml to write.", ())
    exported = Out("The file to write. Default: a new one called as the arm file.", ())
    figures = Out("Write report.html, result.json and a CSV file per figure there.", FIGURES)
    plain: Any = {"markdown": False, "catalogue": False}
    drawing: Any = {"doing": "computing the paper's figures", "out": figures, "unwritten": NOTHING}
    made = {
        "Design": (
            Made("evaluate", doing="evaluating", out=Out(), pdf=True, tip=True),
            Optimize("optimize", out=Out(), pdf=True, kept="this is the best design so far", apart=True),
            Tradeoff(
                "tradeoff",
                doing="setting up the trade-off",
                out=FOLDER,
                pdf=True,
                kept="these are the points solved so far",
                also={"csv": CsvFile},
                apart=True,
            ),
            Made("inverse", doing="looking for poses", tip=True, negative=True),
            Made("seam", doing="following the seam", tip=True),
            Made("budget", out=watched, pdf=True, tip=True),
        ),
        "Diagnose": (
            Diagnose("diagnose", doing="preparing", out=Out(), pdf=True, tip=True),
            Made("compare", doing="preparing", tip=True),
            Made("predict", doing="predicting", tip=True),
            Made("compensate", doing="computing the table", out=table, tip=True),
            Plan("plan", out=plan, tip=True, kept="this is the best plan so far"),
            Made("watch", doing="preparing", out=watched, pdf=True, tip=True),
            Simulate("simulate", doing="simulating", out=recording, tip=True),
        ),
        "Files": (
            Written("import", "import_arm", out=read, catalogue=False),
            Export("export", "export_arm", out=exported),
            Made("columns", out=settings, catalogue=False, tip=True),
        ),
        "Paper": (
            Tables("tables", "paper_tables", out=watched, pdf=True, also=TABLES, **plain),
            Drawings("figures", "paper_figures", **drawing, **plain),
        ),
    }
    return {item.name: replace(item, panel=panel) for panel, items in made.items() for item in items}

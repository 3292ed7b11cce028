"""The commands that design: what an arm can do, the best one, what to trade for what, the error to expect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.output.files import REPORT, RESULT, check_target, write_json, write_markdown

from . import options
from .made import Made, Out, Targets

if TYPE_CHECKING:
    from linkwright.core.executors import Executor
    from linkwright.core.optimize.result import Iteration

HOME = "linkwright.api.design"


class Optimize(Made):
    """`optimize`: rounds are told as they come, and what no design keeps is answered too."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The journal too is written to."""
        check_target(words["resume"], *(path for path in inputs if path != words["resume"]))
        return super().checked(targets, words, inputs)

    def call(self, given: dict[str, Any], targets: Targets, crew: Executor) -> Any:
        """Optimise (and round), with a line for each round and a bar while combinations are tried."""
        from linkwright.screen.progress import Steps

        steps = Steps("looking at what there is to choose from")
        try:
            return lw.optimize(**given, **_heard(given["problem"], steps), progress=steps, executor=crew)
        except KeyboardInterrupt:
            steps.close()
            words = "no design was finished yet, so there is none to keep"
            options.stop(crew, self.left(words, given, crew))
        except NoAnswer as error:
            if error.infeasible is not None:
                steps.close()
                _tell_infeasible(error.infeasible, Path(given["problem"].model.file), targets)
            raise
        finally:
            steps.close()

    def answer(self, result: Any) -> None:
        """Apart from the rounds."""
        _apart()
        super().answer(result)

    def left(self, kept: str, given: dict[str, Any], crew: Executor) -> str:
        """And how it goes on."""
        if given["resume"] is not None:
            return f"{kept}; the same command goes on with what is in {given['resume']}"
        return kept if crew.lost is None else f"{kept}; one that is to go on where it stops needs --resume FILE"


def _heard(problem: lw.Problem, steps: Any) -> dict[str, Any]:
    """What `optimize` tells of on the way, shown beside its bar."""
    from linkwright.results.design import rigid_links_words
    from linkwright.results.figures_in_words import mm
    from linkwright.results.optimization import iteration_line
    from linkwright.screen.console import console
    from linkwright.screen.loudness import loudness

    screen = console()

    def say(text: str) -> None:
        with steps.aside():
            screen.print(text, soft_wrap=True)

    def begun(before: Any) -> None:
        if problem.model.minimize == "max_error":
            for each in rigid_links_words(before.found):
                say(f"arm as given: {mm(before.found.max_error)}; {each.text}")

    def log(iteration: Iteration) -> None:
        say(iteration_line(iteration, problem.model.minimize))

    def beyond(text: str) -> None:
        say(f"{text}; now looking for what the limits would have to be")

    told: dict[str, Any] = {"out_of_reach": beyond}
    return told if loudness() == "answer" else {**told, "log": log, "begun": begun}


def _tell_infeasible(found: Any, problem: Path, targets: Targets) -> None:
    """Write and show why no design keeps all limits, and what each would have to be."""
    from linkwright.json.infeasible import infeasible_json
    from linkwright.results.optimization import describe_infeasible
    from linkwright.screen.console import console
    from linkwright.screen.described import show

    described = describe_infeasible(found)
    with options.not_lost(lambda: show(console(), described)):
        write_json(targets.json, infeasible_json(found, "optimize", problem))
        write_markdown(targets.markdown, described)
    show(console(), described)


def _apart() -> None:
    from linkwright.screen.console import console
    from linkwright.screen.loudness import loudness

    if loudness() != "answer":
        console().print()


class Tradeoff(Made):
    """`tradeoff`: its points are kept in the output folder as they are solved."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The table too is written."""
        from linkwright.output.table_file import check_table

        if words["resume"] and targets.out is None:
            raise InputError("", "--resume", "needs --out DIR, where the journal of the earlier run is")
        found = super().checked(targets, words, inputs)
        check_table(targets.csv)
        return found

    def claim(self, folder: Path) -> None:
        """Its journal does."""

    def call(self, given: dict[str, Any], targets: Targets, crew: Executor) -> Any:
        """Trace the fronts; a front that is stopped is no result, its points wait in the journal."""
        from linkwright.screen.progress import Steps

        steps = Steps(self.doing)
        try:
            found = lw.tradeoff(**given, journal=targets.out, progress=steps, executor=crew)
            if found.interrupted:
                raise KeyboardInterrupt
        except KeyboardInterrupt:
            steps.close()
            options.stop(crew, _points_kept(targets.out))
        finally:
            steps.close()
        return found

    def write(self, result: Any, targets: Targets, read: Sequence[Path]) -> list[Path]:
        """The table of points too."""
        if targets.csv is not None:
            result.save_table(targets.csv)
        return super().write(result, targets, read) + ([] if targets.csv is None else [targets.csv])

    def answer(self, result: Any) -> None:
        """Apart from what was told on the way."""
        _apart()
        super().answer(result)


def _points_kept(folder: Path | None) -> str:
    """What a front that is stopped leaves, in words."""
    if folder is None:
        return "nothing is kept without --out DIR"
    from linkwright.face.tradeoff import points_kept

    return f"{points_kept(folder)} solved points are kept in {folder}; --resume goes on with them"


CsvFile = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Write the points: .csv, .parquet, .md or .tex.")
]
FOLDER = Out("Write report.html, picture, CSV, JSON, an arm file a point, and the journal.")


def commands() -> Mapping[str, Made]:
    """These commands by name."""
    made = (
        Made("evaluate", HOME, doing="evaluating", out=Out(), pdf=True, tip=True),
        Optimize("optimize", HOME, out=Out(), pdf=True, kept="this is the best design so far"),
        Tradeoff("tradeoff", HOME, doing="setting up the trade-off", out=FOLDER, pdf=True, also={"csv": CsvFile}),
        Made("inverse", HOME, doing="looking for poses", tip=True, negative=True),
        Made("budget", HOME, out=Out(own=(RESULT, REPORT)), pdf=True, tip=True),
    )
    return {each.name: each for each in made}

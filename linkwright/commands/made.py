"""Commands made of the functions of `linkwright`. One procedure for all: the files are read, the function is called
with what the options say, and what it gives is written and shown.

Parameters of the function are options: names, choices and defaults by its signature, the help by its docstring.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import import_module
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

import typer

import linkwright as lw
from linkwright.api.signature import Argument, Option
from linkwright.commands import options
from linkwright.core.units.quantities import InputError
from linkwright.output.files import (
    DESIGN,
    OUTPUT,
    REPORT,
    RESULT,
    check_target,
    claim_folder,
    write_file,
    write_markdown,
)
from linkwright.output.table_file import check_table

if TYPE_CHECKING:
    from linkwright.core.executors import Executor

_ENTRY = re.compile(r"^ {4}(\w+): (.*(?:\n {5,}.*)*)", re.MULTILINE)
_FOR_PROGRAMS = re.compile(r"\s+In\s+Python\b.*", re.DOTALL)


def help_of(function: Callable[..., Any]) -> str:
    """What a docstring says before `Args` and the examples in Python: the summary, those of the command line."""
    docstring = inspect.getdoc(function) or ""
    return re.split(r"^(?:Args:|>>> )", docstring, maxsplit=1, flags=re.MULTILINE)[0].strip() + "\n"


def _args_of(function: Callable[..., Any]) -> Mapping[str, str]:
    """What stands under `Args` of each parameter, but for what it is in Python alone."""
    block = (inspect.getdoc(function) or "").partition("\nArgs:\n")[2].partition("\n\n")[0]
    return {name: " ".join(_FOR_PROGRAMS.sub("", text).split()) for name, text in _ENTRY.findall(block)}


@dataclass(frozen=True)
class Parameter:
    """A parameter of a public function that the command line asks for."""

    name: str
    option: Option
    kind: Any
    default: Any
    help: str

    @property
    def flag(self) -> str:
        """What it is called on the command line."""
        if isinstance(self.option, Argument):
            return (self.option.metavar or self.name).strip("[].")
        return self.option.flag or f"--{self.name.rstrip('_').replace('_', '-')}"

    @property
    def _off(self) -> bool:
        """Whether the option turns off what is on."""
        return self.kind is bool and self.default is True

    def typed(self) -> inspect.Parameter:
        """As typer reads it."""
        settings: dict[str, Any] = {"metavar": self.option.metavar, "help": self.help}
        if self.option.least is not None or self.option.most is not None:
            settings |= {"min": self.option.least, "max": self.option.most}
        default, kind = self.default, list[self.kind] if self.option.many else self.kind
        if self.option.many or self._off:
            default = default if default is inspect.Parameter.empty else False if self._off else None
        elif isinstance(default, tuple):
            default = None
        if self.option.required:
            default = inspect.Parameter.empty
        optional = kind | None if default is None else kind
        words = typer.Argument(**settings) if isinstance(self.option, Argument) else typer.Option(self.flag, **settings)
        annotation = Annotated[optional, words]
        return inspect.Parameter(self.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)

    def value(self, word: Any) -> Any:
        """What the function takes for a word of the command line, or for several; nothing where none was given. Raises
        `InputError`."""
        if self._off:
            return not word
        if word is None or word == []:
            return self.default
        if isinstance(word, StrEnum):
            return word.value
        if self.option.read is None:
            return word
        return [self.option.read(item) for item in word] if self.option.many else self.option.read(word)


def parameters_of(function: Callable[..., Any]) -> Iterator[Parameter]:
    """The parameters of a function that are annotated with an `Option` or an `Argument`; programs alone have others."""
    descriptions = _args_of(function)
    for name, parameter in inspect.signature(function).parameters.items():
        annotation = function.__annotations__.get(name)  # its signature is as people read it
        base, *notes = get_args(annotation) if get_origin(annotation) is Annotated else (None,)
        option = next((note for note in reversed(notes) if isinstance(note, Option)), None)
        if option is not None:
            kind = option.kind or _kind(name, base)
            yield Parameter(name, option, kind, parameter.default, descriptions.get(name, ""))


def _kind(name: str, annotation: Any) -> Any:
    """What a word is read as: the first kind of a union that is not None; of literals one of those."""
    if get_origin(annotation) in (Union, UnionType):
        return _kind(name, next(arg for arg in get_args(annotation) if arg is not type(None)))
    if get_origin(annotation) is Literal:
        return StrEnum(name, {arg: arg for arg in get_args(annotation)})
    return annotation


def paths_in(value: Any) -> list[Path]:
    """The files that a value names."""
    several = value if isinstance(value, list | tuple) else [value]
    return [item for item in several if isinstance(item, Path)]


@dataclass(frozen=True)
class Out:
    """What `--out` names: a folder, which holds `files`, or where there are none a file. `beside`: settings are
    written beside it; `required`: it must be given."""

    help: str = "Write report.html and the other files there. Without it nothing is written."
    files: tuple[str, ...] = (RESULT, REPORT, DESIGN)
    beside: bool = False
    required: bool = False

    def typed(self) -> Any:
        """As typer reads it."""
        option = typer.Option("--out", metavar="DIR" if self.files else "FILE", help=self.help)
        return Annotated[Path, option] if self.required else Annotated[Path | None, option]


@dataclass(frozen=True)
class Targets:
    """What the options that all commands share name: files to write, and who signs."""

    out: Path | None = None
    json: Path | None = None
    markdown: Path | None = None
    pdf: Path | None = None
    csv: Path | None = None
    kind: Any = None
    author: str = ""
    comment: str = ""

    @property
    def signed(self) -> dict[str, str]:
        """Who made a report, and what it shall say."""
        return {"author": self.author, "comment": self.comment}


@dataclass(frozen=True)
class Made:
    """A command made of a function of `linkwright`.

    Attributes:
        name: the command's.
        function: the function's, if it is another.
        doing: what is shown until more is heard.
        out: what `--out` writes, if anything.
        pdf: there is a report for `--pdf`, and whoever made it can sign.
        tip: `--tip` names one of several arms on one torso.
        catalogue: files of materials can be added.
        kept: what an interrupted result still holds.
        unwritten: what is said where no file was asked for.
        negative: an argument may begin with a minus.
        also: options of its own for files to write, by name.
        apart: an empty line stands before the answer, after what was told on the way.
        panel: the part of the help where it stands.
    """

    name: str
    function: str = ""
    doing: str = "reading"
    out: Out | None = None
    pdf: bool = False
    tip: bool = False
    catalogue: bool = True
    markdown: bool = True
    kept: str = ""
    unwritten: str = ""
    negative: bool = False
    also: Mapping[str, Any] = field(default_factory=dict[str, Any])
    apart: bool = False
    panel: str = ""

    @property
    def called(self) -> str:
        """The function's name in `linkwright`."""
        return self.function or self.name

    def _function(self) -> Callable[..., Any]:
        """The function itself, whatever stands for it in `linkwright`: its signature is read."""
        home = next(module for module, names in lw.HOMES.items() if self.called in names)
        return getattr(import_module(home), self.called)

    @property
    def help(self) -> str:
        """The help: what the function's docstring begins with."""
        return help_of(self._function())

    @property
    def parameters(self) -> list[Parameter]:
        """The function's parameters that are options here."""
        return list(parameters_of(self._function()))

    def typed(self) -> Callable[..., None]:
        """The command as typer reads it: the function's parameters, then what all commands share."""
        parameters = [parameter.typed() for parameter in self.parameters]
        executor = "executor" in inspect.signature(self._function()).parameters
        shared: list[tuple[bool, str, Any, Any]] = [
            (self.tip, "tip", options.Tip, None),
            (self.out is not None, "out", None if self.out is None else self.out.typed(), None),
            *((True, name, annotation, None) for name, annotation in self.also.items()),
            (True, "json", options.JsonFile, None),
            (self.markdown, "markdown", options.MarkdownFile, None),
            (self.pdf, "pdf", options.PdfFile, None),
            (self.catalogue, "catalogue", options.CatalogueFile, None),
            (self.pdf, "author", options.Author, ""),
            (self.pdf, "comment", options.Comment, ""),
            (executor, "workers", options.Workers, None),
            (executor, "dask", options.Dask, None),
            (self.markdown, "quiet", options.Quiet, False),
            (self.markdown, "verbose", options.Verbose, False),
        ]
        for _, name, annotation, default in (item for item in shared if item[0]):
            required = name == "out" and self.out is not None and self.out.required
            default_value = inspect.Parameter.empty if required else default
            parameters.append(
                inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default_value, annotation=annotation)
            )

        def command(**words: Any) -> None:
            from linkwright.screen.console import showing

            with showing(quiet=words.pop("quiet", False), verbose=words.pop("verbose", False)):
                self.run(words)

        vars(command)["__signature__"] = inspect.Signature(parameters)
        command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return command

    def run(self, words: dict[str, Any]) -> None:
        """Run the command with the words of the command line, by the names of its parameters. Raises `InputError`."""
        targets = Targets(**{name: words[name] for name in Targets.__dataclass_fields__ if name in words})
        catalogue, tip = words.get("catalogue"), words.get("tip")
        named = [path for parameter in self.parameters for path in paths_in(words[parameter.name])]
        inputs = [*named, *([] if catalogue is None else [catalogue])]
        with self.named_as_options(words):
            targets = self.checked(targets, words, inputs)
        from linkwright.screen.progress import waiting

        with self.named_as_options(words), options.crew_of(words.get("workers"), words.get("dask")) as crew:
            with waiting("reading"):
                arguments = {
                    parameter.name: self._read(parameter, words[parameter.name], catalogue, tip)
                    for parameter in self.parameters
                }
            with self.claimed(targets.out):
                result = self.call(arguments, targets, crew)
        problems = [value.arm_file for value in arguments.values() if isinstance(value, lw.Problem)]
        read = _once([*named, *(path for path in problems if path is not None), *read_by(result), *inputs])
        with options.not_lost(lambda: self.answer(result)), waiting("writing"):
            written = self.write(result, targets, read)
        self.answer(result)
        options.tell_written(written, self.unwritten)
        if getattr(result, "interrupted", False):
            options.stop(crew, self.kept)

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """What is to be written, by default too. Raises `InputError` for what could not be, before any work is done."""
        del words
        if self.out is not None and self.out.beside and targets.out == OUTPUT:
            raise InputError("", "--out", "needs the name of a file; the settings are written beside it")
        if self.out is not None and not self.out.files:
            check_target(targets.out, *inputs)
            check_table(targets.out)
        for target in (targets.json, targets.markdown, targets.pdf, targets.csv):
            check_target(target, *inputs)
        check_table(targets.csv)
        options.check_pdf(targets.pdf)
        return targets

    def _read(self, parameter: Parameter, word: Any, catalogue: Path | None, tip: str | None) -> Any:
        """What the function takes for a word: an arm and a problem are read with the catalogue. Raises `InputError`."""
        reads = parameter.option.reads
        if reads == "arm" and word is not None:
            return lw.read_arm(word, catalogue=catalogue, tip=tip)
        if reads == "problem" and word is not None:
            return lw.read_problem(word, catalogue=catalogue)
        return parameter.value(word)

    @contextmanager
    def claimed(self, folder: Path | None) -> Generator[None]:
        """The folder that `--out` names, made or taken again; one that was made goes again where nothing came of it."""
        if folder is None or self.out is None or not self.out.files:
            yield
            return
        there = folder.exists()
        self.claim(folder)
        try:
            yield
        finally:
            if not there:
                with suppress(OSError):  # it holds something, as it should
                    folder.rmdir()

    def claim(self, folder: Path) -> None:
        """Make the folder, or take an earlier one of this command again. Raises `InputError`."""
        claim_folder(folder, self.name, self.out.files if self.out is not None else ())

    def call(self, given: dict[str, Any], targets: Targets, crew: Executor) -> Any:
        """Call the function; a bar shows how far it is."""
        from linkwright.screen.progress import waiting

        del targets
        takes = inspect.signature(self._function()).parameters
        with waiting(self.doing) as steps:
            more = {name: value for name, value in (("progress", steps), ("executor", crew)) if name in takes}
            return getattr(lw, self.called)(**given, **more)

    def write(self, result: Any, targets: Targets, read: Sequence[Path]) -> list[Path]:
        """Write the files that are asked for; gives which, those in the folder first. Raises `InputError`."""
        made = {"made_from": read, **targets.signed} if self.pdf else {}
        if targets.json is not None:
            write_file(targets.json, result.to_json())
        if targets.pdf is not None:
            result.save_pdf(targets.pdf, **made)
        written = [] if targets.out is None else [*result.save(targets.out, **made)]
        if targets.markdown is not None:
            write_markdown(targets.markdown, result.description)
        beside = (targets.pdf, targets.json, targets.markdown)
        return [*written, *(path for path in beside if path is not None)]

    def answer(self, result: Any) -> None:
        """Show the result."""
        from linkwright.screen.console import console, loudness
        from linkwright.screen.described import show

        if self.apart and loudness() != "answer":
            console().print()
        show(console(), result.description)

    @contextmanager
    def named_as_options(self, words: dict[str, Any]) -> Generator[None]:
        """Errors of the function in the command line's words: a parameter by its option (others between backticks in
        the message), what an arm lacks by the arm's file."""
        first = next((words[parameter.name] for parameter in self.parameters if parameter.option.reads), None)
        try:
            with nullcontext() if first is None else options.asked_of(first):
                yield
        except InputError as error:
            flags = {parameter.name: parameter.flag for parameter in self.parameters if not parameter.option.reads}
            if error.file == "with_":
                raise InputError("--with", error.key, error.message) from None
            if error.file or error.key not in flags:
                raise
            message = re.sub(r"`(\w+)`", lambda match: flags.get(match[1], match[0]), error.message)
            raise InputError("", flags[error.key], message) from None


def read_by(result: Any) -> list[Path]:
    """The files that a result was made from beside those that were named: settings beside recordings."""
    return list(getattr(result, "settings_read", ()))


def _once(paths: Sequence[Path]) -> list[Path]:
    """Each file once, where it is named first."""
    return list({path.absolute(): path for path in paths}.values())

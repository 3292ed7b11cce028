"""The parameters of a public function as options of a command: names, choices and defaults by its signature, the help
by its docstring."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import typer

from linkwright.api.signature import Argument, Option

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

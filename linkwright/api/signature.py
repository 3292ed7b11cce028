"""How a parameter of a public function is asked for on the command line, and the parameters that several share."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args, get_origin

from linkwright.core.units.quantities import InputError, shown

if TYPE_CHECKING:
    from linkwright.face.arm import Arm
    from linkwright.face.problem import Problem

Quantity = str | float
"""A quantity as text with its unit (`"400 mm"`), or a number in SI."""
File = Path | str
Progress = Callable[[str, float], None]
"""Hears what is being done, and what share of the whole is behind (0 to 1)."""


@dataclass(frozen=True)
class Option:
    """A parameter as an option; what it is for stands under `Args` of the function's docstring.

    Attributes:
        flag: its name; that of the parameter by default. `--no-NAME` turns a parameter off that is on.
        metavar: what stands for the value in the help.
        kind: what a word is read as; that of the annotation by default.
        many: it may be repeated.
        read: what makes the parameter's value of the word, or of the words.
        reads: the file of an arm or a problem, read with the catalogue.
        least, most: of a number.
        required: it must be given, although a program need not.
    """

    flag: str = ""
    metavar: str | None = None
    kind: Any = None
    many: bool = False
    read: Callable[[Any], Any] | None = None
    reads: Literal["arm", "problem", ""] = ""
    least: float | None = None
    most: float | None = None
    required: bool = False


@dataclass(frozen=True)
class Argument(Option):
    """A parameter by its place."""


def file_option(metavar: str, flag: str = "", *, many: bool = False) -> Option:
    """An option that names a file, or several."""
    return Option(flag, metavar, kind=Path, many=many)


def listed(text: str) -> list[str]:
    """The parts of a list as text: `1 m, 0 m, 0.3 m`."""
    return [item.strip() for item in text.split(",")]


def named(text: str) -> list[str]:
    """The names of a list: `backlash, joint_compliance:2`; none in an empty one."""
    return [item for item in listed(text) if item]


def numbers(text: str) -> list[float]:
    """The numbers of a direction. Raises `InputError`."""
    try:
        return [float(item) for item in text.split(",")]
    except ValueError:
        raise InputError("", "direction", f"needs three numbers such as '0, 0, 1', not {text!r}") from None


def pose_or_file(text: str) -> Path | str:
    """A pose as text, or the table of poses (CSV) that it names."""
    return Path(text) if Path(text).suffix.lower() == ".csv" else text


def span(text: str) -> tuple[str, str]:
    """Both ends of `20 degC to 35 degC`; one value is both. Raises `InputError`."""
    ends = text.split(" to ")
    if len(ends) > 2:
        raise InputError("", "temperature", f"needs two, e.g. '20 degC to 35 degC', not {text!r}")
    return ends[0], ends[-1]


def region(text: str) -> dict[str, Any] | tuple[list[str], list[str]]:
    """A half-space (`below z 0 mm`), or a box by two corners. Raises `InputError`."""
    words = text.split(maxsplit=2)
    if len(words) == 3 and words[0] in ("below", "above"):
        return {words[0]: {words[1]: words[2]}}
    low, to, high = text.partition(" to ")
    if not to:
        would_do = "two corners, '0.5 m, -1 m, 0 m to 2 m, 1 m, 0.4 m', or a side, 'below z 0 mm'"
        raise InputError("", "avoid", f"needs {would_do}, not {shown(text)}")
    return listed(low), listed(high)


ArmFile = Annotated["Arm | File", Argument(metavar="ARM", reads="arm", kind=Path)]
ProblemFile = Annotated["Problem | File", Argument(metavar="PROBLEM", reads="problem", kind=Path)]
ProblemOption = Annotated["Problem | File | None", Option(metavar="PROBLEM", reads="problem", kind=Path)]

T = TypeVar("T")
Listed = Annotated[T, Option(metavar="LIST", kind=str, read=listed)]
"""Several values in one word, between commas."""
Numbered = Annotated[T, Option(metavar="N")]


class _Words:
    """An annotation that shows as its words, without quotation marks."""

    def __init__(self, words: str) -> None:
        self._words = words

    def __repr__(self) -> str:
        """The words."""
        return self._words


def shown_signature(function: Callable[..., Any]) -> inspect.Signature:
    """A function's signature as people read it: what the command line asks for by is left out of annotations."""
    given = inspect.signature(function)
    parameters = [item.replace(annotation=_annotation(item.annotation)) for item in given.parameters.values()]
    return given.replace(parameters=parameters, return_annotation=_annotation(given.return_annotation))


def _annotation(annotation: Any) -> Any:
    if annotation is inspect.Signature.empty:
        return annotation
    bare = get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
    words = bare if isinstance(bare, str) else getattr(bare, "__forward_arg__", None) or inspect.formatannotation(bare)
    return _Words(re.sub(r"\b(?:typing|collections\.abc|pathlib)\.", "", words))

"""What `linkwright materials` and `linkwright sections` do alike to a catalogue of one's own."""

import math
import os
import shlex
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from dataclasses import replace as renamed
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from linkwright.commands.options import Commands
from linkwright.core.catalogues.csv_table import WrongRows
from linkwright.core.catalogues.editor import Editor
from linkwright.core.catalogues.keyed import KeyedEditor
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml
from linkwright.output.files import ReadBack, check_target, write_file
from linkwright.output.table_file import WAYS

if TYPE_CHECKING:
    import pandas as pd

UserFile = Annotated[
    Path | None, typer.Option("--catalogue", metavar="FILE", help="The file to change. Default: your own.")
]
Source = Annotated[str, typer.Option("--source", metavar="TEXT", help="Where the figures are from.")]
Replace = Annotated[bool, typer.Option("--replace", help="Take the place of those of the same name.")]
Changes = Annotated[
    list[str] | None,
    typer.Argument(metavar="[KEY VALUE | KEY=VALUE...]", help="What to change. Without it the editor opens."),
]
Name = Annotated[str, typer.Argument(metavar="NAME", help="Its name.")]
Names = Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Which. Without a name: all.")]
TableFile = Annotated[Path, typer.Option("--out", metavar="FILE", help="A .yaml, .csv, .parquet or .md file.")]
_UsedIn = Annotated[
    list[Path] | None,
    typer.Option("--used-in", metavar="FILE", help="Warn if this arm or problem file uses it. May be repeated."),
]


_AS_WRITTEN = 1e-4
"""How far a figure may be from what it was, of it, once it has been written in a format's units and digits."""
W = TypeVar("W")


@dataclass(frozen=True)
class UserCatalogue:
    """One kind of catalogue, for its commands.

    Attributes:
        group: the commands' name.
        editor: its edits.
        user_file: where the user's file is.
        entry: what it holds, in words.
        called: what the file is called.
        key: under which an arm or problem file names an entry.
        count: how many entries a file has, all checked.
        shipped: what is shipped: names and counts.
        example: a name for the help, as the shell takes it.
        helps: of the commands that say more than that they do.
        such_as: a KEY=VALUE, for messages.
        finder: what finds an entry by its name among the shipped ones and those of a file.
        made: an entry of a name, its values by key, as they were given, and their source.
        read: what reads the entries of a file, by its ending.
        known: all entries with those of a file, by name; its `table_of` some names are their figures, a row each.
        doubts: what is hardly believable of a file's entries, a line each; empty where all are usual.
        keys: what keys are called for short in lists, by which they may be given too.
    """

    group: str
    editor: Editor[Any]
    user_file: Callable[[], Path]
    entry: str
    called: str
    key: str
    count: Callable[[Path], int]
    shipped: Callable[[], list[tuple[str, int]]]
    example: str
    helps: Mapping[str, str]
    such_as: str
    made: Callable[[str, dict[str, str], str], Any]
    finder: Callable[[Path | None], Callable[[str], Any]]
    read: Mapping[str, Callable[[Path], Sequence[Any]]]
    known: Callable[[Path | None], Any]
    doubts: Callable[[Path], Sequence[str]] = lambda _: ()
    keys: Mapping[str, str] = field(default_factory=dict[str, str])

    def whole(self, key: str) -> str:
        """A key as files have it: `E.spread` is `elastic_modulus.spread`."""
        first, dot, rest = key.partition(".")
        return f"{self.keys.get(first, first)}{dot}{rest}"

    def in_full(self, given: Mapping[str, str]) -> dict[str, str]:
        """Values by whole keys. Raises `InputError` where two names of a key are given."""
        values_in_full = {self.whole(key): value for key, value in given.items()}
        if len(values_in_full) < len(given):
            raise InputError("", next(key for key in given if key != self.whole(key)), "is given by both its names")
        return values_in_full

    def path(self, catalogue: Path | None) -> Path:
        """The file to change."""
        return self.user_file() if catalogue is None else catalogue

    def edit_in_editor(self, path: Path, name: str) -> None:
        """Hand a copy of the file to the user's editor, and put it in place once that is closed and it is sound."""
        before, text = self.editor.draft(path, name)
        command = shlex.split(os.environ.get("VISUAL", "").strip() or os.environ.get("EDITOR", "").strip())
        if not command:
            raise InputError("", "$EDITOR", "is not set; set it, or give KEY and VALUE")
        with tempfile.NamedTemporaryFile(
            "w", prefix=f"{path.stem}-", suffix=".yaml", delete=False, encoding="utf-8", newline=""
        ) as stream:
            stream.write(text)
        copy = Path(stream.name)
        try:
            ended = subprocess.run([*command, str(copy)], check=False).returncode
        except OSError as error:
            copy.unlink()
            raise InputError("", "$EDITOR", f"cannot be run: {error.strerror or error}") from None
        edited = copy.read_bytes().decode("utf-8", errors="replace")
        if ended != 0 or edited == text:
            copy.unlink()
            if ended != 0:
                raise InputError("", "$EDITOR", f"ended with status {ended}; nothing was changed")
            typer.echo("nothing was changed")
            return
        try:
            done = self.editor.land(path, before, edited)
        except InputError as error:
            raise InputError("", "", f"{error}; nothing was changed, your text is in {copy}") from None
        copy.unlink()
        say(done, path)

    def write(
        self,
        out: Path,
        names: Sequence[str],
        catalogue: Path | None,
        ways: Mapping[str, Callable[[Sequence[Any]], str]],
    ) -> None:
        """Write the entries of these names to a file in the way that its ending asks for: those of `ways`, which are
        read back and held against their figures, else as a table of these, which nothing reads."""
        check_target(out, catalogue)
        way = _by_ending(out, {**ways, **{ending: None for ending in WAYS if ending not in ways}})
        meant = self.known(catalogue).table_of(names)
        if way is None:
            write_file(out, WAYS[out.suffix.lower()](meant))
        else:
            text = way([*map(self.finder(catalogue), names)])
            write_file(out, ReadBack(text, partial(self._unlike, meant)))
        typer.echo(f"wrote {len(names)} {self.editor.what}{'' if len(names) == 1 else 's'} to {out}")

    def _unlike(self, meant: "pd.DataFrame", path: Path) -> Iterator[str]:
        """The figures that entries of a file, once they are imported, have otherwise than was meant, in its rows; a
        format that holds less leaves some out."""
        from pandas.api.types import is_numeric_dtype

        entries = _by_ending(path, self.read)(path)
        with tempfile.TemporaryDirectory() as folder:
            held = Path(folder) / "read.yaml"
            self.editor.add(held, entries)
            read = self.known(held).table_of(entry.name for entry in entries)
        if len(read) != len(meant):
            yield f"it had {len(meant)} entries and reads {len(read)}"
            return
        for column in meant.columns:
            if not is_numeric_dtype(meant[column]) or not is_numeric_dtype(read[column]):
                continue
            for name, was, reads in zip(meant["name"], meant[column], read[column], strict=True):
                if was == was and reads == reads and not math.isclose(was, reads, rel_tol=_AS_WRITTEN):
                    yield f"{column} of {name} was {was:g} and reads {reads:g}"

    def question(self, path: Path, *names: str) -> None:
        """Warn of what is hardly believable of a file's entries of these names, all of them without a name."""
        for doubt in self.doubts(path):
            if not names or any(doubt.startswith(f"{name}:") for name in names):
                typer.echo(f"WARNING: {doubt}", err=True)

    def _sound(self, file: Path) -> tuple[Sequence[Any], Sequence[InputError]]:
        """The entries of a file that may stand in a catalogue, and what is wrong with the others, which is said.

        Raises `InputError` where there is none.
        """
        faults: list[InputError] = []
        try:
            entries = _by_ending(file, self.read)(file)
        except WrongRows as wrong:
            entries, faults = wrong.good, [*wrong.faults]
        try:
            self.editor.check_each(file, entries)
        except WrongRows as wrong:
            entries, faults = wrong.good, [*faults, *wrong.faults]
        if faults and not entries:
            raise WrongRows((), faults)
        for fault in faults:
            typer.echo(str(fault), err=True)
        return entries, faults

    def _warn(self, name: str, files: list[Path] | None) -> None:
        for file in files or ():
            if self.editor.uses(file, name, self.key):
                typer.echo(f"WARNING: {file} uses {name}", err=True)

    def commands(self, export: Callable[..., None], edit: Callable[..., None] | None = None) -> Commands:
        """`add`, `edit`, `remove`, `check` and `import` with `export`. An `edit` may be given where keys are not all
        that can be changed."""
        editor, example = self.editor, f"Example: linkwright {self.group}"

        def add(
            name: Name,
            values: Annotated[list[str], typer.Argument(metavar="KEY=VALUE", help="What it has, by key.")],
            source: Source = "",
            replace: Replace = False,
            catalogue: UserFile = None,
        ) -> None:
            entry, path = self.made(name, self.in_full(key_values(values, self.such_as)), source), self.path(catalogue)
            say(editor.add(path, [entry], replace=replace), path)
            self.question(path, name)

        def import_(
            file: Annotated[Path, typer.Argument(metavar="FILE", help=f"A file: {', '.join(self.read)}.")],
            name: Annotated[str, typer.Option("--name", help="The name to give the one entry of the file.")] = "",
            replace: Replace = False,
            catalogue: UserFile = None,
        ) -> None:
            entries, faults = self._sound(file)
            path = self.path(catalogue)
            if name:
                if len(entries) != 1:
                    raise InputError(file, "", f"has {len(entries)} {editor.what}s; --name is for one")
                entries = [renamed(entries[0], name=name)]
            done = editor.add(path, entries, replace=replace)
            say(done if len(entries) <= 5 else f"added {len(entries)} {editor.what}s", path)
            self.question(path, *(entry.name for entry in entries))
            if faults:
                count = len(entries) + len(faults)
                raise InputError(file, "", f"{len(faults)} of {count} {editor.what}s were not taken, as said above")

        def remove(name: Name, used_in: _UsedIn = None, catalogue: UserFile = None) -> None:
            path = self.path(catalogue)
            self._warn(name, used_in)
            done = editor.remove(path, name)
            say(done + ("; the shipped one shows again" if editor.shipped(name) is not None else ""), path)

        def check(
            files: Annotated[list[Path] | None, typer.Argument(metavar="[FILE...]", help="The files.")] = None,
            catalogue: Annotated[
                Path | None, typer.Option("--catalogue", metavar="FILE", help="One more file to check.")
            ] = None,
        ) -> None:
            paths = [*(files or ()), *([catalogue] if catalogue is not None else [])]
            counts = [(str(path), self.count(path)) for path in paths]
            if not paths:
                user_file = self.user_file()
                counts = [
                    *self.shipped(),
                    *([(str(user_file), self.count(user_file))] if os.path.exists(user_file) else []),
                ]
            for file, count in counts:
                typer.echo(f"{file}: {count} {editor.what}{'' if count == 1 else 's'}, all sound")
                if Path(file).exists():
                    self.question(Path(file))

        helps = {
            **self.helps,
            "remove": f"Take a {self.entry} out of your {self.called}.\n\n{example} remove {self.example} "
            "--used-in arm.yaml",
            "check": f"{self.helps['check']}\n\n{example} check {self.group}.yaml",
        }
        every: dict[str, Callable[..., None]] = {"add": add, "edit": edit or self._edit_keys()}
        every |= {"remove": remove, "check": check, "import": import_, "export": export}
        for name, function in every.items():
            function.__doc__ = helps.get(name, function.__doc__)
        return every

    def _edit_keys(self) -> Callable[..., None]:
        """The command that changes keys of an entry, or hands the file to the user's editor."""
        editor: KeyedEditor = self.editor  # pyright: ignore[reportAssignmentType] - others bring a command of their own

        def edit(
            name: Name,
            changes: Changes = None,
            source: Source = "",
            unset: Annotated[bool, typer.Option("--unset", help="Take the key away.")] = False,
            catalogue: UserFile = None,
        ) -> None:
            path = self.path(catalogue)
            if not changes:
                self.edit_in_editor(path, name)
                return
            if unset:
                if len(changes) > 1 or "=" in changes[0]:
                    raise InputError("", "--unset", "takes one KEY and no value")
                say(editor.remove_key(path, name, self.whole(changes[0])), path)
                return
            edits = changes_of(changes, self.such_as)
            values = {key: value_of_text(text, key) for key, text in self.in_full(edits).items()}
            say(editor.set_keys(path, name, values, source=source), path)
            self.question(path, name)

        return edit


def value_of_text(text: str, key: str) -> Any:
    """A value as YAML reads it: `71 GPa`, `0.3`, `[1 EUR/kg, 2 EUR/kg]`, `{value: 71 GPa, source: x}`."""
    if text.lstrip().startswith(("[", "{")):
        return parse_yaml(text, file=f"the value of {key}")
    parsed = (
        parse_yaml(f"[{text}]", file="") if not set(text) & set(",[]{}#&*!|>%@`'\"\n") and ": " not in text else None
    )
    return parsed[0] if isinstance(parsed, list) and len(parsed) == 1 and parsed[0] is not None else text


def say(text: str, path: Path) -> None:
    """Tell what was done, and where."""
    typer.echo(f"{text} ({path})")


def key_values(texts: list[str], such_as: str) -> dict[str, str]:
    """`KEY=VALUE` words by key. Raises `InputError`."""
    values: dict[str, str] = {}
    for text in texts:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not key or not value:
            raise InputError("", text, f"is not KEY=VALUE, such as {such_as}")
        if key in values:
            raise InputError("", key, "is given twice")
        values[key] = value
    return values


def changes_of(words: list[str], such_as: str) -> dict[str, str]:
    """`KEY VALUE`, or any number of `KEY=VALUE`, by key. Raises `InputError`."""
    if any("=" in word for word in words[:1]):
        return key_values(words, such_as)
    if len(words) == 1:
        raise InputError("", "VALUE", f"is missing: give {words[0]} a value, or --unset {words[0]}")
    if len(words) > 2:
        raise InputError("", words[2], "is too much: one KEY VALUE, or several KEY=VALUE")
    return {words[0]: words[1]} if words else {}


def _by_ending(path: Path, ways: Mapping[str, W]) -> W:
    ending = path.suffix.lower().replace(".yml", ".yaml")
    for known, way in ways.items():
        if ending == known.lower():
            return way
    raise InputError(path, "", f"is of no known kind; known: {', '.join(ways)}")

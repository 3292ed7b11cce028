"""Many variants of an arm at once: a table of figures by the values of some keys of its file."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.chain import Link
from linkwright.core.arm.errors.structure import Identity, entries, link_entries
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.optimize.sweep.designs import Sweep
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm, arm_of
from linkwright.face.plain_input import File
from linkwright.face.progress import Progress, reporting

if TYPE_CHECKING:
    import pandas as pd

DEFAULT_FIGURES = ("max_error", "mass", "total_mass", "reach", "cost")
"""The figures of a sweep where none are named: those that cost next to nothing beside the worst error."""

Values = Mapping[str, Iterable[object]]


def sweep(
    arm: Arm | File,
    values: Values | pd.DataFrame,
    *,
    figures: Iterable[str] = DEFAULT_FIGURES,
    zipped: bool = False,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """The figures of all variants of an arm, in a table of one row each.

    The worst error and other figures that depend on the pose are those over the joint ranges, climbed to from a scan of
    512 poses, without a certificate; `lw.evaluate` certifies one variant. Variants that differ in lengths, sections and
    materials share what is compiled; each further value of another key (a payload, a stiffness) costs about 0.1 s.

    Args:
        arm: the arm, or its file.
        values: for each key of the arm file, such as `chain[1].link.section.diameter` (lists count from 1), what it is
            set to: text with a unit or numbers in SI. A DataFrame is a row for each variant.
        figures: names in `lw.limits`.
        zipped: take the values of all keys one by one together, not each combination of them.
        progress: called with a text and the share that is done, in place of the bar.

    Returns:
        A DataFrame: a column for each key, with its values as given, and one for each figure, with the unit in its name
        as in JSON (`max_error_mm`); NaN where a figure is not known.

    Raises:
        InputError: a key, a value or a figure that nobody knows, or keys of unequal numbers of values.
        MissingProperty: a figure needs what the arm lacks.

    Example:
        >>> import linkwright as lw
        >>> arm = lw.read_arm("examples/welding-arm/arm.yaml")
        >>> table = lw.sweep(arm, {"chain[1].link.section.diameter": ["100 mm", "120 mm"]})
        >>> table[["max_error_mm", "mass_kg"]].round(4).values.tolist()
        [[0.1939, 26.2951], [0.1172, 30.0273]]
    """
    import pandas as pd

    given = arm_of(arm, tips="every")
    known = [_figure(name) for name in figures]
    keys, rows = _rows(values, zipped=zipped)
    variants = _Variants(given, keys, rows)
    result = np.full((len(rows), len(known)), np.nan)
    with reporting(progress) as report:
        groups = variants.groups()
        steps = len(groups) * max(len(known), 1)
        for step, ((numbers, group), (column, figure)) in enumerate(itertools.product(groups, enumerate(known))):

            def part(share: float, step: int = step, figure: Figure = figure) -> None:
                report(f"{len(rows)} variants: {figure.title}", (step + share) / steps)

            computed = group.figure(figure, part)
            result[numbers, column] = np.where(np.isfinite(computed), figure.factor * computed, np.nan)
    table = pd.DataFrame({key: [row[k] for row in rows] for k, key in enumerate(keys)})
    return table.join(pd.DataFrame(result, columns=[figure.key for figure in known]))


def _figure(name: str) -> Figure:
    if name not in FIGURES:
        raise InputError("sweep", "figures", f"there is no figure '{name}'{nearest(name, list(FIGURES))}")
    return FIGURES[name]


def _rows(values: Values | pd.DataFrame, *, zipped: bool) -> tuple[list[str], list[tuple[object, ...]]]:
    """The keys, and the values of each variant."""
    import pandas as pd

    zipped = zipped or isinstance(values, pd.DataFrame)
    columns = {str(key): list(value) for key, value in values.items()}
    for key, given in columns.items():
        if not given:
            raise InputError("sweep", key, "has no values")
    if not columns:
        raise InputError("sweep", "values", "names no key; write e.g. {'chain[1].link.length': ['400 mm', '450 mm']}")
    counts = {key: len(given) for key, given in columns.items()}
    if zipped and len(set(counts.values())) > 1:
        counts_text = ", ".join(f"{key} {count}" for key, count in counts.items())
        raise InputError("sweep", "values", f"zipped, all keys need as many values, and they have: {counts_text}")
    rows = zip(*columns.values(), strict=True) if zipped else itertools.product(*columns.values())
    return list(columns), list(rows)


class _Variants:
    """The variants, read as an arm file is: once for each combination of the values of the keys of one link, as far as
    these keys change that link alone, and once for each combination of the others."""

    def __init__(self, arm: Arm, keys: Sequence[str], rows: Sequence[tuple[object, ...]]) -> None:
        self._arm, self._keys, self._rows = arm, keys, rows
        owners = [self._link_of(k) for k in range(len(keys))]
        self._of_link = {
            link: tuple(k for k, owner in enumerate(owners) if owner == link) for link in range(arm.model.size)
        }
        self._others = tuple(k for k, owner in enumerate(owners) if owner is None)

    def _read(self, columns: Sequence[int], row: Sequence[object]) -> Model:
        arm = self._arm
        for k in columns:
            arm = arm.replace(self._keys[k], row[k])
        return arm.model

    def _link_of(self, column: int) -> int | None:
        """The link (from 0) that alone changes with a key; None where anything else does."""
        base, changed = self._arm.model, self._read((column,), self._rows[-1])
        for index in range(base.size):
            if self._keys[column].startswith(f"{base.entry(index)}.link.") and changed.size == base.size:
                links = (*changed.links[:index], base.links[index], *changed.links[index + 1 :])
                return index if Identity(changed.with_links(links)) == Identity(base) else None
        return None

    def groups(self) -> list[tuple[Any, Sweep]]:
        """Variants of one structure: their numbers, and the sweep over them."""
        bases, which = self._distinct(self._others, self._read)
        sizes = {base.size for base in bases}
        if len(sizes) > 1:
            raise InputError("sweep", self._keys[self._others[0]], "all variants need as many joints")
        size = sizes.pop()
        options: list[list[Link]] = []
        chosen = np.empty((len(self._rows), size), dtype=np.intp)
        for link in range(size):
            columns = self._of_link.get(link, ())
            if any(base.size != self._arm.model.size or _differ(base, self._arm.model, link) for base in bases):
                columns = (*columns, *self._others)
            links, chosen[:, link] = self._distinct(columns, partial(self._link, link))
            options.append(links)
        kinds = [[link_entries(item) for item in links] for links in options]
        groups: dict[tuple[object, ...], list[int]] = {}
        for number, row in enumerate(chosen.tolist()):
            kind = (int(which[number]), *(links[option] for links, option in zip(kinds, row, strict=True)))
            groups.setdefault(kind, []).append(number)
        return [
            (numbers, self._sweep(bases[which[numbers[0]]], options, chosen[numbers])) for numbers in groups.values()
        ]

    def _link(self, link: int, columns: Sequence[int], row: Sequence[object]) -> Link:
        return self._read(columns, row).links[link]

    def _sweep(self, base: Model, options: Sequence[Sequence[Link]], rows: Any) -> Sweep:
        first = tuple(links[option] for links, option in zip(options, rows[0].tolist(), strict=True))
        return Sweep(base.with_links(first), options, rows)

    def _distinct(self, columns: Sequence[int], read: Any) -> tuple[list[Any], Any]:
        """What is read for each combination of some keys' values, and which of them each variant has."""
        places: dict[str, int] = {}
        made: list[Any] = []
        which = np.empty(len(self._rows), dtype=np.intp)
        for number, row in enumerate(self._rows):
            key = repr([row[k] for k in columns])
            if key not in places:
                places[key] = len(made)
                made.append(read(columns, row))
            which[number] = places[key]
        return made, which


def _differ(one: Model, other: Model, link: int) -> bool:
    return entries(one.links[link]) != entries(other.links[link])

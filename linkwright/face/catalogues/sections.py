"""Stock sizes by name."""

from __future__ import annotations

from collections.abc import ValuesView
from typing import TYPE_CHECKING

from linkwright.core.sections import Stock, StockSize, load_stock
from linkwright.face.catalogues.catalogue_lists import Catalogue
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


class Sections(Catalogue[StockSize]):
    """The stock sizes by name, whatever its case and spaces: the shipped ones with the user's over them.

    Each holds its `section`, `family`, `dimensions` (m), `source` and what its maker or standard `printed`.

    >>> import linkwright as lw
    >>> round(1e6 * lw.sections["ipe80"].section.properties(poisson_ratio=0.3).area, 1)
    764.3
    >>> lw.sections["IPE 81"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: section: there is no stock size 'IPE 81'; did you mean 'IPE 80'?
    """

    @property
    def stock(self) -> Stock:
        """All of them, by families. Raises `InputError`."""
        return load_stock(self._files)

    def __getitem__(self, name: str) -> StockSize:
        """The size of a name; raises `InputError` with the nearest known one."""
        return self.stock.find(name)

    def _names(self) -> list[str]:
        return [size.name for size in self.stock]

    def values(self) -> ValuesView[StockSize]:
        """All of them, in the order of their tables."""
        return {size.name: size for size in self.stock}.values()

    def of_family(self, *families: str) -> tuple[StockSize, ...]:
        """The sizes of some families; raises `InputError` for one that there is not, with those that there are."""
        return tuple(size for family in families for size in self.stock.of_family(family))

    @property
    def table(self) -> pd.DataFrame:
        """All sizes: name, family, shape, area (cm^2), second moments (cm^4), torsion constant (cm^4)."""
        names = {"area": 2, "second_moment_y": 4, "second_moment_z": 4, "torsion_constant": 4}
        rows: list[tuple[object, ...]] = []
        for size in self.values():
            properties = size.section.properties(0.3)
            figures = [float(getattr(properties, name)) * 100.0**power for name, power in names.items()]
            rows.append((size.name, size.family, size.shape, *figures))
        headings = [f"{name}_cm{power}" for name, power in names.items()]
        return frame(rows, ["name", "family", "shape", *headings])


sections = Sections()

"""Shapes of sections, called with their dimensions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from linkwright.core.arm.files.read import read_section
from linkwright.core.sections import SHAPES
from linkwright.core.sections.section import Section as Shape
from linkwright.core.units.names import nearest
from linkwright.core.units.reading import Mapping as Reader
from linkwright.face.catalogues.catalogue_lists import Open
from linkwright.face.plain_input import plain


class Shapes(Open[type[Shape]]):
    """The shapes of sections: each is called with its dimensions (text, or m) and gives a section; by name in arm
    files' spelling they are the classes. Open: what is registered may stand in arm files and be chosen.

    A section has `properties(poisson_ratio)` in SI, and may stand in a link. Raises `InputError` for dimensions that
    are missing, unknown or cannot be.

    >>> import linkwright as lw
    >>> box = lw.shapes.RectangularTube(width="80 mm", height=0.12, thickness="3 mm")
    >>> round(1e6 * box.properties(poisson_ratio=0.3).area, 3)
    1164.0
    >>> lw.shapes.Circel
    Traceback (most recent call last):
    ...
    AttributeError: there is no shape 'Circel'; did you mean 'Circle'?
    """

    def __getattr__(self, name: str) -> Callable[..., Shape]:
        """What makes a section of that shape."""
        names = {_class_name(item): item for item in SHAPES}
        if name not in names:
            raise AttributeError(f"there is no shape '{name}'{nearest(name, list(names))}")
        shape = names[name]

        def made(**dimensions: object) -> Shape:
            return read_section(Reader({"shape": shape, **plain(dimensions)}, file=name))

        made.__name__ = made.__qualname__ = name
        made.__doc__ = f"A section `{shape}` by its dimensions: {', '.join(d.name for d in SHAPES[shape].dimensions)}."
        return made

    def check(self, kind: type[Shape], *sections: Shape) -> None:
        """Hold a shape against the contract that every shape keeps, on sections of random dimensions or on those given.
        Raises `InputError` with all that it breaks."""
        from linkwright.core.sections.contract import check_shape

        check_shape(kind, *sections)

    def from_dxf(self, path: str | Path, name: str, *, solid: bool = False) -> type[Shape]:
        """A shape that looks like the closed edges of a drawing (the largest is the outer one), by its `height`.

        All its properties come from the outline, so that a height may be chosen. What `register` takes may be this
        class, or one derived from it that says which walls it has. Raises `InputError` where the file is no drawing of
        an outline. Needs the extra `dxf`.
        """
        from linkwright.drawings.profile import shape_from_dxf

        return shape_from_dxf(Path(path).absolute(), name, solid=solid)

    def __dir__(self) -> list[str]:
        """The names of all shapes, and what a list of them does."""
        return sorted({*super().__dir__(), *map(_class_name, SHAPES)})

    def __repr__(self) -> str:
        """One line."""
        return f"<Shapes: {', '.join(sorted(map(_class_name, SHAPES)))}>"


def _class_name(shape: str) -> str:
    return "".join(part.capitalize() for part in shape.split("_"))


shapes = Shapes("shape", SHAPES)

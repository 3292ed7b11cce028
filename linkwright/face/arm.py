"""Arms for programs: read from a file, built from parts, and changed key by key; checked as a file is."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, cast

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.files.origin import UNKNOWN_ORIGIN
from linkwright.core.arm.files.read import arm_from
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.materials.catalogue import Catalogue, load_catalogue
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_yaml, parse_yaml
from linkwright.output.arm_file import arm_file
from linkwright.output.files import ReadBack, write_file
from linkwright.results.figures_in_words import mm, section_words

from .plain_input import File, edited, path_of, plain

if TYPE_CHECKING:
    import pandas as pd

    from linkwright.core.arm.evaluation import Evaluation

DESCRIPTIONS = (".urdf", ".xml", ".mjcf", ".xacro")
"""Endings of files that are read as URDF or MJCF; one that is neither is refused by name."""


@dataclass(frozen=True, init=False, repr=False)
class _Keys:
    """A part of an arm to be built, by the keys of an arm file; what numbers mean without a unit is SI."""

    keys: Mapping[str, Any]

    def __init__(self, **keys: object) -> None:
        object.__setattr__(self, "keys", plain(keys))

    def in_file(self) -> Mapping[str, Any]:
        """The keys of the arm file."""
        return self.keys

    def __repr__(self) -> str:
        """As it is written."""
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.keys.items())})"


class Joint(_Keys):
    """A joint of an arm to be built, by the keys of an arm file's `joint`; text with a unit or numbers in SI.

    `type` is revolute (default) or prismatic; `range` two angles (rad) or lengths (m); `clearance` m; `backlash` rad or
    m; `stiffness` N*m/rad or N/m; `mass` kg; any further key of the file as well. Checked when the arm is built.

    >>> import linkwright as lw
    >>> lw.Joint(range=["-90 deg", "90 deg"], backlash="3 arcmin")
    Joint(range=['-90 deg', '90 deg'], backlash='3 arcmin')
    """


class Link(_Keys):
    """A link of an arm to be built, by the keys of an arm file's `link`; text with a unit or numbers in SI.

    `length` m; `section` a stock size (`"IPE 80"`), a mapping, or one of `lw.shapes`; `material` a catalogue's name,
    its properties in place, or one of `lw.materials`; `rigid`, `mass` kg and `center_of_mass` m for a link of unknown
    section. Checked when the arm is built.

    >>> import linkwright as lw
    >>> lw.Link(length="400 mm", section="IPE 80", material="steel-s355")
    Link(length='400 mm', section='IPE 80', material='steel-s355')
    """


@dataclass(frozen=True, init=False, repr=False)
class Arm:
    """A serial arm: built from joints and links, or read by `lw.read_arm`; frozen.

    `chain` is a list of pairs `(lw.Joint(...), lw.Link(...))`, or of mappings as in an arm file; further keywords are
    the other keys of the file (`name`, `payload`, `gravity`, `temperature`, `effects`, ...). Lengths and all other
    quantities are text with a unit or numbers in SI. `catalogue` is a file of materials laid over the shipped ones.
    Everything is checked as a file is: raises `InputError`, one line with the key and what would do.

    >>> import linkwright as lw
    >>> arm = lw.Arm(
    ...     chain=[
    ...         (lw.Joint(range=["-90 deg", "90 deg"]), lw.Link(length=0.4, section="IPE 80", material="steel-s355")),
    ...         (lw.Joint(backlash="3 arcmin"), lw.Link(length="300 mm", section="IPE 80", material="steel-s355")),
    ...     ],
    ...     payload={"mass": "2 kg"},
    ...     name="crane",
    ... )
    >>> arm
    <Arm: crane, 2 joints, reach 700 mm>
    >>> arm.replace("chain[1].link.lenght", "430 mm")
    Traceback (most recent call last):
    ...
    linkwright.InputError: Arm: chain[1].link: unknown key 'lenght'; did you mean 'length'?
    """

    model: Model
    """What the rest of the project computes with, SI."""
    catalogue: File | None = field(compare=False)
    learned: tuple[tuple[float, float], ...] | None = field(compare=False)
    """The joint coordinates (rad, m; least and greatest) of the recording that a corrected arm was learned from."""
    unread: tuple[str, ...] = field(compare=False)
    """What stands for weights of an MJCF whose meshes are not there, a sentence each."""
    _given: Mapping[str, Any] | None = field(compare=False)

    def __init__(self, chain: Iterable[object] = (), *, catalogue: File | None = None, **keys: object) -> None:
        if isinstance(chain, str | Path):
            message = f"is the joints and links; an arm file is read by lw.read_arm({str(chain)!r})"
            raise InputError("Arm", "chain", message)
        content: dict[str, Any] = plain({**keys, "chain": [_entry(item) for item in chain]})
        self._fill(_read(content, catalogue), content, catalogue, None, ())

    def _fill(
        self,
        model: Model,
        content: Mapping[str, Any] | None,
        catalogue: File | None,
        learned: tuple[tuple[float, float], ...] | None,
        unread: tuple[str, ...],
    ) -> None:
        for name, value in (
            ("model", model),
            ("_given", None if content is None else MappingProxyType(dict(content))),
            ("catalogue", catalogue),
            ("learned", learned),
            ("unread", unread),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def of(
        cls,
        model: Model,
        content: Mapping[str, Any] | None = None,
        catalogue: File | None = None,
        learned: tuple[tuple[float, float], ...] | None = None,
        unread: tuple[str, ...] = (),
    ) -> Arm:
        """An arm of what the project computes with; `content` is the arm file that it was read from, if any."""
        made = cls.__new__(cls)
        made._fill(model, content, catalogue, learned, unread)
        return made

    @property
    def name(self) -> str:
        """Its name."""
        return self.model.name

    @property
    def content(self) -> Mapping[str, Any]:
        """The keys of the arm file; of an arm that was read from none, those of the file that would be written."""
        if self._given is not None:
            return self._given
        return MappingProxyType(cast(dict[str, Any], parse_yaml(arm_to_yaml(self.model), file="Arm")))

    @property
    def table(self) -> pd.DataFrame:
        """The chain, a row for each joint and its link."""
        made = links_table(self.model).rename(columns={"link": "joint"})
        made.insert(1, "type", [joint.type for joint in self.model.joints])
        return made

    def replace(self, key: str, value: object) -> Arm:
        """A new arm with one key of its file changed, such as `chain[1].link.length`; lists count from 1.

        `value` is as in the file, or numbers in SI; None takes the key out. Raises `InputError` for a key that nobody
        knows, with the nearest known one.
        """
        content = edited(self.content, key, value, "Arm")
        model = _read(content, self.catalogue, None if self.model.every_tip else self.model.tip)
        return Arm.of(model, content, self.catalogue)

    def to_yaml(self) -> str:
        """The arm as the text of an arm file."""
        return arm_to_yaml(self.model)

    def save(self, path: File) -> None:
        """Write the arm file, whole or not at all, and read it back. Raises `InputError`."""
        write_file(Path(path), self.to_file())

    def to_file(self, promised: Evaluation | None = None) -> ReadBack:
        """Its file to be written, which is read back with its catalogue and held to the figures `promised`."""
        return arm_file(self.model, catalogue_of(self.catalogue), promised)

    def __repr__(self) -> str:
        """One line."""
        size = self.model.size
        joints = f"{size} joint{'s' if size > 1 else ''}"
        reaches = [(branch.name, self.model.on(branch.name).to_tip) for branch in self.model.branches]
        if not self.model.every_tip:
            reaches = [(self.model.tip, self.model.to_tip)]
        reach = "reach " + ", ".join(
            mm(sum(self.model.lengths[index] for index in way)) + (f" to {name}" if name else "")
            for name, way in reaches
        )
        return f"<Arm: {' '.join(self.name.split())}, {joints}, {reach}>"

    def _repr_html_(self) -> str:
        """The line and the chain, for a notebook."""
        import html

        return f"<p>{html.escape(repr(self)[1:-1])}</p>\n{self.table.to_html(index=False, border=0)}"


def links_table(arm: Model) -> pd.DataFrame:
    """The links of an arm: number, length (mm), section, material."""
    import pandas as pd

    rows = [
        (number, 1e3 * link.length, section_words(link), "" if link.material is None else link.material.name)
        for number, link in enumerate(arm.links, start=1)
    ]
    return pd.DataFrame(rows, columns=["link", "length_mm", "section", "material"])


def _read(content: dict[str, Any], catalogue: File | None, tip: str | None = None) -> Model:
    return arm_from(Reader(content, file="Arm"), catalogue_of(catalogue), tip=tip)


def _entry(given: object) -> object:
    """An entry of the chain: a mapping, or a pair of joint and link."""
    if isinstance(given, Mapping):
        return cast(Mapping[str, Any], given)
    if isinstance(given, tuple | list):
        parts = cast("tuple[object, ...] | list[object]", given)
        if len(parts) == 2 and isinstance(parts[0], Joint) and isinstance(parts[1], Link):
            return {"joint": parts[0], "link": parts[1]}
    if isinstance(given, Joint):
        return {"joint": given}
    raise InputError("Arm", "chain", "needs pairs such as (lw.Joint(...), lw.Link(...)), or mappings {joint, link}")


def catalogue_of(path: File | None) -> Catalogue:
    """The materials, with a file of the user's over them. Raises `InputError`."""
    return load_catalogue([] if path is None else [Path(path)])


def read_arm(path: File, *, catalogue: File | None = None, tip: str | None = None) -> Arm:
    """The arm that an arm file, a URDF or an MJCF describes.

    `catalogue` is a file of materials laid over the shipped ones. Of several arms on one torso (`branches`) `tip` names
    the one that counts; empty: the first; None: the worst of all of them does, where a command can take them so. Of a
    URDF it is the link at the tip, of an MJCF a body or site (`import_arm` says what they lack). Raises `InputError`,
    one line with the file, the key and what would do, for anything wrong.

    >>> import linkwright as lw
    >>> arm = lw.read_arm("examples/welding-arm/arm.yaml")
    >>> arm
    <Arm: cathode-bus welding arm, 3 joints, reach 1240 mm>
    >>> arm.replace("chain[1].link.length", "430 mm")
    <Arm: cathode-bus welding arm, 3 joints, reach 1270 mm>
    """
    path = path_of(path, "arm", "an Arm")
    if path.suffix.lower() in DESCRIPTIONS:
        from linkwright.core.arm.descriptions.imported import import_robot

        imported = import_robot(path, tip=tip or None)
        return Arm.of(imported.arm, catalogue=catalogue, unread=imported.unread)
    mapping = load_yaml(path)
    model = arm_from(mapping, catalogue_of(catalogue), tip=tip)
    return Arm.of(model, mapping.content, catalogue, _learned(path, model))


def _learned(path: Path, model: Model) -> tuple[tuple[float, float], ...] | None:
    """What an arm file in the folder of a diagnosis was learned from."""
    if not os.path.exists(path.with_name("diagnosis.json")):
        return None
    from linkwright.output.diagnosis_folder import learned_from

    return learned_from(path, model)


Tips = Literal["every", "first", "one"]
"""What a command can do with several arms on one torso: with all their tips at once, with those that recordings name
(the first will do), or with one that must be named."""


def arm_of(given: Arm | File, *, tips: Tips = "one", unknown_origins: bool = False) -> Arm:
    """An arm as given, or read from the file that is named. It may be of several arms on one torso as `tips` says, and
    with `unknown_origins` of fixed transforms that are free, which a diagnosis alone can do with."""
    arm = given if isinstance(given, Arm) else read_arm(given)
    if arm.model.unknown_origins and not unknown_origins:
        index = arm.model.unknown_origins[0]
        file = "Arm" if isinstance(given, Arm) else str(given)
        raise InputError(file, f"chain[{index + 1}].origin", UNKNOWN_ORIGIN)
    if tips == "first" and arm.model.every_tip:
        return Arm.of(arm.model.on(arm.model.tip), arm.content, arm.catalogue, arm.learned)
    if arm.model.every_tip and tips == "one":
        listed = ", ".join(branch.name for branch in arm.model.branches)
        would_do = f"name one of them (--tip, or read_arm(..., tip={arm.model.branches[0].name!r}))"
        raise InputError(
            "Arm" if isinstance(given, Arm) else given,
            "branches",
            f"end in several tips ({listed}), and this takes one; {would_do}",
        )
    return arm

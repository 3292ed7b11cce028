"""A limit as a problem file writes it: `"<= 26 kg"`, or with the poses at which it holds."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from types import MappingProxyType
from typing import cast

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import Bound, Relation, read_bound, shown
from linkwright.core.units.reading import Mapping

from .figure import Figure
from .limit import Limit

_WORDS: MappingLike[Relation, str] = MappingProxyType({">=": "at_least", "<=": "at_most", "==": "equal_to"})


def read_limit(body: Mapping, figure: Figure, entry: object, arm: Arm) -> Limit:
    """The limit that stands under a figure's name in `subject_to`; raises `InputError`."""
    name = figure.name
    poses = None
    if isinstance(entry, dict) and figure.at_poses is not None:
        with Mapping(cast(object, entry), file=body.file, key=body.path_of(name)).reading() as inner:
            given: list[tuple[Relation, str]] = [
                (relation, word) for relation, word in _WORDS.items() if inner.has(word)
            ]
            if len(given) != 1:
                would_do = " or ".join(_WORDS[relation] for relation in figure.senses)
                raise body.error(name, f"needs {would_do}, e.g. {{{would_do}: ..., poses: [[...]]}}")
            relation, word = given[0]
            bound = Bound(relation, inner.quantity(word, figure.kind))
            poses = _poses(inner, arm)
    else:
        bound = read_bound(entry, figure.kind, file=body.file, key=body.path_of(name), senses=figure.senses)
    if bound.relation not in figure.senses:
        raise body.error(name, f"can only be limited by {' or '.join(figure.senses)}, not {shown(entry)}")
    if bound.value <= 0.0:
        raise body.error(name, f"needs a limit above zero, not {shown(entry)}")
    return Limit(figure, bound.relation, bound.value, poses)


def _poses(body: Mapping, arm: Arm) -> tuple[tuple[float, ...], ...] | None:
    """Lists of joint coordinates, from the base out; everywhere in the workspace where none are given."""
    if not body.has("poses"):
        return None
    found: list[tuple[float, ...]] = []
    for number, raw in enumerate(body.items("poses"), start=1):
        if not isinstance(raw, list) or len(cast(list[object], raw)) != arm.size:
            joints = f"a coordinate for each of the {arm.size} joints"
            raise body.error(f"poses[{number}]", f"is {joints}, e.g. [0 deg, 30 deg], not {shown(raw)}")
        names = {f"q{k}": value for k, value in enumerate(cast(list[object], raw), start=1)}
        one = Mapping(names, file=body.file, key=body.path_of(f"poses[{number}]"))
        kinds = ["angle" if joint.revolute else "length" for joint in arm.joints]
        found.append(tuple(one.quantity(key, kind) for key, kind in zip(names, kinds, strict=True)))
    if not found:
        raise body.error("poses", "is empty; leave it out for the whole workspace")
    return tuple(found)

"""A limit as a problem file writes it: `"<= 26 kg"`, or with the poses at which it holds."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingLike
from types import MappingProxyType
from typing import cast

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures import DIRECTED, Demands, Direction, Figure, Limit
from linkwright.core.arm.figures.motion.settling import SETTLING, settling_time
from linkwright.core.units.quantities import Bound, Relation, read_bound, read_quantity, shown
from linkwright.core.units.reading import Mapping

from .by_link import OTHERS, by_link, said_by_number

_WORDS: MappingLike[Relation, str] = MappingProxyType({">=": "at_least", "<=": "at_most", "==": "equal_to"})


def read_limit(body: Mapping, figure: Figure, entry: object, arm: Arm) -> Limit:
    """The limit that stands under a figure's name in `subject_to`; raises `InputError`."""
    name = figure.name
    poses = None
    if isinstance(entry, dict) and figure.by:
        return _by_parts(body, figure, cast(dict[object, object], entry), arm)
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
            poses = read_coordinates(inner, arm) if inner.has("poses") else None
    else:
        bound = read_bound(entry, figure.kind, file=body.file, key=body.path_of(name), senses=figure.senses)
    return Limit(figure, *_checked(body, name, figure, bound, entry), poses)


def names_direction(name: str, entry: object) -> bool:
    """Whether what stands under a figure's name makes a figure along a direction, or has to."""
    directed = DIRECTED.get(name)
    return directed is not None and isinstance(entry, dict) and directed.word in entry


def read_directed(body: Mapping, name: str, entry: object, arm: Arm) -> Limit:
    """The limit on a figure along a direction, `{direction: [0, 0, 1], value: "<= 0.05 mm"}`; raises `InputError`."""
    directed = DIRECTED[name]
    if not isinstance(entry, dict):
        would_do = f'{{{directed.word}: [0, 0, 1], value: "..."}}'
        raise body.error(name, f"needs its {directed.word}: {would_do}, not {shown(entry)}")
    with Mapping(cast(object, entry), file=body.file, key=body.path_of(name)).reading() as inner:
        figure = directed.figure(read_direction(inner, directed.word))
        bound = inner.bound("value", figure.kind)
        relation, value = _checked(inner, "value", figure, bound, inner.raw("value"))
        poses = None
        if inner.has("poses"):
            if figure.at_poses is None:
                raise inner.error("poses", f"{name} is limited over the whole workspace; leave it out")
            poses = read_coordinates(inner, arm)
    return Limit(figure, relation, value, poses)


def read_settling(body: Mapping) -> Limit:
    """The limit on the settling time, `"<= 0.2 s to 0.05 mm"`; raises `InputError`."""
    raw = body.raw(SETTLING)
    time, apart, distance = raw.partition(" to ") if isinstance(raw, str) else ("", "", "")
    if not apart:
        raise body.error(SETTLING, f"needs a time and a distance of the tip, '<= 0.2 s to 0.05 mm', not {shown(raw)}")
    within = read_quantity(distance, "length", file=body.file, key=body.path_of(SETTLING))
    if within <= 0.0:
        raise body.error(SETTLING, f"needs a distance above zero, not {shown(distance)}")
    figure = settling_time(within)
    bound = read_bound(time, figure.kind, file=body.file, key=body.path_of(SETTLING), senses=figure.senses)
    return Limit(figure, *_checked(body, SETTLING, figure, bound, raw))


def read_direction(body: Mapping, key: str) -> Direction:
    """A direction in the base frame, two or three numbers, as a unit vector. Raises `InputError`."""
    raw = body.raw(key)
    numbers = cast(list[object], raw) if isinstance(raw, list) else []
    values = [float(x) for x in numbers if isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < 1e9]
    length = math.hypot(*values)
    if len(values) != len(numbers) or len(values) not in (2, 3) or length < 1e-9:
        raise body.error(key, f"is a direction in the base frame, e.g. [0, 0, 1], not {shown(raw)}")
    x, y, z = (value / length for value in (*values, 0.0)[:3])
    return x, y, z


def directed_figure(mapping: Mapping, key: str) -> Figure:
    """The figure along a direction that is minimised or maximised, `{error_along: [0, 0, 1]}`. Raises `InputError`."""
    with mapping.mapping(key).reading() as body:
        names = [name for name in DIRECTED if body.has(name)]
        if len(names) != 1:
            raise body.error("", f"names one figure with its direction, e.g. {{error_along: [0, 0, 1]}}; {_known()}")
        return DIRECTED[names[0]].figure(read_direction(body, names[0]))


def _known() -> str:
    return f"those that take one are {', '.join(DIRECTED)}"


def _checked(body: Mapping, key: str, figure: Figure, bound: Bound, entry: object) -> tuple[Relation, float]:
    if bound.relation not in figure.senses:
        raise body.error(key, f"can only be limited by {' or '.join(figure.senses)}, not {shown(entry)}")
    if bound.value <= 0.0:
        raise body.error(key, f"needs a limit above zero, not {shown(entry)}")
    return bound.relation, bound.value


def _by_parts(body: Mapping, figure: Figure, entry: dict[object, object], arm: Arm) -> Limit:
    """The limit that asks different things of links, by their numbers or by what they are made of; the value that all
    others have is its own."""

    def read(mapping: Mapping, key: str) -> tuple[Relation, float]:
        raw = mapping.raw(key)
        bound = read_bound(raw, figure.kind, file=mapping.file, key=mapping.path_of(key), senses=figure.senses)
        return _checked(mapping, key, figure, bound, raw)

    if not said_by_number(entry):
        if "material" not in figure.by:
            would_do = "one limit, or one by link: {1: ..., others: ...}"
            raise body.error(figure.name, f"takes {would_do}, not {shown(entry)}")
        with Mapping(entry, file=body.file, key=body.path_of(figure.name)).reading() as limit_keys:
            made = {str(name): read(limit_keys, str(name)) for name in entry}
        relation, value = made.pop(OTHERS, next(iter(made.values())))
        return Limit(
            figure, relation, value, demands=Demands(materials=tuple((name, x) for name, (_, x) in made.items()))
        )
    values = by_link(Mapping({figure.name: entry}, file=body.file, key=body.key), figure.name, arm, read).each
    known = [item for item in values if item is not None]
    relation, value = known[-1]
    return Limit(figure, relation, value, demands=Demands(links=tuple(value if x is None else x[1] for x in values)))


def read_coordinates(body: Mapping, arm: Arm) -> tuple[tuple[float, ...], ...]:
    """The poses under `poses`: lists of joint coordinates (rad, m), from the base out. Raises `InputError`."""
    coordinates: list[tuple[float, ...]] = []
    for number, raw in enumerate(body.items("poses"), start=1):
        if not isinstance(raw, list) or len(cast(list[object], raw)) != arm.size:
            joints = f"a coordinate for each of the {arm.size} joints"
            raise body.error(f"poses[{number}]", f"is {joints}, e.g. [0 deg, 30 deg], not {shown(raw)}")
        names = {f"q{k}": value for k, value in enumerate(cast(list[object], raw), start=1)}
        one = Mapping(names, file=body.file, key=body.path_of(f"poses[{number}]"))
        kinds = ["angle" if joint.revolute else "length" for joint in arm.joints]
        coordinates.append(tuple(one.quantity(key, kind) for key, kind in zip(names, kinds, strict=True)))
    if not coordinates:
        raise body.error("poses", "is empty; leave it out for the whole workspace")
    return tuple(coordinates)

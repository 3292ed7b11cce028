"""The reference of effects, docs/effects.md, from the effects themselves: `python -m handbook.effects` writes it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import linkwright as lw
from linkwright.core.arm.effects import Effect, Parameter
from linkwright.core.units.quantities import format_quantity

from .sources import DOCS, ROOT

PAGE = ROOT / DOCS / "effects.md"
START = """# Effects

Look up here what each effect does to the tip or to the drives, and which parameters it takes.
`linkwright effects show ID` adds bounds and sources. An arm file names an effect under `effects`, with its parameters
and `at` (numbers of joints or links from 1; none: all): `{effect: backlash, at: 2, total: 3 arcmin}`. Effects marked
*in the model* are there wherever the arm file has their data. An entry adds to them, and `leave_out: [torsion]` takes
one out. Those *between encoders* move a link against its motor by the load alone: motion logs with an encoder on
either side show how far. A parameter in round brackets changes the pattern of the displacement and not its size. The
page is written from the program itself (`make effects-docs`).

With u_i along link i, n_i along its section's height, o_i joint i, p the tip, J_i = axis_i x (p - o_i) (along a slide:
its axis), tau_i the load on drive i, F, M, w a link's end force, end moment and weight per length, s_i the side that
the joint came from, dT_i the warming above 20 degC; of a motion q_i, q'_i, q''_i, and tau_i the torque of drive i,
positive towards increasing q_i. What is said "of a motion" shows in the torques of a moving arm, and in no tip.
"""


def effect_page() -> str:
    """The page, Markdown: a part for each cause, its effects with their formulas and parameters."""
    lines = [START]
    for cause in dict.fromkeys(effect.cause for effect in lw.effects.values()):
        those = [effect for effect in lw.effects.values() if effect.cause == cause]
        does = "moves the tip by" if any(effect.moves_tip for effect in those) else "adds to the torque of a motion"
        lines += [f"## {cause.capitalize()}", "", f"| effect | {does} | parameters |", "|---|---|---|"]
        lines += [_row(effect) for effect in those]
        lines.append("")
    return "\n".join(lines)


def _row(effect: Effect) -> str:
    marks = (", in the model" * effect.automatic, ", between encoders" * effect.drive.by_load)
    where = f"{effect.only or effect.place}{''.join(marks)}"
    text = [
        f"`{effect.id}`<br>{effect.title} ({where}). Seen by: {effect.needs}",
        effect.formula,
        "<br>".join(_parameters(effect)),
    ]
    return f"| {' | '.join(_cell(item) for item in text)} |"


def _cell(text: str) -> str:
    """Text for a cell of a table; stars are those of products."""
    return re.sub(r"([|*])", r"\\\1", " ".join(text.split()))


def _parameters(effect: Effect) -> Iterator[str]:
    """Each with its meaning and usual size; of those that are numbered up only the first and the last."""
    series: dict[str, list[Parameter]] = {}
    for each in effect.parameters:
        series.setdefault(re.sub(r"_[0-9]+$", "", each.name), []).append(each)
    for numbered in series.values():
        if len(numbered) > 8:
            yield f"`{numbered[0].name}` to `{numbered[-1].name}`: {numbered[0].meaning}, and so on"
            continue
        for each in numbered:
            name = f"(`{each.name}`)" if each.role in ("shape", "torque_shape") else f"`{each.name}`"
            low, high = (format_quantity(value, each.kind, None, 3) for value in each.typical)
            yield f"{name}: {each.meaning}; usually {low} to {high}"


if __name__ == "__main__":
    PAGE.write_text(effect_page(), encoding="utf-8")

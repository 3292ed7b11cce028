"""The reference of instruments, docs/instruments.md, from the instruments themselves: `python -m handbook.instruments`
writes it."""

from __future__ import annotations

import linkwright as lw
from linkwright.core.diagnose.instruments import InstrumentKind

from .sources import DOCS, ROOT

PAGE = ROOT / DOCS / "instruments.md"
START = """# Instruments

Look up here what each instrument reads, the columns and settings that it needs, and what it cannot see. `observes` in
recording.yaml names one or several. `linkwright simulate --observe` and `linkwright plan --instrument` take the same
names. [How to record](how-to/recordings.md#instruments) goes by device, [Extend](how-to/extending.md) shows how to add
one. The page is written from the program itself (`make instruments-docs`).

| `observes` | reads | columns | settings | cannot see |
|---|---|---|---|---|
"""


def instrument_page() -> str:
    """The page, Markdown: a row for each kind."""
    return START + "".join(f"| {' | '.join(_cells(kind))} |\n" for kind in lw.instruments.values())


def _cells(kind: InstrumentKind) -> tuple[str, ...]:
    columns = [
        f"`{number.column}_{'deg' if number.quantity == 'angle' else 'mm'}`" for number in kind.numbers if number.column
    ]
    columns += [f"`{kind.label}`, a label"] if kind.label else []
    settings = [f"`{name}`" for name in kind.settings]
    alone = "; a recording of it holds nothing else" if kind.alone else ""
    return f"`{kind.name}`", kind.title + alone, ", ".join(columns), ", ".join(settings), kind.blind


if __name__ == "__main__":
    PAGE.write_text(instrument_page(), encoding="utf-8")

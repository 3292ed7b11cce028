"""`linkwright actuators` on a file of one's own: `add`, `edit`, `price`, `import`, `export` and the like."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import (
    OwnCatalogue,
    edit_keys_command,
    price_command,
    value_of_text,
)
from linkwright.commands.groups import Commands
from linkwright.core.arm.actuators import read_actuators, shipped_actuators, user_actuators_path
from linkwright.core.catalogues.keyed import Entry
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import load_yaml
from linkwright.output.files import check_target
from linkwright.output.table_file import rows_of

from .schema import ACTUATORS, write_table

ADD_HELP = """Add an actuator to your file.

Example: linkwright actuators add 'TURNER 1' maker=Somebody gear=planetary rated_torque='20 N*m' stiffness='5 kN*m/rad' backlash='3 arcmin' mass='2 kg' --source 'Data sheet 7'
"""  # noqa: E501 - an example is one line
EDIT_HELP = """Change keys of an actuator, or the file in $EDITOR; a shipped actuator is copied to yours.

Example: linkwright actuators edit RV-20E mass='4.9 kg' --source 'weighed, 3 March'
"""
IMPORT_HELP = """Put actuators from a .yaml, .csv or .xlsx file into yours; all of it or nothing.

Example: linkwright actuators import supplier.yaml
"""
EXPORT_HELP = """Write actuators to a .yaml or .csv file, or for reports to .tex, .md or .parquet; all without a name.

Example: linkwright actuators export RV-20E --out drives.yaml
"""
CHECK_HELP = "Check files of actuators; without a file the shipped ones and yours."
PRICE_HELP = """Give an actuator a price in your file; the rest of it stays where it is.

Example: linkwright actuators price RV-20E '900 EUR' --source 'Offer 12'
"""


def _made(name: str, given: dict[str, str], source: str) -> Entry:
    if not source:
        raise InputError("", "--source", "is missing: say where the figures are from")
    content = {key: value_of_text(value, key) for key, value in given.items()}
    return Entry(name, {**content, "source": "own"}, {"own": source})


OWN = OwnCatalogue(
    group="actuators",
    editor=ACTUATORS,
    own=lambda: user_actuators_path(),
    entry="actuator",
    called="file",
    key="actuator",
    count=lambda path: len(read_actuators(load_yaml(path))),
    shipped=lambda: [("shipped actuators", len(shipped_actuators()))],
    examples=("'TURNER 1'", "'TURNER 2'"),
    helps={"add": ADD_HELP, "import": IMPORT_HELP, "check": CHECK_HELP},
    such_as="mass='2 kg'",
    made=_made,
    table=lambda path: lw.actuators.with_file(path).table,
    read={".yaml": ACTUATORS.entries, ".csv": ACTUATORS.read_table, ".xlsx": ACTUATORS.read_table},
)


def export_actuators(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME...]", help="Which; all without a name.")] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="A .yaml, .csv, .parquet, .md or .tex file.")
    ] = Path("actuators.yaml"),
    catalogue: Annotated[
        Path | None, typer.Option("--catalogue", metavar="FILE", help="Actuators that add to the shipped ones.")
    ] = None,
) -> None:
    """Run `actuators export`."""
    check_target(out, catalogue)
    known = lw.actuators.with_file(catalogue)
    found = [known[name].name for name in names] if names else [each.name for each in known.values()]
    files = [path for path in (user_actuators_path(), catalogue) if path is not None and path.exists()]
    entries = [entry for name in found if (entry := ACTUATORS.entry(name, files)) is not None]
    OWN.write(
        out,
        entries,
        {".yaml": ACTUATORS.text, ".csv": write_table},
        lambda: rows_of(known.table, found),
    )


def commands() -> Commands:
    """These commands by name."""
    price = price_command(OWN, lambda: list(shipped_actuators()))
    return OWN.commands(
        {
            "edit": (edit_keys_command(OWN, ACTUATORS), EDIT_HELP),
            "export": (export_actuators, EXPORT_HELP),
            "price": (price, PRICE_HELP),
        }
    )

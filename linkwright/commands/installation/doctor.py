"""`linkwright doctor`: is the installation sound, and what to do where it is not."""

from __future__ import annotations

from linkwright.commands.options import JsonFile
from linkwright.output.files import check_target, write_json
from linkwright.version import program_version

HELP = """Is the installation sound: versions, solver, catalogues, folders, threads, optional parts; what to do if not.

Exit status 0 where it is, 1 where something is wrong.

Example: linkwright doctor
"""


def doctor(json: JsonFile = None) -> int:
    """Run the command."""
    from linkwright.installation.checks import checked
    from linkwright.screen.console import console, table

    check_target(json)
    found = checked()
    content = {
        "made_by": f"linkwright doctor {program_version()}",
        "sound": found.sound,
        "checks": [
            {"name": each.name, "state": each.state, "found": each.found, "would_do": each.would_do or None}
            for each in found.checks
        ],
    }
    write_json(json, content)
    shown = table("what", "state", "found", "what would do")
    for each in found.checks:
        shown.add_row(each.name, each.state.upper() if each.state == "wrong" else each.state, each.found, each.would_do)
    screen = console()
    screen.print(shown)
    wrong = [each.name for each in found.checks if each.state == "wrong"]
    screen.print(f"wrong: {', '.join(wrong)}" if wrong else "The installation is sound.", soft_wrap=True)
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)
    return 0 if found.sound else 1

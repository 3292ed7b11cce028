"""The reference of commands, from the command line itself."""

from __future__ import annotations

import re
from typing import Any

import typer

from linkwright.command_line import command_line, commands

PROGRAM = "linkwright"


def command_named(name: str) -> Any:
    """The command or group of that name, as the command line knows it."""
    return typer.main.get_command(command_line(name)).commands[name]  # pyright: ignore


def command_pages() -> dict[str, str]:
    """A page of Markdown for each command, by its place on the site, and one that lists them."""
    pages = {f"commands/{name}.md": _page(name, command_named(name)) for name in commands()}
    rows = [f"| [`{PROGRAM} {name}`]({name}.md) | {_cell(_brief(command_named(name)))} |" for name in commands()]
    start = ["# Commands", "", f"Written from the program itself; `{PROGRAM} COMMAND --help` says the same.", ""]
    return {"commands/index.md": "\n".join([*start, "| command | does |", "|---|---|", *rows, ""]), **pages}


def _page(name: str, command: Any) -> str:
    lines = [f"# {PROGRAM} {name}", "", *_described(f"{PROGRAM} {name}", command)]
    for item in getattr(command, "commands", {}).values():
        lines += [f"## {PROGRAM} {name} {item.name}", "", *_described(f"{PROGRAM} {name} {item.name}", item)]
    return "\n".join(lines)


def _described(called: str, command: Any) -> list[str]:
    """Help, how it is called, arguments and options."""
    lines = [*_help(command.help or ""), ""]
    arguments = [param for param in command.params if param.param_type_name == "argument"]
    options = [param for param in command.params if param.param_type_name == "option" and not param.hidden]
    if getattr(command, "commands", None):
        return [*lines, "```", f"{called} COMMAND ...", "```", ""]
    words = [_argument(argument) for argument in arguments]
    lines += ["```", " ".join([called, *words, *(["[OPTIONS]"] if options else [])]), "```", ""]
    if arguments:
        lines += ["| argument | |", "|---|---|"]
        lines += [f"| `{_cell(_argument(argument))}` | {_cell(argument.help or '')} |" for argument in arguments] + [""]
    if options:
        lines += ["| option | | default |", "|---|---|---|"]
        lines += [
            f"| `{_cell(_option(option))}` | {_cell(option.help or '')} | {_default(option)} |" for option in options
        ]
        lines.append("")
    return lines


def _help(text: str) -> list[str]:
    """The help with its example set as code; what is after `Example:` belongs to it, to the end of the paragraph."""
    lines: list[str] = []
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        if paragraph.lstrip().startswith("Example:"):
            calls = [" ".join(call.split()) for call in paragraph.split("Example:")[1:]]
            lines += ["For example:", "", "```", *calls, "```", ""]
        else:
            lines += [" ".join(paragraph.split()), ""]
    return lines


def _brief(command: Any) -> str:
    return " ".join(re.split(r"\n\s*\n", (command.help or "").strip())[0].split())


def _argument(parameter: Any) -> str:
    word = parameter.metavar or parameter.name.upper()
    if parameter.nargs == -1 and not word.endswith("..."):
        word += "..."
    return word if parameter.required or word.startswith("[") else f"[{word}]"


def _option(parameter: Any) -> str:
    names = ", ".join(parameter.opts) + "".join(f" / {other}" for other in parameter.secondary_opts)
    if parameter.is_flag:
        return names
    return f"{names} {parameter.metavar or parameter.name.upper()}"


def _default(parameter: Any) -> str:
    if parameter.required:
        return "must be given"
    value = parameter.default
    if isinstance(parameter.show_default, str):
        return _cell(parameter.show_default)
    if value in (None, "", False, (), []):
        return ""
    return f"`{_cell(str(getattr(value, 'value', value)))}`"


def _cell(text: str) -> str:
    """Text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")

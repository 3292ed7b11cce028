"""`linkwright serve`: the same in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError
from linkwright.screen.console import console

HELP = """The same in a browser: arms drawn and edited, optimised, traded off, diagnosed; catalogues; results kept.

Only this machine can open it, unless --host says otherwise; then a token is due. Results are kept in the folder.

Example: linkwright serve
Example: linkwright serve designs --port 8080 --open
"""


def serve(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="Whose files are shown. Default: this one.")
    ] = Path("."),
    host: Annotated[
        str, typer.Option("--host", metavar="HOST", help="Where to listen (0.0.0.0 for all who know the token).")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", metavar="PORT", min=0, max=65535, help="The port (0 for any that is free).")
    ] = 8800,
    token: Annotated[
        str,
        typer.Option(
            "--token", metavar="TOKEN", help="What a browser must know. Default: made up where --host needs one."
        ),
    ] = "",
    open_: Annotated[bool, typer.Option("--open", help="Open the browser as well.")] = False,
) -> None:
    """Run the command."""
    if token and (len(token) < 8 or not token.isascii() or not token.isprintable() or set(token) & set("&#+% ")):
        raise InputError("", "--token", "needs 8 letters and digits or more, without blanks and & # + %")
    try:
        import nicegui  # noqa: F401  # pyright: ignore[reportUnusedImport]
    except ModuleNotFoundError:
        raise InputError("", "serve", not_installed("the browser", "NiceGUI", "browser")) from None
    from linkwright.browser.server.start import serve as serving

    screen = console()
    serving(
        folder,
        host=host,
        port=port,
        token=token,
        announce=lambda line: screen.print(line, soft_wrap=True, markup=False, highlight=False),
        open_it=open_,
    )

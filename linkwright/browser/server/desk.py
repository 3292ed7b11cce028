"""What all pages of a server share."""

from __future__ import annotations

from dataclasses import dataclass

from .folder import Folder
from .jobs import Jobs
from .shelf import Shelf


@dataclass(frozen=True)
class Desk:
    """The folder, the results in it, and what is at work."""

    folder: Folder
    shelf: Shelf
    jobs: Jobs

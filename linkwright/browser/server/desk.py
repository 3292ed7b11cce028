"""What all pages of a server share."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import ParamSpec, TypeVar

from .folder import Folder
from .jobs import Jobs
from .shelf import Shelf

Given = ParamSpec("Given")
Found = TypeVar("Found")


@dataclass(frozen=True)
class Desk:
    """The folder, the results in it, and what is at work."""

    folder: Folder
    shelf: Shelf
    jobs: Jobs
    _readers: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(4, "shelf"))

    async def looked_up(self, look: Callable[Given, Found], *given: Given.args, **named: Given.kwargs) -> Found:
        """What a look at the shelf gives. A base that another program holds keeps its own threads waiting alone, not
        the pages and not what they draw."""
        return await asyncio.get_running_loop().run_in_executor(self._readers, lambda: look(*given, **named))

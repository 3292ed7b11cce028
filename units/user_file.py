"""A file of the user's, read over what is shipped: where an environment variable says, or in the configuration
folder."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_config_dir


@dataclass(frozen=True)
class UserFile:
    """A kind of file that users may have: the environment `variable` that names it, and its `name` otherwise."""

    variable: str
    name: str

    @property
    def _named(self) -> str:
        return os.environ.get(self.variable, "").strip()

    def path(self) -> Path:
        """Where it is, or would be."""
        named = self._named
        return Path(os.path.expanduser(named)) if named else Path(user_config_dir("linkwright")) / self.name

    def over(self, paths: Sequence[Path | str], *, user: bool) -> list[Path | str]:
        """The files to read over what is shipped, in order: the user's own (where it exists or is named, and `user` is
        true), then `paths`."""
        user_path = self.path()
        return [*([user_path] if user and (os.path.exists(user_path) or self._named) else []), *paths]

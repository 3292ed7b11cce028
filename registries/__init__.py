"""Lists that are open: what is shipped, what installed packages bring, what a program registers."""

from linkwright.core.registries.registry import Registry

__all__ = ["Registry"]

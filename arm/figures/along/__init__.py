"""Figures that a problem asks for along a direction, or about an axis: each direction makes a separate figure."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from .direction import Directed, Direction
from .part_of_error import ERROR_ALONG, ORIENTATION_ABOUT, ORIENTATION_ERROR, REPEATABILITY
from .stiffness import STIFFNESS_ALONG

DIRECTED: Mapping[str, Directed] = MappingProxyType(
    {directed.name: directed for directed in (ERROR_ALONG, ORIENTATION_ABOUT, STIFFNESS_ALONG)}
)
"""The figures that take a direction, by the key of a problem file."""

__all__ = ["DIRECTED", "ORIENTATION_ERROR", "REPEATABILITY", "Directed", "Direction"]

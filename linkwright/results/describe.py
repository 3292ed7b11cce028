"""Any result described."""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import Any

from .document import Description

_DESCRIBED = MappingProxyType(
    {
        "Evaluation": "evaluation",
        "OptimizationResult": "optimization",
        "Tradeoff": "tradeoff",
        "Diagnosis": "diagnoses.described",
        "Comparison": "diagnoses.comparison",
        "Table": "compensation",
        "Redesign": "redesign",
        "Prediction": "diagnoses.prediction",
        "Imported": "imported",
        "Exported": "exported",
        "Budget": "budget",
        "Planned": "planning",
        "Watch": "diagnoses.watch",
    }
)
"""The module that describes each class of results, loaded when asked for."""


def describe(result: object) -> Description:
    """A result described. Raises `TypeError` for anything that is no result."""
    name = _DESCRIBED.get(type(result).__name__)
    if name is None:
        raise TypeError(f"{type(result).__name__} is no result that is described")
    module: Any = import_module(f"{__package__}.{name}")
    return module.describe(result)

"""Expressions of an arm in symbols, as functions of poses and designs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from .vectorise import VectorFunction, vectorise


@dataclass(frozen=True)
class Expressions:
    """`outputs` (columns) for symbols: `inputs` are a pose q, a design p and what else they depend on."""

    inputs: tuple[Any, ...]
    outputs: tuple[Any, ...]

    @cached_property
    def function(self) -> Any:
        """The CasADi function from inputs to outputs."""
        return ca.Function("expressions", list(self.inputs), list(self.outputs))

    @cached_property
    def vectorised(self) -> VectorFunction:
        """The same for many poses or designs."""
        return vectorise(self.inputs, self.outputs)

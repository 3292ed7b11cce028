"""The worst position error over the workspace and all load cases."""

from __future__ import annotations

from .figure import Figure, WorstError

MAX_ERROR = Figure(
    name="max_error",
    synonyms=("deflection", "displacement", "error", "position_error", "worst_error", "accuracy", "sag", "deformation"),
    title="worst error",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=("<=",),
    key="max_error_mm",
    follows=WorstError(),
    of=lambda evaluation: evaluation.max_error,
    minimised=True,
    digits=5,
)

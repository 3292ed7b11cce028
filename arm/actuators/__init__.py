"""Gears and actuators by name, with the figures that their makers' catalogues print; one file a maker."""

from __future__ import annotations

from .catalogue import (
    ACTUATORS_VARIABLE,
    CONFIRMABLE,
    Actuator,
    Actuators,
    load_actuators,
    read_actuators,
    shipped_actuators,
    user_actuators_path,
)

__all__ = [
    "ACTUATORS_VARIABLE",
    "CONFIRMABLE",
    "Actuator",
    "Actuators",
    "load_actuators",
    "read_actuators",
    "shipped_actuators",
    "user_actuators_path",
]

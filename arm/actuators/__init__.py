"""Gears and actuators by name, with the figures that their makers' catalogues print; one file a maker."""

from __future__ import annotations

from .catalogue import (
    CONFIRMABLE,
    USER_ACTUATORS,
    Actuator,
    Actuators,
    load_actuators,
    read_actuators,
    shipped_actuators,
)

__all__ = [
    "CONFIRMABLE",
    "USER_ACTUATORS",
    "Actuator",
    "Actuators",
    "load_actuators",
    "read_actuators",
    "shipped_actuators",
]

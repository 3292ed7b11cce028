"""Identified parameters of an arm in the formats of the controllers that compensate for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.formats import Exported

from . import klipper, ros2_transmissions, table

CORRECTIONS: Mapping[str, Callable[[Arm], Exported]] = MappingProxyType(
    {
        ros2_transmissions.NAME: ros2_transmissions.transmissions,
        klipper.NAME: klipper.skewed,
        table.NAME: table.tabulated,
    }
)
"""What writes each format."""

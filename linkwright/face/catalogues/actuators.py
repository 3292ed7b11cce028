"""Gears and actuators by name."""

from __future__ import annotations

from collections.abc import ValuesView
from typing import TYPE_CHECKING

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.actuators import Actuators as ActuatorModels
from linkwright.face.catalogues.catalogue_lists import Catalogue
from linkwright.json.fields import fields
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


class Actuators(Catalogue[Actuator]):
    """The gears that joints can name: the shipped ones with the user's over them; figures in SI.

    >>> import linkwright as lw
    >>> lw.actuators["RV-20E"].rated_torque
    167.0
    >>> lw.actuators["RV-2E"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: actuator: there is no actuator 'RV-2E'; did you mean 'RV-20E'?
    """

    def __getitem__(self, name: str) -> Actuator:
        """The actuator of a name; raises `InputError` with the nearest known one."""
        return self._all.find(name)

    @property
    def _all(self) -> ActuatorModels:
        return load_actuators(self._files)

    def _names(self) -> list[str]:
        return list(self._all.by_name)

    def values(self) -> ValuesView[Actuator]:
        """All of them, maker by maker."""
        return self._all.by_name.values()

    @property
    def table(self) -> pd.DataFrame:
        """All actuators: maker, gear, torques (N*m), stiffness of drive and bearing (N*m/rad), backlash (rad), mass
        (kg), cost (EUR)."""
        torques = ("rated_torque_Nm", "peak_torque_Nm", "stiffness_Nm_per_rad", "tilting_stiffness_Nm_per_rad")
        keys = ("name", "maker", "gear", *torques, "backlash_rad=backlash", "mass_kg", "cost_EUR")
        return frame([fields(item, *keys) for item in self.values()], [key.partition("=")[0] for key in keys])


actuators = Actuators()

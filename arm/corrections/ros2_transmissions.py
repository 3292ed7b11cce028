"""Zeros and scales of joints as transmissions of ros2_control, which stand in a robot's `<ros2_control>`.

A simple transmission makes a joint's position of its actuator's by `x_j = x_a / n + x_off`
(ros-controls/ros2_control, transmission_interface/simple_transmission.hpp); here the actuator's position is what is
read of the joint today.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from xml.etree.ElementTree import Element, SubElement

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.exported import effects_beside
from linkwright.core.arm.descriptions.formats import Exported

from .readings import READINGS, readings

NAME = "ros2-offsets"
_PLUGIN = "transmission_interface/SimpleTransmission"


def transmissions(arm: Arm) -> Exported:
    """A transmission for each joint whose zero or scale was found."""
    root = Element("ros2_control", {"name": "what was found", "type": "system"})
    carried: list[str] = []
    for reading in readings(arm):
        if not reading.corrects:
            continue
        one = SubElement(root, "transmission", {"name": f"{reading.name}_transmission"})
        SubElement(one, "plugin").text = _PLUGIN
        SubElement(one, "actuator", {"name": f"{reading.name}_actuator", "role": "actuator1"})
        joint = SubElement(one, "joint", {"name": reading.name, "role": "joint1"})
        reduction, offset = f"{1.0 / (1.0 + reading.scale):.12g}", f"{reading.offset:.12g}"
        SubElement(joint, "mechanical_reduction").text = reduction
        SubElement(joint, "offset").text = offset
        carried.append(f"{reading.name}: offset {offset}, mechanical_reduction {reduction}")
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode") + "\n"
    assumed = ("the actuator's position is what is read of the joint now: a reduction that is there is multiplied",)
    nothing = ("nothing: the arm file's effects name no zero and no scale",)
    return Exported(
        arm, NAME, text, tuple(carried) or nothing, tuple(effects_beside(arm, READINGS)), assumed if carried else ()
    )

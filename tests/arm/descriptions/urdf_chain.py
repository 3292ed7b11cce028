"""Chains of a URDF by themselves: products of 4x4 matrices straight from the XML, and MuJoCo's own reading."""

import math
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np


def _turn(axis, angle):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def _three(element, name):
    return (
        np.array([float(word) for word in (element.get(name) or "0 0 0").split()])
        if element is not None
        else np.zeros(3)
    )


def _step(rotation, translation):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


def tip_pose(text, base, tip, coordinates):
    """Where link `tip` stands in link `base` (4 x 4), with joint coordinates by name (0 where there are none)."""
    above = {joint.find("child").get("link"): joint for joint in ElementTree.fromstring(text).findall("joint")}
    matrix, here = np.eye(4), tip
    while here != base:
        joint = above[here]
        roll, pitch, yaw = _three(joint.find("origin"), "rpy")
        turned = _turn((0, 0, 1), yaw) @ _turn((0, 1, 0), pitch) @ _turn((1, 0, 0), roll)
        step = _step(turned, _three(joint.find("origin"), "xyz"))
        value = coordinates.get(joint.get("name"), 0.0)
        axis = np.array([1.0, 0.0, 0.0]) if joint.find("axis") is None else _three(joint.find("axis"), "xyz")
        if joint.get("type") == "prismatic":
            step = step @ _step(np.eye(3), value * axis / np.linalg.norm(axis))
        elif joint.get("type") in ("revolute", "continuous"):
            step = step @ _step(_turn(axis, value), np.zeros(3))
        matrix, here = step @ matrix, joint.find("parent").get("link")
    return matrix


def in_mujoco(text):
    """The model as MuJoCo reads the URDF, no body fused with another."""
    root = ElementTree.fromstring(text)
    bounds = {"boundmass": "1e-14", "boundinertia": "1e-14", "balanceinertia": "true"}
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", fusestatic="false", **bounds)
    return mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))


def posed(model, coordinates):
    """MuJoCo's data with joint coordinates by name."""
    data = mujoco.MjData(model)
    for name, value in coordinates.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_forward(model, data)
    return data

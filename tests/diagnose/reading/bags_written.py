"""Bags for the tests, by the libraries' own writers."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as PlainWriter
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

State = tuple[float, Sequence[str], Sequence[float], Sequence[float]]
"""A joint state: time, names, positions, efforts."""
STAMP = "uint32 sec\nuint32 nanosec\n"
HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
JOINT_STATE = (
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    f"{'=' * 80}\nMSG: std_msgs/Header\n{HEADER}{'=' * 80}\nMSG: builtin_interfaces/Time\n{STAMP}"
)
FLOAT = "float64 data\n"


def _stamp(time: float) -> tuple[int, int]:
    whole = int(time)
    return whole, round((time - whole) * 1e9)


def write_mcap(
    path: Path,
    states: Sequence[tuple[float, Sequence[str], Sequence[float], Sequence[float], Sequence[float]]],
    *,
    topic: str = "/joint_states",
    payload: Sequence[tuple[float, float]] = (),
    compression: CompressionType = CompressionType.ZSTD,
) -> Path:
    """An MCAP as ROS 2 records it: joint states (time, names, position, velocity, effort), and a payload by time."""
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=4096, compression=compression)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        number = writer.register_msgdef("std_msgs/msg/Float64", FLOAT)
        for time, names, position, velocity, effort in states:
            sec, nanosec = _stamp(time)
            message = {
                "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""},
                "name": list(names),
                "position": list(position),
                "velocity": list(velocity),
                "effort": list(effort),
            }
            writer.write_message(topic, schema, message, log_time=round(time * 1e9), publish_time=round(time * 1e9))
        for time, value in payload:
            writer.write_message("/payload", number, {"data": value}, log_time=round(time * 1e9))
        writer.finish()
    return path


def write_json_mcap(
    path: Path, states: Sequence[tuple[float, Sequence[str], Sequence[float], Sequence[float]]]
) -> Path:
    """An MCAP without ROS, as Foxglove's tools write it."""
    with path.open("wb") as stream:
        writer = PlainWriter(stream)
        writer.start()
        schema = writer.register_schema("JointState", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("/joints", "json", schema)
        for time, names, position, effort in states:
            sec, nanosec = _stamp(time)
            body = {"header": {"stamp": {"sec": sec, "nsec": nanosec}}, "name": list(names)}
            body |= {"position": list(map(float, position)), "effort": list(map(float, effort))}
            writer.add_message(channel, round(time * 1e9), json.dumps(body).encode(), round(time * 1e9))
        writer.finish()
    return path


def write_bag(folder: Path, topics: dict[str, Sequence[State]], *, ros: int = 2) -> Path:
    """A bag of ROS 2 (a folder with SQLite) or ROS 1 (a file): joint states without speeds by topic."""
    store = get_typestore(Stores.ROS2_HUMBLE if ros == 2 else Stores.ROS1_NOETIC)
    kind = "sensor_msgs/msg/JointState"
    state, header, time_type = (
        store.types[item] for item in (kind, "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with Writer2(folder, version=8) if ros == 2 else Writer1(folder) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, kind, typestore=store)
            for number, (time, names, position, effort) in enumerate(messages):
                own = {"seq": number} if ros == 1 else {}
                head = header(stamp=time_type(*_stamp(time)), frame_id="", **own)
                arrays = (np.array(item, dtype=float) for item in (position, [], effort))
                message = state(head, list(names), *arrays)
                serialize = store.serialize_cdr if ros == 2 else store.serialize_ros1
                writer.write(connection, round(time * 1e9), serialize(message, kind))
    return folder

"""Messages of ROS bags one by one: MCAP by the library mcap (ROS 2 and JSON), all other bags by rosbags."""

from __future__ import annotations

import json
import sqlite3
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError, shown

_PASSED_OVER = (
    "CameraInfo", "CompressedImage", "DiagnosticArray", "Image", "LaserScan", "Log", "MarkerArray", "OccupancyGrid",
    "PointCloud2", "String", "TFMessage",
)  # fmt: skip
"""Types of messages that hold nothing of an arm, and much else."""
_DAMAGED = (
    ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, MemoryError, OSError, RuntimeError,
    TypeError, ValueError, sqlite3.Error, struct.error,
)  # fmt: skip
"""What decoders raise on bytes that are no message."""


@dataclass(frozen=True)
class Message:
    """A message: its topic, the name of its type without package (`JointState`), when it was received (s), and its
    fields by name."""

    topic: str
    kind: str
    received: float
    body: Mapping[str, Any]


@dataclass
class Heard:
    """What is to be said of a bag that was read: its topics, types that are not known, where it breaks off."""

    topics: set[str]
    unknown: set[str]
    broken: str = ""


def messages_of(path: Path, topics: Sequence[str], heard: Heard) -> Iterator[Message]:
    """The messages of a bag, of these topics (none: all). A bag that breaks off gives those before.

    Raises:
        InputError: Where the library is not installed, or not even the beginning is a bag's.
    """
    files = sorted(path.glob("*.mcap")) if path.is_dir() else [path] if path.suffix.lower() == ".mcap" else []
    source = (item for one in files for item in _by_mcap(one, topics, heard))
    if not files:
        source = _by_rosbags(path, topics, heard)
    count = 0
    try:
        for message in source:
            count += 1
            yield message
    except InputError:
        raise
    except _DAMAGED as error:
        if not count:
            message = f"is no bag that can be read ({shown(str(error) or type(error).__name__)})"
            raise InputError(path, "", message) from None
        heard.broken = str(error) or type(error).__name__


def _wanted(topic: str, kind: str, topics: Sequence[str]) -> bool:
    return (not topics or topic in topics) and kind not in _PASSED_OVER


def _by_rosbags(path: Path, topics: Sequence[str], heard: Heard) -> Iterator[Message]:
    try:
        from rosbags import rosbag1, rosbag2
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.serde import SerdeError
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(path, "", not_installed("a bag", "rosbags", "logs")) from None
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            heard.topics |= {item.topic for item in reader.connections}
            chosen = [item for item in reader.connections if _wanted(item.topic, _name(item.msgtype), topics)]
            heard.unknown |= {item.msgtype for item in chosen if item.msgtype not in reader.typestore.fielddefs}
            chosen = [item for item in chosen if item.msgtype not in heard.unknown]
            for connection, received, raw in reader.messages(chosen) if chosen else ():
                body = reader.deserialize(raw, connection.msgtype)
                yield Message(connection.topic, _name(connection.msgtype), 1e-9 * received, fields_of(body))
    except (AnyReaderError, rosbag1.ReaderError, rosbag2.ReaderError, SerdeError) as error:
        raise ValueError(str(error)) from None


def _by_mcap(path: Path, topics: Sequence[str], heard: Heard) -> Iterator[Message]:
    """Without the index, so that a file that was never closed is read as far as it goes."""
    try:
        from mcap.exceptions import McapError
        from mcap.reader import NonSeekingReader
        from mcap_ros2.decoder import DecoderFactory
        from zstandard import ZstdError
    except ImportError:
        raise InputError(path, "", not_installed("MCAP", "mcap and mcap-ros2-support", "logs")) from None
    decoders: dict[int, Callable[[bytes], Any] | None] = {}
    factory = DecoderFactory()
    try:
        with path.open("rb") as stream:
            for schema, channel, message in NonSeekingReader(stream).iter_messages(log_time_order=False):
                heard.topics.add(channel.topic)
                kind = "" if schema is None else _name(schema.name)
                if not _wanted(channel.topic, kind, topics):
                    continue
                if channel.id not in decoders:
                    decoder = json.loads if channel.message_encoding == "json" else None
                    decoders[channel.id] = decoder or factory.decoder_for(channel.message_encoding, schema)
                decode = decoders[channel.id]
                if decode is None:
                    heard.unknown.add("" if schema is None else schema.name)
                    continue
                yield Message(channel.topic, kind, 1e-9 * message.log_time, fields_of(decode(message.data)))
    except (McapError, ZstdError) as error:
        raise ValueError(str(error) or type(error).__name__) from None


def _name(kind: str) -> str:
    return kind.replace(".", "/").rpartition("/")[2]


def fields_of(value: Any) -> Mapping[str, Any]:
    """The fields of a decoded message by name, without those that a library adds; empty for what is none."""
    if isinstance(value, dict):
        return MappingProxyType({str(name): item for name, item in value.items()})
    names = getattr(value, "__slots__", None) or getattr(value, "__dataclass_fields__", None) or ()
    return MappingProxyType({name: getattr(value, name) for name in names if not name.startswith("_")})

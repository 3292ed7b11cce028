"""How work crosses between processes: as `pickle` does it, but for read-only mappings, which it refuses."""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any


class _Packer(pickle.Pickler):
    """Sends a read-only mapping as a separate copy."""

    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, MappingProxyType):
            return read_only, (dict(obj),)
        return NotImplemented


def read_only(content: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """A read-only mapping of what was sent."""
    return MappingProxyType(dict(content))


def packed(content: object) -> bytes:
    """An object as bytes. Raises what `pickle` raises where something in it cannot be sent."""
    stream = io.BytesIO()
    _Packer(stream, protocol=pickle.HIGHEST_PROTOCOL).dump(content)
    return stream.getvalue()


def unpacked(content: bytes) -> Any:
    """The object that bytes hold; only ever of bytes that this program's processes sent."""
    return pickle.loads(content)

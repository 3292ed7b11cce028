"""What an instrument reads of the arm: a kind is one object in one file of `kinds`, and this is where it is shipped.

`INSTRUMENTS.register(kind)` adds one for this process, an entry point of the group `linkwright.instruments` those of an
installed package.
"""

from __future__ import annotations

from .instrument import Instrument
from .kind import Change, Frame, InstrumentKind, Modelled, Number, Part, Scene, Seen, Stood
from .kinds.along import ALONG
from .kinds.bar import BAR
from .kinds.camera import CAMERA
from .kinds.distance import DISTANCE
from .kinds.draw_wire import DRAW_WIRE
from .kinds.laser_line import LASER_LINE
from .kinds.plane import PLANE
from .kinds.position import POSITION
from .kinds.same_point import SAME_POINT
from .kinds.tilt import TILT
from .registry import INSTRUMENTS

INSTRUMENTS.ship(POSITION, ALONG, DISTANCE, SAME_POINT, PLANE, TILT, BAR, CAMERA, LASER_LINE, DRAW_WIRE)

__all__ = [
    "INSTRUMENTS",
    "Change",
    "Frame",
    "Instrument",
    "InstrumentKind",
    "Modelled",
    "Number",
    "Part",
    "Scene",
    "Seen",
    "Stood",
]

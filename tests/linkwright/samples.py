"""Arms and maps that several tests of the command line and of the reports make."""

import base64
import gzip
import json
import math

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.error_map import error_map
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.materials.catalogue import load_catalogue


def arm_of(sections, lengths=(0.4, 0.3), joints=None):
    """A planar arm of aluminium with these sections."""
    material = load_catalogue(user=False).find("aluminium-6061-t6")
    joint = Joint(range=(-math.pi / 2, math.pi / 2), backlash=math.radians(0.05), clearance=2e-5, mass=2.0)
    links = tuple(
        Link(length, section=section, material=material) for length, section in zip(lengths, sections, strict=True)
    )
    return Arm("welding <arm>", joints or (joint,) * len(links), links, payload=LoadCase(1.0))


def mapped(evaluation):
    """The error map of an evaluation."""
    search = WorstSearch(error_model(evaluation.arm, evaluation.load_cases), evaluation.workspace)
    return error_map(search, beam_values(beams_of(evaluation.arm)), poses=8192, cells=30)


def unpacked(packed):
    """The figures of a report page: base 85 with two letters exchanged, and gzip."""
    return json.loads(gzip.decompress(base64.b85decode(packed.replace(".", "<").replace(",", "&"))))

"""The beams that an arm's links are."""

from __future__ import annotations

from linkwright.core.arm.bodies.warping import warping_of
from linkwright.core.arm.chain.beam import Beam, elastic_beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.taper import tapered_beam
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.taper import Tapered


class PropertyNeeded(MissingProperty):
    """A question needs a figure that the arm does not have: a link's section, its mass or a material."""

    def __init__(self, message: str) -> None:
        super().__init__("", "", message)

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the message when the error crosses between processes."""
        return PropertyNeeded, (self.message,)


class MassNeeded(PropertyNeeded):
    """A question needs what a link (from 0) of unknown mass weighs, and `why`; in the words of an arm file.

    `what` says it without a format's words, `link` is the link's name, `beyond` what else would do.
    """

    def __init__(self, arm: Arm, index: int, why: str, beyond: str = "") -> None:
        self.what, self.link, self.beyond = _mass_unknown(arm, index, why), arm.links[index].name, beyond
        self._given = arm, index, why, beyond
        super().__init__(f"{arm.entry(index)}.link.mass: {self.what}; write mass: 12 kg, say{beyond}")

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when the error crosses between processes."""
        return MassNeeded, self._given


def _mass_unknown(arm: Arm, index: int, why: str) -> str:
    others = [k + 1 for k, link in enumerate(arm.links) if link.section is None and link.mass is None and k != index]
    name = f", {arm.links[index].name}," if arm.links[index].name else ""
    also = f" (of link{'s' * (len(others) > 1)} {', '.join(map(str, others))} too)" if others else ""
    return f"the mass of link {index + 1}{name} is unknown{also}, and {why}"


def beam_of(arm: Arm, index: int, *, shear: bool = False, calibrated_at: float | None = None) -> Beam:
    """The beam that a link (from 0) is at the arm's temperature, with moduli over those at another where the arm was
    `calibrated_at` it (K); without `shear` its material may lack a shear modulus (`elastic_beam`).

    Raises `PropertyNeeded` for a link of unknown mass, `MissingProperty` or `OutOfRange` for a material's figure.
    """
    link = arm.links[index]
    if link.section is None:
        if link.mass is None:
            raise MassNeeded(arm, index, "this needs its weight")
        center = 0.5 * link.length if link.center_of_mass is None else link.center_of_mass
        return Beam(length=link.length, lumped_mass=link.mass, lumped_at=center)
    if link.material is None:
        raise PropertyNeeded(f"link {index + 1} has a section but no material")
    material = link.material.at(arm.temperature, calibrated_at)
    if isinstance(link.section, Tapered):
        return tapered_beam(link.length, link.section, material, shear=shear)
    section = link.section.properties(0.3 if material.poisson_ratio is None else material.poisson_ratio)
    return elastic_beam(link.length, section, material, shear=shear, warping=warping_of(arm, index))

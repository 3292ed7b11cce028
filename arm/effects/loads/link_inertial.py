"""A link's mass, centre and inertia are not those of the file.

Of all ten figures of every link the drives' torques show combinations only: what turns about one axis shows its inertia
about that axis, and what stands on a link may be part of it. (M. Gautier & W. Khalil, Direct calculation of minimum set
of inertial parameters of serial robots, IEEE Trans. Robotics and Automation 6 (1990) 368-373, doi:10.1109/70.56655.)
"""

from __future__ import annotations

from linkwright.core.arm.effects.effect import Effect

from .inertial import OfInertia, inertial_sizes, of_links

LINK_INERTIAL = Effect(
    id="link_inertial",
    title="mass, centre and inertia of a link",
    formula="nothing; of a motion the torque Y_k(q, q', q'') (mass, first moments, inertia), linear in all ten",
    place="link",
    cause="loads",
    needs="an exciting motion: several postures, speeds and accelerations",
    aliases=("payload", "armature", "torque_constant", "link_mass"),
    source="C. G. Atkeson, C. H. An & J. M. Hollerbach, Estimation of inertial parameters of manipulator loads and "
    "links, International Journal of Robotics Research 5 (1986) 101-119, doi:10.1177/027836498600500306",
    parameters=inertial_sizes("of the link, beyond what its file says", "its joint's frame"),
    torques=OfInertia(of_links),
    rank=85,
    linear=True,
)

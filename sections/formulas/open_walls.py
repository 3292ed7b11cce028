"""Torsion and shear of channels and T-sections, thin-walled or not; shear centres and warping of open walls.

Torsion is the sum over walls as whole rectangles and over junctions, whose share is that of the junction of two (or
three) long strips, a polynomial fitted to boundary element solutions; it needs no correction beyond that. Shear areas
are thin-wall formulas times the exponential of such a polynomial (`sections/fits`).

Three of the four shear problems at Poisson's ratio zero are those of other sections, exactly, because a plane of
symmetry and a free surface ask the same of the shear stress (none across it):
- a channel along its web is an I-section of twice the width and twice the web, cut along the middle of its web;
- a T-section along its flange is an I-section of twice the height, cut at the middle of its web (with a separate fit
  here, as its walls may be thinner);
- a T-section along its web and a channel along its flanges, each cut along its axis of symmetry, are both an L.

Shear centres and warping constants of open walls and of triangles are thin-wall formulas for walls of constant
thickness about their middle lines (W. D. Pilkey, Formulas for Stress, Strain, and Structural Matrices, 2nd ed., Wiley
2005, tables 2-6 and 2-7; V. Z. Vlasov, Thin-walled Elastic Beams, 2nd ed., Jerusalem 1961), times exponentials of
polynomials fitted to boundary element solutions (the shear centre is Trefftz's). A flat wall that is alone on its way
to the shear centre warps across its thickness only, so that T-sections and angles hardly gain from held warping.
"""

from __future__ import annotations

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.formulas.closed_forms import rectangle_torsion_constant
from linkwright.core.sections.formulas.thin_walls import (
    Flange,
    corner_excess,
    i_section_bending_shear,
    i_section_cross_base,
)
from linkwright.core.sections.numeric import Number, exp
from linkwright.core.sections.section import poisson_square

FREE_END = 0.10504
"""What a free end takes from the J of a long strip, in thicknesses^4 (Timoshenko and Goodier, section 109)."""


def l_junction(first: Number, second: Number) -> Number:
    """J of an L-shaped corner of strips of these thicknesses (m) beyond that of its arms, m^4.

    The arms are measured from the inner corner. Within 1e-5 of (first + second)^4.
    """
    return (first + second) ** 4 * fitted("l_junction", (first / (first + second),))


def t_junction(web: Number, flange: Number) -> Number:
    """The same of a web that meets a flange: arms are measured from both inner corners; within 5e-5."""
    return (web + flange) ** 4 * fitted("t_junction", (web / (web + flange),))


def overlap(length: Number, thickness: Number) -> Number:
    """What the end of a wall that reaches into a junction has in a rectangle of its whole length, m^4."""
    return length * thickness**3 / 3.0 - FREE_END * thickness**4


# ---- channel


def channel_torsion_constant(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """J of a channel, m^4; within 0.3 % while no wall is much shorter than thick."""
    walls = 2.0 * rectangle_torsion_constant(width, flange) + rectangle_torsion_constant(height, web)
    return walls + 2.0 * (l_junction(web, flange) - overlap(web, flange) - overlap(flange, web))


def channel_features(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, Number, Number]:
    """Bounded variables of the fits: how stubby flanges and web are, and how the walls share."""
    clear = height - 2.0 * flange
    return flange / (flange + width - web), web / (web + 0.5 * clear), web / (web + flange)


def channel_poisson_base_y(height: Number, width: Number, flange: Number, web: Number) -> Number:
    """Second moment (m^6) of the curl of d in the walls of a channel, for a force along its flanges."""
    clear = height - 2.0 * flange
    return 2.0 * width * (0.5 * (height - flange)) ** 2 * flange**3 / 12.0 + web**3 * clear**3 / 144.0


def channel_poisson_base_z(height: Number, width: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """The same for a force along its web; ``centroid`` is the distance of the centroid from the web's outside (m)."""
    clear, side = height - 2.0 * flange, width - centroid
    return flange**3 / 18.0 * (side**3 + centroid**3) + clear * (
        web**3 / 12.0 * (0.5 * web - centroid) ** 2 + web**5 / 720.0
    )


def channel_shear_factors(
    width: Number,
    height: Number,
    flange: Number,
    web: Number,
    poisson_ratio: Number,
    area: Number,
    centroid: Number,
    moments: tuple[Number, Number],
) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz of a channel; ``moments`` are its second moments about y and z (m^4)."""
    features = channel_features(width, height, flange, web)
    poisson = poisson_square(poisson_ratio) * area
    bending_y = half_shear(0.5 * height, web, flange, width, centroid, 0.5 * area, 0.5 * moments[1])
    _, bending_z = i_section_bending_shear(2.0 * width, height, flange, 2.0 * web)
    twisted_y = channel_poisson_base_y(height, width, flange, web) * exp(fitted("channel_poisson_y", features))
    twisted_z = channel_poisson_base_z(height, width, flange, web, centroid)
    twisted_z = twisted_z * exp(fitted("channel_poisson_z", features))
    return bending_y + poisson * twisted_y / moments[1] ** 2, bending_z + poisson * twisted_z / moments[0] ** 2


# ---- T-section


def t_torsion_constant(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """J of a T-section, m^4; within 0.3 % where the flange overhangs by its thickness, 1 % at 0.8 of it."""
    walls = rectangle_torsion_constant(width, flange) + rectangle_torsion_constant(height, web)
    return walls + t_junction(web, flange) - web * flange**3 / 3.0 - overlap(flange, web)


def t_features(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, Number, Number]:
    """Bounded variables of the fits: how thick the web is against flange, height and flange's thickness."""
    return web / width, flange / (flange + web), web / (web + height)


def t_poisson_base_y(width: Number, height: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """Second moment (m^6) of the curl of d in the walls of a T-section, for a force along its flange.

    ``centroid`` is the distance of the centroid from the flange's outside (m).
    """
    below, above = height - centroid, centroid - flange
    bulge = width * flange**5 / 720.0
    in_flange = width * flange**3 / 12.0 * (centroid - 0.5 * flange) ** 2 + bulge
    return in_flange + web**3 / 36.0 * (above**3 + below**3)


def t_poisson_base_z(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """The same for a force along its web."""
    return flange**3 * width**3 / 144.0 + (height - flange) * web**5 / 720.0


def t_shear_factors(
    width: Number,
    height: Number,
    flange: Number,
    web: Number,
    poisson_ratio: Number,
    area: Number,
    centroid: Number,
    moments: tuple[Number, Number],
) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz of a T-section; ``centroid`` is the centroid's distance from the flange's outside."""
    features = t_features(width, height, flange, web)
    poisson = poisson_square(poisson_ratio) * area
    bending_y = i_section_cross_base(width, 2.0 * height, flange, web, 2.0 * area, 2.0 * moments[1])
    bending_y = bending_y * exp(fitted("t_shear_y", features))
    bending_z = half_shear(0.5 * width, flange, 0.5 * web, height, centroid, 0.5 * area, 0.5 * moments[0])
    twisted_y = t_poisson_base_y(width, height, flange, web, centroid) * exp(fitted("t_poisson_y", features))
    twisted_z = t_poisson_base_z(width, height, flange, web) * exp(fitted("t_poisson_z", features))
    return bending_y + poisson * twisted_y / moments[1] ** 2, bending_z + poisson * twisted_z / moments[0] ** 2


# ---- half of either


def half_shear_base(
    base: Number, thickness: Number, leg: Number, height: Number, centroid: Number, area: Number, second_moment: Number
) -> Number:
    """A / A_s at nu = 0 of an L that stays upright, for a force along its leg, before the fit.

    ``base`` is the length of its base (m), ``thickness`` that of the base, ``leg`` that of the leg, ``height`` the
    leg's with the base, ``centroid`` its centroid's distance from the base's outside; ``area`` and ``second_moment``
    are its own (m^2, m^4). Shear flow along the middle lines, with the exact resistance of the corner.
    """
    clear, arm = base - leg, centroid - 0.5 * thickness
    before = thickness * arm * clear
    after = before + thickness * leg * arm
    in_base = thickness * arm**2 * clear**3 / 3.0 + base * thickness**5 / 120.0
    in_corner = corner_excess(thickness, leg) * (before**2 + before * after + after**2) / 3.0
    bottom, top = height - centroid, centroid - thickness

    def primitive(z: Number) -> Number:
        return bottom**4 * z - 2.0 * bottom**2 * z**3 / 3.0 + z**5 / 5.0

    in_leg = 0.25 * leg * (primitive(top) + primitive(bottom))
    return area / second_moment**2 * (in_base + in_corner + in_leg)


def half_features(base: Number, thickness: Number, leg: Number, height: Number) -> tuple[Number, Number, Number]:
    """Bounded variables of the fit: the slenderness of both arms, and how base and leg share the area."""
    clear, free = base - leg, height - thickness
    return thickness / (thickness + clear), leg / (leg + free), base / (base + height)


def half_shear(
    base: Number, thickness: Number, leg: Number, height: Number, centroid: Number, area: Number, second_moment: Number
) -> Number:
    """A / A_s at nu = 0 of half a T-section along its web, or half a channel along its flanges."""
    result = half_shear_base(base, thickness, leg, height, centroid, area, second_moment)
    return result * exp(fitted("half_shear", half_features(base, thickness, leg, height)))


def walled_features(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, Number, Number]:
    """Bounded variables of the fits of sections with flanges and a web: how thick the walls are, and proportions."""
    return flange / height, web / width, width / (width + height)


def channel_shear_centre_base(width: Number, height: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """Distance of a channel's shear centre from its centroid before the fit, m; ``centroid`` is that of the centroid
    from the web's outside."""
    b, h = width - 0.5 * web, height - flange
    return centroid - 0.5 * web + 3.0 * b**2 * flange / (6.0 * b * flange + h * web)


def channel_shear_centre(width: Number, height: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """Distance of a channel's shear centre from its centroid, beyond the web, m; ``centroid`` as for its base."""
    features = walled_features(width, height, flange, web)
    base = channel_shear_centre_base(width, height, flange, web, centroid)
    return base * exp(fitted("channel_shear_centre", features))


def channel_warping_base(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """Warping constant of a channel before the fit, m^6."""
    b, h = width - 0.5 * web, height - flange
    share = (3.0 * b * flange + 2.0 * h * web) / (6.0 * b * flange + h * web)
    return b**3 * h**2 * flange / 12.0 * share


def channel_warping_constant(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """Warping constant of a channel, m^6."""
    features = walled_features(width, height, flange, web)
    return channel_warping_base(width, height, flange, web) * exp(fitted("channel_warping", features))


def t_shear_centre_base(width: Number, height: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """Distance of a T-section's shear centre from its centroid before the fit, towards the flange, m; ``centroid`` is
    that of the centroid from the flange's outside. Flange and web bend sideways alike, and share a force by how stiff
    they are."""
    in_flange, in_web = flange * width**3, (height - flange) * web**3
    return centroid - 0.5 * flange - 0.5 * height * in_web / (in_flange + in_web)


def t_shear_centre(width: Number, height: Number, flange: Number, web: Number, centroid: Number) -> Number:
    """Distance of a T-section's shear centre from its centroid, towards the flange, m; ``centroid`` as for its base."""
    more = fitted("t_shear_centre", walled_features(width, height, flange, web))
    return t_shear_centre_base(width, height, flange, web, centroid) + height * more


def t_warping_constant(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """Warping constant of a T-section, m^6: that of walls warping across their thickness, within 20 % (what it adds to
    a link's stiffness goes with its root, and is small)."""
    return (width * flange) ** 3 / 144.0 + ((height - 0.5 * flange) * web) ** 3 / 36.0


def angle_features(width: Number, height: Number, thickness: Number) -> tuple[Number, Number]:
    """Bounded variables of an angle's fits: how unlike its legs are, and how thick."""
    return (width - height) / (width + height), thickness / width + thickness / height


def angle_shear_centre(
    width: Number, height: Number, thickness: Number, centroid: tuple[Number, Number]
) -> tuple[Number, Number]:
    """Shear centre (y, z) of an angle from its centroid, m; ``centroid`` is that of the centroid from the outside of
    the standing leg and of the lying one."""
    along_y = exp(fitted("angle_shear_centre", angle_features(width, height, thickness)))
    along_z = exp(fitted("angle_shear_centre", angle_features(height, width, thickness)))
    half = 0.5 * thickness
    return (half - centroid[0]) * along_y, (half - centroid[1]) * along_z


def angle_warping_base(width: Number, height: Number, thickness: Number) -> Number:
    """Warping constant of an angle before the fit, m^6."""
    return thickness**3 / 36.0 * ((width - 0.5 * thickness) ** 3 + (height - 0.5 * thickness) ** 3)


def angle_warping_constant(width: Number, height: Number, thickness: Number) -> Number:
    """Warping constant of an angle, m^6."""
    features = angle_features(width, height, thickness)
    # An even function of how unlike the legs are, since they may change places.
    return angle_warping_base(width, height, thickness) * exp(fitted("angle_warping", (features[0] ** 2, features[1])))


def i_warping_base(width: Number, height: Number, flange: Number) -> Number:
    """Warping constant of an I-section with equal flanges before the fit, m^6."""
    return flange * width**3 * (height - flange) ** 2 / 24.0


def i_section_warping(
    top: Flange, bottom: Flange | None, height: Number, web: Number, centroid: Number
) -> tuple[Number, Number]:
    """Height of an I-section's shear centre above its centroid (m) and its warping constant (m^6).

    ``bottom`` is None where both flanges are equal. With flanges of second moments I_1 and I_2 a height h apart the
    shear centre is h I_2/(I_1 + I_2) from the first, and the constant h^2 I_1 I_2/(I_1 + I_2), the fit being the mean
    of those of the two sections with equal flanges.
    """

    def fit(flange: Flange, whole: Number) -> Number:
        return exp(fitted("i_section_warping", walled_features(flange.width, whole, flange.thickness, web)))

    if bottom is None:
        return 0.0, i_warping_base(top.width, height, top.thickness) * fit(top, height)
    clear = height - top.thickness - bottom.thickness
    apart = clear + 0.5 * (top.thickness + bottom.thickness)
    upper, lower = (flange.thickness * flange.width**3 / 12.0 for flange in (top, bottom))
    above = 0.5 * bottom.thickness + apart * upper / (upper + lower) - centroid
    mean = 0.5 * (fit(top, clear + 2.0 * top.thickness) + fit(bottom, clear + 2.0 * bottom.thickness))
    return above, apart**2 * upper * lower / (upper + lower) * mean


def triangle_shear_centre(width: Number, height: Number) -> Number:
    """Height of the shear centre of a solid isosceles triangle above its centroid, m; within 1e-3 of its height."""
    return height * fitted("triangle_shear_centre", (width / (width + height),))


def triangular_tube_shear_centre(width: Number, height: Number, inner: Number) -> Number:
    """The same of a triangular tube whose hollow is ``inner`` times as large as its outside, m."""
    return height * fitted("triangular_tube_shear_centre", (width / (width + height), inner))

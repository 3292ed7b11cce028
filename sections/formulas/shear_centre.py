"""Where shear centres are, and warping constants, of open walls and of triangles.

Thin-wall formulas for walls of constant thickness about their middle lines (W. D. Pilkey, Formulas for Stress, Strain,
and Structural Matrices, 2nd ed., Wiley 2005, tables 2-6 and 2-7; V. Z. Vlasov, Thin-walled Elastic Beams, 2nd ed.,
Jerusalem 1961), times exponentials of polynomials fitted to boundary element solutions (`sections/fits`; the shear
centre is Trefftz's). A flat wall that is alone on its way to the shear centre warps across its thickness only, so that
T-sections and angles hardly gain from held warping.
"""

from __future__ import annotations

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.formulas.thin_walls import Flange
from linkwright.core.sections.numeric import Number, exp


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

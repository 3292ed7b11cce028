"""Torsion and shear of rectangular tubes and I-sections, thin-walled or not.

Each quantity is a thin-wall formula, improved by the exact resistance of an L-shaped corner, times the
exponential of a polynomial fitted to a spectral element solution (`sections/fits`). The
polynomial's variables are p = (b - h) / (b + h), and the web and flange thickness as fractions of the solid
section; those of the I-section also include the ratio of both thicknesses.

Valid to 1 % for J and both shear areas, at any Poisson's ratio up to 0.45, for width / height from 0.3 to 3
and walls from 0.01 to 0.25 of the outer size they are measured along. Worst errors found there: tube 0.5 %
(J) and 0.4 % (shear areas); I-section 0.9 % each. Outside the formulas degrade slowly. For width / height
from 0.2 to 5 and walls from 0.004 to 0.35: tube 2 %; I-section 5 % (J) and 6 % (shear areas). For 0.12 to 8
and walls from 0.003 to nearly solid: tube 5 % (J) and 12 % (shear areas), I-section 8 % and 31 %.

I-sections with unequal flanges reach the same figures where each flange alone would be in range and the
neutral axis lies in the web; a web thinner than 0.01 of the wider flange brings J to 2 %.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.formulas.closed_forms import rectangle_torsion_constant
from linkwright.core.sections.numeric import Number, atan, exp, log, minimum, sqrt
from linkwright.core.sections.section import poisson_square


@dataclass(frozen=True)
class Flange:
    """A flange.

    Attributes:
        width: m.
        thickness: m.
    """

    width: Number
    thickness: Number


def corner_excess(first: Number, second: Number) -> Number:
    """Resistance of an L-shaped bend between strips of these widths, beyond that of its arms, in squares.

    The arms are measured from the inner corner. By Schwarz-Christoffel mapping; 0.559 for equal widths.
    """
    ratio = first / second
    return (2.0 / math.pi) * (log((ratio + 1.0 / ratio) / 4.0) + ratio * atan(1.0 / ratio) + atan(ratio) / ratio)


def _features(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, Number, Number]:
    """Bounded variables of the fits; walls beyond the solid section (an extrapolated half) count as solid."""
    return (
        (width - height) / (width + height),
        minimum(2.0 * web / width, 1.0),
        minimum(2.0 * flange / height, 1.0),
    )


# ---- rectangular tube


def tube_torsion_base(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """J of a rectangular tube before the fit, m^4.

    Prandtl's membrane: a plateau over the hollow, held by walls and corners that conduct across their
    thickness
    (Bredt), and the bulge of the walls themselves.
    """
    inner_b, inner_h = width - 2.0 * web, height - 2.0 * flange
    conductance = 2.0 * inner_b / flange + 2.0 * inner_h / web + 4.0 * corner_excess(flange, web)
    ramps = inner_b**2 * flange / (inner_b + 0.5 * flange) + inner_h**2 * web / (inner_h + 0.5 * web) + flange * web
    bulges = rectangle_torsion_constant(inner_b, flange) + rectangle_torsion_constant(inner_h, web)
    return 4.0 * (inner_b * inner_h + ramps) ** 2 / conductance + 2.0 * bulges


def tube_torsion_constant(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """J of a rectangular tube, m^4; outer sizes and walls in m."""
    correction = fitted("tube_torsion", _features(width, height, flange, web))
    return tube_torsion_base(width, height, flange, web) * exp(correction)


def corner_shear_base(
    across: Number, along: Number, flange: Number, web: Number, area: Number, second_moment: Number
) -> Number:
    """A / A_s at nu = 0 of a rectangular tube before the fit, for a force along ``along``.

    The shear flow runs along the flange (across the force), turns a corner and closes in the web.
    """
    inner_b, inner_h = across - 2.0 * web, along - 2.0 * flange
    arm = 0.5 * (along - flange)
    before = flange * arm * inner_b / 2.0
    after = before + flange * web * arm
    in_flange = flange * arm**2 * inner_b**3 / 24.0 + across * flange**5 / 480.0 * 2.0
    in_web = (after**2 * inner_h + after * web * inner_h**3 / 6.0 + web**2 * inner_h**5 / 120.0) / (2.0 * web)
    in_corner = corner_excess(flange, web) * (before**2 + before * after + after**2) / 3.0
    return 4.0 * area / second_moment**2 * (in_flange + in_web + in_corner)


def _corner_shear(
    across: Number, along: Number, flange: Number, web: Number, area: Number, second_moment: Number
) -> Number:
    base = corner_shear_base(across, along, flange, web, area, second_moment)
    return base * exp(fitted("corner_shear", _features(across, along, flange, web)))


def tube_poisson_base(
    across: Number, along: Number, flange: Number, web: Number, area: Number, second_moment: Number
) -> Number:
    """Factor of (nu / (1 + nu))^2 in A / A_s of a rectangular tube before the fit: walls twisted by the
    curl of d."""
    middle_b, middle_h = across - web, along - flange
    twisted = flange**3 * middle_b**3 / 72.0 + web**3 * middle_b**2 * middle_h / 24.0
    return area / second_moment**2 * twisted


def tube_shear_factor(
    across: Number,
    along: Number,
    flange: Number,
    web: Number,
    poisson_ratio: Number,
    area: Number,
    second_moment: Number,
) -> Number:
    """A / A_s of a rectangular tube for a force along ``along``.

    ``flange`` are the walls across the force, ``web`` those along it (m); ``second_moment`` resists bending
    by
    this force.
    """
    bending = _corner_shear(across, along, flange, web, area, second_moment)
    poisson = tube_poisson_base(across, along, flange, web, area, second_moment)
    correction = exp(fitted("tube_poisson", _features(across, along, flange, web)))
    return bending + poisson_square(poisson_ratio) * poisson * correction


# ---- I-section


def i_section_torsion_base(width: Number, height: Number, flange: Number, web: Number) -> Number:
    """J of an I-section with equal flanges before the fit, m^4: between flanges and web cut both ways."""
    rectangle = rectangle_torsion_constant
    flanges_whole = 2.0 * rectangle(width, flange) + rectangle(height - 2.0 * flange, web)
    web_whole = rectangle(height, web) + 4.0 * rectangle(0.5 * (width - web), flange)
    return sqrt(flanges_whole**2 + web_whole**2)


def _i_features(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, ...]:
    return (web / (web + flange) - 0.5, *_features(width, height, flange, 0.5 * web))


def _i_torsion(width: Number, height: Number, flange: Number, web: Number) -> Number:
    correction = fitted("i_section_torsion", _i_features(width, height, flange, web))
    return i_section_torsion_base(width, height, flange, web) * exp(correction)


def i_section_torsion_constant(top: Flange, bottom: Flange | None, height: Number, web: Number) -> Number:
    """J of an I-section, m^4; ``bottom`` is None where both flanges are equal.

    Unequal flanges: the mean of the two equal-flanged sections with the same clear web, exact where the web
    is long
    against its thickness.
    """
    if bottom is None:
        return _i_torsion(top.width, height, top.thickness, web)
    clear = height - top.thickness - bottom.thickness
    return 0.5 * sum(_i_torsion(f.width, clear + 2.0 * f.thickness, f.thickness, web) for f in (top, bottom))


def i_section_cross_base(
    width: Number, height: Number, flange: Number, web: Number, area: Number, second_moment_z: Number
) -> Number:
    """A / A_sy at nu = 0 of an equal-flanged I-section before the fit: flow along the flanges, eased by the
    web."""
    clear = height - 2.0 * flange
    flow = 2.0 * flange * width**5 + clear * web**5
    ratio = web / flange
    eased = 0.9 / 32.0 * (flange * width**2) ** 2 * ratio**2 / (ratio + 2.0)
    return area / second_moment_z**2 * flow / 120.0 / (1.0 + 120.0 * eased / flow)


def i_section_poisson_base(
    width: Number, height: Number, flange: Number, web: Number, area: Number, second_moment_y: Number
) -> Number:
    """Factor of (nu / (1 + nu))^2 in A / A_sz of an equal-flanged I-section before the fit."""
    twisted = flange**3 * width**3 / 72.0 + web**5 * (height - 2.0 * flange) / 720.0
    return area / second_moment_y**2 * twisted


def i_section_cross_poisson_base(
    width: Number, height: Number, flange: Number, web: Number, area: Number, second_moment_z: Number
) -> Number:
    """Factor of (nu / (1 + nu))^2 in A / A_sy of an equal-flanged I-section before the fit."""
    clear = height - 2.0 * flange
    twisted = flange**3 * (height - flange) ** 2 * width / 24.0 + web**3 * clear**3 / 144.0
    return area / second_moment_z**2 * twisted


def i_section_shear_factors(
    top: Flange,
    bottom: Flange | None,
    height: Number,
    web: Number,
    poisson_ratio: Number,
    area: Number,
    centroid: Number,
    second_moment_y: Number,
    second_moment_z: Number,
) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz of an I-section; ``bottom`` is None where both flanges are equal.

    Unequal flanges: the web carries its shear in one direction, so a cut through it leaves two halves, each
    half of
    an equal-flanged section; along z (and for the Poisson part) the cut is at the neutral axis, which must
    lie
    in the web, along y at the middle of the web.
    """
    poisson = poisson_square(poisson_ratio)

    def along_y(width: Number, h: Number, flange: Number) -> Number:
        base = i_section_cross_base(width, h, flange, web, area, second_moment_z)
        return base * exp(fitted("i_section_cross_shear", _i_features(width, h, flange, web)))

    def along_z(width: Number, h: Number, flange: Number) -> tuple[Number, Number, Number]:
        # An I-section and a tube with half its web in each side share this problem: they are the same
        # quarters.
        wide = _i_features(width, h, flange, web)
        features = wide[1:]
        bending = _corner_shear(width, h, flange, 0.5 * web, area, second_moment_y)
        z_part = i_section_poisson_base(width, h, flange, web, area, second_moment_y)
        y_part = i_section_cross_poisson_base(width, h, flange, web, area, second_moment_z)
        return (
            bending,
            z_part * exp(fitted("i_section_poisson", features)),
            y_part * exp(fitted("i_section_cross_poisson", wide)),
        )

    if bottom is None:
        bending_y = along_y(top.width, height, top.thickness)
        bending_z, poisson_z, poisson_y = along_z(top.width, height, top.thickness)
        return bending_y + poisson * poisson_y, bending_z + poisson * poisson_z
    clear = height - top.thickness - bottom.thickness
    bending_y = 0.5 * sum(along_y(f.width, clear + 2.0 * f.thickness, f.thickness) for f in (top, bottom))
    upper = along_z(top.width, 2.0 * (height - centroid), top.thickness)
    lower = along_z(bottom.width, 2.0 * centroid, bottom.thickness)
    bending_z, poisson_z, poisson_y = (0.5 * (a + b) for a, b in zip(upper, lower, strict=True))
    return bending_y + poisson * poisson_y, bending_z + poisson * poisson_z


def i_section_bending_shear(width: Number, height: Number, flange: Number, web: Number) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz at nu = 0 of an I-section with equal flanges, from its dimensions alone (m)."""
    clear = height - 2.0 * flange
    area = 2.0 * width * flange + clear * web
    second_moment_y = (width * height**3 - (width - web) * clear**3) / 12.0
    second_moment_z = (2.0 * flange * width**3 + clear * web**3) / 12.0
    moments = (area, 0.5 * height, second_moment_y, second_moment_z)
    return i_section_shear_factors(Flange(width, flange), None, height, web, 0.0, *moments)

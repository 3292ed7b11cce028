"""Torsion and shear of solid rectangles and isosceles triangles for any aspect ratio.

The exact series of the rectangle converge badly on one side of the square or the other, so smooth fits in
variables
that stay bounded for every aspect ratio stand in for them (`sections/fits`).
"""

from __future__ import annotations

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.numeric import Number, maximum, minimum, polynomial
from linkwright.core.sections.section import poisson_square


def rectangle_torsion_constant(width: Number, height: Number) -> Number:
    """J of a rectangle, m^4; symmetric in both sides (m), within 1e-6 for any aspect ratio.

    Stands for b h^3 (1/3 - 64/pi^5 h/b sum over odd n of tanh(n pi b / 2 h) / n^5), Timoshenko and Goodier,
    Theory of
    Elasticity, 3rd ed. (1970), section 109.
    """
    square = width**2 + height**2
    thin = (width * height) ** 3 / (3.0 * square)
    return thin * fitted("rectangle_torsion", (width * height / square,))


def rectangle_torsion_modulus(width: Number, height: Number) -> Number:
    """W_t of a rectangle, m^3, within 0.5 %.

    Roark's Formulas for Stress and Strain, 7th ed. (2002), table 10.1 case 4: the stress at the middle of the
    longer side.
    """
    short, long = minimum(width, height), maximum(width, height)
    factor = polynomial((1.0, 0.6095, 0.8865, -1.8023, 0.91), (short / long,))
    return long * short**2 / (3.0 * factor)


def rectangle_shear_factor(across: Number, along: Number, poisson_ratio: Number) -> Number:
    """A / A_s of a rectangle for a shear force along one side (m); within 1e-4 for any aspect ratio.

    With r = across / along the exact value is 6/5 + (nu / (1 + nu))^2 c,
    c = 144 r^4 (1/720 - r / (8 pi^5) sum over n of tanh(n pi / r) / n^5), from the Fourier series of the
    flexure
    function (J. D. Renton, Generalized beam theory applied to shear stiffness, Int. J. Solids Structures 27
    (1991)).
    """
    ratio = across / along
    factor = ratio**4 / (5.0 + ratio**2) * fitted("rectangle_shear", (across / (across + along),))
    return 1.2 + poisson_square(poisson_ratio) * factor


def triangle_torsion_constant(width: Number, height: Number) -> Number:
    """J of an isosceles triangle, m^4; within 1e-4 for width / height from 0.1 to 10."""
    thin = (width * height) ** 3 / (12.0 * (width**2 + height**2))
    return thin * fitted("triangle_torsion", (width / (width + height),))


def triangle_torsion_modulus(width: Number, height: Number) -> Number:
    """W_t of an isosceles triangle, m^3; within 0.5 % for width / height from 0.1 to 10."""
    thin = (width * height) ** 2 / (width + height)
    return thin * fitted("triangle_torsion_modulus", (width / (width + height),))


def triangle_shear_factors(width: Number, height: Number, poisson_ratio: Number) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz of an isosceles triangle; within 0.05 % for width / height from 0.1 to 10."""
    ratio = width / height
    share = (width / (width + height),)
    poisson = poisson_square(poisson_ratio)
    along_y = fitted("triangle_shear_y", share) + poisson * fitted("triangle_poisson_y", share) / (
        ratio**2 * (1.0 + ratio**2)
    )
    along_z = fitted("triangle_shear_z", share) * (1.0 + ratio**2 / 14.0) + poisson * fitted(
        "triangle_poisson_z", share
    ) * ratio**4 / (1.0 + ratio**2)
    return along_y, along_z

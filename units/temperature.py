"""The two temperatures that everything else is measured from."""

ZERO_CELSIUS = 273.15
"""0 degC in kelvin."""
REFERENCE_TEMPERATURE = ZERO_CELSIUS + 20.0
"""20 degC in kelvin, the standard reference temperature for dimensions (ISO 1:2022)."""

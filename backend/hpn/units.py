"""Unit suffixes of field names: the one place that says what `_Nm` at the end of a name means."""

SYMBOLS = {
    "Nm_per_rad": "Nm/rad",
    "Nm": "Nm",
    "rpm": "rpm",
    "s": "s",
    "h": "h",
    "N": "N",
    "kg": "kg",
    "mm": "mm",
    "arcmin": "arcmin",
    "degC": "°C",
    "percent": "%",
}
"""Unit suffix of a field name -> the symbol a reader sees."""

_LONGEST_FIRST = sorted(SYMBOLS, key=len, reverse=True)


def suffix_of(field_name: str) -> str | None:
    """Unit suffix that ends a field name (`torque_Nm` -> `Nm`), or None for a field without a unit."""
    return next((unit for unit in _LONGEST_FIRST if field_name.endswith("_" + unit)), None)


def symbol_of(field_name: str) -> str:
    """Symbol of a field's unit (`life_L10_h` -> `h`), or an empty text for a field without one."""
    unit = suffix_of(field_name)
    return SYMBOLS[unit] if unit else ""

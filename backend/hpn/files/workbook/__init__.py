"""The workbook with live formulas."""


class EveryDigit(float):
    """Number of a cell with all of its digits: xlsxwriter keeps 16, of which some floats need 17."""

    def __format__(self, format_spec: str) -> str:
        return repr(float(self))

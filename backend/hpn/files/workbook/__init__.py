"""Workbook of a selection: all its numbers, and the handbook's printed equations live on a sheet of their own."""


class EveryDigit(float):
    """Number of a cell with all of its digits: xlsxwriter writes 16, and some floats need 17."""

    def __format__(self, format_spec: str) -> str:
        return repr(float(self))

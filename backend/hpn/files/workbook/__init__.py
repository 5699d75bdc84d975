"""The workbook: the whole selection as numbers, and the handbook's printed equations live on a sheet of their own."""


class EveryDigit(float):
    """Number of a cell with all of its digits: xlsxwriter keeps 16, of which some floats need 17."""

    def __format__(self, format_spec: str) -> str:
        return repr(float(self))

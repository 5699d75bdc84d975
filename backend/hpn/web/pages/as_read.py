"""Numbers of a pasted table as they were understood: every digit, and no mark that could be taken for the other one."""

from jinja2 import pass_context
from jinja2.runtime import Context

from hpn.web.display import GROUP
from hpn.web.reader import reader_of


@pass_context
def as_read(context: Context, number: str) -> str:
    """A number in plain notation with the reader's decimal mark, thousands apart by a narrow blank: `1 234.5`."""
    decimal = reader_of(context).decimal
    sign = "\N{MINUS SIGN}" if number.startswith("-") else ""
    whole, point, fraction = number.lstrip("+-").partition(".")
    if whole.isdigit():
        whole = f"{int(whole):,}".replace(",", GROUP)
    return sign + whole + point.replace(".", decimal) + fraction


@pass_context
def as_typed(context: Context, value: float, unit: str) -> str:
    """A figure of the catalogue as the reader would type it into a field, in their unit and with their decimal mark."""
    reader = reader_of(context)
    measure = reader.measure(unit)
    return (f"{value:.12g}" if measure.same else measure.written(value, 6)).replace(".", reader.decimal)

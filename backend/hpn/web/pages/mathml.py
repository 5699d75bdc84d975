"""Formulas in pages, as MathML for whoever reads the page."""

from collections.abc import Callable
from typing import Any

from jinja2 import pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from hpn.explain.calculation.mathml import compared, in_symbols, result, with_numbers
from hpn.web.door.visit import current
from hpn.words.reader import Reader


def _for_reader(write: Callable[[Reader, Any], str]) -> Callable[..., Markup]:
    def filtered(_: Context, argument: Any) -> Markup:
        return Markup(write(current(), argument))

    return pass_context(filtered)


FILTERS = {
    "in_symbols": _for_reader(in_symbols),
    "with_numbers": _for_reader(with_numbers),
    "result": _for_reader(result),
    "compared": _for_reader(compared),
}
"""`{{ line | in_symbols }}`, `{{ line | with_numbers }}`, `{{ comparison | compared }}`, for whoever reads the page."""

"""Templates, and their common functions: texts, numbers and sentences in the reader's language and units."""

import re
import shutil
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any
from xml.etree.ElementTree import Element

import orjson
from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined, pass_context
from jinja2.bccache import Bucket
from jinja2.runtime import Context
from markupsafe import Markup, escape
from starlette.datastructures import State

from hpn.account.lines import Line, drive_limit
from hpn.account.readings import shortest_life, stiffness_of
from hpn.catalogue.ordering import MOTOR_CODE, ordering_code
from hpn.engine.candidates import REASONS, Candidate, reason_of
from hpn.engine.checks import BY_CODE, name_of
from hpn.engine.remedy import DRIVER_NAMES
from hpn.explain.calculation import calculation_of, mathml
from hpn.explain.comparison import ALIKE
from hpn.explain.drawings import Figure
from hpn.explain.drawings.picture import beyond_limit
from hpn.explain.drawings.svg import markup
from hpn.files.machine.inputs import COLUMNS
from hpn.fleet.faults import Reason
from hpn.installed import data_folder, has_extra
from hpn.links import row_symbols, symbols
from hpn.links.rows import BODY_COLUMNS, LOADS, MOVE_COLUMNS, ROWS_IN_TABLE
from hpn.physics.motion.moves import Move
from hpn.web.door.visit import address, current
from hpn.web.form import ways
from hpn.web.form.linked import carried_pairs, onward
from hpn.web.form.refusals import MISSING
from hpn.web.pages import assets
from hpn.web.pages.notes import head_and_reason, note_groups
from hpn.web.pages.result import preview_of
from hpn.words import units
from hpn.words.quantities import GEAR, LISTED, QUANTITIES
from hpn.words.reader import GROUP, LANGUAGE_NAMES, Reader
from hpn.words.symbols import Part, formula, sentence
from hpn.words.terms import BEARING_MODELS, ENVELOPE_BASIS, MECHANISMS, PROFILES, RANKINGS, SHAPES, VERDICTS
from hpn.words.wording import Sentence

TEMPLATES, COMPILED = data_folder("frontend/templates"), assets.DIST / "templates"


class Compiled(FileSystemBytecodeCache):
    """Compiled templates by name, so that they are still found after their folder has moved."""

    def get_cache_key(self, name: str, filename: str | None = None) -> str:
        """Key of a template; the file itself identifies the source that it was compiled from."""
        return super().get_cache_key(name)


class ReadOnly(Compiled):
    """Templates compiled by the build, as compiling takes a third of a start; changed ones are compiled anew."""

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Store nothing: a service writes only its data."""


JINJA = r"\{\{.*?\}\}|\{%.*?%\}|\{#.*?#\}"
WITHIN = rf"(?:[^<>{{]|{JINJA})*+"
TAG = re.compile(rf"</?[a-z]{WITHIN}>", re.DOTALL)
BREAK = re.compile(rf"({JINJA})|\n", re.DOTALL)
BLOCK = "a|button|caption|dd|dt|figcaption|figure|h[1-6]|label|li|option|p|summary|td|th"
EDGE = re.compile(rf"(<(?:{BLOCK})\b{WITHIN}>)\n|\n(</(?:{BLOCK})>|(?=<dd\b))", re.DOTALL)
UNSEEN = "{#\n#}"
"""Line break that counts in a template but does not appear in the page."""


class Compact(FileSystemLoader):
    """Loads templates without layout whitespace: indentation, line breaks in tags and at the edges of blocks."""

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        """Source of a template for compiling; its lines keep their numbers."""
        source, path, is_current = super().get_source(environment, template)
        source = re.sub(r"^[ \t]+", "", source, flags=re.MULTILINE)
        source = EDGE.sub(lambda edge: f"{edge[1]}{UNSEEN}" if edge[1] else f"{UNSEEN}{edge[2]}", source)
        return TAG.sub(lambda tag: BREAK.sub(lambda piece: piece[1] or f"{UNSEEN} ", tag[0]), source), path, is_current


def environment(state: State) -> Environment:
    """Templates of an application with their common functions; made once per application."""
    if not hasattr(state, "templates"):
        state.templates = environment_of(assets.assets_of(state))
    templates: Environment = state.templates
    return templates


def environment_of(static: assets.Assets) -> Environment:
    """Templates for a service."""
    return _templates(static, ReadOnly(str(COMPILED)))


def prepare(templates: Environment) -> None:
    """Load all templates, so that the first page need not wait for them."""
    for name in templates.list_templates():
        templates.get_template(name)


def compile_all() -> None:
    """Write compiled templates for services to load: a step of the build.

    A template depends on the functions here as well as on its text, so nothing compiled before is kept.
    """
    shutil.rmtree(COMPILED, ignore_errors=True)
    COMPILED.mkdir()
    prepare(_templates(assets.Assets.load(), Compiled(str(COMPILED))))


def _templates(static: assets.Assets, compiled: Compiled) -> Environment:
    """Templates for any reader. `_()` takes a format, the filter `t` a text of the domain that may contain a `%`."""
    templates = Environment(
        loader=Compact(TEMPLATES),
        bytecode_cache=compiled,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        auto_reload=False,
        extensions=["jinja2.ext.i18n"],
    )
    templates.install_gettext_callables(  # type: ignore[attr-defined]
        _for_reader("text"), _for_reader("plural"), newstyle=True
    )
    templates.filters |= FILTERS
    templates.tests |= {"beyond_limit": beyond_limit}
    templates.globals |= GLOBALS | {"asset": static.url}
    return templates


# --- For the reader of the page ---------------------------------------------------------------------------------------


def _for_reader(method: str) -> Callable[..., Any]:
    # With the context, as otherwise Jinja evaluates filters of constants only once.
    def filtered(_: Context, *arguments: Any) -> Any:
        return getattr(current(), method)(*arguments)

    return pass_context(filtered)


def _as_mathml(write: Callable[..., str]) -> Callable[..., Markup]:
    return pass_context(lambda _, formula, **options: Markup(write(current(), formula, **options)))


@lru_cache(maxsize=4096)
def _written(reader: Reader, value: float | None, unit: str, beside: float | None) -> str:
    """Number of the wire in the reader's notation; cached, as pages repeat the catalogue's numbers."""
    return reader.figure(value, unit, beside)


@pass_context
def _figure(_: Context, value: float | None, unit: str = "", beside: float | None = None) -> str:
    return _written(current(), value, unit, beside)


@pass_context
def _say(_: Context, message: Sentence) -> str:
    """Message on an input, for display beside a field that shows the unit."""
    reader = current()
    return message.render(reader.text, reader.bound)


@pass_context
def _reason(_: Context, candidate: Candidate, utilisation: float) -> str:
    """Reason for the rank of a candidate; `utilisation` is the user's u."""
    return current().sentence(reason_of(candidate, utilisation))


@pass_context
def _as_read(_: Context, number: str, unit: str = "") -> str:
    """Number of a pasted table with all digits and the reader's marks: `1 234.5`; with a unit in the reader's unit."""
    measure = current().measure(unit)
    if "e" in number.lower() and unit:
        return current().exact(float(number), unit)
    number = number if measure.same else measure.written(float(number), 6)
    sign = "\N{MINUS SIGN}" if number.startswith("-") else ""
    whole, point, fraction = number.lstrip("+-").partition(".")
    if whole.isdigit():
        whole = f"{int(whole):,}".replace(",", GROUP)
    return sign + whole + point.replace(".", current().decimal) + fraction


@pass_context
def _as_typed(_: Context, value: float, unit: str) -> str:
    """Figure of the catalogue as typed into a field, in the reader's unit and with their decimal mark."""
    reader = current()
    measure = reader.measure(unit)
    return (f"{value:.12g}" if measure.same else measure.written(value, 6)).replace(".", reader.decimal)


PARTS = re.compile(r"(?<=[a-zäöüß]{3})(?=drehzahl|(?<!dreh)zahl|moment|anteil|last\b|gung|rung|ation)")


def parted(name: str) -> str:
    """Name with soft hyphens between its parts, for a narrow column, as some browsers can't hyphenate words."""
    return PARTS.sub("\N{SOFT HYPHEN}", name)


def with_symbols(text: str) -> Markup:
    """Sentence with the handbook's symbols typeset: `T_R` with R as a subscript."""
    return Markup().join(map(_set, sentence(text)))


def as_formula(text: str) -> Markup:
    """Symbol or formula typeset as in the tables, single letters included."""
    return Markup().join(map(_set, formula(text)))


def _set(part: Part) -> Markup:
    if isinstance(part, str):
        return escape(part)
    letter, index = part
    below = Markup("<sub>{}</sub>").format(index) if index else ""
    return Markup('<var class="symbol">{}{}</var>').format(letter, below)


@pass_context
def _followed(_: Context, moves: Iterable[Move]) -> dict[str, str]:
    """Figures of moves that follow from the given ones, by the fields of the form in which they belong."""
    reader = current()
    return {
        f"{symbol.name}-{at}": reader.figure(value, symbol.unit)
        for at, move in enumerate(moves)
        for symbol, value in ((row_symbols.MOVE_BY_LEAF[field], value) for field, value in move.followed.items())
    }


def _of_line(method: str) -> Callable[..., str]:
    # With the context for the same reason.
    def read(_: Context, line: Line) -> str:
        text: str = getattr(line, method)(current())
        return text

    return pass_context(read)


@pass_context
def _stiffness(_: Context, candidate: Candidate) -> str:
    """Sentence on natural frequency and position error of a candidate."""
    return current().sentence(stiffness_of(candidate))


def _inline(drawing: Element | list[Element]) -> Markup:
    """Drawing, or one for each kind of place, as part of a page; the XML library that made it escapes its texts."""
    text = "".join(map(markup, drawing if isinstance(drawing, list) else [drawing]))
    text = text.replace(' xmlns="http://www.w3.org/2000/svg"', "")  # not needed within HTML
    return Markup(_FINER.sub(r"\1", text))


_FINER = re.compile(r"(?<=\d)(\.\d)\d{1,2}(?=[ LZHV\"])")
"""Decimals of coordinates below a tenth of a unit, which no screen shows."""


def _as_attribute(figure: Figure) -> Markup:
    """Figure as JSON for a single-quoted attribute, in which its many double quotes need no escape."""
    text = orjson.dumps(figure).decode()
    return Markup(text.replace("&", "&amp;").replace("'", "&#39;").replace("<", "&lt;"))


def _named_reason(reason: Reason, named: bool) -> Sentence:
    """Sentence on a reason with the name of its input, or behind its column as in the answers."""
    if not named and reason.column:
        return Sentence("{input}: {text}", {"input": reason.column, "text": reason.sentence})
    return reason.named(COLUMNS[reason.column].name if reason.column in COLUMNS else reason.column)


FILTERS: dict[str, Callable[..., Any]] = {
    "as_attribute": _as_attribute,
    "as_read": _as_read,
    "as_typed": _as_typed,
    "named_reason": _named_reason,
    "drive_limit": pass_context(lambda _, limit_Nm: current().number(drive_limit(limit_Nm))),
    "capital": lambda text: text[:1].upper() + text[1:],
    "figure": _figure,
    "followed": _followed,
    "formula": as_formula,
    "headed": head_and_reason,
    "inline": _inline,
    "parted": parted,
    "reason": _reason,
    "say": _say,
    "shortest_life": shortest_life,
    "stiffness": _stiffness,
    "symbols": with_symbols,
    "t": _for_reader("text"),
    "tolerance": pass_context(lambda _, line, factor=1.0: line.text(current(), factor)),
    "addition": pass_context(lambda _, step: mathml.addition(current(), step)),
    **{
        write.__name__: _as_mathml(write)
        for write in (mathml.in_symbols, mathml.substituted, mathml.result, mathml.compared_apart)
    },
    "number": _of_line("number"),
    "text": _of_line("text"),
    "where": _of_line("where"),
    **{
        name: _for_reader(name)
        for name in (
            "exact",
            "fixed",
            "mass",
            "percent",
            "capped_percent",
            "unit",
            "sentence",
            "quantity",
            "source",
            "translated",
        )
    },
}
"""Filters for the reader of the page: `{{ 40 | figure("Nm") }}`, `{{ "Nm" | unit }}`, `{{ sentence | sentence }}`."""

NOT_USED = {"FR": "radial_load_not_used", "FA": "axial_load_not_used"}
"""Inputs that others can make ineffective, and the notice on that at their fields."""

GLOBALS: dict[str, Any] = {
    "ALIKE": ALIKE,
    "BEARING_MODELS": BEARING_MODELS,
    "RANKINGS": RANKINGS,
    "REASONS": REASONS,
    "BODY_COLUMNS": BODY_COLUMNS,
    "calculation_of": calculation_of,
    "CHECKS": BY_CODE,
    "check_name": name_of,
    "DRIVER_NAMES": DRIVER_NAMES,
    "ENVELOPE_BASIS": ENVELOPE_BASIS,
    "GEAR": GEAR,
    "has_extra": has_extra,
    "here": address,
    "LANGUAGE_NAMES": LANGUAGE_NAMES,
    "LISTED": LISTED,
    "LOADS": LOADS,
    "ROWS_IN_TABLE": ROWS_IN_TABLE,
    "unit_of": units.symbol_of,
    "units": units,
    "MECHANISMS": MECHANISMS,
    "MOVE_COLUMNS": MOVE_COLUMNS,
    "motor_pattern": MOTOR_CODE,
    "carried_pairs": carried_pairs,
    "NOT_USED": NOT_USED,
    "MISSING": MISSING,
    "note_groups": note_groups,
    "onward": onward,
    "ordering_code": ordering_code,
    "preview_of": preview_of,
    "PROFILES": PROFILES,
    "QUANTITIES": QUANTITIES,
    "reader": current,
    "SHAPES": SHAPES,
    "today": lambda: datetime.now(UTC).date().isoformat(),
    "row_symbols": row_symbols,
    "symbols": symbols,
    "ways": ways,
    "VERDICTS": VERDICTS,
}

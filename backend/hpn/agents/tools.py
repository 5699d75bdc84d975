"""Three tools: arguments in, a short JSON text out, or a refusal with the question for the user."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import ValidationError

from hpn import ENGINE_VERSION
from hpn.account.account import Account
from hpn.account.lines import Line
from hpn.account.published import published
from hpn.agents.brief import brief, number, within
from hpn.agents.schema import TOOLS
from hpn.application import Application, InputError
from hpn.application.faults import Location, faults_of, pointer
from hpn.catalogue import Catalogue
from hpn.engine.selection import select, with_gear
from hpn.links.writer import to_link
from hpn.words.quantities import INPUTS
from hpn.words.units import symbol_of
from hpn.words.wording import shortened

MOST_FAULTS = 8
MOST_REPEATED = 160
"""Most characters of a place or text in a refusal; it may be the caller's own."""

ASK = "Nothing was calculated. Ask the user for what is lacking or wrong here, and make nothing up:"


class ToolReply(NamedTuple):
    """Text of an answer, or of a refusal with the question for the user."""

    text: str
    is_refusal: bool = False

    @classmethod
    def refusal(cls, text: str) -> "ToolReply":
        """Refusal; characters that no text can hold are replaced, since it may repeat the caller's."""
        return cls(text.encode(errors="replace").decode(), True)


class _RefusedError(ValueError):
    """Error of unusable arguments, with the reason."""


def answer(tool: str, arguments: Mapping[str, Any], catalogue: Catalogue, service: str) -> ToolReply:
    """Answer of a tool; `service` is the address for links, without a slash at its end."""
    try:
        _require_known(tool, arguments)
        if tool == "catalogue":
            return ToolReply(within(_catalogue(arguments.get("designation"), catalogue, service)))
        application = Application.model_validate(arguments.get("application"))
        designation = arguments.get("designation") if tool == "explain" else None
        return ToolReply(within(_answer_on(application, designation, catalogue, service)))
    except _RefusedError as error:
        return ToolReply.refusal(str(error))
    except (ValidationError, InputError) as error:
        return ToolReply.refusal(_refusal(error))


def _require_known(tool: str, arguments: Mapping[str, Any]) -> None:
    if tool not in TOOLS:
        raise _RefusedError(f"there is no tool {tool[:MOST_REPEATED]!r}; there are {', '.join(TOOLS)}")
    schema = TOOLS[tool][1]
    unknown = [name[:MOST_REPEATED] for name in arguments if name not in schema["properties"]]
    missing = [name for name in schema.get("required", ()) if arguments.get(name) is None]
    if unknown or missing:
        takes = f"{tool} takes {' and '.join(schema['properties'])}"
        wrong = [f"{name} is required" for name in missing] + [f"{name} is no argument" for name in unknown[:1]]
        raise _RefusedError(f"{takes}: {'; '.join(wrong)}")
    designation = arguments.get("designation")
    if designation is not None and not isinstance(designation, str):
        raise _RefusedError("designation: must be text, such as HPN-20A-5")


def _answer_on(application: Application, designation: str | None, catalogue: Catalogue, service: str) -> dict[str, Any]:
    selection = select(application, catalogue, to_link)
    gear = None if designation is None else _gear(designation, catalogue)
    selection = with_gear(selection, application, catalogue, gear or "")
    candidate = selection.candidate(gear or "") or selection.foremost
    return brief(Account(selection, candidate, application, catalogue), service, explained=gear is not None)


def _gear(designation: str, catalogue: Catalogue) -> str:
    """Designation in the catalogue's spelling; raises _RefusedError for an unknown gear."""
    gear = catalogue.find(designation)
    if gear is None:
        gears = ", ".join(catalogue.by_designation)
        text = f"the catalogue has no gear {designation[:MOST_REPEATED]!r}; there are {gears}"
        raise _RefusedError(text)
    return gear.designation


def _catalogue(designation: str | None, catalogue: Catalogue, service: str) -> dict[str, Any]:
    """Designations of all gears, or the figures of one."""
    versions = {"engine": ENGINE_VERSION, "catalogue": catalogue.version}
    if designation is None:
        return {"gears": list(catalogue.by_designation), "link": f"{service}/catalogue", "versions": versions}
    gear = catalogue.by_designation[_gear(designation, catalogue)]
    return {
        "gear": gear.designation,
        "ratio": gear.ratio,
        "stages": gear.stages,
        "figures": {
            "columns": ["figure", "value", "unit", "source"],
            "rows": [_row(line) for line in published(gear) if line.value is not None],
        },
        "not_published": [line.field for line in published(gear) if line.value is None],
        "link": f"{service}/catalogue/{gear.designation}",
        "versions": versions,
    }


def _row(line: Line) -> list[Any]:
    value = line.value if isinstance(line.value, str) else number(line.value)
    return [line.field, value, symbol_of(line.code), line.source.text if line.source else ""]


# --- Refusals ---------------------------------------------------------------------------------------------------------


def _refusal(error: ValidationError | InputError) -> str:
    """Faults of an application, each with its place and the name and unit of that input."""
    lines = [
        f"{(pointer(at) or '/')[:MOST_REPEATED]}{_name_of(at)}: {text[:MOST_REPEATED]}"
        for at, text, _ in faults_of(error)
    ]
    return "\n".join((ASK, *shortened(lines, MOST_FAULTS)))


def _name_of(location: Location) -> str:
    """Name of an input with its unit, in parentheses; blank where the place has none."""
    names = [part for part in location if isinstance(part, str)]
    path = ".".join(names).replace("duty_cycle.phases.", "phase.")
    named = INPUTS.get(path)
    return f" ({', '.join(filter(None, (named.name, symbol_of(path))))})" if named else ""

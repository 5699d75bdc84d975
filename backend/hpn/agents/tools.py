"""The three tools: arguments in, a short text of JSON out, or a refusal that says what to ask the user for."""

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
from hpn.engine.selection import judge
from hpn.links.writer import to_link
from hpn.words.quantities import INPUTS
from hpn.words.units import symbol_of

MOST_FAULTS = 8
MOST_REPEATED = 160
"""Characters of a place or text in a refusal, which may be the caller's own."""

ASK = "Nothing was calculated. Ask the user for what is lacking or wrong here, and make nothing up:"


class ToolReply(NamedTuple):
    """Text of an answer; a refusal says what is to be asked for."""

    text: str
    is_refusal: bool = False

    @classmethod
    def refusal(cls, text: str) -> "ToolReply":
        """A refusal, which may repeat what no text can hold."""
        return cls(text.encode(errors="replace").decode(), True)


class _RefusedError(ValueError):
    """Arguments that a tool can't use, with the reason."""


def answer(tool: str, arguments: Mapping[str, Any], catalogue: Catalogue, service: str) -> ToolReply:
    """Answer of a tool; `service` is the address that links lead to, without a slash at its end."""
    try:
        _require_known(tool, arguments)
        if tool == "catalogue":
            return ToolReply(within(_catalogue(arguments.get("designation"), catalogue, service)))
        application = Application.model_validate(arguments.get("application"))
        designation = arguments.get("designation") if tool == "explain" else None
        return ToolReply(within(_judged(application, designation, catalogue, service)))
    except _RefusedError as error:
        return ToolReply.refusal(str(error))
    except (ValidationError, InputError) as error:
        return ToolReply.refusal(_told(error))


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


def _judged(application: Application, designation: str | None, catalogue: Catalogue, service: str) -> dict[str, Any]:
    judged = judge(application, catalogue)
    selection = judged.selection(to_link)
    candidate = selection.foremost
    if designation is not None:
        name = _gear(designation, catalogue)
        left_out = () if selection.candidate(name) else judged.left_out()
        candidate = selection.candidate(name) or next(one for one in left_out if one.designation == name)
    return brief(Account(selection, candidate, application, catalogue), service, explained=designation is not None)


def _gear(designation: str, catalogue: Catalogue) -> str:
    """Designation as the catalogue has it."""
    found = catalogue.find(designation)
    if found is None:
        gears = ", ".join(catalogue.by_designation)
        text = f"the catalogue has no gear {designation[:MOST_REPEATED]!r}; there are {gears}"
        raise _RefusedError(text)
    return found.designation


def _catalogue(designation: str | None, catalogue: Catalogue, service: str) -> dict[str, Any]:
    """Every gear, or the figures of one."""
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
        "not_published": [_field(line) for line in published(gear) if line.value is None],
        "link": f"{service}/catalogue/{gear.designation}",
        "versions": versions,
    }


def _row(line: Line) -> list[Any]:
    value = line.value if isinstance(line.value, str) else number(line.value)
    return [_field(line), value, symbol_of(line.code), line.source.text if line.source else ""]


def _field(line: Line) -> str:
    return line.code.removeprefix("gear.")


# --- Refusals ---------------------------------------------------------------------------------------------------------


def _told(error: ValidationError | InputError) -> str:
    """Faults of an application, each with its place and the name and unit of what belongs there."""
    faults = faults_of(error)
    lines = [
        f"{(pointer(at) or '/')[:MOST_REPEATED]}{_named(at)}: {text[:MOST_REPEATED]}"
        for at, text, _ in faults[:MOST_FAULTS]
    ]
    more = [f"and {len(faults) - MOST_FAULTS} more"] if len(faults) > MOST_FAULTS else []
    return "\n".join((ASK, *lines, *more))


def _named(location: Location) -> str:
    """Name of an input with its unit, in parentheses; blank where the place has none."""
    names = [part for part in location if isinstance(part, str)]
    path = ".".join(names).replace("duty_cycle.phases.", "phase.")
    named = INPUTS.get(path)
    return f" ({', '.join(filter(None, (named.name, symbol_of(path))))})" if named else ""

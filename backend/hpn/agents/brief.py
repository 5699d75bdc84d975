"""Selection in brief for an agent: a few thousand characters, from the account that pages show."""

import json
from collections.abc import Mapping
from typing import Any

from hpn.account.account import Account, CheckLine
from hpn.engine.candidates import Candidate, reason_of
from hpn.engine.remedy import remedy_of
from hpn.engine.tolerance_words import tolerance_of
from hpn.engine.tried import needed_of
from hpn.words.quantities import DUTY
from hpn.words.reader import Reader
from hpn.words.wording import Sentence

DIGITS = 6
"""Significant digits of a number; the link and POST /api/v1/select have all digits."""

MOST_BYTES = 3900
"""Most bytes of an answer in transport: a string of JSON in ASCII, with its quotes escaped."""
MOST_LINK = 1000
LONG_LINK = "longer than an answer: POST the application to /api/v1/selections and share the address of what is saved"
MOST_NEXT, MOST_NOTICES = 4, 8
SPARE = ("figures", "notices", "next", "duty", "not_published", "fits_if", "over_tolerance")
"""Parts to leave out of a too long answer, the first one first; lists lose an item at a time."""

UNLIMITED = "unlimited"
ENGLISH = Reader("en")


def brief(account: Account, service: str, *, explained: bool) -> dict[str, Any]:
    """Decision, limits with their sources, next gears and link; for an explained gear also the changes to fit it."""
    selection, candidate = account.selection, account.candidate
    return {
        "selected": selection.selected,
        "gear": candidate.designation,
        "status": candidate.status,
        "reason": reason_of(candidate, account.utilisation).text,
        **_sentences(account, explained),
        "limits": _limits(account),
        "duty": {name: number(getattr(selection.duty, name)) for name in DUTY},
        "figures": {line.field: number(line.value) for line in account.figures if isinstance(line.value, float)},
        "next": [_beside(one) for one in selection.candidates if one is not candidate][:MOST_NEXT],
        "notices": [notice.text for notice in selection.notices][:MOST_NOTICES],
        **({"left_out": ["notices"]} if len(selection.notices) > MOST_NOTICES else {}),
        "link": link if len(link := service + selection.link) <= MOST_LINK else LONG_LINK,
        "versions": {"engine": selection.engine_version, "catalogue": selection.catalogue_version},
    }


def _sentences(account: Account, explained: bool) -> dict[str, Any]:
    """Missing figures of a gear, its remedy, and its verdict over the tolerances, as far as there are any."""
    candidate = account.candidate
    sentences: dict[str, Sentence | None] = {"over_tolerance": tolerance_of(candidate)}
    if explained and account.application is not None and account.catalogue is not None:
        sentences["fits_if"] = remedy_of(candidate, needed_of(candidate, account.application, account.catalogue))
    missing = {"ask_for": list(candidate.missing)} if candidate.missing else {}
    return missing | {name: sentence.text for name, sentence in sentences.items() if sentence}


def _limits(account: Account) -> dict[str, Any]:
    """Row for each check: demand, relation, limit, unit, utilisation, status and source."""
    columns = ["check", "demand", "is", "limit", "unit", "utilisation", "status", "source"]
    return {"columns": columns, "rows": [_row(check) for check in account.checks]}


def _row(check: CheckLine) -> list[Any]:
    reading, result = check.reading, check.result
    demand = UNLIMITED if reading.has_unlimited_demand else number(reading.demand)
    limit = UNLIMITED if reading.has_unlimited_limit else number(reading.limit)
    sign = "?" if result.status == "not_rated" else reading.actual_sign(result.status == "fail")
    used = number(result.utilisation)
    return [check.definition.title, demand, sign, limit, reading.unit, used, result.status, check.where(ENGLISH)]


def _beside(candidate: Candidate) -> dict[str, Any]:
    return {
        "gear": candidate.designation,
        "status": candidate.status,
        "utilisation": number(candidate.utilisation),
        "governing_check": candidate.governing_check,
    }


def number(value: object) -> float | None:
    """Number with DIGITS digits; None for any other value."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, int | float) else None


def encoded(value: object) -> str:
    """JSON without blanks, in characters that are not escaped."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("\N{NARROW NO-BREAK SPACE}", " ")


def within(reply: Mapping[str, Any]) -> str:
    """Text of a reply within MOST_BYTES; it names the parts left out."""
    rest, left = dict(reply), list[str](reply.get("left_out", ()))
    for name in SPARE:
        while name in rest and len(json.dumps(encoded(rest))) > MOST_BYTES:
            if isinstance(rest[name], list) and len(rest[name]) > 1:
                rest[name] = rest[name][:-1]
            else:
                del rest[name]
            left = [*left, name] if name not in left else left
            rest["left_out"] = left
    return encoded(rest)

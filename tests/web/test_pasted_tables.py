"""Tables as people paste them: each has its phases, questions or reason for refusal; none is silently wrong."""

import re
import tomllib
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from starlette.testclient import TestClient

from tests.web.paste import ASKED

Case = dict[str, Any]

FILE = Path(__file__).parent / "pasted/tables.toml"
GROUPS: dict[str, dict[str, Case]] = tomllib.loads(FILE.read_text("utf-8"))
CASES = [pytest.param(case, id=f"{group}: {name}") for group, cases in GROUPS.items() for name, case in cases.items()]
SYMBOLS = ("T", "n", "t", "FRi", "FAi", "Tpk", "npk", "Trms", "Tlo")


def outcome(client: TestClient, case: Case, chosen: dict[str, str]) -> tuple[str, str | list[str]]:
    """Outcome of a table: `becomes` and phases, `asks` and questions, or `refused` and the reason."""
    fields = {"take": "replace", **chosen}
    content = case["text"].encode(case["as"]) if "as" in case else b""
    files = {"file": ("cycle.csv", content)} if "as" in case else None
    fields |= {} if files else {"text": case["text"]}
    reply = client.post("/paste", data=fields, files=files, headers={"Cookie": f"hpn_units={case.get('reader', '')}"})
    assert reply.status_code in (200, 303, 422)
    if reply.status_code == 303:
        return "becomes", phases(reply.headers["location"])
    values = [unescape(text) for text in ASKED.findall(reply.text) for text in text]
    if reply.status_code == 422:
        return "refused", "".join(values)
    return "asks", list(filter(None, values))


def phases(location: str) -> str:
    inputs = parse_qs(urlsplit(location).query, keep_blank_values=True)
    values = [name for name in SYMBOLS if name in inputs and (name != "Tlo" or any(inputs[name]))]
    rows = zip(*(inputs[name] for name in values), strict=True)
    figures = "; ".join(" ".join(cell or "-" for cell in row) for row in rows)
    return f"{figures} named {'; '.join(inputs['pn'])}" if "pn" in inputs else figures


def judge(found: tuple[str, str | list[str]], wanted: dict[str, str]) -> None:
    kind, message = found
    assert kind in wanted, (kind, message)
    if kind == "becomes":
        assert message == wanted[kind]
    elif kind == "refused":
        assert wanted[kind] in message
    else:
        parts = wanted[kind].split("; ")
        assert len(parts) == len(message), message
        assert all(part in question for part, question in zip(parts, message, strict=True)), message


@pytest.mark.parametrize("case", CASES)
def test_pasted_table_becomes_what_it_says_or_is_asked_about_or_refused(client: TestClient, case: Case) -> None:
    by_name = {str(kind): case[kind] for kind in ("becomes", "asks", "refused") if kind in case}
    judge(outcome(client, case, {}), by_name)
    if "chosen" in case:
        then = outcome(client, case, {**case["chosen"], "of": of_table(client, case)})
        after = {"then": "becomes", "asks_then": "asks", "refused_then": "refused"}
        judge(then, {kind: case[name] for name, kind in after.items() if name in case})


def test_choices_about_one_table_say_nothing_about_another(client: TestClient) -> None:
    case: Case = {"text": "1.234\t250\t3"}
    chosen = {"decimal": ".", "of": of_table(client, case)}
    assert outcome(client, case, chosen) == ("becomes", "1.234 250 3")
    assert outcome(client, {"text": "1.235\t250\t3"}, chosen)[0] == "asks"


def of_table(client: TestClient, case: Case) -> str:
    """Digest from a table's preview, which the choices about the table belong to."""
    reply = client.post(
        "/paste", data={"text": case["text"]}, headers={"Cookie": f"hpn_units={case.get('reader', '')}"}
    )
    match = re.search(r'name="of" value="(\w+)"', reply.text)
    assert match, reply.text
    return match[1]


def test_there_are_at_least_150_tables_and_twelve_each_in_french_and_italian() -> None:
    assert len(CASES) >= 150
    assert min(len(GROUPS[language]) for language in ("french", "italian")) >= 12

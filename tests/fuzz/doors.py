"""The doors: what is sent through each, and what its answer must be like."""

import hashlib
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from random import Random
from urllib.parse import quote, urlencode
from zipfile import ZipFile

import msgspec
import pyarrow.parquet as pq
from pydantic import SecretStr

from hpn.application import Application, InputError
from hpn.catalogue import CatalogueError, load_catalogue
from hpn.catalogue.tables import TABLES
from hpn.engine.selection import encode, select
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.cycles import LAST, PARTS, PHASE, SEPARATOR, TOTALS
from hpn.tables.files import tidied
from hpn.tables.inputs import CYCLE, Inputs
from hpn.tables.interpreter import DECIMAL, SCALES, TIMES
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.fuzz import corpus
from tests.fuzz.caller import Caller, Header, Reply

LONGEST_ADDRESS = 65_000
"""A little more than a link may have, and less than no server takes."""

FORM = (b"content-type", b"application/x-www-form-urlencoded")
JSON = (b"content-type", b"application/json")
LINES = (b"content-type", b"application/x-ndjson")
PACKAGE = (b"content-type", b"application/asset-administration-shell-package")
FILE = (b"content-type", b"multipart/form-data; boundary=boundary")
EDIT = ((b"hx-request", b"true"), (b"hx-target", b"section#result"))
READERS: tuple[tuple[Header, ...], ...] = ((), ((b"cookie", b"hpn_language=de; hpn_units=lb_in.lbf"),))
_ON_THE_WIRE = "".join(map(chr, range(0x21, 0x7F)))
"""Characters that a server lets through in an address; the rest is percent-encoded."""

EVERY_CHOICE = (SEPARATOR, PHASE, DECIMAL, SCALES, TIMES, LAST, TOTALS, PARTS)
"""Choices that a table may leave."""


class World:
    """Targets of the inputs: the service on a database of its own, and a small catalogue to lay supplements over."""

    def __init__(self, folder: Path) -> None:
        self.app = create_app(Settings(database_url=SecretStr(f"sqlite:///{folder}/fuzz.sqlite3"), log_level="error"))
        self.call = Caller(self.app)
        self.handbook, self.supplement, self.fleet = (folder / name for name in ("catalogue", "supplement", "fleet"))
        for place in (self.handbook, self.supplement, self.fleet):
            place.mkdir()
        for name, content in corpus.small_catalogue():
            (self.handbook / name).write_text(content, encoding="utf-8")

    @classmethod
    @asynccontextmanager
    async def opened(cls, folder: Path) -> "AsyncIterator[World]":
        """A world whose service runs."""
        world = cls(folder)
        async with world.app.router.lifespan_context(world.app):
            yield world


Send = Callable[[World, Random, bytes], Awaitable[str]]
"""Sends an input, and gives what was answered in a word; raises AssertionError for what must not be answered."""


@dataclass(frozen=True)
class Door:
    """One way in: valid inputs, the names and marks of their format, and how an input is sent."""

    send: Send
    corpus: Sequence[bytes]
    words: Sequence[bytes]


def judged(reply: Reply, *, api: bool) -> str:
    """Status of an answer that is well-formed: no server error, JSON that can be read, problems with their members."""
    assert reply.status < 500, f"answered with {reply.status}: {reply.body[:300]!r}"
    if reply.media_type.endswith("json"):
        answered = msgspec.json.decode(reply.body)
        if reply.status >= 400:
            assert {"type", "title", "status", "detail"} <= answered.keys(), f"no problem: {reply.body[:300]!r}"
    else:
        reply.body.decode()
    if api and reply.status >= 400:
        assert reply.media_type == "application/problem+json", f"{reply.status} as {reply.media_type}"
    return str(reply.status)


async def _link(world: World, random: Random, content: bytes) -> str:
    query = quote(content, safe=_ON_THE_WIRE).encode()[:LONGEST_ADDRESS]
    path = random.choice(("/", "/", "/paste", *["/cycle.csv"] * 4, *["/application.json"] * 8))
    headers = [*random.choice(READERS), *(() if random.random() < 0.2 else EDIT)] if path == "/" else []
    return judged(await world.call("GET", path, query=query, headers=headers), api=False)


async def _form(world: World, random: Random, content: bytes) -> str:
    headers = [FORM, *random.choice(READERS), *(() if random.random() < 0.1 else EDIT)]
    return judged(await world.call("POST", "/", headers=headers, body=content), api=False)


async def _paste(world: World, random: Random, content: bytes) -> str:
    text = tidied(content.decode(errors="replace"))
    fields = {"text": content, "link": random.choice(corpus.LINKS[:2]), "take": random.choice(_TAKES)}
    fields |= _answers(random, text, CYCLE) if random.random() < 0.7 else {}
    headers = [FORM, *random.choice(READERS), EDIT[0]]
    return judged(await world.call("POST", "/paste", headers=headers, body=urlencode(fields).encode()), api=False)


async def _axes(world: World, random: Random, content: bytes) -> str:
    answers = _answers(random, content.decode(errors="replace").strip(), AXIS_INPUTS)
    headers = [FORM, *random.choice(READERS)]
    body = urlencode({"text": content, **answers}).encode()
    return judged(await world.call("POST", "/machines", headers=headers, body=body), api=False)


def _answers(random: Random, text: str, inputs: Inputs) -> dict[str, str]:
    """Answers to any question about a table, and what its columns are said to hold."""
    roles, codes = ("", "skip", "nothing", *inputs.by_role), ("", "cells", "Nm", "ms", "kg", "nothing")
    columns = range(random.choice((0, 0, random.randrange(9))))
    return {
        "of": hashlib.sha256(text.encode()).hexdigest()[:16],
        "rest": random.choice(("", "skip")),
        **{choice.name: random.choice(("", *choice.options)) for choice in EVERY_CHOICE},
        **{f"r{place}": random.choice(roles) for place in columns if random.random() < 0.5},
        **{f"u{place}": random.choice(codes) for place in columns if random.random() < 0.5},
    }


async def _upload(world: World, random: Random, content: bytes) -> str:
    parts = (
        b'name="link"\r\n\r\nT=1&n=1&t=1',
        b'name="take"\r\n\r\n' + random.choice(_TAKES).encode(),
        b'filename="duty.csv"; name="file"\r\n\r\n' + content,
    )
    body = b"".join(b"--boundary\r\nContent-Disposition: form-data; " + part + b"\r\n" for part in parts)
    reply = await world.call("POST", "/paste", headers=[FILE, EDIT[0]], body=body + b"--boundary--\r\n")
    return judged(reply, api=False)


_TAKES = ("", "", "", "", "", "", "append", "replace")


async def _lines(world: World, random: Random, content: bytes) -> str:
    reply = await world.call("POST", "/api/v1/select/batch", headers=[LINES], body=content)
    assert reply.status == 200, f"answered with {reply.status}"
    sent = [line for line in content.split(b"\n") if line.removeprefix(b"\xef\xbb\xbf").strip()]
    answers = [msgspec.json.decode(line) for line in reply.body.splitlines()]
    assert len(answers) == len(sent), f"{len(answers)} answers to {len(sent)} lines"
    assert all(answer["problem"]["status"] < 500 for answer in answers if answer["status"] == "error")
    return "ok" if any(answer["status"] == "ok" for answer in answers) else "error"


async def _json(world: World, random: Random, content: bytes) -> str:
    path = "/api/v1/select"
    if b'"applications"' in content:
        path = "/api/v1/select/batch"
    elif b'"application"' in content:
        path = "/api/v1/selections"
    return judged(await world.call("POST", path, headers=[JSON], body=content), api=True)


async def _machine(world: World, random: Random, content: bytes) -> str:
    """Save a machine, read it, and change it or its first axis by what stands in it."""
    path = "/api/v1/machines"
    saved = await world.call("POST", path, headers=[JSON], body=content)
    path = f"{path}/{msgspec.json.decode(saved.body)['id'] if saved.status == 201 else 'A' * 22}"
    for place in (path, f"{path}/gears", f"{path}/axes/1", f"{path}/axes/1/selection"):
        judged(await world.call("GET", place), api=True)
    body = random.choice((content, b'{"common": ' + content + b"}", b'{"application": ' + content + b"}"))
    judged(await world.call("PATCH", path + random.choice(("", "/axes/1")), headers=[JSON], body=body), api=True)
    return judged(saved, api=True)


async def _pairs(world: World, random: Random, content: bytes) -> str:
    """Ask for pairs, or keep a list of motors, read it and ask for pairs with it."""
    path = "/api/v1/pairs" + random.choice(("", "?failing=1"))
    if b'"application"' in content:
        return judged(await world.call("POST", path, headers=[JSON], body=content), api=True)
    saved = await world.call("POST", "/api/v1/motor-lists", headers=[JSON], body=content)
    if saved.status != 201:
        return judged(saved, api=True)
    id = msgspec.json.decode(saved.body)["id"]
    judged(await world.call("GET", f"/api/v1/motor-lists/{id}"), api=True)
    question = msgspec.json.encode({"application": corpus.APPLICATIONS[-1 - random.randrange(5)], "list": id})
    judged(await world.call("POST", path, headers=[JSON], body=question), api=True)
    return judged(await world.call("DELETE", f"/api/v1/motor-lists/{id}"), api=True)


_QUESTIONS = [Application.model_validate(entry) for entry in corpus.APPLICATIONS[1:3]]
_QUESTIONS.append(
    Application.model_validate(corpus.APPLICATIONS[0] | {"output_load": {"radial_N": 9, "model": "digitised"}})
)


async def _supplement(world: World, random: Random, content: bytes) -> str:
    """Lay one file over the small catalogue; what is accepted must answer every question that can be asked of it."""
    name, _, text = content.partition(b"\n")
    file = world.supplement / (name.decode("latin-1") if name in _FILES else "ratings.csv")
    file.write_bytes(text)
    try:
        catalogue = load_catalogue(world.handbook, world.supplement)
    except CatalogueError as refusal:
        assert str(file) in str(refusal) or str(world.handbook) in str(refusal), f"names no file: {refusal}"
        return "refused"
    finally:
        file.unlink()
    for question in _QUESTIONS:
        with suppress(InputError):  # a supplement may take a size or a curve away
            encode(select(question, catalogue))
    return "accepted"


async def _sizing(world: World, random: Random, content: bytes) -> str:
    """Open a package with a broken environment beside a whole course."""
    course = random.choice((b"Time,AngularVelocity\n0,0\n1,9\n", b"Time,LinearVelocity\n0,0\n1,0.5\n2,0\n"))
    with BytesIO() as output:
        with ZipFile(output, "w") as package:
            package.writestr("aasx/data.json", content)
            package.writestr("aasx/a.csv", course)
        body = output.getvalue()
    return judged(await world.call("POST", "/api/v1/sizing", headers=[PACKAGE], body=body), api=True)


_FILES = {table.file.encode() for table in TABLES}


async def _fleet(world: World, random: Random, content: bytes) -> str:
    """Size a fleet as the command does, in this process; each axis gets figures or an error."""
    (path := world.fleet / "input.csv").write_bytes(content)
    order = Order(path, world.fleet / "answers.parquet", rejected=world.fleet / "rejected.parquet")
    try:
        size_fleet(order, world.app.state.catalogue)
    except FleetError as refusal:
        assert str(world.fleet) in str(refusal), f"names no file: {refusal}"
        return "refused"
    rows = pq.read_table(order.answers).to_pylist()
    assert all((row["error"] is None) == (row["average_torque_Nm"] is not None) for row in rows)
    return "sized" if any(row["error"] is None for row in rows) else "rejected"


DOORS = {
    "link": Door(_link, corpus.LINKS, corpus.SYMBOLS),
    "form": Door(_form, corpus.FORMS, corpus.SYMBOLS),
    "paste": Door(_paste, corpus.TABLES_OF_PHASES, corpus.HEADINGS),
    "axes": Door(_axes, corpus.TABLES_OF_AXES, corpus.HEADINGS),
    "csv": Door(_upload, corpus.TABLES_OF_PHASES, corpus.HEADINGS),
    "xlsx": Door(_upload, corpus.WORKBOOKS, corpus.HEADINGS),
    "ndjson": Door(_lines, corpus.LINES, corpus.MARKS),
    "supplement": Door(_supplement, corpus.SUPPLEMENTS, corpus.COLUMNS),
    "fleet": Door(_fleet, corpus.FLEETS, corpus.FLEET_COLUMNS),
    "pairs": Door(_pairs, corpus.PAIRS, corpus.MARKS),
    "sizing": Door(_sizing, corpus.SIZINGS, corpus.MEANINGS),
    "machine": Door(_machine, corpus.MACHINES, corpus.MARKS),
    "json": Door(_json, (*corpus.JSON, *corpus.JSON, *corpus.BATCHES, *corpus.SAVES), corpus.MARKS),
}

"""Form for a table on the pages of machines and motor lists: its content, and the table read or refused."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

from starlette.requests import Request
from starlette.responses import Response

from hpn.store import StoreUnavailableError
from hpn.tables.files import packed, unpacked
from hpn.tables.reading import Reading
from hpn.tables.table import Table
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.pages.rendering import page
from hpn.words.wording import N_, Sentence

NOTHING = N_("choose a file or paste cells into the field")


@dataclass(frozen=True, slots=True, kw_only=True)
class TableUpload:
    """State of the form: the given text, its reading, and its problems.

    `of` identifies the table that the choices belong to; `carried` is the table itself, for a form that can't send its
    file again.
    """

    text: str = ""
    problems: tuple[Sentence, ...] = ()
    table: Table | None = None
    of: str = ""
    carried: str = ""
    sheets: tuple[str, ...] = ()
    sheet: str = ""

    def as_read(self, content: bytes | str, reading: Reading) -> Self:
        """State with a table that was read."""
        whole = content.encode() if isinstance(content, str) else content
        return replace(
            self,
            table=reading.table,
            of=reading.of,
            carried=packed(whole) if reading.sheets else "",
            sheets=reading.sheets,
            sheet=reading.sheet,
        )

    def refused(self, *problems: Sentence) -> Self:
        """State with problems."""
        return replace(self, problems=problems)


async def content_of(request: Request, parts: Mapping[str, bytes], text: bytes | str) -> bytes | str:
    """File of a form, else its text, else its carried table; blank for a form without any."""
    content = parts.get("file") or text.strip()
    return content or await compute(request, "pages", unpacked, parts.get("table", b""))


async def show_form(
    request: Request,
    template: str,
    draft: TableUpload,
    error: Problem | StoreUnavailableError | None = None,
    unavailable: str = "",
    **values: Any,
) -> Response:
    """Page with the form, and the reason if the table was refused; `unavailable` is the text for a failing store."""
    status, headers = 422 if draft.problems else 200, dict[str, str]()
    if error is not None:
        problem = error if isinstance(error, Problem) else Problem.of(error)
        message = Sentence("{text}", {"text": problem.detail}) if error is problem else Sentence(unavailable)
        draft = draft.refused(*(problem.sentences or (message,)))
        status, headers = problem.status_code, dict(problem.headers or {})
    response = await compute(request, "pages", page, request, template, status, draft=draft, **values)
    response.headers.update(headers)
    return response

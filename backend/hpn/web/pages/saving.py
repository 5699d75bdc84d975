"""Saving of the live page's selection, and the page with the reason why a selection can't be saved or shown."""

import hashlib
import re
from dataclasses import dataclass
from urllib.parse import urlencode

import orjson
from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.application import InputError
from hpn.catalogue import Catalogue
from hpn.links.labels import FIELDS, TITLE_BLOCK, query_of
from hpn.store import Draft, StoreUnavailableError
from hpn.web.archive import Labels, draft_of, keep, url_of
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form import link_reader
from hpn.web.form.form import Form
from hpn.web.form.linked import query_part
from hpn.web.form.query import Pairs
from hpn.web.pages import calculator
from hpn.web.pages.calculator import LiveResult
from hpn.web.pages.rendering import reason
from hpn.words.wording import N_

REASON = "selection_refused.html"
"""Page with the reason why a selection can't be saved or shown."""

ONCE = re.compile(r"[A-Za-z0-9_-]{22}")


@dataclass(frozen=True, slots=True)
class SaveForm:
    """Content of a form that saves, and the key that saves it once, however often it is sent."""

    pairs: Pairs
    once: str
    form: Form

    @property
    def key(self) -> str | None:
        """Idempotency key: a form sent twice saves once, an edited form saves another selection.

        The blank distinguishes it from the keys of API callers.
        """
        if ONCE.fullmatch(self.once) is None:
            return None
        return f"form {self.once} {hashlib.sha256(orjson.dumps(self.pairs)).hexdigest()[:32]}"

    @property
    def link(self) -> str:
        """Address of the form's content without the title block."""
        return "/?" + urlencode([pair for pair in self.pairs if pair[0] not in TITLE_BLOCK])

    @property
    def address(self) -> str:
        """Address of the live page with the form's whole content; the start page if that is too long."""
        whole = self.link + query_of({name: self.form.labels[name] for name in TITLE_BLOCK})
        return whole if len(whole) <= MAXIMUM_QUERY_BYTES else "/"


async def save_from_page(request: Request) -> Response:
    """Save the selection of the live page, and redirect to the page of the saved selection."""
    require_same_origin(request)
    body = await read_form(request)
    save = await compute(request, "pages", _read_form, body)
    try:
        owner, catalogue = request.state.api_key, request.app.state.catalogue
        draft = await compute(request, "pages", _draft, save, catalogue, owner)
        return RedirectResponse(url_of(await keep(request, draft)), 303)
    except (InputError, StoreUnavailableError) as error:
        problem = Problem.of(error)
    except Problem as error:
        problem = error
    return await compute(request, "pages", _refusal_page, request, problem, save)


def _read_form(body: bytes) -> SaveForm:
    """Fields of the form; `link` adds those of an address that the form itself lacks."""
    fields = pairs_of(body)
    named = dict(fields)
    own = [(name, text) for name, text in fields if name not in ("link", "once")]
    names = {name for name, _ in own}
    linked = pairs_of(query_part(named.get("link", "")))
    pairs = [*own, *(pair for pair in linked if pair[0] not in names)]
    return SaveForm(pairs, named.get("once", ""), link_reader.parse(pairs))


def _draft(save: SaveForm, catalogue: Catalogue, owner: str | None) -> Draft:
    form, answer = calculator.form_and_answer(save.form, catalogue)
    if answer is None:
        errors = [((problem.name,), problem.message.text) for problem in form.problems]
        raise Problem(422, N_("the inputs have errors: correct them on the page, then save"), errors)
    values = {field: form.labels[name] for name, field in FIELDS.items()}
    labels = Labels(**values, ordering_code=_code(form, answer))
    return draft_of(catalogue, answer.application, labels, save.key, owner)


def _code(form: Form, answer: LiveResult) -> str | None:
    """Ordering code as the page shows it; None for an unsuitable gear that the reader has not chosen."""
    if answer.order.problem:
        raise Problem(422, answer.order.problem, [(("order_motor",), answer.order.problem)])
    chosen = form.gear or answer.selection.selected or any(answer.order.labels.values())
    return answer.order.text if chosen else None


def _refusal_page(request: Request, problem: Problem, save: SaveForm) -> Response:
    """Page with the reason, which keeps the typed inputs."""
    is_spent = problem.status_code == 410  # saving it again is then deliberate
    once_more = calculator.once_key() if is_spent else save.once
    return reason(request, REASON, problem, posted=save, form=save.form, once_more=once_more)


router = APIRouter(include_in_schema=False)
router.add_api_route("/selections", save_from_page, methods=["POST"], dependencies=[admit("writing")])

"""Whole requests of the OpenAPI document, with the answers that this very service gives them."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from hpn.application import WORKED_EXAMPLE, Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.web.api.batch import batch_lines
from hpn.web.api.catalogue import one_gear
from hpn.web.api.replies import BatchReply, encode
from hpn.web.api.samples import WHOLE, Json, envelopes, plain, refusal
from hpn.web.api.schemas import LINES
from hpn.web.door.problems import MEDIA_TYPE
from hpn.web.form.link_writer import to_link

SUMMARIES = {
    "worked_example": "The handbook’s worked example",
    "no_duration": "The same with a first phase of 0 s",
    "two_lines": "Two axes, one of them without a duty cycle",
    "first_gear": "The smallest gear",
    "first_size": "The smallest size at the published condition",
}
"""Summary of each example, by its name."""


class Exchange(NamedTuple):
    """An answer, and what is asked for it: values of parameters, lines, or else the example of the JSON body."""

    name: str
    answer: Any
    status: int = 200
    media_type: str = "application/json"
    parameters: Mapping[str, str] = {}
    lines: str = ""


def exchanges(catalogue: Catalogue) -> dict[str, list[Exchange]]:
    """Exchanges by operation; those alone that this catalogue allows."""
    gear = catalogue.gears[0]
    published = envelopes(catalogue, gear.size)
    axes: list[Json] = [*WHOLE["Batch"]["applications"], {"reference": "axis-8"}]
    answered = batch_lines(axes, catalogue)
    return {
        "select": _of_worked_example(catalogue),
        "selectBatch": [
            Exchange("worked_example", plain(BatchReply(answered[:1]))),
            Exchange("two_lines", _lines(answered), media_type=LINES, lines=_lines(axes)),
        ],
        "getGear": [
            Exchange("first_gear", plain(one_gear(gear, catalogue)), parameters={"designation": gear.designation})
        ],
        "getBearingEnvelopes": [Exchange("first_size", published, parameters={"size": gear.size})]
        if published["curves"]
        else [],
    }


def _of_worked_example(catalogue: Catalogue) -> list[Exchange]:
    refused = Exchange("no_duration", refusal().body(), 422, MEDIA_TYPE)
    application = Application.model_validate(WORKED_EXAMPLE)
    try:
        selection = select(application, catalogue, to_link(application))
    except InputError:  # a catalogue without its ratio
        return [refused]
    return [Exchange("worked_example", plain(selection)), refused]


def _lines(values: Sequence[Any]) -> str:
    return "".join(encode(value).decode() + "\n" for value in values)

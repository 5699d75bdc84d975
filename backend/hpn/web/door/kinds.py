"""Kinds of problems by the name at the end of their `type`: meaning, cause and remedy of each."""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.words.wording import N_

PATH = "/problems/"


@dataclass(frozen=True, slots=True)
class Kind:
    """Kind of problem: its HTTP status, its title in English, and texts for its page."""

    status: int
    title: str
    cause: str
    remedy: str


KINDS: Mapping[str, Kind] = {
    "unreadable-request": Kind(
        400,
        N_("The request can’t be read"),
        N_("The body is not the JSON, form or file that its content type says, or the request itself is broken."),
        N_("Send what the API’s document describes; the detail names the place where reading stopped."),
    ),
    "api-key-needed": Kind(
        401,
        N_("An API key is needed"),
        N_("This service requires an API key here, and none was sent."),
        N_("Send a key of this service as X-API-Key, as a Bearer token, or as the password of Basic authentication."),
    ),
    "api-key-unknown": Kind(
        401,
        N_("The API key is unknown"),
        N_("A key was sent, but it is none of this service: it is mistyped or cut off, or has been withdrawn."),
        N_("Compare it with the key that you were given, which begins with hpn_, or ask the operator for a new one."),
    ),
    "not-allowed": Kind(
        403,
        N_("Not allowed"),
        N_("It belongs to another key than the one that was sent, or none was sent; or a form came from another site."),
        N_("Use the key that saved it or an administrator’s, or send the form from this service’s own page."),
    ),
    "not-found": Kind(
        404,
        N_("Not found"),
        N_("There is nothing at this address: part of it is mistyped, or the content has been deleted."),
        N_("Check the address; the lists of gears and of saved selections show what there is."),
    ),
    "method-not-allowed": Kind(
        405,
        N_("Method not allowed"),
        N_("The address exists, but not with this method."),
        N_("Use one of the methods in the header Allow."),
    ),
    "too-slow": Kind(
        408,
        N_("The request took too long to arrive"),
        N_("A part of the request did not arrive in time."),
        N_("Send it again, faster or in smaller parts."),
    ),
    "conflict": Kind(
        409,
        N_("In conflict with the present state"),
        N_("The request does not fit the present state."),
        N_("Read the present state and decide again."),
    ),
    "gone": Kind(
        410,
        N_("No longer there"),
        N_("It existed and was deleted, or this way of asking for it has been withdrawn."),
        N_("Use the replacement that the detail names."),
    ),
    "idempotency-key-spent": Kind(
        410,
        N_("The idempotency key is used up"),
        N_("The selection saved under this Idempotency-Key has been deleted."),
        N_("Send another key to save it anew."),
    ),
    "other-state": Kind(
        412,
        N_("Precondition failed"),
        N_("If-Match names another version: it has been changed since it was read."),
        N_("Read it again, and repeat the change with its new ETag."),
    ),
    "too-large": Kind(
        413,
        N_("The request is too large"),
        N_("The body, or its unpacked content, is larger than the service accepts at once."),
        N_("Send less at once; the detail gives the limit."),
    ),
    "address-too-long": Kind(
        414,
        N_("The address is too long"),
        N_("A link holds some 1,400 phases; this one has more."),
        N_("Send the application in the body, or save it and share the address of the saved selection."),
    ),
    "unsupported-type": Kind(
        415,
        N_("The content type or coding is not supported"),
        N_("The content type or coding of the body is not supported here."),
        N_("Send one of those that the detail names."),
    ),
    "other-host": Kind(
        421,
        N_("Not the host of this service"),
        N_("The request names a host for which this service does not answer."),
        N_("Use the address at which it is published, or add the name to HPN_ALLOWED_HOSTS."),
    ),
    "input-errors": Kind(
        422,
        N_("The input has errors"),
        N_("The input could be read, but part of it can’t be calculated."),
        N_("Each entry of errors names a field by its JSON pointer, a code and the correction."),
    ),
    "idempotency-key-reused": Kind(
        422,
        N_("The idempotency key was used for another request"),
        N_("An Idempotency-Key belongs to one request; this one was sent before with another body."),
        N_("Send a new key with a new request, and the same body when a request is repeated."),
    ),
    "condition-needed": Kind(
        428,
        N_("A condition is needed"),
        N_("This change is about much at once, and the request does not say which state it was made for."),
        N_("Read the machine, and send its ETag as If-Match."),
    ),
    "too-many-requests": Kind(
        429,
        N_("Too many requests"),
        N_("This key or address has sent more than its share."),
        N_("Wait for the time given by Retry-After."),
    ),
    "head-too-large": Kind(
        431,
        N_("The head of the request is too large"),
        N_("The address and headers together are too long."),
        N_("Send fewer or shorter headers."),
    ),
    "internal-error": Kind(
        500,
        N_("Internal error"),
        N_("The service failed; its log has the cause under the request’s id."),
        N_("Tell the operator the X-Request-ID of the answer."),
    ),
    "not-installed": Kind(
        501,
        N_("Not installed here"),
        N_("This service was installed without the part that this needs."),
        N_("Tell the operator the extra that the detail names."),
    ),
    "unavailable": Kind(
        503,
        N_("Temporarily unavailable"),
        N_("The service, its database or its folder for files is full or busy at the moment."),
        N_("Try again after the time given by Retry-After."),
    ),
}

OF_STATUS: Mapping[int, str] = {kind.status: name for name, kind in reversed(list(KINDS.items()))}
"""Kind of a status where nothing more is known: the first in KINDS."""

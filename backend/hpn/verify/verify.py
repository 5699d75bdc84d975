"""Verification of any file that the product writes."""

import json
from collections.abc import Mapping
from typing import Any

from hpn.catalogue import Catalogue
from hpn.verify import replies
from hpn.verify.paper import PACKAGE, PDF, WORKBOOK, Format, verified
from hpn.verify.shown import FileSubject, UnreadableFileError
from hpn.verify.verdict import Verdict

WORKBOOK_PART, PACKAGE_PART = b"xl/workbook.xml", b"aasx/"


def verify(content: bytes, catalogue: Catalogue, question: FileSubject | None = None) -> Verdict:
    """Verdict on a file; raises UnreadableFileError for a file that the product has not written."""
    form = _format_of(content)
    if form is not None:
        return verified(form, content, catalogue, question)
    return replies.verified(_object_of(content), catalogue)


def _format_of(content: bytes) -> Format | None:
    if content.startswith(b"%PDF-"):
        return PDF
    if content.startswith(b"PK"):
        return WORKBOOK if WORKBOOK_PART in content else PACKAGE
    return None


def _object_of(content: bytes) -> Mapping[str, Any]:
    try:
        value = json.loads(content)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, dict):
        raise UnreadableFileError("it is no report, workbook or package, and no JSON of a selection or machine")
    return value

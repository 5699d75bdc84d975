"""Parts that a file carries as JSON: application, answer, and its title block and reader.

Programs read them, and `hpn verify` makes the file again from them and compares. Report, workbook and package carry the
same parts.
"""

from collections.abc import Mapping
from datetime import UTC, date, datetime, time

import msgspec

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.kept import decode
from hpn.engine.selection import encode
from hpn.files.export import DIGITS, Export, ExportTitle
from hpn.words.reader import Reader

APPLICATION, RESULT, DOCUMENT = "application.json", "result.json", "document.json"


class CarriedTitle(msgspec.Struct, frozen=True):
    """Contents of a file besides application and answer: link, title block, gear and reader."""

    link: str
    heading: ExportTitle
    created: datetime | None = None
    made: date | None = None
    chosen: str = ""
    reader: str = ""


_titled = msgspec.json.Decoder(CarriedTitle).decode


def parts_of(export: Export, reader: Reader) -> Mapping[str, bytes]:
    """Parts that a file carries, by their names; a saved answer byte for byte."""
    date = export.moment and export.moment.astimezone(UTC).date()
    titled = CarriedTitle(export.link, export.heading, export.created, date, export.chosen, reader.marker)
    return {
        APPLICATION: export.application.model_dump_json(exclude_none=True).encode(),
        RESULT: export.reply or encode(export.selection),
        DOCUMENT: msgspec.json.encode(titled),
    }


def export_of(parts: Mapping[str, bytes], catalogue: Catalogue) -> tuple[Export, Reader]:
    """Export and reader of a file, from the parts that it carries.

    A package of an earlier version has no title block. Raises ValidationError, UnreadableReplyError or MsgspecError for
    invalid parts.
    """
    application = Application.model_validate_json(parts[APPLICATION])
    selection = decode(parts[RESULT])
    titled = _titled(parts[DOCUMENT]) if DOCUMENT in parts else CarriedTitle(selection.link, ExportTitle())
    export = Export(
        application=application,
        selection=selection,
        link=titled.link,
        heading=titled.heading,
        created=titled.created,
        moment=datetime.combine(titled.made, time(), UTC) if titled.made else None,
        catalogue=catalogue,
        reply=parts[RESULT],
        chosen=titled.chosen,
    )
    reader = Reader.of_marker(titled.reader)
    return export, Reader(reader.language, reader.units, DIGITS)

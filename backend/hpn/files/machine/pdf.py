"""PDF report of a machine, in the look of a selection's."""

from hpn.files.machine.content import content
from hpn.files.machine.export import MachineExport, pages_of
from hpn.files.report.pdf import printed
from hpn.words.reader import Reader


def pdf(export: MachineExport, reader: Reader, *, axes: str | None = None, full: bool = False) -> bytes:
    """Report on a machine with pages of the axes in `axes`; raises InputError as `pages_of`."""
    pages = pages_of(export.document, axes, full=full)
    return printed("machine.typ", content(export, pages, reader), export.heading.title.strip(), export.created)

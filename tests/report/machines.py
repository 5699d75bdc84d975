"""Revision of a machine as its files have it, and axes with tolerances."""

from hpn.catalogue import Catalogue
from hpn.documents.revision import Frozen
from hpn.files.export import ExportTitle
from hpn.files.machine.export import MachineExport
from hpn.words.reader import Reader
from hpn.words.units import PRESETS
from tests.build import worked_example
from tests.machines import axis, frozen
from tests.report.cases import CREATED, language

AMERICAN = Reader("en", PRESETS["US"], language("en").digits)
LINK = "https://hpn.example/machines/0123456789abcdefghijkl?revision=B"
TITLE = "Packing line VP-40"

BEYOND = worked_example(tolerances={"emergency_stop.torque_Nm": {"percent": 40}})
"""An application whose selected gear passes at 200 Nm, and fails at 280 Nm."""

WITHIN = worked_example(tolerances={"emergency_stop.torque_Nm": {"percent": 20}})
"""The same application with a stop of 240 Nm at most, which its gear bears."""


def export_of(document: Frozen, catalogue: Catalogue, before: Frozen | None = None) -> MachineExport:
    heading = ExportTitle(TITLE, "HB-2431", "MA", "B")
    return MachineExport(document, catalogue, LINK, heading, CREATED, None, ("A", before) if before else None)


def plain(text: str) -> str:
    """Text of a page in one line, with plain spaces."""
    return " ".join(text.replace("\u200b", "").replace("\u202f", " ").split())


def with_and_without_tolerance(catalogue: Catalogue) -> MachineExport:
    return export_of(
        frozen([axis("near", WITHIN), axis("far", BEYOND), axis("bare", worked_example())], catalogue), catalogue
    )

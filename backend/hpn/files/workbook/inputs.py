"""Sheet of all given inputs: loads, requirements, motion, and below them the duty cycle."""

from hpn.account.inputs import MOTION_TITLE, MOVES_TITLE
from hpn.files.workbook.sheet import SelectionSheet
from hpn.words.wording import N_

WIDTHS = (44, 14, 14, 14, 14, 14, 14, 14, 14)


def write_inputs(sheet: SelectionSheet) -> None:
    """Write the sheet; phases stand last, so that there is room for any number."""
    account = sheet.export.account
    for title, lines in (
        (N_("Loads"), account.loads),
        (N_("Requirements"), account.requirements),
        (MOTION_TITLE, account.mechanism),
    ):
        sheet.lines(title, lines)
    for title, table in ((MOVES_TITLE, account.moves), (N_("Duty cycle"), account.phases)):
        if table is not None:
            sheet.table(title, table)
    sheet.page(WIDTHS)

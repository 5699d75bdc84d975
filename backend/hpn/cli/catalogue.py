"""`hpn catalogue`: the gears, or one of them."""

import argparse
import sys

import msgspec

from hpn.catalogue import load_catalogue
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Print a line for each gear, or one gear as JSON."""
    settings = Settings()
    catalogue = load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    if options.designation is None:
        for gear in catalogue.gears:
            rated = f"T_N {gear.rated_torque_Nm:g} Nm" if gear.rated_torque_Nm else "unrated"
            mark = " (supplied by the user)" if gear.is_supplied("rated_torque_Nm") else ""
            print(f"{gear.designation:<11} {gear.stages}-stage  {rated}{mark}")
        return 0
    figures = catalogue.find(options.designation)
    if figures is None:
        print(
            f"the catalogue has no gear {options.designation!r}; a designation is written like HPN-20A-5",
            file=sys.stderr,
        )
        return 2
    print(msgspec.json.format(msgspec.json.encode(figures)).decode())
    return 0

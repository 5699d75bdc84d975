"""`hpn --version`: versions of engine and catalogue."""

import argparse

from hpn import ENGINE_VERSION
from hpn.catalogue import load_catalogue
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Print the versions as in every reply."""
    settings = Settings()
    catalogue = load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    print(f"HPN Select {ENGINE_VERSION}, catalogue {catalogue.version}")
    return 0

"""Why a fleet can't be sized."""


class FleetError(Exception):
    """Input that can't be used as a whole; the text names the file and what would be right."""

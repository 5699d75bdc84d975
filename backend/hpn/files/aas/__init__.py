"""The Asset Administration Shell of a selection."""

"""Functions for Python: `hpn.select`, `hpn.size`, `hpn.catalogue` and `hpn.report`, loaded on first use."""

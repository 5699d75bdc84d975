"""The package as Python calls it: `hpn.select`, `hpn.size`, `hpn.catalogue` and `hpn.report`, loaded on first use."""

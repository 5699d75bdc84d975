"""Words: what things are called, in which units and symbols, and how they are shown in a language."""

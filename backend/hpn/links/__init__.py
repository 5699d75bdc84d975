"""Links: every input as a symbol of the address bar, and the canonical link of an application."""

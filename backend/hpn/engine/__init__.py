"""The engine: from an application and the catalogue to checks, verdicts and ranked candidates."""

"""HPN Select: which Harmonic Drive HPN planetary gear fits an application, and why."""

ENGINE_VERSION = "1.1.0"

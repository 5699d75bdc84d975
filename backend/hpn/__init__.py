"""HPN Select: which Harmonic Drive HPN planetary gear fits an application, and why.

    import hpn

    answer = hpn.select({"duty_cycle": {"phases": [{"torque_Nm": 40, "speed_rpm": 250, "duration_s": 0.3}]}})
    answer.selected
    hpn.size(frame)        # a gear for each axis of a table: pandas, polars, Arrow
    hpn.catalogue()        # every gear with its published figures
    hpn.report(answer)     # bytes of the PDF

Each is loaded when it is first asked for, so that the import itself takes no time.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hpn.python.answer import Answer, select
    from hpn.python.faults import ApplicationError
    from hpn.python.frames import size
    from hpn.python.gears import Gears
    from hpn.python.report import report

    catalogue = Gears.of

ENGINE_VERSION = "1.3.0"

__all__ = ["ENGINE_VERSION", "Answer", "ApplicationError", "Gears", "catalogue", "report", "select", "size"]

_HOMES = {
    "Answer": "answer",
    "ApplicationError": "faults",
    "Gears": "gears",
    "report": "report",
    "select": "answer",
    "size": "frames",
}
"""Modules of `hpn.python` by what they bring; `hpn.catalogue` is a room, too, and calls them itself."""


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "catalogue":
        return import_module("hpn.catalogue")
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"hpn.python.{_HOMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

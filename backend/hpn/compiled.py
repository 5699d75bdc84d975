"""Compiled functions: an equation is written once, for one case, and runs as machine code over a million.

Numba compiles a function when it is first called, and keeps the result beside the source, or where NUMBA_CACHE_DIR
says. It looks whether the function's own file has changed, but not at the functions that it calls: a changed equation
would be computed as before. So what is kept belongs to the source of all modules together.
"""

import hashlib
import os
from collections.abc import Callable
from inspect import signature
from itertools import compress, zip_longest
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Function = TypeVar("Function", bound=Callable[..., Any])


def _keep_by_source() -> bool:
    """Have numba keep what it compiles in a folder of this very source; False where none can be written."""
    modules = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(modules.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    settings: Any = numba.config
    folder = Path(settings.CACHE_DIR or modules / "__pycache__") / f"compiled-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    settings.CACHE_DIR = str(folder)
    return os.access(folder, os.W_OK)


_KEPT = _keep_by_source()


def compiled(function: Function) -> Function:
    """Compile a function of floats and arrays. Dividing by zero gives infinity or NaN, as with numpy.

    Each is put in where it is called: handing arrays over costs more than most of these functions do.
    """
    try:
        result: Any = numba.njit(cache=_KEPT, error_model="numpy", nogil=True, forceinline=True)(function)
    except RuntimeError:  # no folder for the cache can be written: compile at each start
        result = numba.njit(error_model="numpy", nogil=True, forceinline=True)(function)
    return cast(Function, result)


_equations: list["Equation"] = []


class Equation:
    """A published equation: `case` computes it for one case, in compiled code; called by name it takes arrays.

    Arguments broadcast; a series over the phases lies along the last axis. Gives float64 arrays, 0-d for scalars in.
    """

    def __init__(self, function: Callable[..., Any], layout: str | None) -> None:
        self.__doc__, self.__name__ = function.__doc__, function.__name__
        self.case: Any = compiled(function)
        self._parameters = signature(function).parameters
        self._by_phase = [group == "(p)" for group in layout.partition("->")[0].split(",")] if layout else []
        _equations.append(self)
        self._over_arrays = np.vectorize(self.case, otypes=None if layout else [np.float64], signature=layout)

    def __call__(self, **given: Any) -> NDArray[np.float64]:
        """The equation on floats or arrays, by the names of its parameters."""
        known = {name: p.default for name, p in self._parameters.items() if p.default is not p.empty} | given
        if known.keys() != self._parameters.keys():
            raise TypeError(f"{self.__name__} takes {', '.join(self._parameters)} by name")
        arrays = [np.asarray(known[name], dtype=np.float64) for name in self._parameters]
        per_phase = (array.copy() for array in np.broadcast_arrays(*compress(arrays, self._by_phase)))
        arrays = [next(per_phase) if by else array for by, array in zip_longest(self._by_phase, arrays)]
        with np.errstate(all="ignore"):  # infinity and NaN are answers: unlimited, and not published
            return np.asarray(self._over_arrays(*arrays), dtype=np.float64)


def equation(function: Callable[..., Any]) -> Equation:
    """Make an equation of single figures out of a function of floats."""
    return Equation(function, None)


def over_phases(layout: str) -> Callable[[Callable[..., Any]], Equation]:
    """Make an equation out of a function that sums over phases; `layout` as in "(p),(p),()->()"."""
    return lambda function: Equation(function, layout)


def compile_equations() -> None:
    """Compile every equation now, rather than when it is first called by name."""
    for known in _equations:
        known(**dict.fromkeys(signature(known.case.py_func).parameters, np.ones(1)))

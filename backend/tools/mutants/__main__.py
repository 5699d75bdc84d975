"""`python -m tools.mutants [MODULE …]`: tries every mutant, and lists those that no test finds."""

import argparse
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path

from tools.mutants.changes import Mutant, mutants_of
from tools.mutants.explained import EXPLAINED
from tools.mutants.trial import timed

LIBRARIES = (
    "babel.numbers",
    "fastapi",
    "jsonschema_rs",
    "mpmath",
    "msgspec",
    "numpy",
    "orjson",
    "pint",
    "pydantic",
    "pydantic_settings",
    "starlette.testclient",
)
"""Libraries of the modules, imported once for all forked processes; modules and tests are imported in each process."""

PACKAGE = Path(__file__).parents[2] / "hpn"
MODULES = {
    "equations": "physics",
    "bearing": "physics",
    "stop": "physics",
    "stiffness": "physics",
    "shaft_load": "physics",
    "stops": "engine",
    "checks": "engine",
    "evaluation": "engine",
    "selection": "engine",
}
"""Modules and packages to try, and their rooms."""

BESIDE = {"selection": ("candidates", "allowed")}
"""Modules tried together with another."""

NEAREST = {
    "equations": ["tests/reference/test_edges.py", "tests/reference/test_equations.py"],
    "bearing": ["tests/reference/test_edges.py", "tests/reference/test_bearing.py"],
    "stop": ["tests/property/test_stiffness.py", "tests/unit/test_brake_stops.py"],
    "stiffness": ["tests/property/test_stiffness.py", "tests/unit/test_stiff_exact_safe.py"],
    "shaft_load": ["tests/reference/test_shaft_load.py", "tests/unit/test_shaft_load.py"],
    "stops": ["tests/unit/test_brake_stops.py", "tests/property/test_stiffness.py"],
    "checks": ["tests/unit/test_check_texts.py", "tests/unit/test_checks.py"],
    "evaluation": [
        "tests/property/test_order.py",
        "tests/fleet/test_equality.py",
        "tests/fleet/test_listing.py",
        "tests/unit/test_selection.py",
        "tests/unit/test_checks.py",
    ],
    "selection": [
        *("tests/unit/test_selection.py", "tests/unit/test_checks.py", "tests/unit/test_comparison.py"),
        *("tests/unit/test_motors.py", "tests/unit/test_readings.py"),
    ],
}
"""Own tests of each module, which find most mutants."""

FURTHER = (
    [
        *(
            "tests/reference/test_worked_example.py",
            "tests/reference/test_equations.py",
            "tests/unit/test_selection.py",
        ),
        *("tests/reference/test_bearing.py", "tests/unit/test_checks.py", "tests/unit/test_check_texts.py"),
        *("tests/unit/test_notices.py", "tests/unit/test_remedy.py", "tests/unit/test_application.py"),
        *("tests/unit/test_calculation.py", "tests/unit/test_comparison.py", "tests/unit/test_supplements.py"),
        *("tests/property/test_arrays.py", "tests/property/test_reserve.py", "tests/property/test_envelopes.py"),
        "tests/property/test_invariances.py",
    ],
    [
        *("tests/property/test_contract.py", "tests/property/test_calculation.py", "tests/web/test_select.py"),
        *("tests/web/test_openapi.py", "tests/web/test_openapi_bounds.py", "tests/web/test_openapi_truth.py"),
    ],
)
"""Further tests of a mutant that passes its module's own, by cost."""


def mutants_in(module: str) -> list[Mutant]:
    """Mutants of a module and of those beside it, or of each file of a package."""
    room = PACKAGE / MODULES[module]
    folder = room / module
    files = [room / f"{name}.py" for name in (module, *BESIDE.get(module, ()))]
    if folder.is_dir():
        files = sorted(folder.glob("*.py"))
    return [mutant for file in files for mutant in mutants_of(module, file)]


def main() -> int:
    """Print the unexplained survivors, and counts; returns 1 where there is a survivor."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    parser.add_argument("modules", nargs="*", metavar="MODULE", help=f"out of {', '.join(MODULES)}; all by default")
    parser.add_argument("--list", action="store_true", help="list the mutants, and try none")
    parser.add_argument("--only", default="", help="only those whose name contains this")
    given = parser.parse_args()
    os.nice(19)
    for library in LIBRARIES:
        import_module(library)
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # no test needs one, and each takes its time
    found = 0
    for module in given.modules or MODULES:
        mutants = [mutant for mutant in mutants_in(module) if given.only in mutant.name]
        if given.list:
            print(*(mutant.name for mutant in mutants), sep="\n")
            continue
        found += _report(module, mutants)
    return min(found, 1)


def _report(module: str, mutants: list[Mutant]) -> int:
    """Try the mutants and print the survivors; those that are explained are tried only with the module's own tests."""
    survivors = _survivors(mutants, NEAREST[module])
    explained = [mutant for mutant in survivors if mutant.name in EXPLAINED]
    survivors = [mutant for mutant in survivors if mutant not in explained]
    for tests in FURTHER:
        survivors = _survivors(survivors, tests)
    killed = len(mutants) - len(explained) - len(survivors)
    print(
        f"{module}: {len(mutants)} mutants, {killed} killed, {len(explained)} explained, {len(survivors)} survived",
        *(f"  {mutant.path.name}, line {mutant.line}: {mutant.name}" for mutant in survivors),
        sep="\n",
        flush=True,
    )
    return len(survivors)


def _survivors(mutants: list[Mutant], tests: list[str]) -> list[Mutant]:
    def passes(mutant: Mutant) -> bool:
        passed, seconds = timed(mutant.path, mutant.source, tests)
        print("PASSED" if passed else "killed", f"{seconds:.1f} s {mutant.name}", file=sys.stderr, flush=True)
        return passed

    with ThreadPoolExecutor(2) as pool:  # each waits for a process of its own
        return [mutant for mutant, passed in zip(mutants, pool.map(passes, mutants), strict=True) if passed]


if __name__ == "__main__":
    sys.exit(main())

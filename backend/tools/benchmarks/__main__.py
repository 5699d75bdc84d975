"""`make bench`: waiting times of users, measured side by side in one run and written to bench-results.json.

Beside this checkout stand a plain FastAPI service (`plain.py`) and, with `make bench BESIDE=folder`, another installed
checkout, such as the one before a change; `make bench ONLY="replies edits"` measures a part. Nothing asserts a time.
"""

import argparse
import json
import os
import platform
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tools.benchmarks import batches, edits, fleets, machines, replies, starts
from tools.benchmarks.applications import EVERY, select_body
from tools.benchmarks.turns import ratios
from tools.benchmarks.variants import HERE, Checkout, Server, plain_service, product

RESULTS = HERE / "bench-results.json"
MEASURES = ("first_starts", "commands", "idle", "replies", "edits", "batches", "savings", "machines", "fleets")
IDLE_SECONDS = 2


def main() -> None:
    """Measure the named parts, or everything."""
    options = _options()
    checkouts = {"here": Checkout("here", HERE)}
    if options.beside:
        checkouts["beside"] = Checkout("beside", options.beside.resolve())
    results: dict[str, Any] = {
        "measured": datetime.now(UTC).strftime("%Y-%m-%d"),
        "machine": {"python": platform.python_version(), "processor": platform.machine(), "cores": os.cpu_count()},
        "commits": {name: checkout.commit() for name, checkout in checkouts.items()},
    }
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="hpn-bench-") as folder:
        for name, found in _measured(checkouts, Path(folder), options.only or MEASURES):
            results[name] = found
            print(f"{name}, by second {time.perf_counter() - start:.0f}:", json.dumps(found, indent=2), flush=True)
    RESULTS.write_text(json.dumps(results, indent=2) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m tools.benchmarks")
    parser.add_argument("--beside", type=Path, metavar="FOLDER", help="another installed checkout to measure as well")
    parser.add_argument("only", nargs="*", metavar="MEASURE", help="what to measure; everything by default")
    return parser.parse_args()


def _measured(
    checkouts: Mapping[str, Checkout], folder: Path, wanted: Sequence[str]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Name and outcome of each requested measure; the servers run only for measures that need them."""
    for name, measure in (
        ("first_starts", starts.first_starts),
        ("commands", starts.commands),
        ("fleets", fleets.measure),
    ):
        if name in wanted:
            yield name, measure(checkouts, folder)
    of_servers: dict[str, Callable[[Mapping[str, Server]], dict[str, Any]]] = {
        "idle": _idle,
        "replies": lambda servers: _replies(servers, folder),
        "edits": edits.measure,
        "batches": batches.measure,
        "savings": lambda servers: replies.measure(servers, "/api/v1/selections"),
        "machines": machines.measure,
    }
    if of_servers.keys().isdisjoint(wanted):
        return
    with ExitStack() as stack:
        servers = {name: stack.enter_context(product(checkout, folder)) for name, checkout in checkouts.items()}
        for name, measure_servers in of_servers.items():
            if name in wanted:
                yield name, measure_servers(servers)


def _idle(servers: Mapping[str, Server]) -> dict[str, Any]:
    """Memory of a server after one request."""
    for server in servers.values():
        server.ask("/api/v1/select", select_body(0, EVERY))
    time.sleep(IDLE_SECONDS)
    resident = {name: [server.resident_MB()] for name, server in servers.items()}
    return {**{f"{name}_MB": round(values[0]) for name, values in resident.items()}, "ratios": ratios(resident)}


def _replies(servers: Mapping[str, Server], folder: Path) -> dict[str, Any]:
    """Replies beside the plain service, which takes ratings and texts from this checkout's replies."""
    (folder / "catalogue.json").write_bytes(servers["here"].ask("/api/v1/catalogue"))
    (folder / "reply.json").write_bytes(servers["here"].ask("/api/v1/select", select_body(0, EVERY)))
    with plain_service(folder) as plain:
        everybody = {**servers, "plain": plain}
        replies.prove_equal(everybody)
        return replies.measure(everybody, "/api/v1/select")


if __name__ == "__main__":
    main()

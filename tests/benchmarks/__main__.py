"""`make bench`: what things cost, as ratios measured side by side in one run, written to bench-results.json."""

import json
import platform
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tests.benchmarks import batch, edits, reply, saving

BENCHMARKS: dict[str, Callable[[], dict[str, Any]]] = {
    "reply": reply.measure,
    "edits": edits.measure,
    "batch": batch.measure,
    "saving": saving.measure,
}


def main() -> None:
    """Run the benchmarks named on the command line, or all of them."""
    names = sys.argv[1:] or list(BENCHMARKS)
    path = Path("bench-results.json")
    results: dict[str, Any] = json.loads(path.read_text()) if sys.argv[1:] and path.exists() else {}
    results["machine"] = {"python": platform.python_version(), "processor": platform.machine()}
    results["measured"] = datetime.now(UTC).strftime("%Y-%m-%d")
    for name in names:
        results[name] = BENCHMARKS[name]()
        print(name, json.dumps(results[name], indent=2), flush=True)
    path.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()

"""`make containers`: builds the image, starts the compose file and tries both on a real engine.

Prints a line for each trial and the images that were stand-ins. Ends with 0 where all hold, 1 where one does not, and 3
where there is no engine: that says nothing about the containers.
"""

import os
import signal
import sys
from pathlib import Path

from tests.containers import restarts, serving, upgrade, upkeep
from tests.containers.debian import Debian, UnavailableError
from tests.containers.engine import Engine, engine
from tests.containers.images import Images
from tests.containers.stack import IMAGE, ROOT, Stack, stack
from tests.containers.trials import trial

NOT_TRIED = 3
KINDS = (serving, restarts, upkeep)


def main(wanted: str) -> int:
    """Try all, or what a pattern finds by its name; exit code."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends what was started, as Ctrl+C does
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hpn-containers"
    cache.mkdir(parents=True, exist_ok=True)
    debian = Debian(cache)
    try:
        with engine(cache, debian) as running:
            print(running.version, flush=True)
            images = Images(running, debian, made={f"{IMAGE}:latest"})
            try:
                _try_all(running, images, wanted)
            finally:
                images.tidy()
    except UnavailableError as reason:
        print(f"NOT TRIED: {reason}")
        return NOT_TRIED
    print(f"{len(trial.passed)} passed, {len(trial.failed)} failed")
    return 1 if trial.failed else 0


def _try_all(running: Engine, images: Images, wanted: str) -> None:
    with stack(running, images, ROOT) as output:
        print(*images.lines(), sep="\n", flush=True)
        built = trial.try_one("the image is built", lambda: _build(output))
        if built and trial.try_one("the stack starts and is healthy", lambda: output.up()):
            for kind in KINDS:
                trial.run(output, kind.__name__, wanted)
    if built:
        upgrade.run(running, images, wanted)


def _build(made: Stack) -> str:
    made.compose("build", "--quiet", "web", seconds=1800)
    size = int(made.engine.docker("image", "inspect", "--format", "{{.Size}}", IMAGE))
    return f"{size / 1e6:.0f} MB"


if __name__ == "__main__":
    sys.exit(main(" ".join(sys.argv[1:])))

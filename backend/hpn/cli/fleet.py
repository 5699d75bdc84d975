"""`hpn fleet`: gears for a table of axes."""

import argparse
import os
import signal
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from pyarrow import Table
from tqdm import tqdm

from hpn.catalogue import Catalogue
from hpn.fleet.listing import listing_of
from hpn.fleet.order import TWO_GONE, FleetError, Order, require_writable
from hpn.fleet.run import Engine, Use, keep_memory, size_fleet, threads
from hpn.fleet.tables import Progress
from hpn.installed import require
from hpn.web.settings import Settings

STOPPED = 1


def run(options: argparse.Namespace) -> int:
    """Size the axes; returns 0 when all are done, rejected rows included, 1 when it is stopped."""
    settings = Settings()
    catalogue = settings.catalogue()
    order = Order(
        axes=options.input,
        answers=options.output,
        candidates=options.candidates,
        rejected=options.rejected,
        ignored=tuple(options.ignore),
    )
    _require_used(options)
    if options.report:
        _require_report(options.report)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    keep_memory()
    try:
        rows = _sized(order, catalogue, _engine(options), partial(_write_report, options, order, catalogue))
    except (KeyboardInterrupt, OSError) as error:
        print(f"stopped: {str(error).splitlines()[0]}" if str(error) else "stopped", file=sys.stderr)
        return STOPPED
    if sys.stderr.isatty():
        print(f"{rows['answers']:,} axes are in {options.output}", file=sys.stderr)
    return 0


def _sized(order: Order, catalogue: Catalogue, engine: Engine, use: Use) -> dict[str, int]:
    """Rows of the files by kind; a bar shows the progress on a terminal."""
    with tqdm(unit_scale=True, disable=None, file=sys.stderr) as bar:

        def watch(progress: Progress) -> None:
            bar.total, bar.unit = progress.total, progress.counted
            bar.update(progress.done - bar.n)

        def note_ignored(path: Path, name: str) -> None:
            tqdm.write(f"{path}: column {name!r} is an index that pandas wrote, and ignored", file=sys.stderr)

        return size_fleet(order, catalogue, engine, watch, use, note_ignored)


def _engine(options: argparse.Namespace) -> Engine:
    workers = options.workers or len(os.sched_getaffinity(0))
    if options.engine == "local":
        return threads(workers)
    from hpn.fleet.cluster import dask

    return dask(options.scheduler, workers)


def _require_used(options: argparse.Namespace) -> None:
    """Raise FleetError for a removed option, or for one without effect unless another is given."""
    if options.axes is not None:
        raise FleetError(f"--axes: {TWO_GONE}")
    if options.scheduler is not None and options.engine != "dask":
        raise FleetError("--scheduler: belongs to --engine dask")
    for name in ("lang", "service"):
        if getattr(options, name) is not None and options.report is None:
            raise FleetError(f"--{name}: belongs to --report")


def _require_report(report: Path) -> None:
    """Raise FleetError where a report could not be written."""
    if report.suffix != ".html":
        raise FleetError(f"{report}: the suffix of a report must be .html")
    require_writable(report)
    require("serve")  # the report is one of its pages


def _write_report(options: argparse.Namespace, order: Order, catalogue: Catalogue, answers: Iterator[Table]) -> None:
    """Write the report, where one is requested; it appears complete under its name or not at all."""
    if options.report is None:
        return
    from hpn.web.pages.fleet_report import report_of  # a second of imports, only for reports

    listing = listing_of(order, answers, catalogue)
    written = options.report.with_name(f".{options.report.name}.{os.getpid()}")
    try:
        service: str = (options.service or "").rstrip("/")
        name = os.fsencode(options.input.name).decode("utf-8", "replace")  # in any locale
        text = report_of(listing, name, catalogue, service, options.lang or "en")
        written.write_text(text, encoding="utf-8")
        os.replace(written, options.report)
    finally:
        written.unlink(missing_ok=True)

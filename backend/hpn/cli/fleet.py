"""`hpn fleet`: gears for a table of axes."""

import argparse
import os
import sys

from tqdm import tqdm

from hpn.catalogue import load_catalogue
from hpn.fleet.run import Engine, Order, processes, size_fleet
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Size the axes; 0 where all went well, rejected rows included."""
    settings = Settings()
    catalogue = load_catalogue(settings.catalogue_folder, settings.catalogue_supplement, settings.averaging_seconds)
    order = Order(
        axes=options.input,
        answers=options.output,
        requirements=options.axes,
        candidates=options.candidates,
        rejected=options.rejected,
        resume=options.resume,
    )
    with tqdm(unit="rows", unit_scale=True, disable=None, file=sys.stderr) as bar:

        def watch(done: int, total: int, counted: str) -> None:
            bar.total, bar.unit = total, counted
            bar.update(done - bar.n)

        rows = size_fleet(order, catalogue, _engine(options), watch)
    if sys.stderr.isatty():
        print(f"{rows['answers']:,} axes; {options.output} is written", file=sys.stderr)
    return 0


def _engine(options: argparse.Namespace) -> Engine:
    workers = options.workers or len(os.sched_getaffinity(0))
    if options.engine == "local":
        return processes(workers)
    from hpn.fleet.cluster import dask

    return dask(options.scheduler, workers)

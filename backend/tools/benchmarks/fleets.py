"""Fleet from Parquet to Parquet beside mere reading and writing; its kernel beside a plain loop and compiled C."""

import ctypes
import math
import os
import shutil
import statistics
import subprocess
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.evaluation import SUITABLE, evaluate
from hpn.fleet.axes import Axes
from hpn.physics.equations import FloatArray
from tools.benchmarks.turns import in_turns, ratios
from tools.benchmarks.variants import Checkout

AXES, PHASES, UNIT_ROWS = 1_000_000, 10, 50_000
TIMES = 10
"""Number of axes of the large fleet, as a multiple of AXES."""

TURNS = 3
KERNEL_AXES, LOOP_AXES = 20_480, 200


def measure(checkouts: Mapping[str, Checkout], folder: Path) -> dict[str, Any]:
    """Seconds, axes per second and memory by number of workers, with their ratios; then the kernel."""
    hpn = checkouts["here"].hpn
    fleet = written(folder / "fleet.parquet", AXES)
    workers = sorted({1, os.cpu_count() or 1})
    answers = _fleet(hpn, fleet, folder, workers[-1])
    floor = {f"files_{count}": partial(_files_alone, fleet, folder / "out.parquet", count) for count in workers}
    sized = {f"fleet_{count}": partial(_seconds, hpn, fleet, folder, count) for count in workers}
    seconds = in_turns({name: _turn(run) for name, run in (floor | sized).items()}, TURNS, warm_up=False)
    large = _fleet(hpn, written(folder / "large.parquet", TIMES * AXES), folder, workers[-1])
    return {
        "axes": AXES,
        "phases": PHASES,
        "seconds": {name: round(statistics.median(values), 2) for name, values in seconds.items()},
        "ratios": ratios(seconds),
        "axes_per_s": round(AXES / answers.seconds),
        "peak_MB": round(answers.peak_MB),
        f"times_{TIMES}": {"axes_per_s": round(TIMES * AXES / large.seconds), "peak_MB": round(large.peak_MB)},
        "kernel": kernel(folder),
    }


def _turn(run: Callable[[], float]) -> Callable[[int], float]:
    return lambda turn: run()


def written(path: Path, axes: int) -> Path:
    """File of axes in list form, in row groups, whose checks all matter."""
    chance = np.random.default_rng(17)
    with pq.ParquetWriter(path, random_axes(chance, 1).schema) as writer:
        for start in range(0, axes, UNIT_ROWS):
            writer.write_table(random_axes(chance, UNIT_ROWS, start))
    return path


def random_axes(chance: np.random.Generator, count: int, start: int = 0) -> pa.Table:
    """Axes of some phases, with a stop and a required life: six checks."""
    ends = pa.array(np.arange(count + 1) * PHASES, pa.int32())
    values = {"torque_Nm": (-100, 100), "speed_rpm": (-500, 500), "duration_s": (0.1, 3)}
    phases = {
        name: pa.ListArray.from_arrays(ends, pa.array(chance.uniform(*bounds, count * PHASES)))
        for name, bounds in values.items()
    }
    beside = {"pause_s": chance.uniform(0, 5, count), "emergency_stop.torque_Nm": chance.uniform(50, 300, count)}
    return pa.table(
        {"axis": np.arange(start, start + count), **phases, **beside, "requirements.life_h": np.full(count, 2e4)}
    )


# --- The command ------------------------------------------------------------------------------------------------------


class Run(NamedTuple):
    """Time and memory of a run; the memory is that of its largest process."""

    seconds: float
    peak_MB: float


def _fleet(hpn: str, fleet: Path, folder: Path, workers: int) -> Run:
    command = [hpn, "fleet", str(fleet), str(folder / "out.parquet"), "--workers", str(workers)]
    start = time.perf_counter()
    pid = os.posix_spawn(command[0], command, os.environ)
    _, status, usage = os.wait4(pid, 0)
    if status:
        raise RuntimeError(f"{' '.join(command)} ended with {os.waitstatus_to_exitcode(status)}")
    return Run(time.perf_counter() - start, usage.ru_maxrss / 1024)


def _seconds(hpn: str, fleet: Path, folder: Path, workers: int) -> float:
    return _fleet(hpn, fleet, folder, workers).seconds


def _files_alone(fleet: Path, output: Path, workers: int) -> float:
    """Seconds of reading the input in `workers` running processes and of writing the output."""
    answers = pq.read_table(output)
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        list(pool.map(_nothing, range(workers)))
        start = time.perf_counter()
        sum(pool.map(_read, [fleet] * (AXES // UNIT_ROWS), range(AXES // UNIT_ROWS)))
        pq.write_table(answers, output, row_group_size=UNIT_ROWS)
        return time.perf_counter() - start


def _nothing(number: int) -> int:
    time.sleep(0.2)  # so that each process gets one
    return number


def _read(fleet: Path, unit: int) -> int:
    rows: int = pq.ParquetFile(fleet, memory_map=True).read_row_group(unit, use_threads=False).num_rows
    return rows


# --- The kernel -------------------------------------------------------------------------------------------------------


Sized = tuple[NDArray[np.int32], NDArray[np.int32]]
"""For each axis, the place of the selected gear, -1 without one, and the number of suitable gears."""

ASKED = ("duty_cycle.pause_s", "emergency_stop.torque_Nm", "requirements.life_h")
RATINGS = (
    "ratio",
    "rated_torque_Nm",
    "repeated_peak_torque_Nm",
    "momentary_peak_torque_Nm",
    "average_input_speed_rpm",
    "maximum_input_speed_rpm",
    "weight_kg",
)


def kernel(folder: Path) -> dict[str, Any]:
    """Microseconds per axis for all gears and six checks: numpy as in a fleet, a plain loop, and C."""
    catalogue = load_catalogue()
    table = random_axes(np.random.default_rng(1), KERNEL_AXES)
    axes, few = Axes(table, catalogue), Axes(table.slice(0, LOOP_AXES), catalogue)
    runs: dict[str, Callable[[], Sized]] = {
        "numpy": lambda: by_numpy(axes, catalogue),
        "loop": lambda: by_loop(few, catalogue),
    }
    if compiler := shutil.which("cc"):
        size = compiled(compiler, folder)
        runs["c"] = lambda: by_c(size, axes, catalogue)
    wanted = by_numpy(few, catalogue)
    for name, run in runs.items():
        for values, expected in zip(run(), wanted, strict=True):
            np.testing.assert_array_equal(values[:LOOP_AXES], expected, name)
    seconds = in_turns({name: _timed(run) for name, run in runs.items()}, 5)
    return {
        **{f"{name}_us": round(1e6 * statistics.median(values), 3) for name, values in seconds.items()},
        "ratios": ratios(seconds),
    }


def _timed(run: Callable[[], Sized]) -> Callable[[int], float]:
    def per_axis(turn: int) -> float:
        start = time.perf_counter()
        answered, _ = run()
        return (time.perf_counter() - start) / len(answered)

    return per_axis


def by_numpy(axes: Axes, catalogue: Catalogue) -> Sized:
    """Result of the engine, in the chunks of a fleet."""
    selected, suitable = (np.empty(len(axes.counts), np.int32) for _ in range(2))
    for gears, rows in axes.chunks():
        evaluation = evaluate(axes.duty(rows), gears, catalogue)
        suits = evaluation.verdict == SUITABLE
        suitable[rows] = suits.sum(axis=-1)
        selected[rows] = np.where(suits.any(axis=-1), evaluation.foremost(suits), -1)
    return selected, suitable


def by_loop(axes: Axes, catalogue: Catalogue) -> Sized:
    """Result of a loop over axes, phases and gears, the first version that anyone would write."""
    cycles, asked, gears = (values.tolist() for values in _arrays(axes, catalogue))
    rated_speed, rated_life = catalogue.rated_input_speed_rpm, catalogue.life_at_rated_torque_h
    selected, suitable = [], []
    for phases, (pause, T_k, life) in zip(cycles, asked, strict=True):
        T_max, n_max = max(T for T, _, _ in phases), max(n for _, n, _ in phases)
        turns = sum(n * t for _, n, t in phases)
        T_av = (sum(n * t * T ** (10 / 3) for T, n, t in phases) / turns) ** 0.3
        n_av = turns / (sum(t for _, _, t in phases) + pause)
        best, count = None, 0
        for place, (ratio, T_N, T_R, T_M, n_permitted, n_most, weight) in enumerate(gears):
            L_10 = rated_life * rated_speed / (ratio * n_av) * (T_N / T_av) ** (10 / 3)
            uses = (T_av / T_N, T_max / T_R, T_k / T_M, ratio * n_av / n_permitted, ratio * n_max / n_most, life / L_10)
            used = max(uses)
            if used <= 1 + 1e-12 and not any(math.isnan(use) for use in uses):
                count += 1
                key = (weight, used, -L_10, place)
                best = min(best or key, key)
        selected.append(-1 if best is None else best[-1])
        suitable.append(count)
    return np.array(selected, np.int32), np.array(suitable, np.int32)


def compiled(compiler: str, folder: Path) -> Any:
    """Function of kernel.c, compiled for this processor."""
    library = folder / "kernel.so"
    options = ["-O3", "-march=native", "-shared", "-fPIC", "-o", str(library)]
    subprocess.run([compiler, *options, str(Path(__file__).with_name("kernel.c")), "-lm"], check=True)
    return ctypes.CDLL(str(library)).size


def by_c(size: Any, axes: Axes, catalogue: Catalogue) -> Sized:
    """Result of the compiled function."""
    selected, suitable = (np.empty(len(axes.counts), np.int32) for _ in range(2))
    cycles, asked, gears = _arrays(axes, catalogue)
    size(
        len(axes.counts),
        PHASES,
        cycles.ctypes,
        asked.ctypes,
        len(gears),
        gears.ctypes,
        ctypes.c_double(catalogue.rated_input_speed_rpm),
        ctypes.c_double(catalogue.life_at_rated_torque_h),
        selected.ctypes,
        suitable.ctypes,
    )
    return selected, suitable


def _arrays(axes: Axes, catalogue: Catalogue) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Phases by magnitude (axes, phases, 3), requirements (axes, 3), figures of the gears (gears, 7)."""
    duty = axes.duty(np.arange(len(axes.counts)))
    series = (duty.phases.torque_Nm, duty.phases.speed_rpm, duty.phases.duration_s)
    columns = catalogue.restricted(None, None).columns
    return (
        np.ascontiguousarray(np.stack([values[:, 0] for values in series], axis=-1)),
        np.ascontiguousarray(np.concatenate([duty.inputs[name] for name in ASKED], axis=-1)),
        np.ascontiguousarray(np.stack([getattr(columns, name) for name in RATINGS], axis=-1)),
    )

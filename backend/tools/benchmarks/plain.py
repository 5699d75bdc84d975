"""Plain service as a user would write it: FastAPI, pydantic models in and out, numpy over the gears.

It answers only the requests of the benchmark (no bearing, no requirements but ratios and sizes, no number formats), so
it does less than the product for the same reply. Texts and ratings come from two replies of the product, so that
nothing of the engine is imported: `python -m tools.benchmarks.plain PORT FOLDER`.
"""

import json
import math
import sys
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import numpy as np
import uvicorn
from fastapi import FastAPI
from numpy.typing import NDArray
from pydantic import BaseModel

from hpn.application import Application

FloatArray = NDArray[np.float64]
ROUNDING = 1 + 1e-12
"""Factor that lets a limit met exactly pass in floating point (contract of the checks)."""


class PlainDuty(BaseModel):
    """Figures of the cycle."""

    average_torque_Nm: float
    average_output_speed_rpm: float
    maximum_torque_Nm: float
    maximum_output_speed_rpm: float


class PlainCheck(BaseModel):
    """Check of a gear."""

    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None
    status: str


class PlainReserve(BaseModel):
    """Possible growth of each driver."""

    torque_factor: float | None
    speed_factor: float | None
    load_factor: float | None
    emergency_stop_torque_Nm: float | None


class PlainCandidate(BaseModel):
    """Gear with its verdict."""

    designation: str
    size: str
    ratio: int
    stages: int
    status: str
    rank: int | None
    utilisation: float | None
    governing_check: str | None
    reason: str
    average_input_speed_rpm: float
    maximum_input_speed_rpm: float
    life_L10_h: float | None
    momentary_peak_count: float | None
    bearing_life_L50_h: float | None
    bearing_life_L10_h: float | None
    motor_peak_torque_Nm: float
    motor_rated_torque_Nm: float
    reserve: PlainReserve
    checks: list[PlainCheck]


class Definition(BaseModel):
    """Purpose of a check, and the reason for it."""

    title: str
    equation: str | None
    unit: str
    kind: str
    group: str
    limit_name: str
    source: str
    tests: str
    consequence: str
    basis: str
    remedy: str


class PlainNotice(BaseModel):
    """Notes for the reader beyond the numbers."""

    code: str
    text: str


class PlainReply(BaseModel):
    """Whole reply."""

    engine_version: str
    catalogue_version: str
    link: str
    duty: PlainDuty
    selected: str | None
    candidates: list[PlainCandidate]
    check_definitions: dict[str, Definition]
    notices: list[PlainNotice]


class Cycle:
    """Sums of a duty cycle, equations 17.2 and 17.4, and the RMS torque."""

    def __init__(self, application: Application) -> None:
        phases, pause = application.duty_cycle.load_phases, application.duty_cycle.pause_s
        T = np.abs([phase.torque_Nm for phase in phases])
        n = np.abs([phase.speed_rpm for phase in phases])
        t = np.array([phase.duration_s for phase in phases])
        time = t.sum() + pause
        self.T_av = float(((n * t * T ** (10 / 3)).sum() / (n * t).sum()) ** 0.3)
        self.n_av = float((n * t).sum() / time)
        self.T_max, self.n_max = float(T.max()), float(n.max())
        self.T_rms = float(np.sqrt((T * T * t).sum() / time))


class PlainGears:
    """Catalogue as columns; an unpublished figure is NaN."""

    def __init__(self, rows: list[dict[str, Any]], rated_speed_rpm: float) -> None:
        self.rows, self.rated_speed_rpm = rows, rated_speed_rpm
        self.ratio = np.array([row["ratio"] for row in rows], dtype=float)
        self.T_N = self._column("rated_torque_Nm")
        self.T_R = self._column("repeated_peak_torque_Nm")
        self.T_M = self._column("momentary_peak_torque_Nm")
        self.n_av = self._column("average_input_speed_rpm")
        self.n_max = self._column("maximum_input_speed_rpm")
        self.weight = self._column("weight_kg")

    def _column(self, name: str) -> FloatArray:
        return np.array([math.nan if row[name] is None else row[name] for row in self.rows], dtype=float)

    def allowed(self, application: Application) -> "PlainGears":
        """Gears of the application's ratios and sizes."""
        ratios, sizes = application.requirements.ratios, application.requirements.sizes
        rows = [
            row
            for row in self.rows
            if (ratios is None or row["ratio"] in ratios) and (sizes is None or row["size"] in sizes)
        ]
        return self if len(rows) == len(self.rows) else PlainGears(rows, self.rated_speed_rpm)


class Selector:
    """Selection from a list of gears."""

    def __init__(self, folder: Path) -> None:
        catalogue = json.loads((folder / "catalogue.json").read_text())
        self.gears = PlainGears(catalogue["gears"], catalogue["series"]["rated_input_speed"]["value"])
        sample = json.loads((folder / "reply.json").read_text())
        self.versions = {name: sample[name] for name in ("engine_version", "catalogue_version")}
        self.definitions = {code: Definition(**entry) for code, entry in sample["check_definitions"].items()}
        self.notices = [PlainNotice(**notice) for notice in sample["notices"]]

    def reply(self, application: Application) -> PlainReply:
        """Reply to an application."""
        cycle, gears = Cycle(application), self.gears.allowed(application)
        candidates = self._candidates(application, cycle, gears)
        best = candidates[0]
        return PlainReply(
            **self.versions,
            link=link_of(application),
            duty=PlainDuty(
                average_torque_Nm=cycle.T_av,
                average_output_speed_rpm=cycle.n_av,
                maximum_torque_Nm=cycle.T_max,
                maximum_output_speed_rpm=cycle.n_max,
            ),
            selected=best.designation if best.status == "suitable" else None,
            candidates=candidates,
            check_definitions=self.definitions,
            notices=self.notices,
        )

    def _candidates(self, application: Application, cycle: Cycle, gears: PlainGears) -> list[PlainCandidate]:
        stop = application.emergency_stop
        T_k = math.nan if stop is None or stop.torque_Nm is None else abs(stop.torque_Nm)
        demands = {
            "average_torque": (np.full_like(gears.ratio, cycle.T_av), gears.T_N),
            "repeated_peak_torque": (np.full_like(gears.ratio, cycle.T_max), gears.T_R),
            "momentary_peak_torque": (np.full_like(gears.ratio, T_k), gears.T_M),
            "average_input_speed": (gears.ratio * cycle.n_av, gears.n_av),
            "maximum_input_speed": (gears.ratio * cycle.n_max, gears.n_max),
        }
        codes = [code for code in demands if stop is not None or code != "momentary_peak_torque"]
        demand = np.array([demands[code][0] for code in codes])
        limit = np.array([demands[code][1] for code in codes])
        u = application.requirements.utilisation
        figures = self._figures(cycle, gears, T_k)
        used = demand / limit
        figures["torque_factor"] = u / used[:2].max(axis=0)
        figures["speed_factor"] = u / used[-2:].max(axis=0)
        figures["emergency_stop_torque_Nm"] = u * gears.T_M if stop is not None else np.full_like(gears.T_M, math.nan)
        checks = [self._checks(codes, *terms, u) for terms in zip(demand.T, limit.T, used.T, strict=True)]
        columns = zip(*map(numbers, figures.values()), strict=True)
        figures_of = [dict(zip(figures, values, strict=True)) for values in columns]
        found = [self._candidate(*parts) for parts in zip(gears.rows, checks, figures_of, strict=True)]
        places = sorted(range(len(found)), key=lambda g: _order(found[g], gears, g))
        for rank, g in enumerate((g for g in places if found[g].status == "suitable"), 1):
            found[g].rank = rank
        return [found[g] for g in places]

    @staticmethod
    def _figures(cycle: Cycle, gears: PlainGears, T_k: float) -> dict[str, FloatArray]:
        n_in_av = gears.ratio * cycle.n_av
        peaks = np.floor(10 ** (8.5 - 1.5 * T_k / gears.T_R) * ROUNDING)
        return {
            "average_input_speed_rpm": n_in_av,
            "maximum_input_speed_rpm": gears.ratio * cycle.n_max,
            "life_L10_h": 20_000 * (gears.rated_speed_rpm / n_in_av) * (gears.T_N / cycle.T_av) ** (10 / 3),
            "momentary_peak_count": np.where(T_k > gears.T_R, peaks, math.nan),
            "motor_peak_torque_Nm": cycle.T_max / gears.ratio,
            "motor_rated_torque_Nm": cycle.T_rms / gears.ratio,
        }

    @staticmethod
    def _checks(
        codes: list[str], demand: FloatArray, limit: FloatArray, used: FloatArray, u: float
    ) -> list[PlainCheck]:
        states = ["not_rated" if math.isnan(x) else "pass" if x <= u * ROUNDING else "fail" for x in used.tolist()]
        columns = zip(codes, numbers(demand), numbers(limit), numbers(used), states, strict=True)
        return [
            PlainCheck(code=code, demand=demanded, limit=bound, utilisation=share, status=status)
            for code, demanded, bound, share, status in columns
        ]

    def _candidate(self, row: dict[str, Any], checks: list[PlainCheck], of: dict[str, Any]) -> PlainCandidate:
        failed = sum(check.status == "fail" for check in checks)
        unrated = not failed and any(check.status == "not_rated" for check in checks)
        governing = None if unrated else max(checks, key=lambda check: check.utilisation or 0.0)
        return PlainCandidate(
            designation=row["designation"],
            size=row["size"],
            ratio=row["ratio"],
            stages=row["stages"],
            status="unsuitable" if failed else "unrated" if unrated else "suitable",
            rank=None,
            utilisation=governing.utilisation if governing else None,
            governing_check=governing.code if governing else None,
            reason=self._reason(row, governing, failed),
            average_input_speed_rpm=of["average_input_speed_rpm"],
            maximum_input_speed_rpm=of["maximum_input_speed_rpm"],
            life_L10_h=of["life_L10_h"],
            momentary_peak_count=of["momentary_peak_count"],
            bearing_life_L50_h=None,
            bearing_life_L10_h=None,
            motor_peak_torque_Nm=of["motor_peak_torque_Nm"],
            motor_rated_torque_Nm=of["motor_rated_torque_Nm"],
            reserve=PlainReserve(
                torque_factor=of["torque_factor"],
                speed_factor=of["speed_factor"],
                load_factor=None,
                emergency_stop_torque_Nm=of["emergency_stop_torque_Nm"],
            ),
            checks=checks,
        )

    def _reason(self, row: dict[str, Any], governing: PlainCheck | None, failed: int) -> str:
        if governing is None or governing.utilisation is None:
            return f"Not rated: figures of HPN-{row['size']} that the checks need are not in this catalogue’s source."
        title, percent = self.definitions[governing.code].title, f"{100 * governing.utilisation:.1f} %"
        if failed > 1:
            return f"{title} is at {percent} of its limit; checks that fail: {failed}."
        if failed:
            return f"{title} is at {percent} of its limit."
        return f"Every check passes; the closest is {title} at {percent} of its limit."


def numbers(values: FloatArray) -> list[float | None]:
    """Floats for JSON: None for NaN and infinity."""
    return [value if math.isfinite(value) else None for value in values.tolist()]


def _order(candidate: PlainCandidate, gears: PlainGears, g: int) -> tuple[float, ...]:
    """Suitable gears by weight, then unsuitable ones by utilisation, then unrated ones in catalogue order."""
    used, ratio = candidate.utilisation or 0.0, float(candidate.ratio)
    life = candidate.life_L10_h if candidate.life_L10_h is not None else -math.inf
    if candidate.status == "suitable":
        return (0, float(gears.weight[g]), used, -life, ratio)
    if candidate.status == "unsuitable":
        return (1, used, float(gears.weight[g]), -life, ratio)
    return (2, g)


def link_of(application: Application) -> str:
    """Link of an application."""
    pairs: list[tuple[str, float]] = []
    for phase in application.duty_cycle.load_phases:
        pairs += [("T", phase.torque_Nm), ("n", phase.speed_rpm), ("t", phase.duration_s)]
    pairs.append(("tp", application.duty_cycle.pause_s))
    if application.emergency_stop is not None and application.emergency_stop.torque_Nm is not None:
        pairs.append(("Tk", application.emergency_stop.torque_Nm))
    pairs += [("i", ratio) for ratio in application.requirements.ratios or ()]
    return "/?" + urlencode([(name, repr(value).removesuffix(".0")) for name, value in pairs])


def create_app(folder: Path) -> FastAPI:
    """Plain service."""
    app, selector = FastAPI(), Selector(folder)

    @app.post("/api/v1/select", response_model=PlainReply)
    async def select(application: Application) -> PlainReply:
        return selector.reply(application)

    return app


if __name__ == "__main__":
    uvicorn.run(create_app(Path(sys.argv[2])), port=int(sys.argv[1]), log_level="warning", access_log=False)

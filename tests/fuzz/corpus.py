"""Valid inputs of every door, from which the broken ones are made."""

import csv
import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import openpyxl

from hpn.application import Application
from hpn.catalogue import HANDBOOK_FOLDER, load_catalogue
from hpn.catalogue.tables import TABLES
from hpn.engine.selection import select
from hpn.files.aas.courses import LINEAR, ROTATIVE
from hpn.files.aas.sizing_ids import meaning
from hpn.files.export import Export
from hpn.files.workbook.workbook import workbook
from hpn.fleet.columns import COLUMNS as FLEET
from hpn.links.labels import LABELS
from hpn.links.row_symbols import MOVE_BY_NAME, PHASE_BY_NAME
from hpn.links.symbols import BY_NAME
from hpn.links.writer import to_link
from hpn.web.pages.transfer import write_table
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, cycle, phase, worked_example
from tests.fleet.tables import in_long_form, row_of, write
from tests.report.sizings import element, section, shell

Json = dict[str, Any]

REQUIREMENTS: Json = {
    "ratios": [5, 10],
    "sizes": ["14A", "20A"],
    "life_h": 20000,
    "backlash_arcmin": 7,
    "torsional_stiffness_Nm_per_rad": 5000,
    "weight_kg": 5,
    "length_mm": 200,
    "ambient_temperature_degC": 25,
    "utilisation": 0.9,
    "efficiency": 0.95,
    "motor": {"maximum_speed_rpm": 4000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
}
LOAD = {"radial_N": 500, "axial_N": 200, "load_coefficient": 1.2, "life_h": 20000, "model": "iso281"}

OFF_CENTRE = {
    "axial_N": 100,
    "life_basis": "L10",
    "radial_position_mm": 45,
    "shaft_centre_mm": {"20A": 21, "32A": 30.5, "others": 18},
}

MOTOR = {"inertia_kgm2": 1e-4, "inertia_ratio": 5, "rated_speed_rpm": 3000}
POINTS = [
    {"speed_rpm": 0, "continuous_Nm": 2.8, "peak_Nm": 7.2},
    {"speed_rpm": 3000, "continuous_Nm": 2.4, "peak_Nm": 7.2},
    {"speed_rpm": 6000, "continuous_Nm": 1.5, "peak_Nm": 3},
]
CURVED = {"curve": POINTS, "stall_torque_Nm": 2.8, "weight_kg": 2.1, "name": "S60", "inertia_kgm2": 1e-4}
INERTIAS = {"load_inertia_kgm2": 0.2, "motor": MOTOR}

APPLICATIONS: tuple[Json, ...] = (
    cycle(phase(40, 250)),
    worked_example(),
    worked_example(output_load=LOAD, requirements=REQUIREMENTS, application_area="vacuum", rank_by="life"),
    worked_example(output_load=OFF_CENTRE, emergency_stop={"torque_Nm": 200, "count": 1000}),
    worked_example(
        emergency_stop={"brake": {"torque_Nm": 8, "rise_time_s": 0.1, "load_torque_Nm": 5, "opposing_torque_Nm": 9}},
        requirements=INERTIAS,
    ),
    cycle(phase(-40, 250, 0.5, radial_N=50), phase(0, -1e3, 2.5, axial_N=7), pause_s=4.0, output_load={}),
    cycle(phase(9.3, 0), phase(1e-3, 1e4, 1e-3), requirements={"ratios": [5]}, rank_by="motor_torque"),
    cycle(*(phase(k, 100 + k, 0.1) for k in range(1, 40)), pause_s=1.5),
    cycle(
        phase(40, 250, 1, peak_torque_Nm=60, peak_speed_rpm=400, rms_torque_Nm=45, least_torque_Nm=30)
        | {"name": "lift"},
        phase(9, 0),
        requirements=INERTIAS | {"position_error_at": "rest", "rest_friction_Nm": 2.5},
    ),
    {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {"motor": MOTOR}},
    {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {"motor": CURVED}},
    cycle(phase(20, 250), phase(5, 0), requirements={"motor": CURVED}),
    {"duty_cycle": {"motion": LIFTING}, "rank_by": "motor_torque"},
    worked_example(
        requirements={"worst_case_utilisation": 0.9, "over_tolerance": True},
        tolerances={
            "torque_Nm": {"percent": 10},
            "phases.1.torque_Nm": {"minus": {"percent": 0}, "plus": {"absolute": 3.5}},
            "pause_s": {"percent": 50},
        },
    ),
    {"duty_cycle": {"motion": TURNING}, "tolerances": {"motion.mechanism.inertia_kgm2": {"percent": 5}}},
)

_MODELS = [Application.model_validate(entry) for entry in APPLICATIONS]

JSON = tuple(json.dumps(entry).encode() for entry in APPLICATIONS)
BATCHES = tuple(
    json.dumps({"applications": [{"reference": f"axis {k}", **entry} for k, entry in enumerate(part)]}).encode()
    for part in (APPLICATIONS[:1], APPLICATIONS[:4], APPLICATIONS[2:6], APPLICATIONS[7:])
)
NAMES = {"reference": "plm-4711", "author": "M. Muster", "revision": "B", "ordering_code": "HPN-20A-5-J6-BH-AF1"}
SAVES = tuple(json.dumps({"application": entry, "title": "Axis 7", **NAMES}).encode() for entry in APPLICATIONS)
LINES = tuple(
    b"\n".join(json.dumps({"reference": f"axis {k}", **entry}).encode() for k, entry in enumerate(part)) + b"\n"
    for part in (APPLICATIONS[:1], APPLICATIONS[:3], APPLICATIONS[2:6], APPLICATIONS)
)
NAMED = b"&title=Achse+7&ref=plm-4711&author=M.+Muster&rev=B&order_output=J6&order_motor=AF1&gear=HPN-20A-5"
LINKS = (
    *(to_link(model).removeprefix("/?").encode() for model in _MODELS),
    *(to_link(model).removeprefix("/?").encode() + NAMED for model in _MODELS[1:3]),
)
FORMS = (
    *LINKS,
    *(link + b"&do=" + do for link in LINKS[1:4] for do in (b"add", b"remove:1", b"up:1", b"duplicate:0", b"example")),
    b"phases=40+250+0.3%0A32+500+3%0A20%09250%090.4&tp=4&Tk=200&i=5",
    b"phases=1%3B2%3B3%3B4%3B5&written=de.lb_in.lbf&was=Nm%3A40+N%3A1.5&Tk=200%2C5&gear=HPN-20A-5&pin=HPN-14A-5",
    LINKS[7] + b"&do=varying",
    b"T=40&n=250&t=1&written=de&mcv=0+:+2,8+:+7%0D%0A3000:2:5&Tst=3&mmo=2&mnm=S60",
    LINKS[8] + b"&written=de.lb_in&do=add",
    b"T=354%2C03&n=250&t=0%2C3&written=de.lb_in&was=Nm%3A40&FR=1.234%2C5&gear=HPN-14A-5&pin=HPN-20A-5&unpin=HPN-20A-5",
)
MOTORS = (
    {"designation": "M 40", "maximum_speed_rpm": 6000, "rated_speed_rpm": 3000, "rated_torque_Nm": 2.4},
    {"designation": "M 60", "rated_torque_Nm": 9, "peak_torque_Nm": 27, "inertia_kgm2": 1e-3, "weight_kg": 4.2},
    {"designation": "M 80", "stall_torque_Nm": 30.5, "peak_torque_Nm": 90, "inertia_kgm2": 1e-2},
    {"designation": "M 90", "curve": POINTS, "inertia_kgm2": 1e-4},
)
PAIRED = (
    {"application": cycle(phase(40, 250), requirements=INERTIAS | {"motor": {"inertia_ratio": 5}})},
    {"application": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}}, "best_of": "motor", "drive_resonance_Hz": 9},
    {"application": {"duty_cycle": {"motion": LIFTING}}, "rank_by": "resonance", "top": 1000},
    {"application": worked_example(output_load=LOAD), "rank_by": "utilisation"},
)
PAIRS = tuple(
    json.dumps(entry).encode()
    for entry in (*({**one, "motors": MOTORS} for one in PAIRED), {"name": "Ours", "motors": MOTORS})
)
SIZINGS = tuple(
    json.dumps(shell([section(kind, columns, "/aasx/a.csv", **constants)], mechanism)).encode()
    for kind, columns, constants, mechanism in (
        ("RotativeSection", ROTATIVE, {"LoadTorque": -40.0, "RadialForce": 500, "MomentOfInertiaOfLoad": 0.5}, None),
        (
            *("LinearSection", LINEAR, {"LoadMass": 80, "FrictionForce": 20.5, "CounterMass": 10}),
            element("SpindleDrive", [element("FeedConstant", 0.01), element("InclinationAngle", 0.3)], "Entity"),
        ),
    )
)
MEANINGS = tuple(
    meaning(name).encode() for name in ("LoadTorque", "LoadMass", "FeedConstant", "MotionSectionFile", "Efficiency")
)
"""Sizings in JSON, without the course of their motion, and meanings of their elements."""
MACHINES = tuple(
    json.dumps(machine).encode()
    for machine in (
        {"title": "Line 4", "axes": [{"name": "hub", "quantity": 2, "application": APPLICATIONS[0]}]},
        {
            "reference": "4711",
            "common": {
                "requirements": {"utilisation": 0.9, "natural_frequency_Hz": 5, "ratios": [5, 10]},
                "output_load": {"life_h": 20000, "model": "iso281"},
                "rank_by": "life",
            },
            "axes": [
                {"application": APPLICATIONS[2], "without": ["requirements.utilisation"], "note": "one\nline"},
                {"ordering_code": "HPN-20A-5-J6", "application": APPLICATIONS[3]},
                {"application": {}},
            ],
        },
    )
)

TABLES_OF_PHASES = (
    *(write_table(model.duty_cycle).encode() for model in _MODELS),
    *(write_table(model.duty_cycle, ",").encode() for model in _MODELS[1:]),
    b"Drehmoment [Nm]\tDrehzahl [1/min]\tDauer [s]\n40\t250\t0,3\n32\t500\t3\n",
    "T_Nm;n;t_s;Radiallast (N);Axiallast in N\n1.234;2;3;4;5\n1’234,5;2;3;;\n".encode("cp1252"),
    "\ufefftorque speed duration\r\n40 250 0.3\r\n".encode(),
    "40\t250\t0.3\n32\t500\t3\n".encode("utf-16"),
    b"1.234\t2\t3\n1,234\t2\t3\n",
    b"Zyklus 7\nNr.;T;n;Zeit\n-;kNm;rad/s;ms\n1;0,04;10;300\n2;0,03;20;400\nSumme;;;700\n",
    b"T;n;t;T_max;Spitzendrehzahl;Effektivmoment [kNm]\n40;250;0,3;55;500;0,042\n",
    b"T;n;Endzeit\n40;250;1\n32;500;1e309\n",
    b"Time;T;n\n2026-03-01T08:00:00;40;250\n2026-03-01T08:00:05,5;20;100\nPart 2\n2026-03-01T08:00:09;20;100\n",
    b"T;n;Dauer [hh:mm:ss]\n40 Nm;250;0:00:30\n0.3 kNm;250;PT1M\n",
    b"Torque:\t40 Nm\t32 Nm\nSpeed:\t250 rpm\t500 rpm\nDuration:\t300 ms\t3 s\n",
)

TABLES_OF_AXES = (
    b"Achse;Nr.;Moment [Nm];Drehzahl [1/min];Zeit [ms];Lebensdauer [h]\nHub;1;12,5;250;300;20000\n;2;8;500;2.000;\n",
    b"axis\ttorque_Nm\tspeed_rpm\tduration_s\tratios\tsizes\nA\t1.234\t2\t1\t4/5\t14A\nA\t2\t3\t4\t\t\n",
    "Achse;Moment kNm;Drehzahl;Dauer ms;Maximale Auslastung u;Umgebungstemperatur [°C];Untersetzung;K_3 [Nm/rad]\n"
    "A;0,04;250;300;80 %;25 °C;5:1, 10;5e3\n;8;500;2.5;9.5e1 %;25;i = 5;14 %\n".encode(),
    b"Achse;Moment;Drehzahl;Endzeit\n;Nm;rpm;d\nA;1;2;3\nA;1;2;1e309\n;;;4\nB;1;2;0:00:30\n",
    b"Linie 4\nDrive,Torque (Nm),Speed (rpm),Duration (s),K_3,Load\nx,1,2,3,4,5\ny,1,2,3 ms,-,\n",
)


def _fleets() -> Iterator[bytes]:
    """The applications as tables of axes in both forms."""
    rows = [row_of(f"axis {number}", application) for number, application in enumerate(APPLICATIONS[:6])]
    with tempfile.TemporaryDirectory() as folder:
        for table in (rows, in_long_form(rows), in_long_form(rows, repeated=True)):
            yield write(Path(folder, "axes.csv"), table).read_bytes()


FLEETS = tuple(_fleets())


def _workbook() -> bytes:
    catalogue = load_catalogue()
    selection = select(_MODELS[1], catalogue)
    return workbook(Export(application=_MODELS[1], selection=selection, link="/", catalogue=catalogue), Reader("en"))


def _table() -> bytes:
    book = openpyxl.Workbook()
    sheet = book.create_sheet("Zyklus", 0)
    for row in (["Nr.", "Drehmoment [Nm]", "Drehzahl [1/min]", "Dauer"], [1, 40, 250, 300], [2, "32,5", 500, 200]):
        sheet.append(row)
    sheet["D2"].number_format = '0" ms"'
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


WORKBOOKS = (_workbook(), _table())
"""A report, whose sheets are no table of phases, and a table."""

SIZES = ("14A", "40A")
"""Sizes of the small catalogue that supplements are laid over, so that loading it costs little."""


def small_catalogue() -> Iterator[tuple[str, str]]:
    """The shipped catalogue's files with the rows of two sizes: name and content."""
    for table in TABLES:
        rows = list(csv.reader((HANDBOOK_FOLDER / table.file).read_text(encoding="utf-8").splitlines()))
        written = io.StringIO()
        place = rows[0].index("size") if "size" in rows[0] else None
        csv.writer(written).writerows(row for row in rows if place is None or row[place] in ("size", *SIZES))
        yield table.file, written.getvalue()


SUPPLEMENTS = (
    *(f"{name}\n{content}".encode() for name, content in small_catalogue()),
    b"ratings.csv\nsize,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    b"40A,5,752,400,1250,page 12\n",
    b"bearing_envelopes.csv\nsize,load_coefficient,axial_N,radial_N,source\n"
    b"14A,1,0,500,graph\n14A,1,200,400,graph\n14A,1,600,0,graph\n14A,1.2,0,400,graph\n14A,1.2,500,0,graph\n",
    b"efficiency.csv\nsize,ratio,torque_Nm,efficiency,source\n14A,5,1,0.5,graph\n14A,5,10,0.9,graph\n",
)
"""A file of a supplement each: its name in the first line, its content below."""

OF_THE_PAGE = ("tol", "tol_T", "tols_T", "tol_Tk", "exact", "gear", "pin", "do", "phases", "written", "was")
SYMBOLS = tuple(
    b"&%s=" % name.encode()
    for name in (
        *PHASE_BY_NAME,
        *MOVE_BY_NAME,
        *BY_NAME,
        *LABELS,
        "tol",
        "gear",
        "pin",
        "do",
        "phases",
        "written",
        "was",
    )
)
FIELDS = tuple(
    b'"%s"' % name.encode()
    for name in (
        *("duty_cycle", "phases", "pause_s", "torque_Nm", "speed_rpm", "duration_s", "radial_N", "axial_N"),
        *("emergency_stop", "count", "output_load", "load_coefficient", "life_h", "life_basis", "model", "linear"),
        *("requirements", *REQUIREMENTS, "application_area", "vacuum", "rank_by", "reference", "title", "application"),
        *(
            "motion",
            *TURNING,
            *TURNING["mechanism"],
            *TURNING["moves"][0],
            "peak_torque_Nm",
            "s_curve",
            "rms_torque_Nm",
            "least_torque_Nm",
            "rest",
        ),
        *("shaft_centre_mm", "20A", "others"),
        *("tolerances", "percent", "absolute", "minus", "plus", "phases.1.torque_Nm", "motion.mechanism.mass_kg"),
        *("applications", "digitised", "L10", "", "x" * 300, "\\ud800", "\\u0000", "\u202e"),
    )
)
MARKS = (*FIELDS, b"{}", b"[]", b"[null]", b'""', b"null", b"true", b"{", b"}", b"[", b"]", b",", b":", b"\n", b"\r")
HEADINGS = (
    *(b"torque", b"speed", b"duration", b"Dauer [s]", b"n [1/min]", b"T_Nm", b"radial_N", b"Axiallast in N", b"in"),
    *(
        b"Nr.",
        b"Summe",
        b"kNm",
        b"1/s",
        b"lbf\xc2\xb7in",
        b"ms",
        b"\xe2\x80\xaf",
        b"\xc2\xa0",
        b"\xe2\x88\x92",
        b"%",
        b"-",
    ),
    *(b"\t", b";", b",", b" ", b"\n", b"\r\n", b'"', b'""', b"'", b"\x00", b"1.234", b"1,234", b"1 234"),
)
FLEET_COLUMNS = tuple(
    name.encode() for name in ("axis", *FLEET.all, "", "\n", ",", '"', "[", "]", "{", ":", "null", "[]")
)
COLUMNS = tuple({name.encode() for table in TABLES for name in table.columns()} | {b"14A", b"40A", b"5", b",", b"\n"})

"""`hpn verify`: JSON of answers and machines, and files of machines, which it doesn't calculate again."""

import json

import msgspec
import pytest

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion, answers
from hpn.documents.merge import resolve
from hpn.engine.selection import encode
from hpn.files.export import ExportTitle
from hpn.files.machine import changes_pdf
from hpn.files.machine.changes import DifferencesExport
from hpn.files.machine.export import MachineExport
from hpn.files.machine.gears import gears
from hpn.files.machine.pdf import pdf
from hpn.verify.shown import UnreadableFileError
from hpn.verify.verify import verify
from hpn.words.reader import Reader
from tests.build import Json, cycle, phase, worked_example
from tests.machines import axis, frozen
from tests.report.cases import CASES, CREATED, typed_export_of


def test_an_answer_is_read_by_its_link(catalogue: Catalogue) -> None:
    answer = json.loads(encode(typed_export_of(worked_example(), catalogue).selection))
    assert verify(json.dumps(answer).encode(), catalogue).differs == ()
    answer["duty"]["average_torque_Nm"] *= 1 + 1e-9
    findings = verify(json.dumps(answer).encode(), catalogue).differs
    assert [(one.place, one.reasons) for one in findings] == [("/duty/average_torque_Nm", ("file",))]


def test_a_value_of_a_notice_and_a_verdict_over_tolerances_are_figures_too(catalogue: Catalogue) -> None:
    """Programs read them there, in place of the sentence."""
    answer = json.loads(encode(typed_export_of(CASES["everything"], catalogue).selection))
    assert verify(json.dumps(answer).encode(), catalogue).differs == ()
    place, notice = next((k, one) for k, one in enumerate(answer["notices"]) if "gear_life_h" in one["values"])
    notice["values"]["gear_life_h"] += 1
    findings = verify(json.dumps(answer).encode(), catalogue).differs
    assert [one.place for one in findings] == [f"/notices/{place}/values/gear_life_h"]


OPEN: Json = {"duty_cycle": {"phases": []}}


def machine_of(catalogue: Catalogue) -> Json:
    """A machine of two axes as `GET /machines/{id}` gives it."""
    common: Json = {"requirements": {"life_h": 20000}}
    own = [worked_example(requirements={"ratios": [5]}), OPEN]
    values = [AxisQuestion(resolve(part, common)) for part in own]
    axes = [
        {"number": place, "application": part, "resolved": one.resolved.whole, "answer": msgspec.to_builtins(answer)}
        for place, (part, one, answer) in enumerate(zip(own, values, answers(values, catalogue), strict=True), 1)
    ]
    return {"title": "Line", "common": common, "axes": axes}


def test_a_machine_is_calculated_axis_by_axis(catalogue: Catalogue) -> None:
    machine = machine_of(catalogue)
    verdict = verify(json.dumps(machine).encode(), catalogue)
    assert (verdict.differs, verdict.unchecked) == ((), ())
    assert machine["axes"][0]["answer"]["holds"] is None
    machine["axes"][0]["answer"]["holds"] = True
    holds = verify(json.dumps(machine).encode(), catalogue).differs
    assert [one.place for one in holds] == ["/axes/0/answer/holds"]
    machine["axes"][0]["answer"] |= {"holds": None, "weight_kg": 2.7}
    machine["axes"][0]["resolved"]["requirements"]["life_h"] = 10000
    findings = verify(json.dumps(machine).encode(), catalogue).differs
    assert {one.place for one in findings} == {"/axes/0/answer/weight_kg", "/axes/0/resolved/requirements/life_h"}


def test_a_file_of_a_machine_or_of_two_revisions_is_called_one_and_its_json_is_asked_for(catalogue: Catalogue) -> None:
    """It is no file of an earlier version, and there is no application that could be named with it."""
    before, after = (frozen([axis("Lift", cycle(phase(torque, 250, 2)))], catalogue) for torque in (40, 41))
    place = "http://hpn.example/{}/0123456789abcdefghijkl"
    whole = MachineExport(after, catalogue, place.format("machines"), ExportTitle("Line"), CREATED)
    files = [(make(whole, Reader()), "is of a machine") for make in (pdf, gears)]
    for kind in ("machines", "selections"):
        link = f"{place.format(kind)}/revisions?from=A&to=now"
        compared = DifferencesExport(("A", "now"), (before, after), (catalogue, catalogue), link)
        files.append((changes_pdf.pdf(compared, Reader()), "compares two revisions"))
    for content, message in files:
        with pytest.raises(UnreadableFileError, match=f"{message}, of which the JSON alone is calculated again"):
            verify(content, catalogue)

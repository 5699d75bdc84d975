"""The command line: exit codes, what goes where, and that a mistake is a sentence and not a trace."""

import errno
import io
import json
import os
import signal
import socket
import subprocess
import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import orjson
import pytest

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.cli import main
from tests.build import Json, cycle, phase, worked_example

Output = pytest.CaptureFixture[str]
TOO_MUCH = cycle(phase(100_000, 100))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "application.json"


def write(file: Path, application: Json) -> str:
    file.write_bytes(orjson.dumps(application))
    return str(file)


def test_select_prints_the_choice_every_candidate_and_the_notes(
    file: Path, catalogue: Catalogue, capsys: Output
) -> None:
    code = main(["select", write(file, worked_example()), "--table"])

    out = capsys.readouterr().out
    assert code == 0
    assert out.startswith("selected: HPN-20A-4\n")
    assert out.count("\nHPN-") == len(catalogue.gears)
    assert "HPN-40A" in out and "unrated" in out
    assert "note: " in out


def test_select_json_prints_the_reply_of_the_api(file: Path, capsys: Output) -> None:
    code = main(["select", write(file, worked_example(requirements={"ratios": [5]}))])

    reply = json.loads(capsys.readouterr().out)
    assert code == 0
    assert reply["selected"] == "HPN-20A-5"
    assert reply["link"] == "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


def test_select_reads_standard_input(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    content = io.BytesIO(orjson.dumps(worked_example()))
    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=content))

    assert main(["select", "-", "--table"]) == 0
    assert capsys.readouterr().out.startswith("selected: HPN-20A-4")


def test_no_suitable_gear_is_exit_code_1_with_the_whole_answer(file: Path, capsys: Output) -> None:
    assert main(["select", write(file, TOO_MUCH), "--table"]) == 1
    assert capsys.readouterr().out.startswith("selected: none is suitable")
    assert main(["select", str(file), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["selected"] is None


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"{", "JSON"),
        (b"", "JSON"),
        (b'{"duty_cycle": {"phases": [{"torque_Nm": "40", "speed_rpm": 1, "duration_s": 1}]}}', "phases/0/torque_Nm"),
        (orjson.dumps(cycle(phase(1, 0))), "no phase moves"),
        (orjson.dumps(cycle(phase(1, 1), requirements={"ratios": [6]})), "/requirements/ratios/0: the catalogue has"),
        (orjson.dumps(cycle(phase(1, 1), price=5)), "/price: is not a field"),
        (
            orjson.dumps(cycle(phase(1, 1))).replace(b'"speed', b'"torque_Nm":2,"speed'),
            "contains the name 'torque_Nm' 2 times",
        ),
        (b"\xff\xfe", ""),
    ],
)
def test_wrong_input_is_exit_code_2_with_the_place_on_standard_error(
    file: Path, capsys: Output, content: bytes, words: str
) -> None:
    file.write_bytes(content)

    code = main(["select", str(file)])

    captured = capsys.readouterr()
    assert code == 2
    assert captured.out == ""
    assert words in captured.err
    assert captured.err.strip()
    assert "Traceback" not in captured.err


def test_a_file_that_is_not_there_is_exit_code_2(tmp_path: Path, capsys: Output) -> None:
    assert main(["select", str(tmp_path / "none.json")]) == 2
    assert "none.json" in capsys.readouterr().err


def test_a_file_with_a_byte_order_mark_is_read(file: Path, capsys: Output) -> None:
    file.write_bytes(b"\xef\xbb\xbf" + orjson.dumps(worked_example()))

    assert main(["select", str(file), "--table"]) == 0
    assert capsys.readouterr().out.startswith("selected: HPN-20A-4\n")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("", "is a folder, where a file belongs"),
        ("none.json", "there is no such file"),
        ("none/none.json", "there is no such file"),
        ("text.txt", "is not JSON: expected ident at line 1 column 2; an application is a JSON object"),
        ("blank.json", "is empty; an application is a JSON object"),
        ("powershell.json", "is not text in UTF-8; an application is a JSON object"),
        ("endless", "is larger than an application can be"),
    ],
)
def test_a_file_that_is_no_application_is_named_in_one_line(
    tmp_path: Path, name: str, words: str, capsys: Output
) -> None:
    (tmp_path / "text.txt").write_text("torque speed time", encoding="utf-8")
    (tmp_path / "blank.json").write_text("\n", encoding="utf-8")
    (tmp_path / "powershell.json").write_text("{}", encoding="utf-16")
    (tmp_path / "endless").symlink_to("/dev/zero")

    assert main(["select", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{tmp_path / name}: {words}")
    assert error.count("\n") == 1


def test_many_wrong_fields_are_the_first_twenty(file: Path, capsys: Output) -> None:
    write(file, cycle(*[{**phase(1, 1), "duration_s": "long"}] * 5000))

    assert main(["select", str(file)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) <= 21
    assert lines[0] == "/duty_cycle/phases/0/duration_s: must be a JSON number, such as 9.3"


def test_version_names_engine_and_catalogue(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output, catalogue: Catalogue
) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"HPN Select {ENGINE_VERSION}, catalogue {catalogue.version}\n"

    (tmp_path / "weights.csv").write_text("size,stages,weight_kg,source\n20A,1,2.7,mine\n", encoding="utf-8")
    monkeypatch.setenv("HPN_CATALOGUE_SUPPLEMENT", str(tmp_path))
    assert main(["--version"]) == 0
    assert catalogue.version not in capsys.readouterr().out


def test_a_port_that_is_taken_or_no_address_of_this_machine_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    monkeypatch.setenv("HPN_DATABASE_URL", f"sqlite:///{tmp_path}/store.sqlite3")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]

        assert main(["serve", "--port", str(port)]) == 2
    assert capsys.readouterr().err == (
        f"127.0.0.1 port {port} (HPN_HOST, HPN_PORT): another program listens there; choose another port\n"
    )
    assert not list(tmp_path.iterdir())  # the other's database, maybe
    assert main(["serve", "--host", "192.0.2.1", "--port", "0"]) == 2
    assert "192.0.2.1 port 0 (HPN_HOST, HPN_PORT): can’t be listened on: Cannot assign" in capsys.readouterr().err


def test_a_port_that_permissions_forbid_is_a_sentence(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(socket.socket, "bind", refuse)

    assert main(["serve", "--port", "80"]) == 2
    assert capsys.readouterr().err == (
        "127.0.0.1 port 80 (HPN_HOST, HPN_PORT): can’t be listened on: Permission denied\n"
    )


def test_a_mistake_of_the_program_is_another_code_of_select_than_no_suitable_gear(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    monkeypatch.setattr("hpn.web.settings.load_catalogue", lambda *folders: 1 / 0)
    assert main(["select", write(file, worked_example())]) == 3

    monkeypatch.setattr("hpn.web.settings.load_catalogue", lambda *folders: bytearray(1 << 62))
    assert main(["select", str(file)]) == 3
    assert capsys.readouterr().err.endswith("hpn can’t go on: this takes more memory than there is\n")


def test_a_mistake_of_the_program_is_exit_code_1_in_words_and_a_trace_for_who_asks_for_it(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    monkeypatch.setattr("hpn.cli.catalogue.load_catalogue", lambda *folders: 1 / 0)

    assert main(["catalogue"]) == 1
    assert capsys.readouterr().err == (
        "hpn made a mistake: ZeroDivisionError: division by zero\nHPN_LOG_LEVEL=debug shows where\n"
    )
    monkeypatch.setenv("HPN_LOG_LEVEL", "debug")
    with pytest.raises(ZeroDivisionError):
        main(["catalogue"])


FULL = "hpn can’t go on: No space left on device\n"
SHELL = {
    "output on a full disk": ("hpn catalogue > /dev/full", 1, FULL),
    "answer on a full disk": ('echo "$INPUT" | hpn select - > /dev/full', 3, FULL),
    "no output": ("hpn catalogue >&-", 0, ""),
    "no input": ("hpn select - <&-", 2, "standard input: is closed\n"),
}


@pytest.mark.parametrize("case", SHELL, ids=list(SHELL))
def test_a_stream_that_a_shell_takes_away_is_a_line_at_most(case: str) -> None:
    command, code, error = SHELL[case]
    path = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    environment = {"PATH": path, "INPUT": orjson.dumps(worked_example()).decode()}
    outcome = subprocess.run(["sh", "-c", command], env=environment, capture_output=True, text=True, timeout=60)

    assert (outcome.returncode, outcome.stderr) == (code, error)


def test_an_interruption_ends_it_without_a_word(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    command = [sys.executable, "-m", "hpn", "select", str(tmp_path / "pipe")]
    # Tests started in the background ignore interruptions, and processes inherit that.
    heard = partial(signal.signal, signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(command, stderr=subprocess.PIPE, preexec_fn=heard)
    with process, (tmp_path / "pipe").open("wb"):  # opens when the command reads
        process.send_signal(signal.SIGINT)
        assert process.stderr and process.stderr.read() == b""
    assert process.returncode == 128 + signal.SIGINT


def test_catalogue_lists_every_gear_and_shows_one(catalogue: Catalogue, capsys: Output) -> None:
    assert main(["catalogue"]) == 0
    listed = capsys.readouterr().out
    assert len(listed.splitlines()) == len(catalogue.gears)
    assert listed.count("unrated") == sum(gear.rated_torque_Nm is None for gear in catalogue.gears) > 0

    assert main(["catalogue", "HPN-20-5"]) == 0
    gear = json.loads(capsys.readouterr().out)
    assert (gear["designation"], gear["rated_torque_Nm"]) == ("HPN-20A-5", 80)

    assert main(["catalogue", "HPN-20A-6"]) == 2
    assert "HPN-20A-6" in capsys.readouterr().err


def test_the_list_marks_ratings_that_the_user_supplied(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    titles = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source"
    (tmp_path / "ratings.csv").write_text(f"{titles}\n40A,5,752,400,1250,mine\n20A,5,110,,,mine\n", encoding="utf-8")
    monkeypatch.setenv("HPN_CATALOGUE_SUPPLEMENT", str(tmp_path))

    assert main(["catalogue"]) == 0

    marked = [line for line in capsys.readouterr().out.splitlines() if "supplied" in line]
    assert marked == ["HPN-40A-5   1-stage  T_N 400 Nm (supplied by the user)"]


def test_a_wrong_catalogue_is_exit_code_2_with_file_line_and_column(
    folder: Path, file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    weights = folder / "weights.csv"
    weights.write_text(weights.read_text(encoding="utf-8").replace("0.44", "light"), encoding="utf-8")
    monkeypatch.setenv("HPN_CATALOGUE_FOLDER", str(folder))

    for command in (["catalogue"], ["select", write(file, worked_example())], ["serve"]):
        assert main(command) == 2
        assert "weights.csv, line 2, column weight_kg" in capsys.readouterr().err


def test_a_supplement_is_used_and_a_wrong_setting_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    (tmp_path / "weights.csv").write_text("size,stages,weight_kg,source\n20A,1,2.7,mine\n", encoding="utf-8")
    monkeypatch.setenv("HPN_CATALOGUE_SUPPLEMENT", str(tmp_path))
    assert main(["catalogue", "HPN-20A-5"]) == 0
    assert json.loads(capsys.readouterr().out)["weight_kg"] == 2.7

    monkeypatch.setenv("HPN_MAXIMUM_BODY_BYTES", "many")
    assert main(["catalogue"]) == 2
    assert capsys.readouterr().err == "HPN_MAXIMUM_BODY_BYTES: must be a whole number, such as 5\n"


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"duty_cycle": {"phases": []}}, "/duty_cycle/phases: must have at least 1 item, not 0"),
        (
            cycle(phase(1, 1), requirements={"ratios": [5] * 101}),
            "/requirements/ratios: must have at most 100 items, not 101",
        ),
        (
            cycle(phase(1, 1), requirements={"motor": {"designation": 5}}),
            "/requirements/motor/designation: must be text",
        ),
    ],
)
def test_faults_that_pydantic_finds_are_said_in_plain_words(
    wrong: Json, message: str, file: Path, capsys: Output
) -> None:
    assert main(["select", write(file, wrong)]) == 2
    assert capsys.readouterr().err == f"{message}\n"


def test_a_wrong_setting_is_named_as_it_was_given(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    monkeypatch.setenv("HPN_GUARDED", "all,none")
    monkeypatch.setenv("HPN_PORT", "abc")
    assert main(["serve"]) == 2
    first, *rest = sorted(capsys.readouterr().err.splitlines())
    assert first.startswith("HPN_GUARDED: must be 'calculator', 'batch'")
    assert [line.split(":")[0] for line in rest] == ["HPN_PORT"]  # and both wrong words are one line

    monkeypatch.delenv("HPN_GUARDED")
    assert main(["serve", "--port", "70000"]) == 2
    assert capsys.readouterr().err == "--port: must be less than or equal to 65535\n"


@pytest.mark.parametrize(
    "arguments",
    [["select", "-", "--json"], ["select", "-", "--table"], ["catalogue"], ["catalogue", "HPN-20-5"]],
    ids=" ".join,
)
def test_a_reader_who_has_seen_enough_ends_it_quietly(arguments: list[str]) -> None:
    command = [sys.executable, "-m", "hpn", *arguments]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin and process.stdout and process.stderr
        process.stdout.close()
        if "-" in arguments:
            process.stdin.write(orjson.dumps(worked_example()))
        process.stdin.close()

        assert process.stderr.read() == b""
    assert process.returncode == 128 + signal.SIGPIPE  # as a shell says it of a program that SIGPIPE has ended


@pytest.mark.parametrize("command", [["mcp"], ["fleet", "axes.csv", "answers.csv"]])
def test_a_service_that_is_no_address_is_refused(command: list[str], capsys: Output) -> None:
    with pytest.raises(SystemExit) as ended:
        main([*command, "--service", "plm.example"])

    assert ended.value.code == 2
    assert "must be an address, such as https://plm.example; 'plm.example' is none" in capsys.readouterr().err

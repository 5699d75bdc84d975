"""Help and usage of the command line: every command, option, setting and exit code is told."""

import re
from pathlib import Path

import pytest

from hpn.cli import main
from hpn.web.settings import Settings

Output = pytest.CaptureFixture[str]


@pytest.mark.parametrize(
    "arguments", [[], ["selct"], ["select"], ["select", "a", "b"], ["serve", "--port", "http"], ["--port"], ["key"]]
)
def test_a_wrong_command_is_exit_code_2_with_usage(arguments: list[str], capsys: Output) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(arguments)

    assert exit_.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith("usage: hpn")
    assert error.count("\n") == 2 and "error: " in error


def test_help_names_every_command(capsys: Output) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(["--help"])

    assert exit_.value.code == 0
    out = capsys.readouterr().out
    assert re.findall(r"^ {4}(\w+)", out.partition("exit codes")[0], re.M) == [
        "select",
        "fleet",
        "machine",
        "verify",
        "catalogue",
        "serve",
        "mcp",
        "database",
        "key",
    ]


COMMANDS = [
    *(["select"], ["fleet"], ["machine", "export"], ["machine", "import"], ["verify"]),
    *(["catalogue"], ["serve"], ["mcp"], ["database"], ["key"]),
]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_of_a_command_says_what_it_and_all_it_takes_is_for(command: list[str], capsys: Output) -> None:
    with pytest.raises(SystemExit):
        main([*command, "--help"])

    out = capsys.readouterr().out
    paragraphs = out.split("\n\n")
    assert paragraphs[0].startswith(f"usage: hpn {' '.join(command)} ")
    assert paragraphs[1].endswith(".") and paragraphs[1][0].isupper()
    assert out.rstrip().endswith("hpn --help has the exit codes and all settings.")
    entries = re.findall(r"^  (\S.*(?:\n {10}.*)*)$", out, re.M)
    alone = [entry for entry in entries if "\n" not in entry and "  " not in entry]
    assert len(entries) > 0
    assert alone == []


def test_help_has_every_setting_with_its_default_and_every_exit_code(capsys: Output) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])

    out = capsys.readouterr().out
    view = dict(re.findall(r"^  (HPN_[A-Z_]+)(?: \((.*)\))?$", out, re.M))
    assert set(view) == {f"HPN_{name.upper()}" for name in Settings.model_fields}
    assert (view["HPN_PORT"], view["HPN_API_KEYS"]) == ("8000", "")
    assert view["HPN_GUARDED"] == "batch,deleting,listing,writing"
    assert view["HPN_DATABASE_URL"] == "sqlite:///hpn.sqlite3"
    words = " ".join(out.split())
    assert all((field.description or "?") in words for field in Settings.model_fields.values())
    table = (Path(__file__).parents[2] / "docs/command-line.md").read_text()
    codes = re.findall(r"^\| (\d) \|", table, re.M)
    assert re.findall(r"^  (\d) ", out, re.M) == codes == ["0", "1", "2", "3"]

"""The notebook in docs runs from the first cell to the last, as a reader's own installation runs it."""

import ast
import contextlib
import io
import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

NOTEBOOK = Path(__file__).parents[2] / "docs/python.ipynb"


def run(source: str, names: dict[str, Any]) -> Any:
    """Value of the last expression of a cell, as a notebook shows it."""
    tree = ast.parse(source)
    last = tree.body[-1]
    if not isinstance(last, ast.Expr):
        exec(compile(tree, NOTEBOOK.name, "exec"), names)
        return None
    exec(compile(ast.Module(tree.body[:-1], []), NOTEBOOK.name, "exec"), names)
    return eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names)


def test_each_cell_of_the_notebook_runs_and_shows_what_its_text_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    monkeypatch.chdir(tmp_path)
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all((cell["outputs"], cell["execution_count"]) == ([], None) for cell in cells)  # a reader's own come there
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])

    view, printed, names = dict[str, Any](), dict[str, str](), dict[str, Any]()
    for cell in cells:
        with contextlib.redirect_stdout(io.StringIO()) as output:
            view[cell["id"]] = run("".join(cell["source"]), names)
        printed[cell["id"]] = output.getvalue()

    assert "HPN-20A-5" in view["select"]._repr_html_()
    assert printed["parts"].startswith("HPN-20A-5 0.78125 momentary_peak_torque 1167275.9")
    assert printed["smaller"].startswith("Load limit 3: momentary peak torque is at 186.9 % of its limit")
    assert list(view["candidates"]["designation"][:2]) == ["HPN-20A-5", "HPN-32A-5"]
    assert view["size"]["axis"].to_list() == ["lift", "gripper", "press"]
    assert view["size"]["selected"].to_list()[2] is None
    assert list(view["long"]["axis"]) == [7, 7, 8]
    assert view["rejected"]["column"] == ["speed_rpm"]
    assert isinstance(view["study"], pd.DataFrame) and view["study"]["selected"].notna().any()
    assert printed["catalogue"].endswith("149.0\n")
    assert printed["errors"].splitlines()[-1] == "/rank: is not a field of this object; it looks like rank_by"
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")

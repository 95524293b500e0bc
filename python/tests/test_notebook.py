"""The notebook of the documents runs, cell by cell."""

import contextlib
import io
from pathlib import Path

import pytest

import frazil

NOTEBOOK = Path(__file__).parents[2] / "docs" / "python.ipynb"


def test_the_notebook_holds_what_it_says(monkeypatch):
    nbformat = pytest.importorskip("nbformat")
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(cells) >= 4
    assert not any(cell.outputs for cell in cells), "outputs are made by whoever reads it"
    names, said = {"__name__": "__main__"}, io.StringIO()
    with contextlib.redirect_stdout(said):
        for number, cell in enumerate(cells):
            exec(compile(cell.source, f"cell {number}", "exec"), names)
    assert {run.record["method"] for run in names["runs"].values()} == {method.name for method in frazil.methods()}
    assert isinstance(names["mine"], frazil.Run) and names["mine"].outcome == "ok"

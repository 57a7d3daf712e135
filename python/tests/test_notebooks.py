"""Notebooks run from their first cell to their last, and are kept with what they gave."""

from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook(path):
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    book = nbformat.read(path, as_version=4)
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    needs = any("data/measured" in cell.source for cell in cells)
    if needs and not (path.parents[2] / "data" / "measured").exists():
        pytest.skip("outside of the repository")
    assert all(cell.outputs for cell in cells), "python generate.py notebooks runs them"
    assert all(output.output_type != "error" for cell in cells for output in cell.outputs)
    nbclient.NotebookClient(book, timeout=120, resources={"metadata": {"path": str(path.parent)}}).execute()
    for cell in book.cells:
        for output in cell.get("outputs", []):
            print(output.get("text", ""), end="")

from pathlib import Path

import pytest

from cityx.errors import MissingDependency
from cityx.viewer.page import page_folder

NOTEBOOK = Path(__file__).parents[2] / "examples" / "notebook" / "city.ipynb"


def test_the_notebook_carries_no_outputs():
    nbformat = pytest.importorskip("nbformat")
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    code = [cell for cell in cells if cell.cell_type == "code"]
    assert code
    assert all(not cell.outputs and cell.execution_count is None for cell in code)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")
def test_the_notebook_runs(tmp_path):
    """Every cell runs in a kernel of its own, without a front end that would show its outputs.

    A project shows picture and plan, a plot its picture, and the page is in a frame.
    """
    for name in ("starlette", "uvicorn"):
        pytest.importorskip(name, reason="cityx view needs the extra view")
    try:
        page_folder()
    except MissingDependency as error:
        pytest.skip(str(error))
    nbformat, nbclient = map(pytest.importorskip, ("nbformat", "nbclient"))
    pytest.importorskip("ipykernel", reason="no kernel: pip install -e '.[dev]'")
    pytest.importorskip("matplotlib")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(
        notebook, timeout=600, resources={"metadata": {"path": tmp_path}}
    ).execute()
    shown = [
        output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs
    ]
    kinds = {kind for output in shown for kind in output.get("data", ())}
    assert {"text/html", "image/png"} <= kinds
    pages = [output.data.get("text/html", "") for output in shown if "data" in output]
    cities = [page for page in pages if "<svg" in page]
    assert len(cities) == len(set(cities)) == 2  # before and after a change
    assert all('src="data:image/jpeg;base64,' in page for page in cities)
    assert sum('<iframe src="http://127.0.0.1:' in page for page in pages) == 1
    assert shown[-1].text.strip().endswith("True")
    assert (tmp_path / "city.glb").stat().st_size > 10_000

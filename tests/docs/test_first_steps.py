"""The first page of `docs`: a notebook that runs, whose results and progress are seen."""

import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from harness.api import stepping_engines

ROOT = Path(__file__).parents[2]
ENGINES = stepping_engines(None)
pytestmark = pytest.mark.slow  # a kernel, seven runs and two figures

PAGE = ROOT / "docs" / "first-steps.ipynb"


class Recorded(NotebookClient):
    """Runs a notebook and keeps what its outputs showed before they were replaced."""

    shown: list[str]

    def process_message(self, msg: dict[str, Any], cell: Any, cell_index: int) -> Any:
        """Keep the HTML of an output that is shown or replaced."""
        if msg["msg_type"] in {"display_data", "update_display_data"}:
            self.shown.append(msg["content"]["data"].get("text/html", ""))
        return super().process_message(msg, cell, cell_index)


@pytest.fixture(scope="module")
def executed(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    notebook = nbformat.read(PAGE, as_version=4)  # type: ignore[no-untyped-call]
    folder = str(tmp_path_factory.mktemp("notebook"))
    client = Recorded(notebook, kernel_name="python3", resources={"metadata": {"path": folder}})
    client.shown = []
    client.execute()
    return client


def codes(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def results(executed: Recorded) -> list[dict[str, Any]]:
    """Return what each cell shows as its result."""
    return [
        next((o.data for o in cell.outputs if o.output_type == "execute_result"), {})
        for cell in codes(executed.nb)
    ]


def test_the_first_cell_is_the_example_of_the_first_page() -> None:
    page = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    first = codes(nbformat.read(PAGE, as_version=4))[0]  # type: ignore[no-untyped-call]
    assert first.source == example.rstrip("\n")


def test_it_is_committed_without_outputs() -> None:
    cells = codes(nbformat.read(PAGE, as_version=4))  # type: ignore[no-untyped-call]
    assert [cell.outputs for cell in cells] == [[]] * len(cells)


def test_a_run_and_a_comparison_show_a_table_and_a_figure(executed: Recorded) -> None:
    _, run, _, comparison, _ = results(executed)
    for shown, words in ((run, "angle of turn"), (comparison, "mujoco")):
        html = shown["text/html"]
        assert words in html
        assert html.count("<table") == 1
        assert html.count('<img src="data:image/svg+xml,') == 1
        assert "<script" not in html


def test_plots_are_interactive_figures(executed: Recorded) -> None:
    phi, convergence = (
        output.data["application/vnd.plotly.v1+json"]
        for cell in codes(executed.nb)
        for output in cell.outputs
        if "application/vnd.plotly.v1+json" in output.get("data", {})
    )
    assert {trace["name"] for trace in phi["data"]} == {"exact", "mujoco, adaptive"}
    names = {f"{engine}, {word}" for engine in ENGINES for word in ("matched", "default")}
    assert names <= {trace["name"] for trace in convergence["data"]}


def test_progress_is_shown_and_leaves(executed: Recorded) -> None:
    bars = [html for html in executed.shown if "simulating" in html]
    assert len(bars) > len(["one", "a replaced one"])
    assert "{0}/{0}".format(3 * len(ENGINES)) in bars[-1]
    outputs = codes(executed.nb)[0].outputs
    assert [o.data for o in outputs if o.output_type == "display_data"] == [{}]
    assert [o.text for o in outputs if o.output_type == "stream" and o.name == "stderr"] == []

"""`rockingcan check`: a table or JSON, and an exit code that says whether the contract is kept."""

import json
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from harness.cli import catalogue as command
from harness.cli.catalogue import check
from harness.core.errors import InvalidSettingError, UnknownEngineError
from harness.engines.base import Capabilities
from harness.engines.conformance import CLAUSES

app = typer.Typer()
app.command()(check)


def ask(*words: str) -> tuple[int, Any]:
    """Return the exit code and the JSON of the command."""
    done = CliRunner().invoke(app, [*words, "--json"])
    return done.exit_code, json.loads(done.stdout)


def test_an_engine_that_keeps_the_contract_leaves_with_zero() -> None:
    code, answer = ask("reference")
    assert code == 0
    assert answer["engine"] == "reference"
    assert answer["conforms"] is True
    assert [each["name"] for each in answer["checks"]] == list(CLAUSES)
    assert {each["result"] for each in answer["checks"]} == {"passed", "not applicable"}


class Broken:
    """Keeps next to nothing."""

    name = "broken"
    version = "1"
    settings = ()
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def timestep(self, case: object) -> None:
        """Return None."""

    def simulate(self, case: object) -> None:
        """Raise nothing and return nothing."""


def test_an_engine_that_breaks_it_leaves_with_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "engine", lambda _: Broken())
    code, answer = ask("broken")
    assert code == 1
    assert answer["conforms"] is False
    failed = {each["name"]: each["detail"] for each in answer["checks"]}
    assert failed["trajectory"] == "`simulate` returned NoneType, not a Simulation"
    table = CliRunner().invoke(app, ["broken"])
    assert table.exit_code == 1
    assert "failed" in table.stdout


def test_an_unknown_engine_is_wrong_use() -> None:
    with pytest.raises(UnknownEngineError) as caught:
        CliRunner().invoke(app, ["nothing"], catch_exceptions=False)
    assert caught.value.name == "nothing"
    assert "mujoco" in caught.value.available


@pytest.mark.slow
def test_capabilities_are_measured_with_the_settings_that_were_asked_for() -> None:
    words = ("mujoco", "--capabilities", "--profile", "default", "--timestep", "0.004")
    code, answer = ask(*words)
    assert code == 0
    assert (answer["profile"], answer["timestep_s"]) == ("default", 0.004)
    effects = {finding["effect"] for finding in answer["findings"]}
    assert {"compliance", "rim", "damping", "gyroscopic term"} <= effects
    assert "compliance" in CliRunner().invoke(app, words).stdout


def test_the_reference_has_no_world_to_probe() -> None:
    with pytest.raises(InvalidSettingError) as caught:
        CliRunner().invoke(app, ["reference", "--capabilities"], catch_exceptions=False)
    assert (caught.value.name, caught.value.value) == ("engine", "reference")

"""What an engine declares of itself reaches every part of the program, and nothing else is told."""

import json
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness import api
from harness.cli.main import code_of
from harness.core.case import Case
from harness.core.engine_packages import ENGINE_ENTRY_POINTS, engine_packages, packages_of
from harness.core.errors import UnsupportedEffectError
from harness.core.provenance import provenance
from harness.core.report_model import Figure, Panel, Series
from harness.engines import registry
from harness.engines.description import Description, Method, Precision
from harness.evaluation.effort import expected_seconds, expected_steps
from harness.report.style import LineStyle, entries, palette
from models import Effects, RoundedRim, Scene
from tests.benchmarks.lean import builds_both

ADAPTER = """\
from harness.engines import Capabilities, Description, Method, Precision


class Glider:
    name, version = "glider", "2.5"
    settings = ()
    capabilities = Capabilities(honours=frozenset({{"rim"}}), imposes={{}})
    {description}

    def timestep(self, case):
        return case.timestep or 1e-3

    def simulate(self, case):
        raise NotImplementedError
"""

DESCRIBED = (
    'description = Description(label="The Glider", light="#010203", dark="#fdfcfb", dashes=(9, 4), '
    "precision=Precision.SINGLE, method=Method.CONSTRAINT, tells_forces=False, by_default=False, "
    "step_s=0.25)"
)

Register = Callable[[str], None]


@pytest.fixture
def register(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Register]:
    """Return a function that installs a package which registers the engine `glider`."""
    cached = (packages_of, engine_packages, registry.engine, registry.description_of)

    def forget() -> None:
        for each in cached:
            each.cache_clear()

    def install(description: str) -> None:
        metadata = tmp_path / "site" / "glider_kit-1.5.dist-info"
        metadata.mkdir(parents=True)
        text = "Metadata-Version: 2.4\nName: Glider_Kit\nVersion: 1.5\n"
        (metadata / "METADATA").write_text(text, encoding="utf-8")
        entry = f"[{ENGINE_ENTRY_POINTS}]\nglider = glider_adapter:Glider\n"
        (metadata / "entry_points.txt").write_text(entry, encoding="utf-8")
        adapter = ADAPTER.format(description=description)
        (metadata.parent / "glider_adapter.py").write_text(adapter, encoding="utf-8")
        monkeypatch.syspath_prepend(metadata.parent)
        monkeypatch.delitem(sys.modules, "glider_adapter", raising=False)
        forget()

    # tried in a process of its own, in which this package is not installed
    monkeypatch.setattr(registry, "crash_reason", lambda _: "")
    monkeypatch.setattr(registry, "timestep_from_worker", lambda _, case: case.timestep or 1e-3)
    yield install
    forget()


def curve(*kinds: str) -> Figure:
    """Return a figure with a curve of each kind."""
    x = np.arange(3.0)
    series = tuple(Series(label=kind, kind=kind, x=x, y=x) for kind in kinds)
    panel = Panel(title="", x_label="t", y_label="phi", series=series)
    return Figure(name="curves", title="Curves", seen="", panels=(panel,))


def test_what_it_declares_reaches_colours_estimates_and_lists(
    register: Register, gentle: Scene, capsys: pytest.CaptureFixture[str]
) -> None:
    register(DESCRIBED)
    inks = palette(("glider", "mujoco", "reference"))
    assert inks["glider"] == LineStyle(light="#010203", dark="#fdfcfb")
    dashes = {entry.kind: entry.dashes for entry in entries(curve("glider", "mujoco"))}
    assert dashes == {"glider": (9, 4), "mujoco": ()}
    case = Case(scene=gentle, engine="glider", timestep=1e-3)
    assert expected_seconds(case) == pytest.approx(0.25 * expected_steps(case), abs=0.2)
    assert code_of(["engines", "--json"]) == 0
    told = {each["name"]: each for each in json.loads(capsys.readouterr().out)["engines"]}
    for key, value in {
        "label": "The Glider",
        "version": "2.5",
        "method": "constraint",
        "precision": "single",
        "tells_forces": False,
        "by_default": False,
    }.items():
        assert told["glider"][key] == value


def test_it_takes_part_where_it_is_named_or_all_are(register: Register) -> None:
    register(DESCRIBED)
    assert "glider" not in api.stepping_engines(None)
    assert api.stepping_engines(["glider"]) == ("glider",)
    every = api.stepping_engines(["all"])
    assert {"glider", "mujoco"} <= set(every)
    assert "reference" not in every
    assert "all" not in every


def test_what_is_not_installed_is_missed_where_it_would_take_part(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    described = {"quiet": Description(by_default=False)}
    monkeypatch.setattr(registry, "not_installed", lambda: ("mujoco", "quiet"))
    for module in (registry, api):
        monkeypatch.setattr(module, "description_of", lambda n: described.get(n, Description()))
    assert api.absent_engines(None) == registry.left_out() == ("mujoco",)
    assert api.absent_engines(["all"]) == ("mujoco", "quiet")
    assert api.absent_engines(["quiet"]) == ()
    assert "mujoco" not in api.stepping_engines(["all"])


def test_its_package_is_in_provenance_and_it_is_said_to_be_able(
    register: Register, gentle: Scene
) -> None:
    register("")
    rounded = replace(gentle, effects=Effects(rim=RoundedRim(radius=1e-3)))
    assert provenance().packages["glider-kit"] == "1.5"
    with pytest.raises(UnsupportedEffectError) as caught:
        registry.check_effects("mujoco", rounded)
    assert "glider" in caught.value.able
    assert not builds_both("glider")


@pytest.mark.parametrize("declared", ["", "description = 'a text'"])
def test_what_declares_nothing_has_the_defaults(register: Register, declared: str) -> None:
    register(declared)
    assert registry.description_of("glider") == Description()
    assert "glider" in api.stepping_engines(None)
    inks = palette(("glider", "mujoco", "reference"))
    assert len({ink.light for ink in inks.values()}) == 3
    assert entries(curve("glider"))[0].dashes == ()


def test_no_engine_of_ours_is_described_twice() -> None:
    for name in registry.our_names():
        if name not in registry.not_installed():
            made: Any = registry.engine(name)
            if hasattr(made, "description"):
                assert made.description is registry.description_of(name)


def test_a_colour_that_an_engine_has_is_nobody_elses() -> None:
    described = {name: registry.description_of(name) for name in registry.our_names()}
    some = ["reference", "mujoco", "pybullet", *(f"further {n}" for n in range(len(described) - 3))]
    for kinds, face in product((described, some), ("light", "dark")):
        colours = [getattr(ink, face) for ink in palette(kinds).values()]
        assert len(set(colours)) == len(colours)
        assert all(re.fullmatch("#[0-9a-f]{6}", colour) for colour in colours)


def test_an_engine_that_is_not_known_has_the_defaults() -> None:
    assert registry.description_of("no-such-engine") == Description()
    said = Description()
    assert (said.precision, said.method) == (Precision.DOUBLE, Method.FIXED_TIMESTEP)

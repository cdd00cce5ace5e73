"""The clock of the benchmark, and that its claims are computed; speed is not for tests to say."""

import json
import math
import re
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from harness.cli.main import code_of
from reference.numerics.compiled import available
from tests.benchmarks import __main__ as program
from tests.benchmarks import engines, friction, heyoka_rows, lean, reference, start_up, whole_jobs
from tests.benchmarks.clock import Ratio, in_turns, paired, seconds
from tests.benchmarks.lean import Lean

Benchmark = Callable[..., tuple[int, dict[str, list[dict[str, Any]]]]]


def _work(rounds: int) -> int:
    return sum(range(rounds))


def test_work_of_twice_the_size_takes_longer() -> None:
    short, long = in_turns(lambda: _work(200_000), lambda: _work(2_000_000))
    assert 0.0 < short < long


def test_each_has_as_many_runs_in_its_turn() -> None:
    order: list[str] = []
    in_turns(lambda: order.append("a"), lambda: order.append("b"), repeats=2, runs=3)
    # once to warm up
    assert "".join(order) == "ab" + 2 * "aaabbb"


def test_a_median_of_pairs_does_not_mind_a_few_that_are_disturbed() -> None:
    first, second = np.full(25, 3.0), np.full(25, 2.0)
    first[:3] *= 10.0
    second[-3:] *= 10.0
    ratio, (low, high) = paired(first.tolist(), second.tolist())
    assert (ratio, low, high) == (1.5, 1.5, 1.5)
    # of 25 the 8th and the 18th: 95 of 100 samples of 25 have their median between them
    ratio, (low, high) = paired([float(n) for n in range(1, 26)], [1.0] * 25)
    assert (ratio, low, high) == (13.0, 8.0, 18.0)


def test_only_the_processor_counts() -> None:
    # sleeping is not work: a tenth of the nap leaves room for the calls around it
    assert seconds(lambda: time.sleep(0.05)) < 0.005


def test_both_solvers_are_given_the_same_releases() -> None:
    few = {name: values[:2] for name, values in reference._releases(2).items()}  # noqa: SLF001
    own, scipy = reference._batch(few), reference._by_scipy(few)  # noqa: SLF001
    # DOP853 at rtol 1e-12 keeps a turn of a few radians to some hundred times that
    assert own == pytest.approx(scipy, abs=1e-9)


@pytest.fixture
def benchmark(capsys: pytest.CaptureFixture[str]) -> Benchmark:
    """Return a function that runs the command, and returns its exit code and its JSON object."""

    def run(*words: str) -> tuple[int, dict[str, list[dict[str, Any]]]]:
        capsys.readouterr()
        code = code_of([*words, "--json"], program.app, "rockingcan benchmark")
        return code, json.loads(capsys.readouterr().out)

    return run


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure each claim on little work, and once: the same program, and ratios that say nothing.

    Engines take 4,000 steps where the benchmark takes 400,000.
    """
    for module, sizes in (
        (start_up, {"_ROUNDS": 1, "_COMMANDS": ((("--version",), 4.0), (("scenes",), None))}),
        (reference, {"_BATCH": 1000, "_SCIPY_RELEASES": 1, "_SIDE": 20}),
        (reference, {"_HEYOKA_RELEASES": 80}),
        (reference, {"_TURNS": 1, "_RUNS": 1}),
        (friction, {"SCENES": friction.SCENES[:1], "_TOLERANCES": ((1e-6, 1e-3),), "_REPEATS": 1}),
        (friction, {"_TURNS": 1, "_RUNS": 1}),
        (
            whole_jobs,
            {
                "_MANY": 1000,
                "_MORE": 1_000_000,
                "_STARTS": 1,
                "_QUICK_SUITE": 1000.0,
                "_SUITE": ("run", "gentle-rock", "--engine", "mujoco"),
            },
        ),
        (engines, {"_PAIRS": {1e-4: 1}, "_BRIEF": 1}),
        (engines, {"_RELEASES": 3, "_FIXED": (1e-3,)}),
        (lean, {"names": lambda: ("gentle-rock",), "PIECE": 0.1, "PAIRS": 1, "_FEW": 1}),
    ):
        for name, size in sizes.items():
            monkeypatch.setattr(module, name, size)


def bound_holds(row: dict[str, Any]) -> bool:
    """Whether a ratio keeps the bound that is claimed of it in words."""
    at_least = re.search(r"at least ([\d,.]+) times", row["claim"])
    at_most = re.search(r"at most ([\d,.]+)", row["claim"])
    within = re.search(r"under ([\d.,e-]+) s", row["claim"])
    held: dict[re.Match[str] | None, Callable[[float], bool]] = {
        at_least: lambda limit: row["ratio"] >= limit,
        at_most: lambda limit: row["ratio"] <= limit,
        within: lambda limit: row["first_s"] < limit,
    }
    ((found, holds),) = [(one, holds) for one, holds in held.items() if one is not None]
    return holds(float(found[1].replace(",", "")))


@pytest.mark.slow
@pytest.mark.usefixtures("small")
def test_a_small_benchmark_measures_every_claim(benchmark: Benchmark) -> None:
    code, found = benchmark("--engine", "mujoco")
    ratios, lean_ones = found["ratios"], found["lean"]
    # two commands; the exact bounce, the integrator over one bounce and three, the map, a can that
    # is dropped; friction, and laws not declared; three whole jobs; of the engine two loops, a
    # batch, adaptive steps; over heyoka the exact bounce at two tolerances and the integrator
    rivals = 0 if heyoka_rows.missing() else 3
    assert len(ratios) == 16 + rivals
    assert sum("heyoka" in row["what"] for row in ratios) == rivals
    assert [(one["who"], one["scene"]) for one in lean_ones] == [
        ("mujoco", "gentle-rock"),
        ("reference", "gentle-rock"),
    ]
    for row in ratios:
        first, second = row["first_s"], row["second_s"]
        assert 0.0 < min(first, second) <= max(first, second) < math.inf
        # times are rounded on their way, a part in 1e6 is less than any claim rests on
        if row["interval"] is None:
            assert pytest.approx(row["ratio"], rel=1e-6) in (first / second, second / first)
        else:
            low, high = row["interval"]
            assert low <= row["ratio"] <= high
        if row["claim"]:
            # of memory a child has at least what this process had when it was started
            more = any(word in row["claim"] for word in ("accurate", "MB"))
            assert bound_holds(row) or not row["holds"]
            assert row["holds"] or more or not bound_holds(row)
        else:
            assert row["holds"]
    # what is claimed of the integrator over heyoka is that of compiled code
    assert sum(bool(row["claim"]) for row in ratios) == 12 + available() + rivals
    assert code == (0 if all(row["holds"] for row in [*ratios, *lean_ones]) else 1)


RATIO = Ratio(what="a", ratio=2.0, claim="", holds=True, first_s=2.0, second_s=1.0, note="")
LEAN = Lean(
    scene="gentle-rock",
    who="mujoco",
    model="condim 3",
    ratio=1.5,
    claim="at least 1.2",
    quantity="turn",
    difference=1e-9,
    tolerance=1e-5,
    holds=True,
    lean_s=1.0,
    everything_s=1.5,
)


@pytest.mark.parametrize(
    ("ratio", "part", "code"),
    [
        (RATIO, LEAN, 0),
        (replace(RATIO, holds=False), LEAN, 1),
        (RATIO, replace(LEAN, holds=False), 1),
    ],
)
def test_a_claim_that_does_not_hold_is_a_failure(
    benchmark: Benchmark, monkeypatch: pytest.MonkeyPatch, ratio: Ratio, part: Lean, code: int
) -> None:
    monkeypatch.setattr(program, "start_up_ratios", list)
    monkeypatch.setattr(program, "reference_ratios", lambda: [RATIO, ratio])
    monkeypatch.setattr(program, "friction_ratios", list)
    monkeypatch.setattr(program, "whole_job_ratios", list)
    monkeypatch.setattr(program, "engine_ratios", lambda _: [RATIO])
    monkeypatch.setattr(program, "lean_ratios", lambda _: [part, LEAN])
    told = {"ratios": [asdict(one) for one in (RATIO, ratio, RATIO)]}
    told["lean"] = [asdict(one) for one in (part, LEAN)]
    assert benchmark("--engine", "mujoco") == (code, told)

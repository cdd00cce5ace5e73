"""Plans: which scenes, cut how, and what is refused before anything runs."""

import tracemalloc
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.errors import HarnessError
from harness.sweep.axes import Axis, read_axis
from harness.sweep.parameters import PARAMETERS, scene_at
from harness.sweep.plan import plan_sweep
from models import load
from tests.support.examples import examples
from tests.support.sweeps import make_plan

TURN = ("angle_of_turn_deg",)


def test_a_grid_holds_both_ends_and_its_last_axis_varies_fastest() -> None:
    chosen = make_plan("gentle-rock", "release.psi_dot=-1:1:3", "can.h=log:0.1:10:3")
    values = chosen.values(range(chosen.rows))
    assert chosen.rows == 9
    assert values["release.psi_dot"].tolist() == [-1.0] * 3 + [0.0] * 3 + [1.0] * 3
    assert values["can.h"].tolist() == pytest.approx([0.1, 1.0, 10.0] * 3, rel=1e-15, abs=0)


@settings(max_examples=examples(3))
@given(data=st.data(), spacing=st.sampled_from(["even", "log"]), count=st.integers(1, 3000))
def test_values_of_a_grid_are_those_of_numpy_to_the_bit(
    data: st.DataObject, spacing: str, count: int
) -> None:
    log = spacing == "log"
    numbers = st.floats(1e-100 if log else -1e100, 1e100)
    low, high = data.draw(numbers), data.draw(numbers)
    axis = Axis(name="release.psi_dot", low=low, high=high, count=count, log=log)
    whole = (np.geomspace if log else np.linspace)(low, high, count)
    cut = data.draw(st.integers(0, count))
    for places in (np.arange(cut), np.arange(cut, count), np.array([count // 2, 0, count - 1])):
        assert axis.values(places).tobytes() == whole[places].tobytes()


@pytest.mark.parametrize("spacing", ["", "log:"])
def test_a_long_axis_takes_no_memory(spacing: str) -> None:
    chosen = make_plan("gentle-rock", f"release.psi_dot={spacing}0.5:2:60000000")
    tracemalloc.start()
    try:
        first, last = (
            chosen.values(chosen.span(0)),
            chosen.values(chosen.span(chosen.partitions - 1)),
        )
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 8e6  # fifteen columns of a partition of 65536; the axis itself is 480 MB
    assert first["release.psi_dot"][0] == 0.5
    assert last["release.psi_dot"][-1] == 2.0


@pytest.mark.parametrize("sample", ["random", "sobol", "halton"])
@settings(max_examples=examples(1 / 4))
@given(cut=st.integers(1, 999))
def test_a_row_of_a_sample_depends_on_its_number_alone(sample: str, cut: int) -> None:
    chosen = plan_sweep(
        load("gentle-rock"),
        [read_axis("release.psi_dot=-1:1"), read_axis("can.h=log:0.1:10")],
        sample=sample,
        count=1000,
        seed=3,
    )
    whole = chosen.values(range(1000))
    parts = [chosen.values(range(cut)), chosen.values(range(cut, 1000))]
    for name, column in whole.items():
        assert np.array_equal(column, np.concatenate([part[name] for part in parts]))
        axis = next(axis for axis in chosen.axes if axis.name == name)
        assert (column >= axis.low).all()
        assert (column <= axis.high).all()


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("horizon.bounces=1:5:5", [1, 2, 3, 4, 5]),
        ("horizon.bounces=9:1:3", [9, 5, 1]),
        ("horizon.bounces=log:1:100000:6", [1, 10, 100, 1000, 10_000, 100_000]),
    ],
)
def test_bounces_of_a_grid_are_whole(text: str, values: list[int]) -> None:
    axis = read_axis(text)
    found = axis.values(np.arange(axis.count or 0))
    assert found.tolist() == values


def test_bounces_of_a_sample_are_whole_and_none_is_left_out() -> None:
    ends = np.arange(2.0, 7.0)
    for spacing, way in (("", ends), ("log:", np.log(ends))):
        found = read_axis(f"horizon.bounces={spacing}2:5").at(np.linspace(0.0, 1.0, 1001))
        values, counts = np.unique(found, return_counts=True)
        assert values.tolist() == [2, 3, 4, 5]
        even = 1000.0 * np.diff(way) / (way[-1] - way[0])
        assert np.abs(counts - even).max() <= 1.0  # a point at an end belongs to one side


def test_another_seed_is_another_sample() -> None:
    first, other = (
        make_plan("gentle-rock", "can.h=1:2", sample="random", count=9, seed=seed)
        for seed in (0, 1)
    )
    assert not np.array_equal(first.values(range(9))["can.h"], other.values(range(9))["can.h"])
    assert first.digest() != other.digest()


def test_partitions_hold_every_row_once() -> None:
    chosen = make_plan("gentle-rock", "can.h=1:2:100000")
    rows = [row for index in range(chosen.partitions) for row in chosen.span(index)]
    assert rows == list(range(100_000))


@pytest.mark.parametrize("name", [n for n in PARAMETERS if not n.startswith("effects.")])
def test_every_parameter_reaches_the_scene(name: str) -> None:
    scene = load("gentle-rock")
    own = {"can.A": 5e-5, "can.C": 4e-5, "can.H": 0.05, "can.radius": 0.05, "horizon.bounces": 7}
    value = own.get(name, 0.7)
    changed = scene_at(scene, {name: value})
    table, _, key = name.rpartition(".")
    owner = getattr(changed, table) if table else changed
    fields = {"A": "transverse_inertia", "C": "axial_inertia", "H": "half_height"}
    # a group of the can is kept as a length or a moment: a product and a quotient of round-off
    assert getattr(owner, fields.get(key, key)) == pytest.approx(value, rel=4e-16, abs=0)
    others = {"can", "release"} - {table}
    assert all(getattr(changed, other) == getattr(scene, other) for other in others)


def test_a_can_of_another_size_is_the_same_can() -> None:
    can, larger = (
        load("gentle-rock").can,
        scene_at(load("gentle-rock"), {"can.radius": 0.4, "can.mass": 7.0}).can,
    )
    assert (larger.a, larger.c, larger.h) == pytest.approx((can.a, can.c, can.h), rel=1e-15, abs=0)


def test_an_effect_is_a_parameter_too() -> None:
    scene = scene_at(load("gentle-rock"), {"effects.slip.mu": 0.3})
    assert scene.effects.slip is not None
    assert scene.effects.slip.mu == 0.3


REFUSED: dict[str, tuple[tuple[str, ...], dict[str, Any], tuple[str, ...]]] = {
    "a parameter that is none": (("release.phy=0:1:3",), {}, ("release.phy", "release.phi")),
    "no range": (("can.h",), {}, ("NAME=LOW:HIGH:COUNT",)),
    "words for numbers": (("can.h=low:high:3",), {}, ("NAME=LOW:HIGH:COUNT",)),
    "too many numbers": (("can.h=1:2:3:4",), {}, ("NAME=LOW:HIGH:COUNT",)),
    "a mass of zero": (("can.mass=0:1:3",), {}, ("can.mass", "greater than 0")),
    "half a bounce": (("horizon.bounces=1:2:3",), {}, ("horizon.bounces=1.0:2.0:3", "whole")),
    "no bounce": (("horizon.bounces=0:2:3",), {}, ("horizon.bounces", "greater than 0")),
    "more bounces than there are": (("horizon.bounces=1:9:99999999",), {}, ("whole numbers",)),
    "bounces and a time": (
        ("horizon.bounces=1:3:3", "horizon.seconds=1:2:2"),
        {},
        ("horizon.seconds", "one of them"),
    ),
    "a time out of reach": (("horizon.seconds=1:1e9:3",), {}, ("horizon.seconds", "at most")),
    "a can on its side": (("release.phi=0.1:1.6:3",), {}, ("release.phi", "less than 1.5708")),
    "no number": (("can.h=nan:1:3",), {}, ("can.h", "nan")),
    "no values": (("can.h=1:2:0",), {}, ("can.h", "1 or more")),
    "a logarithm of zero": (("release.psi_dot=log:0:1:3",), {}, ("greater than zero",)),
    "friction that drives": (("effects.slip.mu=-1:1:3",), {}, ("effects.slip.mu", "-1")),
    "an axis twice": (("can.h=1:2:3", "can.h=1:2:3"), {}, ("each parameter once",)),
    "a group and its moment": (("can.a=1:2:3", "can.A=1:2:3"), {}, ("each parameter once",)),
    "a grid without counts": (("can.h=1:2",), {}, ("NAME=LOW:HIGH:COUNT",)),
    "a sample with counts": (("can.h=1:2:3",), {"sample": "sobol", "count": 8}, ("--count",)),
    "a sample without a count": (("can.h=1:2",), {"sample": "sobol"}, ("--count",)),
    "a seed of a grid": (("can.h=1:2:3",), {"seed": 1}, ("--seed",)),
    "a sample that is none": (("can.h=1:2",), {"sample": "dice"}, ("grid, random, sobol",)),
    "a quantity that is none": (("can.h=1:2:3",), {"quantities": ["turn"]}, ("angle_of_turn_deg",)),
    "an error of the truth": (
        ("can.h=1:2:3",),
        {"quantities": ["angle_of_turn_error_deg"]},
        ("reference",),
    ),
    "an engine that is none": (("can.h=1:2:3",), {"engine": "chrono"}, ("mujoco",)),
    "too many scenes": (("can.h=1:2:99999", "can.a=1:2:99999"), {}, ("1000000000",)),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_wrong_use_is_refused_with_what_is_allowed(fault: str) -> None:
    over, more, parts = REFUSED[fault]
    with pytest.raises(HarnessError) as caught:
        make_plan("gentle-rock", *over, **more)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("over", "more", "allowed"),
    [
        ("effects.slip.mu=-1:1:3", {}, "cannot be -1.0; allowed: a finite number, zero or greater"),
        (
            "effects.compliance.damping=0:1:3",
            {},
            "unless the scene itself declares `effects.compliance` with its constants",
        ),
        (
            "can.h=1:2",
            {"sample": "halton", "count": 0},
            "setting '--count' cannot be 0; allowed: a whole number of halton scenes, 1 or more",
        ),
    ],
)
def test_a_refusal_says_once_what_is_allowed(over: str, more: dict[str, Any], allowed: str) -> None:
    with pytest.raises(HarnessError) as caught:
        make_plan("gentle-rock", over, **more)
    assert str(caught.value).endswith(allowed)


def test_nothing_to_vary_is_refused() -> None:
    with pytest.raises(HarnessError, match="at least one"):
        plan_sweep(load("gentle-rock"), [])


def test_a_digest_tells_plans_apart() -> None:
    first = make_plan("gentle-rock", "can.h=1:2:3")
    assert first.digest() == make_plan("gentle-rock", "can.h=1:2:3").digest()
    others = [
        make_plan("petals", "can.h=1:2:3"),
        make_plan("gentle-rock", "can.h=1:2:4"),
        make_plan("gentle-rock", "can.h=log:1:2:3"),
        make_plan("gentle-rock", "can.h=1:2:3", quantities=TURN),
        make_plan("gentle-rock", "can.h=1:2:3", engine="mujoco", timestep=1e-3),
        replace(first, engine_version="0"),
    ]
    assert len({first.digest(), *(other.digest() for other in others)}) == 1 + len(others)


def test_the_exact_bounce_knows_no_horizon() -> None:
    """A run may end before its bounce does; the formula has the whole bounce."""
    assert make_plan("gentle-rock", "release.phi=0.2:0.3:2", quantities=("period_s",)).exact
    for axis in ("horizon.seconds=1e-3:2e-3:2", "horizon.bounces=1:2:2"):
        assert not make_plan("gentle-rock", axis, quantities=("period_s",)).exact


def test_an_axis_reads_back_as_it_is_written() -> None:
    for text in ("can.h=0.1:10.0:7", "can.h=log:0.1:10.0:7", "release.psi_dot=-1.0:1.0"):
        assert read_axis(text).text() == text
        assert isinstance(read_axis(text), Axis)

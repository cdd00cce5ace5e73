"""The sample of `make test` holds each value, and of three parameters each pair of values."""

from itertools import chain, combinations, product

import pytest

from tests.support.sampling import covering, sampled


def test_of_one_parameter_and_of_none_all_stay() -> None:
    assert covering([(n,) for n in range(5)]) == [0, 1, 2, 3, 4]
    assert covering([()]) == [0]
    assert covering([]) == []


@pytest.mark.parametrize("sizes", [(2, 3), (7, 4), (1, 5)])
def test_of_two_parameters_each_value_is_there_and_no_row_is_needless(
    sizes: tuple[int, int],
) -> None:
    rows = list(product(*map(range, sizes)))
    kept = [rows[n] for n in covering(rows)]
    assert len(kept) == max(sizes)
    for place, size in enumerate(sizes):
        assert {row[place] for row in kept} == set(range(size))


@pytest.mark.parametrize("sizes", [(3, 3, 3), (4, 2, 5), (2, 2, 2, 6)])
def test_of_more_each_pair_is_there_in_hardly_more_rows_than_the_two_longest_need(
    sizes: tuple[int, ...],
) -> None:
    rows = list(product(*map(range, sizes)))
    kept = [rows[n] for n in covering(rows)]
    for one, other in combinations(range(len(sizes)), 2):
        pairs = {(row[one], row[other]) for row in kept}
        assert pairs == set(product(range(sizes[one]), range(sizes[other])))
    longest, second = sorted(sizes, reverse=True)[:2]
    assert len(kept) <= 1.2 * longest * second


def test_pairs_that_no_row_has_are_not_asked_for() -> None:
    rows = [(0, 0, 0), (0, 1, 1), (1, 0, 0)]
    assert covering(rows) == [0, 1, 2]


@pytest.mark.parametrize("turned", [{"one": 1}, {"other": 2}])
@pytest.mark.parametrize(("low", "high"), [(0, 1), (0, 2), (1, 2)])
def test_values_of_one_mark_stay_together(
    low: int, high: int, turned: dict[str, int], request: pytest.FixtureRequest
) -> None:
    """Of itself: three rows of low and high, each of them once, with either dictionary."""
    assert low < high
    assert turned
    assert isinstance(request.node, pytest.Function)
    module = request.node.getparent(pytest.Module)
    assert module is not None
    own = [
        item
        for item in module.collect()
        if isinstance(item, pytest.Function) and item.originalname == request.node.originalname
    ]
    assert len(own) == 6
    kept = [vars(item)["callspec"].params for item in sampled(own)]
    assert [(one["low"], one["high"]) for one in kept] == [(0, 1), (0, 2), (1, 2)]
    assert {*chain(*(one["turned"] for one in kept))} == {"one", "other"}

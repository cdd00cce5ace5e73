"""The accepted results that are committed: small, of the full suite, and fit for the quick one."""

from pathlib import Path

import pytest

from harness import api
from harness.engines.registry import left_out
from harness.gate.baseline import required_cases
from harness.gate.spread import FEWEST
from harness.results.errors import FILE
from harness.results.files import read_baseline, read_result
from harness.results.scores import QUANTITIES, QuantityKind, identity

BASELINE = Path(__file__).parents[3] / "reports" / "baseline"

TIMES = {quantity.column for quantity in QUANTITIES if quantity.kind is QuantityKind.TIME}

pytestmark = pytest.mark.skipif(
    not (BASELINE / FILE).is_file(), reason="none yet: rockingcan validate --suite full --accept"
)


def test_it_is_small() -> None:
    size = sum(path.stat().st_size for path in BASELINE.rglob("*") if path.is_file())
    assert size < 2_000_000  # bytes; what a checkout should not have to carry


def test_it_covers_both_suites_as_their_scenes_are_now() -> None:
    accepted = read_baseline(BASELINE)
    assert accepted.suite == "full"
    for suite in ("quick", "full"):
        cases = api.suite(suite)
        found = required_cases(accepted, suite, cases, every_engine=True)
        here = {name for name in found if name.engine not in left_out()}
        assert here == {identity(case) for case in cases}


SUBMITTED = sorted((BASELINE.parent / "results").glob("*.json"))


@pytest.mark.parametrize("path", [BASELINE / FILE, *SUBMITTED], ids=lambda path: path.name)
def test_every_case_has_its_spread(path: Path) -> None:
    for name, one in read_result(path).scores.items():
        assert one.members >= FEWEST, name
        assert sum(one.endings.values()) == one.members + 1
        assert not one.finished or set(one.values) - TIMES <= set(one.spread), name

"""From the evaluations of a path to accounts, and from those to artefacts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from harness.artefact import Artefact, Prose
from harness.case import Case
from harness.runner import Evaluation
from harness.studies.attribution.accounts import Account, account
from harness.studies.attribution.figure import waterfall
from harness.studies.attribution.path import Closed, Path, case
from harness.studies.attribution.quantities import QUANTITIES, Quantity
from harness.studies.attribution.tables import gap_table, interaction_table, run_table
from harness.studies.attribution.words import sentences


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attribution:
    """A path with its evaluations and accounts.

    Parameters
    ----------
    path : Path
    evaluations : mapping of Case to Evaluation
    accounts : mapping of str to Account
        By the key of the quantity.
    sentences : tuple of str
        Two, in plain words.
    """

    path: Path
    evaluations: Mapping[Case, Evaluation]
    accounts: Mapping[str, Account]
    sentences: tuple[str, ...]


def attribution(way: Path, evaluations: Sequence[Evaluation]) -> Attribution:
    """Return who accounts for what, from the evaluations of the path's cases in any order."""
    found = {e.simulation.case: e for e in evaluations}
    accounts = {
        quantity.key: account(way.names, partial(_level, way, found, quantity))
        for quantity in QUANTITIES
    }
    return Attribution(
        path=way,
        evaluations=found,
        accounts=accounts,
        sentences=sentences(way, found, accounts),
    )


def _level(
    way: Path, found: Mapping[Case, Evaluation], quantity: Quantity, closed: Closed
) -> float | None:
    """Return a discrepancy with a set of gaps closed."""
    return quantity.read(found[case(way, closed)])


def read(found: Attribution) -> tuple[Artefact, ...]:
    """Return the artefacts of an attribution: words, figure, tables."""
    way = found.path
    return (
        Prose(
            name=f"{way.scene.name}-{way.engine}-attribution",
            title=f"What makes {way.engine} differ",
            text=" ".join(found.sentences),
            scene=way.scene.name,
        ),
        waterfall(way, found.evaluations, found.accounts),
        gap_table(way, found.accounts),
        interaction_table(way, found.accounts),
        run_table(way, found.evaluations, found.accounts),
    )

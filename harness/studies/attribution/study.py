"""The attribution study: which of an engine's gaps causes which part of its discrepancy.

The part of each gap is read along an ablation path, and reported in numbers, words and bars.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Panel,
    Prose,
    Series,
    Table,
)
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import (
    QUANTITIES,
    Number,
    Quantity,
    less,
    recorded_turn_error,
    turn_error,
)
from harness.studies.shared import run_columns
from harness.studies.shared.ablation import AblationPath, Account, account, total
from harness.studies.study import EVALUATION, Job, Results, evaluation_jobs

ATTRIBUTED = tuple(
    QUANTITIES[key]
    for key in (
        "turn_error_deg",
        "contact_locus_rms_m",
        "phi_rms_rad",
        "peak_friction_ratio_error",
        "contact_locus_hausdorff_m",
    )
)
"""The discrepancies that are attributed, in the order in which words and figures take them."""

_PANELS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attribution:
    """A path with its evaluations, and the parts of each discrepancy.

    Parameters
    ----------
    path : AblationPath
    evaluations : mapping of Case to Evaluation
    accounts : mapping of str to Account
        By the key of the quantity.
    """

    path: AblationPath
    evaluations: Mapping[Case, Evaluation]
    accounts: Mapping[str, Account]

    @property
    def uncounted(self) -> int:
        """In how many runs of a scene that ends with a bounce the turn is not known."""
        if self.path.scene.horizon.seconds is not None:
            return 0
        return sum(turn_error(e) is None for e in self.evaluations.values())

    @property
    def sentences(self) -> tuple[str, str]:
        """Two sentences on the first quantity whose whole is known."""
        for quantity in ATTRIBUTED:
            own = self.accounts[quantity.key]
            if own.whole is not None:
                return (
                    f"{own.in_order_sentence()}{self._doubt()}.",
                    f"{own.interaction_sentence()}.",
                )
        ends = sorted({e.simulation.outcome.name.lower() for e in self.evaluations.values()})
        nothing = (
            f"Nothing of what {self.path.engine} does to {self.path.scene.name} can be attributed, "
            "because one end of the way has no motion to compare."
        )
        return nothing, f"The runs ended: {', '.join(ends)}."

    def _doubt(self) -> str:
        """Return in how many runs the turn is not known, and which gap matters most where it is."""
        if not self.uncounted:
            return ""
        turn = self.accounts[ATTRIBUTED[0].key]
        known = turn.by_gap(turn.in_order)
        words = f" (the turn cannot be counted in {self.uncounted} of {len(self.evaluations)} runs"
        if known and turn.whole is None:
            name = max(known, key=lambda name: (abs(known[name]), name))
            words += f"; where it can, most is taken away by {name}, {turn.words(known[name])}"
        return words + ")"

    def artefacts(self) -> tuple[Artefact, ...]:
        """Return words, figure, tables."""
        path = self.path
        return (
            Prose(
                name=f"{path.scene.name}-{path.engine}-attribution",
                title=f"What makes {path.engine} differ",
                text=" ".join(self.sentences),
                scene=path.scene.name,
            ),
            self._waterfall(),
            self._table("gaps", "What each gap accounts for", _GAPS, self.gap_rows()),
            self._table(
                "interactions", "The whole and its parts", _INTERACTIONS, self.accounts.values()
            ),
            self._table("runs", "Every run of the attribution", _RUNS, self._run_rows()),
        )

    def _table(
        self, name: str, title: str, columns: tuple[Column, ...], records: Iterable[object]
    ) -> Table:
        scene, engine = self.path.scene.name, self.path.engine
        hidden = ("scene", "engine", *(f"takes_away_{q.key}" for q in ATTRIBUTED[1:]))
        name, title = f"{engine}-{name}", f"{title}: {engine}"
        return run_columns.scene_table(scene, name, title, columns, records, *hidden)

    def gap_rows(self) -> list[dict[str, Any]]:
        """Return the part of each gap in each quantity, a row each."""
        return [
            {
                "scene": self.path.scene.name,
                "engine": self.path.engine,
                "place": place + 1,
                "gap": gap.name,
                "settings": ", ".join(gap.settings),
                "what_it_does": gap.sentence,
                "quantity": key,
                "in_order": (in_order := own.in_order[place]),
                "share_of_whole": in_order / own.whole
                if in_order is not None and own.whole
                else None,
                "alone": own.alone[place],
                "left_open": own.left_open[place],
                "interaction": less(in_order, own.alone[place]),
            }
            for key, own in self.accounts.items()
            for place, gap in enumerate(self.path.gaps)
        ]

    def _run_rows(self) -> list[dict[str, Any]]:
        """Return a row for every run: its discrepancies, and the parts that its step takes away."""
        names = self.path.names
        rows: list[dict[str, Any]] = []
        for step in self.path.steps():
            e = self.evaluations[self.path.case(step.closed)]
            row: dict[str, Any] = {
                "simulation": e.simulation,
                "step": step.step,
                "gap": step.gap,
                "closed": ", ".join(name for name in names if name in step.closed),
                "turn_error_seen_deg": recorded_turn_error(e),
                "turn_resolved": e.bounces[0].resolved if e.bounces else None,
            }
            for quantity in ATTRIBUTED:
                own = self.accounts[quantity.key]
                row[quantity.key] = quantity.of_run(e)
                if step.gap:
                    parts = getattr(own, step.step.replace(" ", "_"))
                    row[f"takes_away_{quantity.key}"] = parts[names.index(step.gap)]
            rows.append(row)
        return rows

    def _waterfall(self) -> Figure:
        """Return the waterfall of the first quantities that are known anywhere on the path."""
        path, lost = self.path, self.uncounted
        known = [q for q in ATTRIBUTED if set(self.accounts[q.key].levels) != {None}]
        missing = (
            f"; bars that rest on the {lost} of {len(self.evaluations)} runs whose turn cannot be "
            "counted are left out"
            if lost
            else ""
        )
        return Figure(
            name=f"{path.scene.name}-{path.engine}-waterfall",
            title=f"From default to matched: {path.engine}",
            seen=(
                f"Each bar is what closing one more gap takes away, from {path.engine} as it ships "
                "to matched. A mark off the end of its bar is interaction: alone, that gap takes "
                f"away another amount{missing}."
            ),
            panels=tuple(_panel(self.accounts[q.key]) for q in known[:_PANELS]),
            scene=path.scene.name,
        )


_QUANTITY = Column("quantity", "Which discrepancy; the unit is its suffix.")
_GAP = Column("gap", "Name of the gap.")

_GAPS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    Column("place", "Place of the gap in the order of closing, from 1."),
    _GAP,
    _QUANTITY,
    Column("in_order", "What closing it takes away after those before it; sums to the whole."),
    Column("share_of_whole", "The same as a share of what closing all gaps takes away."),
    Column("alone", "What closing only this gap takes away from the engine as it ships."),
    Column("left_open", "What only this gap adds to the matched engine when it is open."),
    Column("interaction", "In order less alone: what it takes away only as others are closed."),
    Column("what_it_does", "What the open gap does to the can."),
    Column("settings", "Settings that close it."),
)

_INTERACTIONS = (
    run_columns.SCENE.of("path.scene.name"),
    run_columns.ENGINE.of("path.engine"),
    _QUANTITY.of("quantity.key"),
    Column("as_shipped", "Discrepancy with all gaps open."),
    Column("remains", "Discrepancy with all gaps closed: profile matched."),
    Column("whole", "As shipped less what remains."),
    Column(
        "sum_in_order",
        "Sum of what the gaps take away one after the other: the whole.",
        lambda account: total(account.in_order),
    ),
    Column("sum_alone", "Sum of what each gap takes away alone."),
    Column("interaction", "Sum alone less the whole: what the gaps do only together."),
    Column(
        "sum_left_open",
        "Sum of what each gap adds when only it is open.",
        lambda account: total(account.left_open),
    ),
    Column("interaction_left_open", "The same less the whole."),
)

_RUNS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    Column(
        "step",
        "As shipped; in order: this gap and those before it closed; alone: only it closed; "
        "left open: all closed but it.",
    ),
    _GAP,
    Column("closed", "Gaps closed in this run."),
    run_columns.TIMESTEP,
    *(Column(q.key, q.meaning) for q in ATTRIBUTED),
    Column("turn_error_seen_deg", "Error of the turn as recorded, up to whole turns."),
    Column("turn_resolved", "Whether the record is dense enough to count the turns of psi."),
    *(Column(f"takes_away_{q.key}", f"What this step takes away of {q.key}.") for q in ATTRIBUTED),
    run_columns.OUTCOME,
    run_columns.CASE,
    run_columns.COMMAND,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AttributionStudy:
    """Run every step of an ablation path, and attribute discrepancies to its gaps.

    Parameters
    ----------
    path : AblationPath
        From `harness.studies.shared.ablation.ablation_path`.
    """

    path: AblationPath

    name = "attribution"

    def next_jobs(self, _: Results) -> list[Job[Case, Evaluation]]:
        """Return the cases of the path."""
        return evaluation_jobs(self.path.cases())

    def findings(self, done: Results) -> Attribution:
        """Return the part of each gap in each discrepancy."""
        runs = done.of(EVALUATION)

        def discrepancy(quantity: Quantity) -> Account:
            read = quantity.of_run
            return account(self.path, quantity, lambda closed: read(runs[self.path.case(closed)]))

        return Attribution(
            path=self.path,
            evaluations={case: runs[case] for case in self.path.cases()},
            accounts={quantity.key: discrepancy(quantity) for quantity in ATTRIBUTED},
        )

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, the waterfall, and the tables."""
        return self.findings(done).artefacts()

    def answer(self, done: Results) -> dict[str, Any]:
        """Return the attribution as `--json` prints it."""
        attribution = self.findings(done)
        wholes = ("as_shipped", "remains", "whole", "interaction")
        parts = ("gap", "in_order", "alone", "left_open")
        quantities: dict[str, dict[str, Any]] = {
            key: {name: getattr(own, name) for name in wholes} | {"gaps": []}
            for key, own in attribution.accounts.items()
        }
        for row in attribution.gap_rows():
            quantities[row["quantity"]]["gaps"].append({name: row[name] for name in parts})
        return {
            "scene": self.path.scene.name,
            "engine": self.path.engine,
            "timestep_s": self.path.matched_timestep,
            "order": list(self.path.names),
            "quantities": quantities,
            "sentences": list(attribution.sentences),
        }


def _panel(own: Account) -> Panel:
    """Return the waterfall of one quantity."""
    (word, scale), names = own.unit, own.path.names

    def numbers(values: Sequence[Number]) -> Floats:
        return np.array([math.nan if value is None else value * scale for value in values])

    def takes_away(values: Sequence[Number], words: str) -> tuple[str, ...]:
        return tuple(
            f"{name}{words}: "
            + ("not known" if value is None else f"takes away {own.words(value)}")
            for name, value in zip(names, values, strict=True)
        )

    levels, count = numbers(own.levels), len(names)
    places = np.arange(1.0, count + 1.0)
    return Panel(
        title=own.quantity.label.capitalize(),
        x_label="gaps, closed from left to right",
        y_label=f"off by [{word}]" if word else "off by",
        x_names=("as shipped", *names, "matched"),
        series=(
            Series(
                label="discrepancy",
                kind=own.path.engine,
                x=np.array((0.0, count + 1.0)),
                y=levels[[0, -1]],
                base=np.zeros(2),
                mark="bars",
            ),
            Series(
                label="taken away by a gap, in this order",
                kind=own.path.engine,
                x=places,
                y=levels[1:],
                base=levels[:-1],
                mark="bars",
                hover=takes_away(own.in_order, ""),
            ),
            Series(
                label="where it would end if it took away as much as alone",
                kind="reference",
                x=places,
                y=levels[:-1] - numbers(own.alone),
                mark="points",
                hover=takes_away(own.alone, ", alone"),
            ),
        ),
    )

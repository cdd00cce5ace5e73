"""Whether an engine has one answer, whatever the heading: a short scene, let go at five of them.

A plane has no direction of its own. The scene is that of the probe of the heading
(`harness.engines.probes.heading`): a can that passes the flat state closely, where the direction of
the rim's lowest point is lost first.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from harness.core.case import PROFILES, Case
from harness.core.report_model import Artefact, Column, Prose, Table, table_of
from harness.core.simulation import Outcome
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import takes_timestep
from harness.engines.probes.heading import HEADINGS, passing, spread
from harness.evaluation.evaluation import Evaluation
from harness.studies.comparison.fidelity import AGREES_TURN, size_verdict
from harness.studies.comparison.study import EngineSettings
from harness.studies.shared import run_columns
from harness.studies.study import EVALUATION, Job, Results, evaluation_jobs
from models.catalogue import load

SCENE = "paper-release"
"""Scene whose can it is."""

_COLUMNS = (
    run_columns.ENGINE,
    run_columns.PROFILE,
    run_columns.TIMESTEP,
    Column(
        "turn_spread_deg",
        "Range of the turn past the flat state over five headings.",
        verdict="turn_spread_deg_verdict",
        case="turn_spread_deg_case",
    ),
    Column("turn_spread_deg_verdict", "Verdict in words on the spread.", shown=False),
    Column("turn_spread_deg_case", "Digest of the run at the first heading.", shown=False),
    Column("tilt_spread_rad", "Range of phi behind the flat state over five headings."),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeadingStudy:
    """The same short scene at five headings, in each profile of each engine.

    Parameters
    ----------
    engines : tuple of str
    settings : mapping
        By engine, settings to put on top of every case of it.
    """

    engines: tuple[str, ...]
    settings: EngineSettings = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Title of the study."""
        return "One answer at any heading"

    def next_jobs(self, _: Results) -> list[Job[Case, Evaluation]]:
        """Return all jobs: one round."""
        return evaluation_jobs([case for own in self._cases() for case in own])

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return the table of the spreads, and a sentence on what has several answers."""
        found = done.of(EVALUATION)
        table = headings([tuple(map(found.__getitem__, own)) for own in self._cases()])
        return _told(table), table

    def _cases(self) -> list[tuple[Case, ...]]:
        """Return the cases at all headings, of each engine and profile."""
        scenes = [passing(load(SCENE), heading) for heading in HEADINGS]
        return [
            tuple(
                Case(
                    scene=scene,
                    engine=engine,
                    profile=profile,
                    options=tuple(self.settings.get(engine, {}).items()),
                )
                for scene in scenes
            )
            for engine in self.engines
            for profile in PROFILES
            if profile != "adaptive" or takes_timestep(engine)
        ]


def _told(table: Table) -> Prose:
    """Return a sentence on the engines that have several answers."""
    several = [
        f"{row['engine']} in profile {row['profile']}, by {row['turn_spread_deg']:.2g} degrees"
        for row in table.frame.to_dict("records")
        if row["turn_spread_deg_verdict"].status is Status.DEVIATES
    ]
    said = (
        f"several answers have {'; '.join(several)}" if several else "every engine has one answer"
    )
    text = f"A can that passes the flat state closely, let go at five headings: {said}."
    return Prose(name="headings-told", title=table.title, text=text)


def headings(runs: Sequence[Sequence[Evaluation]]) -> Table:
    """Return the spread of each engine and profile, of whose runs there is one for each heading."""
    rows = []
    for own in runs:
        turn, tilt = spread([e.simulation.trajectory for e in own])
        rows.append(
            {
                "simulation": own[0].simulation,
                "turn_spread_deg": math.degrees(turn),
                "turn_spread_deg_verdict": _verdict(own, math.degrees(turn)),
                "turn_spread_deg_case": own[0].simulation.digest,
                "tilt_spread_rad": tilt,
            }
        )
    return table_of("headings", "One answer at any heading", _COLUMNS, rows)


def _verdict(own: Sequence[Evaluation], turn: float) -> Verdict:
    """Return whether the runs have one answer."""
    ended = {e.simulation.outcome for e in own} - {Outcome.FINISHED}
    if ended:
        words = ", ".join(sorted(outcome.name.lower().replace("_", " ") for outcome in ended))
        return Verdict(Status.FAILED, f"failed: {words}")
    return size_verdict(turn / AGREES_TURN)

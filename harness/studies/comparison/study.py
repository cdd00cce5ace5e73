"""The comparison as a study: its cases, and its report of figures, tables, words and replays.

A replay shows the exact can and each engine's side by side, in a time that is slow where much
happens. Half of the frames are spread over the time, half over the turning of the exact can: the
bounce of the paper's release, microseconds of a run of a tenth of a second, then takes half of the
replay. Every can is shown by its own clock, which strikes zero at its own first bounce.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import itemgetter

import numpy as np

from harness.core.case import RECORDED, Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Artefact, Body, Prose, Replay
from harness.core.simulation import Outcome
from harness.core.trajectory import Floats
from harness.engines.ladder import rung_words, takes_timestep
from harness.engines.registry import is_constraint
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion
from harness.metrics.quantities import turn_error
from harness.studies.comparison.convergence import orders
from harness.studies.comparison.fidelity import fidelity
from harness.studies.comparison.figures import scene_figures
from harness.studies.comparison.selection import (
    MANY,
    by_case,
    drawn_runs,
    followed_best,
    label,
    longest,
)
from harness.studies.comparison.suite import (
    SUITES,
    Unsupported,
    split_unsupported,
    suite_cases,
)
from harness.studies.comparison.tables import bounces, parity, results, scorecards
from harness.studies.study import EVALUATION, Job, Results, evaluation_jobs
from models.catalogue import load
from models.effects import modelling_choices
from models.rim import contact_point
from models.scene import Scene

EngineSettings = Mapping[str, Mapping[str, Value]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparisonStudy:
    """Every engine on every scene of a suite, held against the exact motion.

    Parameters
    ----------
    suite : str
    designed : tuple of Case
        The cases that the engines can represent, without settings on top.
    unsupported : tuple of Unsupported
        What the engines cannot represent.
    settings : mapping
        By engine, settings to put on top of every case of it.
    """

    suite: str
    designed: tuple[Case, ...]
    unsupported: tuple[Unsupported, ...] = ()
    settings: EngineSettings = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"{self.suite} suite"

    @property
    def cases(self) -> tuple[Case, ...]:
        """The cases that run, in the order of `designed`."""
        on_top = {engine: tuple(own.items()) for engine, own in self.settings.items()}
        return tuple(
            replace(case, options=case.options + on_top.get(case.engine, ()))
            for case in self.designed
        )

    def next_jobs(self, _: Results) -> list[Job[Case, Evaluation]]:
        """Return all jobs: one round."""
        return evaluation_jobs(self.cases)

    def evaluations(self, done: Results) -> tuple[Evaluation, ...]:
        """Return the evaluations in the order of `designed`."""
        return tuple(map(done.of(EVALUATION).__getitem__, self.cases))

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, scorecard, figures and tables."""
        return comparison_report(self.evaluations(done), self.unsupported)


def plan_comparison(
    suite: str, engines: Sequence[str], settings: EngineSettings | None = None
) -> ComparisonStudy:
    """Return the comparison of engines over a suite.

    Parameters
    ----------
    suite : str
        A key of `SUITES`.
    engines : sequence of str
        Names of engines that move a can by steps.
    settings : mapping, optional
        By engine, settings to put on top of every case of it.

    Raises
    ------
    InvalidSettingError
        If there is no such suite.
    """
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    cases, unsupported = split_unsupported(
        suite_cases(suite, engines, {name: load(name) for name in SUITES[suite]})
    )
    return ComparisonStudy(
        suite=suite, designed=cases, unsupported=unsupported, settings=settings or {}
    )


def comparison_report(
    evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()
) -> tuple[Artefact, ...]:
    """Return the artefacts of the comparison; unsupported scenes are rows of its tables."""
    artefacts: list[Artefact] = [_summary(evaluations), *scorecards(evaluations, unsupported)]
    for (scene,), own in by_case(evaluations, "scene").items():
        cite, supposed = own[0].simulation.case.scene.cite, _supposed(own)
        title = "What the exact motion supposes"
        artefacts += [
            *replay(scene, own),
            *scene_figures(scene, own),
            Prose(name=f"{scene}-assumptions", title=title, text=supposed, scene=scene),
            Prose(name=f"{scene}-cite", title="Source", text=cite, scene=scene),
        ]
    return (
        *artefacts,
        fidelity(evaluations, unsupported),
        results(evaluations),
        orders(evaluations),
        bounces(evaluations),
        parity(evaluations),
    )


def _supposed(own: Sequence[Evaluation]) -> str:
    """Return the modelling choices, the assumptions that the motion breaks, and a note on chaos."""
    broken = [
        f"{finding.sentence} A model that would carry it: {finding.model}."
        if finding.model
        else finding.sentence
        for finding in own[0].findings
    ]
    intact = "The exact motion keeps to everything that its model assumes."
    chosen = modelling_choices(own[0].simulation.case.scene.effects)
    parts = (*chosen, *(broken or [intact]), followed_best(own))
    return " ".join(part for part in parts if part)


def _summary(evaluations: Sequence[Evaluation]) -> Prose:
    """Return a summary: a sentence for each engine and profile."""
    by_engine = by_case(evaluations, "engine")
    runs = by_case(evaluations, "engine", "profile")
    engines = "1 engine" if len(by_engine) == 1 else f"{len(by_engine)} engines"
    sentences = [f"{len(evaluations)} runs of {engines} were held against the exact motion."]
    for profile, words in _PROFILES.items():
        known = {engine: _turned(runs.get((engine, profile), ())) for (engine,) in by_engine}
        extreme = "worst" if profile == "default" else "best"
        chosen = [
            (engine, *(max if profile == "default" else min)(turned, key=itemgetter(0)))
            for engine, turned in known.items()
            if turned
        ]
        chosen.sort(key=itemgetter(1))
        ranked = [one for one in chosen if not is_constraint(one[0])]
        if len(ranked) > MANY:  # the nearest and the farthest; the tables have all
            chosen = [ranked[0], ranked[-1], *(one for one in chosen if one not in ranked)]
        sentences += [
            f"{engine} {words} misses the angle of turn by at {extreme} {error:.2g} degrees "
            f"({', '.join(filter(None, (e.simulation.case.scene.name, _step(e))))})."
            for engine, error, e in chosen
        ]
    paragraphs = (" ".join(sentences), f"{_uncounted(evaluations)} {_endings(evaluations)}")
    return Prose(name="summary", title="Summary", text="\n\n".join(paragraphs))


def _step(e: Evaluation) -> str:
    """Return the timestep or the accuracy of a run in words; empty where it has neither."""
    case, words = e.simulation.case, rung_words(e.simulation)
    if not words or not takes_timestep(case.engine):
        return words
    return f"timestep {'up to ' if case.profile == 'adaptive' else ''}{words}"


def _turned(runs: Sequence[Evaluation]) -> list[tuple[float, Evaluation]]:
    """Return the errors of the turn of the runs that can be held to it, with the runs."""
    return [
        (abs(error), e)
        for e in runs
        if (error := turn_error(e)) is not None
        and e.simulation.outcome is Outcome.FINISHED
        and not e.truth_pulls
    ]


_PROFILES = {
    "default": "as it ships",
    "matched": "matched to the scene",
    "adaptive": "with steps that follow the motion",
    RECORDED: "as recorded",
}


def _uncounted(evaluations: Sequence[Evaluation]) -> str:
    """Return a sentence on the runs whose record cannot tell how often psi went round."""
    runs = [e for e in evaluations if e.bounces and not e.bounces[0].resolved]
    if not runs:
        return "Every record is dense enough to count the turns."
    return f"Too coarse to count the turns: {_runs(runs)}."


def _endings(evaluations: Sequence[Evaluation]) -> str:
    """Return a sentence on the runs that ended before their horizon."""
    ends: dict[Outcome, list[Evaluation]] = {}
    for e in evaluations:
        if e.simulation.outcome is not Outcome.FINISHED:
            ends.setdefault(e.simulation.outcome, []).append(e)
    if not ends:
        return "Every run reached its horizon."
    endings = (
        f"{outcome.name.lower().replace('_', ' ')}, {_runs(e)}" for outcome, e in ends.items()
    )
    return f"Before the horizon ended: {'; '.join(endings)}."


def _runs(evaluations: Sequence[Evaluation]) -> str:
    """Return how many runs, and of which scenes."""
    scenes = dict.fromkeys(e.simulation.case.scene.name for e in evaluations)
    count = len(evaluations)
    return f"{count} {'run' if count == 1 else 'runs'} of {', '.join(scenes)}"


_FRAMES = 480
"""Eight seconds of sixty frames; a bounce of 209 degrees moves by less than one in a frame."""

_RATE = 60.0
"""Frames that the page shows in a second."""

_SHOWN_TILT = 0.3
"""rad: a can that tilts less is drawn as if it tilted so far."""

_LARGEST_TILT = 12.0
"""Beyond it the drawing would have little to do with the can."""


def replay(scene: str, evaluations: Sequence[Evaluation]) -> tuple[Replay, ...]:
    """Return the replay of a scene, or nothing if there is nothing exact to show."""
    drawn = _two_each(drawn_runs(evaluations))
    exact = longest(drawn).truth if drawn else None
    if exact is None or len(exact.time) <= 1:
        return ()
    own = drawn[0].simulation.case.scene
    true = next((e.true_bounces[0].time for e in drawn if e.true_bounces), 0.0)
    time = _frames(exact)
    bodies = [_body("exact", "reference", exact, own, time)]
    for e in drawn:
        if e.motion is not None:
            late = e.bounces[0].time - true if e.bounces and e.true_bounces else 0.0
            kind = e.simulation.case.engine
            bodies.append(_body(label(e), kind, e.motion, own, time + late))
    tilt = _tilt(exact)
    return (
        Replay(
            name=f"{scene}-replay",
            title="Replay",
            seen=f"{_slow(time, own)} {_drawn(tilt, bounces=bool(drawn[0].true_bounces))}",
            radius=own.can.radius,
            height=2.0 * own.can.half_height,
            time=time,
            bodies=tuple(bodies),
            tilt=tilt,
            scene=scene,
        ),
    )


_BEST = ("adaptive", "matched", RECORDED)
"""Profiles of an engine at its best, the first that was run."""


def _two_each(drawn: Sequence[Evaluation]) -> list[Evaluation]:
    """Return of each engine the run as shipped and the best other; `drawn` has one a profile."""
    chosen: list[Evaluation | None] = []
    for runs in by_case(drawn, "engine").values():
        own = {e.simulation.case.profile: e for e in runs}
        chosen += [own.get("default"), next((own[p] for p in _BEST if p in own), None)]
    return [e for e in chosen if e is not None]


def _frames(exact: Motion) -> Floats:
    """Return the times of the frames, half by time and half by turning, s."""
    angle = np.abs(np.diff(exact.angles.psi)).cumsum()
    passed = (exact.time - exact.time[0]) / (exact.time[-1] - exact.time[0])
    turned = np.concatenate(([0.0], angle)) / angle[-1] if angle[-1] > 0.0 else passed
    frames: Floats = np.interp(np.linspace(0.0, 1.0, _FRAMES), (passed + turned) / 2.0, exact.time)
    return frames


_FLIES = 1e-3
"""Of the radius: a can that is less high above the plane is drawn on it."""


def _body(label_: str, kind: str, motion: Motion, scene: Scene, time: Floats) -> Body:
    """Return a can at the times of the frames; before and after its record it stands still."""
    at = motion.trajectory
    contact = contact_point(scene.can, at.position, at.quaternion)
    above = np.where(contact[:, 2] > _FLIES * scene.can.radius, contact[:, 2], 0.0)
    return Body(
        label=label_,
        kind=kind,
        phi=np.interp(time, motion.time, motion.angles.phi),
        psi=np.interp(time, motion.time, motion.angles.psi),
        theta=np.interp(time, motion.time, motion.angles.theta),
        contact=np.column_stack(
            [np.interp(time, motion.time, contact[:, axis]) for axis in range(2)]
        ),
        height=np.interp(time, motion.time, above),
    )


def _tilt(exact: Motion) -> float:
    """Return by how much phi is drawn larger, a number of one digit."""
    largest = float(exact.angles.phi.max())
    wanted = min(max(_SHOWN_TILT / largest, 1.0), _LARGEST_TILT) if largest > 0.0 else 1.0
    return float(math.floor(wanted))


def _slow(time: Floats, scene: Scene) -> str:
    steps = np.diff(time)
    ratio = float(steps.max() / steps.min())
    return (
        f"{time[-1] - time[0]:.3g} s of {scene.name} are played in {_FRAMES / _RATE:.0f} s; where "
        f"the can turns fastest, time goes {ratio:.0f} times slower than where it turns least."
    )


def _drawn(tilt: float, *, bounces: bool) -> str:
    larger = f"Its tilt is drawn {tilt:.0f} times as large as it is" if tilt > 1.0 else ""
    clocks = "every can is shown by the clock of its own first bounce" if bounces else ""
    notes = "; ".join(part for part in (larger, clocks) if part)
    return f"{notes[:1].upper()}{notes[1:]}." if notes else "All cans are shown at the same time."

"""The history of an engine as a study: install releases, run a suite in each, compare neighbours.

The spread of the results is measured for the newest release, and of a change that is not clear in
its own two releases too. A quantity has changed from one
release to the next if it exceeds the tolerance that follows from the spread: the gate's own rule,
`harness.gate.comparison.differences`.

Where a change lies between two releases that are not neighbours, the cases that changed are run in
a release between them, and again, until the two are neighbours: bisection, of all cases at once.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from itertools import pairwise

from packaging.version import Version

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Artefact
from harness.engines.make_environment import find_interpreter, packages_for, released_versions
from harness.engines.registry import description_of, entry_of
from harness.gate.comparison import differences
from harness.gate.history.releases import (
    ALL,
    INSTALLING,
    Installation,
    PackageRelease,
    parse_versions,
)
from harness.gate.history.runs import RUNNING, RunRow
from harness.gate.history.tables import Change, ReleaseRow, history_report
from harness.gate.report import changed
from harness.gate.spread import SIZES, member, members, spread
from harness.results.result import Result, input_digests, make_result
from harness.results.scores import QUANTITIES, CaseIdentity, QuantityKind, Score, division_of
from harness.results.scores import identity as name_of
from harness.studies.comparison.study import plan_comparison
from harness.studies.comparison.suite import SUITES
from harness.studies.study import Job, Results, Work

CLEAR = 10.0
"""Tolerances beyond which a change is clear without the spread in its own two releases."""

HistoryJob = Job[PackageRelease, Installation] | Job[Case, RunRow]


@dataclass(frozen=True, slots=True, kw_only=True)
class HistoryStudy:
    """Releases of an engine over the cases of a suite.

    Parameters
    ----------
    engine : str
        Name of the adapter.
    suite : str
    versions : tuple of str
        To run, the oldest first.
    released : tuple of str
        Versions that can be installed, the oldest first; empty if unknown.
    bisect : bool
        Whether to look for a change between two releases in those between them.
    settings : tuple
        Settings that `design` has on top of every case of the suite.
    design : callable
        Returns the cases of an engine in an environment, by its name.
    installing, running : Work
        How a release is installed, and how a case is run in it.
    """

    engine: str
    suite: str
    versions: tuple[str, ...]
    released: tuple[str, ...] = ()
    bisect: bool = False
    settings: tuple[tuple[str, Value], ...] = ()
    design: Callable[[str], tuple[Case, ...]]
    installing: Work[PackageRelease, Installation] = INSTALLING
    running: Work[Case, RunRow] = RUNNING

    @property
    def name(self) -> str:
        """Title of the study."""
        words = [f"{name} {value}" for name, value in self.settings]
        label = description_of(self.engine).label or self.engine
        return f"the history of {label}" + (f" with {', '.join(words)}" if words else "")

    def next_jobs(self, done: Results) -> Iterator[HistoryJob]:
        """Yield the jobs wanted: installing, the suite, the spread, and what bisects a change."""
        installs = [self._install(version) for version in self.versions]
        yield from installs
        if any(job not in done for job in installs):
            return
        runs = [Job(self.running, c) for v in self.versions for c in self._cases(v, done)]
        yield from runs
        if any(job not in done for job in runs):
            return
        newest = self._known(self._newest(done), done)
        members = [Job(self.running, one) for pair in newest for one in _members(*pair)]
        yield from members
        if all(job in done for job in members):
            yield from dict.fromkeys(self._narrowing(done))

    def results(self, done: Results) -> dict[str, Result]:
        """Return the result of each release that ran, the oldest first, with spreads if measured.

        Of a release that bisects a change it has the cases that changed. A case is named by the
        engine's own name, whatever environment it ran in, so that the releases compare.
        """
        settings = {f"{self.engine}.{name}": str(value) for name, value in self.settings}
        found = {}
        for version in sorted(self._installed(done), key=Version):
            known = self._known(version, done)
            scores = [
                self._with_spread(case, score, done).model_copy(
                    update={
                        **asdict(self._name(case)),
                        "division": division_of(self.engine, case.profile, settings),
                    }
                )
                for case, score in known
            ]
            if not scores:
                continue
            result = make_result(
                self.suite,
                scores,
                versions={self.engine: version},
                inputs=input_digests(case.scene for case, _ in known),
                settings=settings,
            )
            sizes = SIZES if any(score.members for score in scores) else ()
            result = result.model_copy(update={"perturbed_by": tuple(sizes)})
            found[version] = result.read_from(f"{self.engine} {version}")
        return found

    def whole_results(self, done: Results) -> dict[str, Result]:
        """Return the results to publish, of releases that ran every case of the suite.

        Their digests are those of the engine's own name, as of any other file of results.
        """
        found = {}
        for version, result in self.results(done).items():
            cases = {self._name(case): case for case in self._cases(version, done)}
            if len(result.cases) == len(cases):
                digests = {
                    name: replace(case, engine=self.engine).digest(version)
                    for name, case in cases.items()
                }
                found[version] = result.of_cases(
                    score.model_copy(update={"digest": digests[score.identity]})
                    for score in result.cases
                )
        return found

    def changes(self, done: Results) -> tuple[Change, ...]:
        """Return the quantities that changed from one release that ran a case to the next."""
        known, newest = self.results(done), self._newest(done)
        spreads = known.get(newest)
        scores = {version: result.scores for version, result in known.items()}
        found: list[Change] = []
        for before, after, case in _steps(scores):
            first, second = (known[v].of_cases([scores[v][case]]) for v in (before, after))
            own = differences(first, second, spreads=spreads)
            if moved := changed(own):
                between = self._between(before, after, case, done)
                found += [
                    Change(before=before, after=after, between=between, difference=difference)
                    for difference in moved
                ]
        return tuple(
            sorted(
                found, key=lambda c: (Version(c.before), Version(c.after), c.difference.identity)
            )
        )

    def report(self, done: Results) -> Sequence[Artefact]:
        """Return words, the figure, the changes and the releases."""
        return history_report(
            self.name, self.results(done), self.changes(done), self._rows(done), self._newest(done)
        )

    def made(self, done: Results) -> tuple[str, ...]:
        """Return the names of the environments that were made for this run."""
        return tuple(one.name for one in done.of(self.installing).values() if one.made)

    def _install(self, version: str) -> Job[PackageRelease, Installation]:
        release = PackageRelease(engine=self.engine, version=version, released=self.released)
        return Job(self.installing, release)

    def _installed(self, done: Results) -> dict[str, Installation]:
        """Return what became of installing each release so far, by version."""
        return {release.version: one for release, one in done.of(self.installing).items()}

    def _cases(self, version: str, done: Results) -> tuple[Case, ...]:
        """Return the cases of a release; none if it could not be installed."""
        name = self._installed(done)[version].name
        return self.design(name) if name else ()

    def _newest(self, done: Results) -> str:
        """Return the newest of the given releases that ran a case; empty if none did."""
        runs = done.of(self.running)
        for version in reversed(self.versions):
            cases = self._cases(version, done) if version in self._installed(done) else ()
            if any(case in runs and not runs[case].reason for case in cases):
                return version
        return ""

    def _known(self, version: str, done: Results) -> list[tuple[Case, Score]]:
        """Return the cases that ran in a release so far, with their scores; none without one."""
        runs = done.of(self.running)
        cases = self._cases(version, done) if version else ()
        scores = ((case, runs[case].score(case)) for case in cases if case in runs)
        return [(case, score) for case, score in scores if score is not None]

    def _with_spread(self, case: Case, score: Score, done: Results) -> Score:
        """Return the score of a case with its spread, as far as that is measured."""
        runs = done.of(self.running)
        scores = [runs[one].score(one) for one in _members(case, score) if one in runs]
        known = [score for score in scores if score is not None]
        return spread(score, known) if known else score

    def _confirming(self, change: Change, done: Results) -> list[HistoryJob]:
        """Return the jobs that measure the spread of a case in both releases of a doubtful change.

        A spread of a few members is known to a factor of a few, and a release may have another.
        """
        own = change.difference
        if own.first is None or own.second is None or own.tolerance is None:
            return []
        if abs(own.second - own.first) >= CLEAR * own.tolerance:
            return []
        known = (
            pair for version in (change.before, change.after) for pair in self._known(version, done)
        )
        return [
            Job(self.running, one)
            for case, score in known
            if self._name(case) == own.identity
            for one in _members(case, score)
        ]

    def _between(
        self, before: str, after: str, identity: CaseIdentity, done: Results
    ) -> tuple[str, ...]:
        """Return the releases between two that may run a case, as far as it is known."""
        low, high = Version(before), Version(after)
        installed, runs = self._installed(done), done.of(self.running)
        found = []
        for version in self.released:
            if low < Version(version) < high:
                case = self._case_in(version, identity, done) if version in installed else None
                if version not in installed or (case is not None and case not in runs):
                    found.append(version)
        return tuple(found)

    def _narrowing(self, done: Results) -> Iterator[HistoryJob]:
        """Yield what confirms each change, then halves its interval: installing, then the case."""
        installed = self._installed(done)
        for change in self.changes(done):
            confirming = self._confirming(change, done)
            yield from confirming
            if self.bisect and change.between and all(job in done for job in confirming):
                version = change.between[len(change.between) // 2]
                case = None
                if version in installed:
                    case = self._case_in(version, change.difference.identity, done)
                yield self._install(version) if case is None else Job(self.running, case)

    def _name(self, case: Case) -> CaseIdentity:
        """Return what a case is called in every release: without its environment and settings."""
        of_suite = tuple(one for one in case.options if one[0] not in dict(self.settings))
        return replace(name_of(replace(case, options=of_suite)), engine=self.engine)

    def _case_in(self, version: str, identity: CaseIdentity, done: Results) -> Case | None:
        """Return the case of an identity in a release; None if the release has none."""
        for case in self._cases(version, done):
            if self._name(case) == identity:
                return case
        return None

    def _rows(self, done: Results) -> list[ReleaseRow]:
        """Return what became of each release."""
        runs, known = done.of(self.running), self.results(done)
        rows = []
        for version, one in sorted(
            self._installed(done).items(), key=lambda each: Version(each[0])
        ):
            own = [runs[case] for case in self._cases(version, done) if case in runs]
            reasons = [run.reason for run in own if run.reason]
            rows.append(
                ReleaseRow(
                    version=version,
                    environment=one.name,
                    cases=len(own) - len(reasons),
                    quantities=_compared(known[version]) if version in known else 0,
                    refused=len(reasons),
                    reason=one.reason or next(iter(reasons), ""),
                    bisecting=version not in self.versions,
                )
            )
        return rows


@cache
def _perturbed(case: Case, steps: int) -> tuple[Case, ...]:
    """Return the members of a case that takes so many steps."""
    return tuple(member(case, number) for number in range(members(steps)))


def _members(case: Case, score: Score) -> tuple[Case, ...]:
    """Return the members of a case: the releases, slightly perturbed, that measure its spread."""
    return _perturbed(case, int(score.values.get("steps", 0.0)))


def _steps(
    scores: Mapping[str, Mapping[CaseIdentity, Score]],
) -> Iterator[tuple[str, str, CaseIdentity]]:
    """Yield each case with two releases that ran it one after the other, the older first."""
    by_case: dict[CaseIdentity, list[str]] = {}
    for version, own in scores.items():
        for case in own:
            by_case.setdefault(case, []).append(version)
    for case, versions in by_case.items():
        for before, after in pairwise(versions):
            yield before, after, case


def _compared(result: Result) -> int:
    """Return how many quantities of all cases are compared."""
    judged = {one.column for one in QUANTITIES if one.kind is not QuantityKind.TIME}
    return sum(len(judged.intersection(score.values)) for score in result.cases)


def plan_history(
    engine: str,
    versions: str,
    suite: str,
    settings: Sequence[tuple[str, Value]] = (),
    *,
    scenes: Sequence[str] = (),
    bisect: bool = False,
) -> HistoryStudy:
    """Return the history of an engine.

    Parameters
    ----------
    engine : str
        Name of an adapter that takes timesteps.
    versions : str
        With commas between them, or "all".
    suite : str
        A key of `SUITES`.
    settings : sequence of tuple of str and Value
        To put on top of every case, by the engine's own names.
    scenes : sequence of str
        Scenes of the suite that are run; all of them if empty.
    bisect : bool
        Whether to look for each change in the releases between two.

    Raises
    ------
    UnknownEngineError
        If no adapter of that name is registered.
    InvalidSettingError
        If the engine has no package of its own, a version is none, or there is no such suite, or no
        such scene in it.
    """
    entry = entry_of(engine)
    if not packages_for(entry):
        allowed = "an engine with a package of its own, of which there are releases"
        raise InvalidSettingError("ENGINE", engine, allowed)
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    for scene in scenes:
        if scene not in SUITES[suite]:
            raise InvalidSettingError("--scene", scene, f"one of {', '.join(SUITES[suite])}")
    parse_versions(versions.replace(ALL, "1,2"), ())  # wrong use is refused before pip is asked
    released = released_versions(entry, find_interpreter("--python", sys.executable))
    return HistoryStudy(
        engine=engine,
        suite=suite,
        versions=parse_versions(versions, released),
        released=released,
        bisect=bisect,
        settings=tuple(settings),
        design=cache(partial(_designed, suite, tuple(scenes), dict(settings))),
    )


def _designed(
    suite: str, scenes: Sequence[str], settings: Mapping[str, Value], name: str
) -> tuple[Case, ...]:
    """Return the cases of a suite that the engine in an environment can represent."""
    plan = plan_comparison(suite, (name,), {name: settings})
    if own := sorted(settings.keys() & {name for c in plan.designed for name, _ in c.options}):
        raise InvalidSettingError("--set", own[0], f"what suite {suite} does not vary itself")
    return tuple(case for case in plan.cases if not scenes or case.scene.name in scenes)

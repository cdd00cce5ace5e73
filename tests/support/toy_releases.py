"""Releases of an engine that is not there, whose depth of contact depends on the version."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NoReturn

from packaging.version import Version

from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.execution.worker import LostTaskError
from harness.gate.history.releases import Installation, PackageRelease
from harness.gate.history.runs import RunRow
from harness.gate.history.study import HistoryStudy
from harness.studies.study import Work
from models import load

Depth = Callable[[Version, Case], float]
"""Returns the deepest penetration of a case in a version, m."""

TIMESTEPS = (1e-3, 1e-4)


def designed(name: str) -> tuple[Case, ...]:
    """Return two cases of an engine."""
    scene = load("gentle-rock")
    return tuple(
        Case(
            scene=scene,
            engine=name,
            profile="matched",
            timestep=timestep,
            options=(("softness", 1.0),),
        )
        for timestep in TIMESTEPS
    )


@dataclass
class ToyReleases:
    """Releases 1.0 to 1.8, what becomes of each, and what was run."""

    depth: Depth
    absent: Mapping[str, str] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)
    ran: list[tuple[str, float | None]] = field(default_factory=list)

    def study(self, *versions: str, bisect: bool = False) -> HistoryStudy:
        """Return the history of these releases."""
        return HistoryStudy(
            engine="toy",
            suite="quick",
            versions=versions,
            released=tuple(f"1.{number}" for number in range(9)),
            bisect=bisect,
            settings=(("softness", 1.0),),
            design=designed,
            installing=Work(name="installing", call=self._install, lost=lost, label=str),
            running=Work(name="running", call=self._run, lost=lost, label=str),
        )

    def _install(self, release: PackageRelease) -> Installation:
        if reason := self.absent.get(release.version):
            return Installation(reason=reason)
        return Installation(name=f"toy-{release.version}", made=True)

    def _run(self, case: Case) -> RunRow:
        version = case.engine.removeprefix("toy-")
        if case.scene.name == "gentle-rock":
            self.ran.append((version, case.timestep))
        row = {
            "digest": case.digest(version),
            "truth_pulls": False,
            "max_penetration_m": self.depth(Version(version), case),
        }
        reason = self.refused.get(version, "")
        return RunRow(outcome="FINISHED", row=row, reason=reason, record={"engine": case.engine})


def lost(task: object, error: LostTaskError) -> NoReturn:
    """Raise what was lost: nothing is, in this process."""
    raise HarnessError(task, error)

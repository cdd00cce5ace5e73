"""A result: the scores of a suite in some engines, with all that is needed to make them again.

The accepted baseline, a submission and a row of the leaderboard are one format. The published JSON
schema is made from the models here; see `harness.results.schema`.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, model_validator

from harness.core.provenance import provenance
from harness.engines.registry import description_of
from harness.execution.source_fingerprint import sources_fingerprint
from harness.results.scores import CaseIdentity, Digest, Division, Line, Part, Score, scene_digest
from models.scene import Scene

FORMAT: Literal["rockingcan-result"] = "rockingcan-result"
VERSION: Literal[2] = 2
"""Of the format; 1 was of accepted results alone, called "rockingcan-baseline"."""


class EngineRelease(Part):
    """An engine: its name for people, and its version as the engine or its package tells it."""

    label: Line
    version: Line


class Program(Part):
    """The version of rockingcan; and of a run the digest of its sources, None where unknown."""

    version: Line
    fingerprint: Digest | None = None


class Machine(Part):
    """Where a result was measured: platform, processor, cores of the process, versions.

    `packages` are the versions of Python packages; `environments` of each engine in an interpreter
    of its own the versions there.
    """

    platform: Line
    processor: Line
    cores: Annotated[int, Field(ge=1)]
    python: Line
    packages: Mapping[Line, Line]
    environments: Mapping[Line, Line] = {}


class Made(Part):
    """When a result was written (UTC, ISO 8601), and from which commit, None where unknown."""

    written: Line
    commit: Line | None = None
    changed_since_commit: bool | None = None


class Result(Part):
    """The scores of a run of a suite, and where they come from.

    Parameters
    ----------
    format, version
        Of the file.
    suite : str
    name, note : str
        Words of whoever submits; may be empty.
    engines : mapping of str to EngineRelease
        By the name under which an engine ran.
    program : Program
    machine : Machine
    made : Made
    settings : mapping of str to str
        What the run set on top of the suite's cases, by `engine.name`.
    inputs : mapping of str to str
        Digests of the scenes, by name; see `scene_digest`.
    perturbed_by : tuple of float
        Sizes of the perturbations that the spreads were measured with; empty without any.
    cases : tuple of Score
        Each case once.
    """

    format: Literal["rockingcan-result"]
    version: Literal[2]
    suite: Line
    name: Line = ""
    note: Line = ""
    engines: Mapping[Line, EngineRelease]
    program: Program
    machine: Machine
    made: Made
    settings: Mapping[Line, Line] = {}
    inputs: Mapping[Line, Digest]
    perturbed_by: tuple[float, ...] = ()
    cases: tuple[Score, ...]
    _place: str = PrivateAttr("this run")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """Refuse cases that are there twice, or whose engine or scene is not declared."""
        counts = Counter(score.identity for score in self.cases)
        if twice := [name.label() for name, count in counts.items() if count > 1]:
            raise ValueError(f"a case is there twice: {twice[0]}")
        if engines := sorted({score.engine for score in self.cases} - set(self.engines)):
            raise ValueError(f"`engines` lacks {', '.join(engines)}, of which there are cases")
        if scenes := sorted({score.scene for score in self.cases} - set(self.inputs)):
            raise ValueError(f"`inputs` lacks {', '.join(scenes)}, of which there are cases")
        return self

    @property
    def place(self) -> str:
        """What messages call the result: the path that it was read from."""
        return self._place

    def read_from(self, place: str) -> Self:
        """Return the result with another place."""
        moved = self.model_copy()
        moved._place = place  # noqa: SLF001 - its own
        return moved

    @property
    def scores(self) -> dict[CaseIdentity, Score]:
        """The cases by their identity, in their order."""
        return {score.identity: score for score in self.cases}

    @property
    def versions(self) -> dict[str, str]:
        """Versions of rockingcan and of each engine."""
        engines = {name: engine.version for name, engine in self.engines.items()}
        return {"rockingcan": self.program.version, **engines}

    def of_cases(self, cases: Iterable[Score]) -> Self:
        """Return the result with other cases of its own, such as those of one division."""
        return self.model_copy(update={"cases": tuple(cases)})

    def of_division(self, division: Division) -> Self:
        """Return the result with the cases of one division."""
        return self.of_cases(score for score in self.cases if score.division is division)


def make_result(
    suite: str,
    cases: Iterable[Score],
    *,
    versions: Mapping[str, str],
    inputs: Mapping[str, str],
    settings: Mapping[str, str] | None = None,
    origin: Mapping[str, Any] | None = None,
) -> Result:
    """Return a result of this machine and program, or of those of a written report.

    Parameters
    ----------
    suite : str
    cases : iterable of Score
    versions : mapping of str to str
        Of each engine, by name.
    inputs : mapping of str to str
        Digests of the scenes, by name.
    settings : mapping of str to str, optional
        What the run set on top, by `engine.name`.
    origin : mapping, optional
        Provenance as the manifest of a report has it; of this program, and now, if left out.

    Raises
    ------
    ValueError, KeyError
        If the cases and the rest do not fit together.
    """
    made = provenance().to_dict() if origin is None else origin
    machine = {key: made[key] for key in Machine.model_fields if key in made}
    fingerprint = sources_fingerprint() if origin is None else None
    return Result(
        format=FORMAT,
        version=VERSION,
        suite=suite,
        engines={
            name: EngineRelease(label=description_of(name).label or name, version=version)
            for name, version in versions.items()
        },
        program=Program(version=made["rockingcan"], fingerprint=fingerprint),
        machine=Machine(**machine),
        made=Made(**{key: made[key] for key in Made.model_fields if key in made}),
        settings=dict(settings or {}),
        inputs=dict(inputs),
        cases=tuple(cases),
    )


def input_digests(scenes: Iterable[Scene]) -> dict[str, str]:
    """Return the digests of scenes, by name."""
    return {scene.name: scene_digest(scene) for scene in scenes}

"""Scores and results made by hand, for the rules of the gate and of files."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any, Literal

from harness.core.case import Case
from harness.metrics.quantities import Number
from harness.results.result import FORMAT, VERSION, EngineRelease, Machine, Made, Program, Result
from harness.results.scores import Division, Score, identity


def make_score(
    values: Mapping[str, float] | None = None,
    *,
    spread: Mapping[str, Number] | None = None,
    outcome: str = "FINISHED",
    endings: Mapping[str, int] | None = None,
    scene: str = "gentle-rock",
    engine: str = "mujoco",
    profile: Literal["default", "matched", "adaptive"] = "matched",
    timestep: float = 1e-3,
    digest: str = "0123456789abcdef",
    truth_pulls: bool = False,
    division: Division = Division.MATCHED,
) -> Score:
    """Return a score with some values and spreads."""
    return Score(
        scene=scene,
        engine=engine,
        profile=profile,
        timestep=timestep,
        division=division,
        outcome=outcome,
        truth_pulls=truth_pulls,
        values=values or {},
        digest=digest,
        members=0 if spread is None and endings is None else 4,
        spread=spread or {},
        endings=endings or {},
    )


def make_scores(
    *own: Score,
    suite: str = "full",
    versions: Mapping[str, str] | None = None,
    inputs: Mapping[str, str] | None = None,
    place: str = "this run",
    platform: str = "here",
    processor: str = "one",
    **rest: Any,
) -> Result:
    """Return a result with some scores."""
    engines = {"mujoco": "4.0.0", **dict.fromkeys(_of(own, "engine"), "4.0.0"), **(versions or {})}
    program = Program(version=engines.pop("rockingcan", "0.1.0"))
    return Result(
        format=FORMAT,
        version=VERSION,
        suite=suite,
        engines={name: EngineRelease(label=name, version=v) for name, v in engines.items()},
        program=program,
        machine=Machine(
            platform=platform, processor=processor, cores=1, python="3.11.7", packages={}
        ),
        made=Made(written="2026-01-01T00:00:00+00:00"),
        inputs=dict.fromkeys(_of(own, "scene"), "0" * 16) | dict(inputs or {}),
        cases=own,
        **rest,
    ).read_from(place)


def scores_of(cases: Iterable[Case]) -> list[Score]:
    """Return scores of cases as if they had run to their horizon, without a number."""
    return [
        Score(
            **asdict(identity(case)),
            division=Division.MATCHED,
            digest="0" * 16,
            outcome="FINISHED",
            truth_pulls=False,
            values={},
        )
        for case in cases
    ]


def _of(own: Iterable[Score], field: Literal["engine", "scene"]) -> list[str]:
    return [score.engine if field == "engine" else score.scene for score in own]

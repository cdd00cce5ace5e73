"""Scores made by hand, for the rules of the gate; and a suite of four coarse cases, for runs."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import pytest

from harness.core.case import Case
from harness.gate.scores import CaseIdentity, Number, Score, Scores
from models import load

MakeScore = Callable[..., Score]
MakeScores = Callable[..., Scores]


@pytest.fixture(scope="session")
def score() -> MakeScore:
    """Return a function that makes a score with some values and spreads."""

    def make(
        values: Mapping[str, float] | None = None,
        *,
        spread: Mapping[str, Number] | None = None,
        outcome: str = "FINISHED",
        endings: Mapping[str, int] | None = None,
        scene: str = "gentle-rock",
        engine: str = "mujoco",
        profile: str = "matched",
        timestep: float = 1e-3,
        digest: str = "0123456789abcdef",
        truth_pulls: bool = False,
    ) -> Score:
        return Score(
            identity=CaseIdentity(scene=scene, engine=engine, profile=profile, timestep=timestep),
            scene_digest=scene,
            outcome=outcome,
            truth_pulls=truth_pulls,
            values=values or {},
            digest=digest,
            members=0 if spread is None and endings is None else 4,
            spread=spread or {},
            endings=endings or {},
        )

    return make


@pytest.fixture(scope="session")
def scores() -> MakeScores:
    """Return a function that makes a set of scores."""

    def make(*own: Score, suite: str = "full", **rest: object) -> Scores:
        told: dict[str, object] = {"versions": {"mujoco": "4.0.0"}, **rest}
        return Scores(
            suite=suite,
            scores=MappingProxyType({one.identity: one for one in own}),
            **told,  # type: ignore[arg-type]
        )

    return make


@pytest.fixture(scope="session")
def coarse() -> tuple[Case, ...]:
    """Return cases that cost little and amplify much, one of them too coarse for its bounce."""
    return tuple(
        Case(scene=load(scene), engine=engine, profile=profile, timestep=timestep)
        for scene, profile, timestep in (
            ("gentle-rock", "matched", 1e-3),
            ("paper-release", "default", None),
        )
        for engine in ("mujoco", "pybullet")
    )

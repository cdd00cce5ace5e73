"""Scores made by hand, for the rules of the gate."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from harness.gate.scores import CaseIdentity, Score, Scores
from harness.metrics.quantities import Number


def make_score(
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
    """Return a score with some values and spreads."""
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


def make_scores(*own: Score, suite: str = "full", **rest: Any) -> Scores:
    """Return a set of scores."""
    return Scores(
        suite=suite,
        scores=MappingProxyType({one.identity: one for one in own}),
        **({"versions": {"mujoco": "4.0.0"}} | rest),
    )

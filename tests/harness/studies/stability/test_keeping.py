"""Verdicts and findings come back as they were kept; what decides them is in their key."""

import math
from dataclasses import fields, replace
from pathlib import Path

from harness.core.case import Case
from harness.evaluation.evaluate import evaluate
from harness.execution.cache import CacheFolder
from harness.studies.stability.failure_criteria import classify
from harness.studies.stability.study import classified_cache
from harness.studies.stability.suite import random_scenes
from harness.studies.stability.survey import examine, reference_check_cache
from models import Scene


def test_a_verdict_comes_back(gentle: Scene, tmp_path: Path) -> None:
    case = Case(scene=gentle, engine="mujoco", timestep=1e-3)
    made = classify(evaluate(case))
    odd = replace(made, symptom=replace(made.symptom, number=math.inf))
    shelf = classified_cache(CacheFolder(folder=tmp_path / "store"))
    shelf.put(case, odd)
    kept = shelf.get(case)
    assert kept is not None
    assert (kept.verdict, kept.symptom) == (odd.verdict, odd.symptom)
    assert type(kept.symptom.time) is type(odd.symptom.time)
    for field in fields(kept.simulation):
        assert getattr(kept.simulation, field.name) == getattr(odd.simulation, field.name)
    assert shelf.get(replace(case, timestep=2e-3)) is None


def test_findings_come_back_and_are_those_of_their_scenes(tmp_path: Path) -> None:
    part = tuple(random_scenes(3))
    made = [examine(scene) for scene in part]
    shelf = reference_check_cache(CacheFolder(folder=tmp_path / "store"))
    shelf.put(part, made)
    assert shelf.get(part) == made
    assert shelf.get(part[:2]) is None
    heavier = replace(part[2], gravity=2.0 * part[2].gravity)
    assert shelf.get((*part[:2], heavier)) is None

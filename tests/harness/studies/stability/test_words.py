"""What the pages of engines say: numbers with their units, and the timesteps that cure."""

import math

import pytest

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus, Symptom
from harness.studies.stability.limits import TimestepLimit, limit_sentence
from harness.studies.stability.study import engine_page, seen
from models import load


@pytest.mark.parametrize(
    ("words", "number", "said"),
    [
        ("largest phi since, rad", 0.001, "largest phi since 0.001 rad, at 0.12 s"),
        ("speed reached, m/s", 48.0, "speed reached 48 m/s, at 0.12 s"),
        ("depth over the radius", 0.3, "depth over the radius 0.3, at 0.12 s"),
        (
            "error of phi over its largest, rms",
            0.02,
            "error of phi over its largest, rms 0.02, at 0.12 s",
        ),
        ("no numbers in the first step", math.nan, "no numbers in the first step"),
    ],
)
def test_a_unit_stays_with_its_number(words: str, number: float, said: str) -> None:
    assert seen(Symptom(time=0.12, number=number, words=words)) == said


def judged(
    scene: str,
    verdict: StabilityStatus,
    timestep: float,
    profile: str = "default",
    *,
    own: bool = False,
) -> ClassifiedRun:
    """Return a run with a verdict; `own` is at the timestep that the engine ships with."""
    case = Case(
        scene=load(scene),
        engine="mujoco",
        profile=profile,
        timestep=None if own else timestep,
    )
    simulation = Simulation(
        case=case,
        outcome=Outcome.FINISHED,
        trajectory=None,
        engine_version="0",
        model="mujoco",
        timestep=timestep,
    )
    symptom = Symptom(time=0.12, number=0.001, words="largest phi since, rad")
    return ClassifiedRun(simulation=simulation, verdict=verdict, symptom=symptom)


def test_what_cures_a_case_is_told_with_its_largest_timestep() -> None:
    names = ("fast-spin", "planar-fall", "tall-can", "tiny-can", "hundred-g")
    runs = [
        *(judged(name, StabilityStatus.FLAT, 2e-3, own=True) for name in names),
        judged("fast-spin", StabilityStatus.ACCURATE, 1e-3),
        judged("fast-spin", StabilityStatus.ACCURATE, 2e-4),
        judged("planar-fall", StabilityStatus.ACCURATE, 2e-4),
        judged("tall-can", StabilityStatus.ACCURATE, 5e-3),
        judged("tiny-can", StabilityStatus.ACCURATE, 2e-5, "matched"),
    ]
    text = engine_page("mujoco", runs, (), names).text
    flat = f"({StabilityStatus.FLAT.value})"
    assert f"Cured by a shorter timestep alone, at 0.001 s: fast-spin {flat}." in text
    assert f"Cured by a shorter timestep alone, at 0.0002 s: planar-fall {flat}." in text
    assert f"Cured by a longer timestep alone, at 0.005 s: tall-can {flat}." in text
    assert f"Cured by profile matched at 2e-05 s: tiny-can {flat}." in text
    assert f"Cured by nothing that was tried: hundred-g {flat}." in text
    assert "(largest phi since 0.001 rad, at 0.12 s)" in text


def test_the_limits_of_an_engine_are_told_between_the_hardest_and_the_easiest_case() -> None:
    least, most = (
        TimestepLimit(
            scene=scene,
            engine="toy",
            standard="accurate",
            usable=(step,),
            coarsest=1e-2,
            finest=1e-6,
        )
        for scene, step in (("hundred-g", 1.4e-4), ("tall-can", 7.1e-3))
    )
    assert limit_sentence([most, least]) == (
        "Matched, the largest timestep that follows the exact motion lies between 0.00014 s "
        "(hundred-g) and 0.0071 s (tall-can) in the 2 cases that have one."
    )
    assert limit_sentence([]) == "No hard case is followed at any timestep that was tried."

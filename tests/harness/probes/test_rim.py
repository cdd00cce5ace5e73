"""The survey under the rim: nothing of an exact collider, and every trap of others, told."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.probes import rim_survey
from harness.engines.probes.rim_contact import Stance, ask, collision
from harness.engines.probes.rim_survey import RimFinding, survey_rim
from harness.engines.world import Contact
from models import Scene
from models.kinematics import to_world
from tests.harness.probes.rim_worlds import FOUR_BELOW, MIDDLE_BELOW, MadeUpEngine, RimWorld
from tests.support.engines import CONSTRAINT

Survey = Callable[[str], tuple[RimFinding, ...]]


@pytest.fixture
def findings(gentle: Scene, monkeypatch: pytest.MonkeyPatch) -> Survey:
    """Return a function that surveys a collider of the made-up engine."""
    monkeypatch.setattr(rim_survey, "engine", lambda _: MadeUpEngine())

    def survey(kind: str) -> tuple[RimFinding, ...]:
        case = Case(scene=gentle, engine="made-up", options=(("collider", kind),))
        return survey_rim(case).findings

    return survey


def test_an_exact_collider_has_no_finding(findings: Survey) -> None:
    assert findings("exact") == ()


def test_a_contact_that_jumps_to_the_middle_is_found_with_its_tilt(
    findings: Survey, gentle: Scene
) -> None:
    found = findings("middle")
    assert [each.kind for each in found] == ["contact", "place", "depth"]
    lost, middle, depth = found
    assert middle.below_tilt_rad == pytest.approx(MIDDLE_BELOW, rel=2e-6)
    assert middle.place_error_m == pytest.approx(gentle.can.radius, rel=1e-6)
    assert re.match(r"below 0\.000447\d+ rad the contact is 37 mm off", middle.sentence)
    # the middle of the base is above the plane, and too shallow where it is not
    assert " and below 0.000447" in lost.sentence
    assert "no contact" in lost.sentence
    assert "the depth is" in depth.sentence


def test_points_that_become_several_are_found_with_their_tilt(findings: Survey) -> None:
    (several,) = findings("four")
    assert several.below_tilt_rad == pytest.approx(FOUR_BELOW, rel=2e-6)
    assert several.kind == "count"
    assert "has 4 contact points" in several.sentence


def test_a_ground_that_ends_is_found(findings: Survey) -> None:
    (ends,) = findings("ends")
    assert ends.kind == "distance"
    assert re.fullmatch(
        r"1,000 m from the origin no contact is found in (\d+) of \1 stances", ends.sentence
    )


def test_a_polygon_is_off_the_rim_at_every_tilt(findings: Survey, gentle: Scene) -> None:
    found = findings("polygon")
    assert {each.kind for each in found} <= {"contact", "place", "depth"}  # alike at any size
    (place,) = (each for each in found if each.kind == "place")
    half_a_side = gentle.can.radius * math.pi / 32.0
    assert 0.5 * half_a_side < place.place_error_m < 1.01 * half_a_side


def test_a_depth_that_is_told_wrongly_is_found(findings: Survey, gentle: Scene) -> None:
    deeper, above = findings("sinking")
    assert deeper.sentence == f"at every tilt the depth is {2.0 * gentle.can.radius:.3g} mm off"
    height = f"{gentle.can.radius:.3g} mm above the ground"
    assert (above.kind, above.sentence) == (
        "above",
        f"at every tilt a can that is {height} touches it",
    )


def test_a_normal_that_leans_is_found(findings: Survey) -> None:
    (leaning,) = findings("leaning")
    assert leaning.sentence == "at every tilt the normal leans by 0.01 rad"


def test_a_normal_that_is_zero_is_found(findings: Survey) -> None:
    (zero,) = findings("no direction")
    assert zero.sentence == "at every tilt the normal leans by 1.6 rad"


def test_a_depth_that_is_not_told_is_a_contact_without_an_error(
    findings: Survey, gentle: Scene
) -> None:
    assert findings("surface") == ()
    stance = Stance(tilt=0.3, heading=1.0, spin=1.0, upside_down=False, depth=1e-6)
    answer = ask(RimWorld(gentle.can, "surface"), gentle.can, stance)  # type: ignore[arg-type] # no more is asked of it
    assert (answer.count, math.isnan(answer.depth_error)) == (1, True)


def test_numbers_that_break_are_no_contact(findings: Survey) -> None:
    (broken,) = findings("broken")
    assert broken.sentence.startswith("at every tilt no contact is found")


def test_what_depends_on_the_size_is_found(findings: Survey) -> None:
    (small,) = findings("small")
    assert small.kind == "size"
    assert small.sentence == "at a radius of 1 mm the contact is 0.1 mm off the lowest point"


@pytest.mark.parametrize("upside_down", [False, True])
@pytest.mark.parametrize(("tilt", "heading", "spin"), [(1e-12, 0.3, 2.0), (0.7, 4.0, -1.0)])
def test_a_stance_has_the_lowest_point_of_the_rim(
    gentle: Scene, tilt: float, heading: float, spin: float, *, upside_down: bool
) -> None:
    can = gentle.can
    stance = Stance(
        tilt=tilt, heading=heading, spin=spin, upside_down=upside_down, depth=1e-5, distance=10.0
    )
    pose, lowest = stance.put(can)
    assert np.linalg.norm(pose.quaternion) == pytest.approx(1.0, rel=1e-15)
    around = np.linspace(0.0, 2.0 * math.pi, 100_001)
    ring = can.radius * np.array((np.cos(around), np.sin(around), np.zeros_like(around))).T
    ends = [ring + np.array((0.0, 0.0, end * can.half_height)) for end in (-1.0, 1.0)]
    points = pose.position + to_world(pose.quaternion, np.concatenate(ends))
    assert points[:, 2].min() == pytest.approx(-1e-5, rel=1e-5)
    if tilt > 1e-9:  # else heights are equal to round-off
        found = points[np.argmin(points[:, 2])]
        assert math.hypot(*(found - lowest)[:2]) < 1e-4 * can.radius


class Solving(RimWorld):
    """A collider that tells its contacts only as those that a step solved."""

    def step(self) -> None:
        """Solve."""
        self.solved = RimWorld.collision(self)

    def contact(self) -> Contact:
        """Return what was solved."""
        (point,), (depth,) = self.solved.points, self.solved.depths
        return Contact(point=point, force=np.zeros(3), penetration=depth, count=1)

    def __getattribute__(self, name: str) -> object:
        """Hide the question without a step."""
        if name == "collision":
            raise AttributeError(name)
        return super().__getattribute__(name)


def test_without_a_question_a_step_is_taken(gentle: Scene) -> None:
    world = Solving(gentle.can, "exact")
    stance = Stance(tilt=0.3, heading=1.0, spin=1.0, upside_down=False, depth=1e-6)
    answer = ask(world, gentle.can, stance)  # type: ignore[arg-type] # no more is asked of it
    assert (answer.count, math.isnan(answer.normal_error)) == (1, True)
    assert answer.place_error < 1e-12
    assert answer.depth_error < 1e-12
    assert len(collision(world).points) == 1  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "why"), [("reference", "steps no world"), (CONSTRAINT, "imposes")]
)
def test_an_engine_without_contacts_is_refused(gentle: Scene, name: str, why: str) -> None:
    if name == CONSTRAINT:
        pytest.importorskip(name)
    with pytest.raises(InvalidSettingError, match=why):
        survey_rim(Case(scene=gentle, engine=name))


@pytest.mark.parametrize(
    ("name", "options", "below", "off"),
    [
        ("mujoco", (("shapes", "mesh-plane"),), math.pi / 2.0, 3.5e-3),
        pytest.param(
            *("pybullet", (("URDF_USE_IMPLICIT_CYLINDER", False),), math.pi / 2.0, 3.5e-3),
            marks=pytest.mark.engine("pybullet"),
        ),
        pytest.param(
            *("dart", (("collisionDetector", "FCLCollisionDetector"),), MIDDLE_BELOW, 0.037),
            marks=pytest.mark.engine("dart"),
        ),
        pytest.param(
            *("drake", (("ground", "HalfSpace"),), MIDDLE_BELOW, 0.037),
            marks=pytest.mark.engine("drake"),
        ),
        pytest.param(
            *("drake", (("compliance_type", "compliant"),), math.pi / 2.0, 0.037),
            marks=pytest.mark.engine("drake"),
        ),
        pytest.param(
            *("mjx", (("shapes", "mesh-plane"),), math.pi / 2.0, 0.0258),
            marks=pytest.mark.engine("mjx"),
        ),
        pytest.param(
            *("mujoco-warp", (("shapes", "mesh-plane"),), math.pi / 2.0, 0.026),
            marks=pytest.mark.engine("mujoco-warp"),
        ),
        pytest.param(*("ode", (), MIDDLE_BELOW, 0.018), marks=pytest.mark.engine("ode")),
    ],
)
def test_what_real_colliders_do_is_found_unaided(
    gentle: Scene, name: str, options: tuple[tuple[str, str | bool], ...], below: float, off: float
) -> None:
    found = survey_rim(Case(scene=gentle, engine=name, options=options)).findings
    (jump,) = (each for each in found if each.kind == "place")
    assert jump.below_tilt_rad == pytest.approx(below, rel=1e-5)
    assert jump.place_error_m == pytest.approx(off, rel=0.02)


@pytest.mark.engine("pybullet")
def test_the_implicit_cylinder_of_pybullet_is_exact(gentle: Scene) -> None:
    assert survey_rim(Case(scene=gentle, engine="pybullet")).findings == ()


def test_the_same_question_has_the_same_answer(gentle: Scene) -> None:
    case = Case(scene=gentle, engine="mujoco")
    first, second = (survey_rim(each) for each in (case, replace(case)))
    assert first.findings == second.findings
    assert repr(first.found) == repr(second.found)

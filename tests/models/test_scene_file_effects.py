"""The effects of a scene file: what is allowed, and the sentence for everything that is wrong."""

from pathlib import Path

import pytest

from models import SceneFileError, read_scene, write_scene

GOOD = """\
name = "a-scene"
gravity = 9.81
[can]
mass = 0.043
radius = 0.037
a = 0.727
c = 0.615
h = 1.473
[release]
phi = 0.4
[horizon]
bounces = 1
"""


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "[horizon]",
            "[effects]\nslip = 0.3\n[horizon]",
            "key 'effects.slip' is 0.3, but must be a table",
        ),
        (
            "[horizon]",
            "[effects]\nslip = { mu = -0.3 }\n[horizon]",
            "key 'effects.slip.mu' is -0.3, but must be a finite number, zero or greater",
        ),
        (
            "[horizon]",
            "[effects]\nslip = { mu = 0 }\ndrilling = { length = 1e-3 }\n[horizon]",
            (
                "key 'effects.drilling.length' is 0.001, but must be left out beside `slip` with "
                "mu 0: a plane without friction does not resist"
            ),
        ),
        (
            "[horizon]",
            (
                "[effects]\ncompliance = { stiffness = 1e4 }\nrestitution = { coefficient = 0.5 }\n"
                "[horizon]"
            ),
            (
                "key 'effects.restitution.coefficient' is 0.5, but must be left out beside "
                "`compliance`: its damping says what a contact gives back"
            ),
        ),
        (
            "[horizon]",
            "[effects]\nrestitution = { coefficient = 1.5 }\n[horizon]",
            (
                "key 'effects.restitution.coefficient' is 1.5, but must be a number from 0 to 1: "
                "no impact gives back more than it got"
            ),
        ),
        (
            "[horizon]",
            "[effects]\nshake = { vertical = 1e-3 }\n[horizon]",
            "key 'effects.shake.frequency' is missing; it must be a number",
        ),
        (
            "[horizon]",
            "[effects]\nshake = { frequency = 5 }\n[horizon]",
            (
                "key 'effects.shake.horizontal' is 0.0, but must be greater than zero, "
                "or `vertical` must be"
            ),
        ),
        (
            "[horizon]",
            "[effects]\ndamping = {}\n[horizon]",
            (
                "key 'effects.damping.linear' is 0.0, but must be greater than zero, "
                "or `angular` must be"
            ),
        ),
        (
            "[horizon]",
            "[effects]\npoint_mass = { mass = 1e-3, x = 0.03, y = 0.03 }\n[horizon]",
            (
                "key 'effects.point_mass.x' is 0.03, but must be inside the can: "
                "at most 0.037 from its axis, with y at 0.03"
            ),
        ),
        (
            "[horizon]",
            "[effects]\npoint_mass = { mass = 1e-3, x = 0.0, y = -0.05 }\n[horizon]",
            (
                "key 'effects.point_mass.y' is -0.05, but must be inside the can: "
                "at most 0.037 from its axis"
            ),
        ),
        (
            "[horizon]",
            "[effects]\nslip = { nu = 0.3 }\n[horizon]",
            "key 'effects.slip.nu' is unknown; allowed are mu, mu_static, patch",
        ),
        (
            "[horizon]",
            "[effects]\ncompliance = { stifness = 1e4 }\n[horizon]",
            (
                "key 'effects.compliance.stifness' is unknown, did you mean 'stiffness'? "
                "allowed are stiffness, damping, exponent"
            ),
        ),
        (
            "[horizon]",
            "[effects]\ncompliance = { stiffness = 1e4, exponent = 2.5 }\n[horizon]",
            (
                "key 'effects.compliance.exponent' is 2.5, but must be a number from 1 (linear) to "
                "2; 1.5 is Hertz's"
            ),
        ),
        (
            "[horizon]",
            "[effects]\nrim = { radius = 0.04 }\n[horizon]",
            (
                "key 'effects.rim.radius' is 0.04, but must be less than the can's radius 0.037 "
                "and half height 0.054501"
            ),
        ),
        (
            "[horizon]",
            "[effects]\ntilt = { angle = 1.6 }\n[horizon]",
            (
                "key 'effects.tilt.angle' is 1.6, but must be greater than 0 and less than "
                "pi/2 (radians)"
            ),
        ),
        (
            "[horizon]",
            '[effects]\nrestitution = { coefficient = 0.5, law = "stronge" }\n[horizon]',
            ("key 'effects.restitution.law' is 'stronge', but must be 'newton' or 'poisson'"),
        ),
        (
            "[horizon]",
            "[effects]\nrestitution = { coefficient = 0.5, law = 1 }\n[horizon]",
            "key 'effects.restitution.law' is 1, but must be a string",
        ),
        (
            "[horizon]",
            "[effects]\nslip = {}\n[horizon]",
            "key 'effects.slip.mu' is missing; it must be a number",
        ),
        (
            "[horizon]",
            "[effects]\nslide = { mu = 1 }\n[horizon]",
            (
                "key 'effects.slide' is unknown, did you mean 'slip'? allowed are slip, "
                "compliance, restitution, drilling, rolling_resistance, contour_friction, "
                "air_film, damping, rim, tilt, shake, point_mass"
            ),
        ),
    ],
)
def test_each_wrong_effect_has_its_sentence(
    tmp_path: Path, old: str, new: str, expected: str
) -> None:
    path = tmp_path / "scene.toml"
    assert old in GOOD
    path.write_text(GOOD.replace(old, new))
    with pytest.raises(SceneFileError) as caught:
        read_scene(path)
    assert str(caught.value) == f"scene file '{path}': {expected}"


def test_a_law_of_restitution_is_kept_and_its_default_leaves_the_digest(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    declared = '[effects]\nrestitution = { coefficient = 0.5, law = "%s" }\n[horizon]'
    path.write_text(GOOD.replace("[horizon]", declared % "poisson"))
    scene = read_scene(path)
    path.write_text(write_scene(scene))
    assert read_scene(path) == scene
    path.write_text(GOOD.replace("[horizon]", declared % "newton"))
    assert read_scene(path).to_dict()["effects"] == {"restitution": {"coefficient": 0.5}}


@pytest.mark.parametrize(
    ("effects", "key"),
    [
        ("slip = { mu = 0.3, mu_static = 0.2 }", "effects.slip.mu_static"),
        ("slip = { mu = 0.3, patch = -1e-3 }", "effects.slip.patch"),
        ("slip = { mu = 0.0, patch = 1e-3 }", "effects.slip.patch"),
        ("slip = { mu = 0.3, patch = 0.04 }", "effects.slip.patch"),
        ("slip = { mu = 0.3, patch = 1e-3 }\ndrilling = { length = 1e-3 }", "effects.slip.patch"),
        ("contour_friction = { coulomb = -0.1 }", "effects.contour_friction.coulomb"),
        ("contour_friction = {}", "effects.contour_friction.coulomb"),
        ("contour_friction = { viscous = nan }", "effects.contour_friction.viscous"),
        ("air_film = { viscosity = 0.0 }", "effects.air_film.viscosity"),
        ("air_film = { viscosity = 1e-5, density = -1.0 }", "effects.air_film.density"),
        ("air_film = { density = 1.2 }", "effects.air_film.viscosity"),
        (
            "contour_friction = { coulomb = 0.1 }\nrolling_resistance = { length = 0.1 }",
            "effects.contour_friction.coulomb",
        ),
        (
            "slip = { mu = 0.0 }\ncontour_friction = { coulomb = 0.1 }",
            "effects.contour_friction.coulomb",
        ),
    ],
)
def test_laws_that_make_no_sense_are_refused_by_key(tmp_path: Path, effects: str, key: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(GOOD.replace("[horizon]", f"[effects]\n{effects}\n[horizon]"))
    with pytest.raises(SceneFileError) as caught:
        read_scene(path)
    assert key in str(caught.value)


def test_equal_coefficients_are_one_and_a_scene_of_old_keeps_its_keys(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    read = []
    for slip in ("{ mu = 0.3 }", "{ mu = 0.3, mu_static = 0.3 }", "{ mu = 0.3, mu_static = 0.4 }"):
        path.write_text(GOOD.replace("[horizon]", f"[effects]\nslip = {slip}\n[horizon]"))
        read.append(read_scene(path))
    assert read[0] == read[1]
    path.write_text(
        GOOD.replace("[horizon]", "[effects]\nslip = { mu = 0.3, patch = 0.0 }\n[horizon]")
    )
    assert read_scene(path) == read[0]
    assert read[0].to_dict()["effects"] == {"slip": {"mu": 0.3}}
    assert read[2].to_dict()["effects"] == {"slip": {"mu": 0.3, "mu_static": 0.4}}
    path.write_text(write_scene(read[2]))
    assert read_scene(path) == read[2]

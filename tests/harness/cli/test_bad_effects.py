"""Laws of effects out of their range, that contradict each other, or that an engine lacks."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.command_line import Command, able, is_one_clear_message

# each: the laws that a scene declares, what the message must name
FAULTS = {
    "restitution that makes energy": (
        "[effects.restitution]\ncoefficient = 1.5",
        ("restitution.coefficient", "1.5"),
    ),
    "a negative restitution": (
        "[effects.restitution]\ncoefficient = -0.1",
        ("restitution.coefficient", "-0.1"),
    ),
    "a law of restitution that is none": (
        "[effects.restitution]\ncoefficient = 1\nlaw = 'kane'",
        ("restitution.law", "'poisson'"),
    ),
    "a spring without stiffness": (
        "[effects.compliance]\ndamping = 1.0",
        ("compliance.stiffness", "missing"),
    ),
    "a spring of no stiffness": (
        "[effects.compliance]\nstiffness = 0.0",
        ("compliance.stiffness", "greater than zero"),
    ),
    "an exponent of no contact": (
        "[effects.compliance]\nstiffness = 1e6\nexponent = 3",
        ("compliance.exponent", "3.0"),
    ),
    "static friction below kinetic": (
        "[effects.slip]\nmu = 0.4\nmu_static = 0.3",
        ("slip.mu_static", "0.4"),
    ),
    "a patch without friction": ("[effects.slip]\nmu = 0.0\npatch = 1e-4", ("slip.patch", "`mu`")),
    "a patch beside drilling": (
        "[effects.slip]\nmu = 0.3\npatch = 1e-4\n[effects.drilling]\nlength = 1e-4",
        ("slip.patch", "`drilling`"),
    ),
    "two dry moments": (
        "[effects.contour_friction]\ncoulomb = 0.1\n[effects.rolling_resistance]\nlength = 1e-4",
        ("contour_friction.coulomb", "`rolling_resistance`"),
    ),
    "contour friction of nothing": (
        "[effects.contour_friction]\ncoulomb = 0.0",
        ("contour_friction.coulomb", "`viscous`"),
    ),
    "a film of no air": (
        "[effects.air_film]\nviscosity = 0.0",
        ("air_film.viscosity", "greater than zero"),
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_law_is_refused_by_file_and_key(
    rockingcan: Command, scene_file: Callable[..., Path], fault: str
) -> None:
    law, parts = FAULTS[fault]
    path = scene_file(("[effects]", law))
    is_one_clear_message(rockingcan("reference", str(path)), str(path), *parts)


@pytest.mark.parametrize(
    ("law", "key"),
    [
        ("[effects.slip]\nmu = 0.3\nmu_static = 0.4", "slip.mu_static"),
        ("[effects.slip]\nmu = 0.3\npatch = 1e-4", "slip.patch"),
        ("[effects.compliance]\nstiffness = 1e7\nexponent = 1.5", "compliance.exponent"),
        ('[effects.restitution]\ncoefficient = 0.5\nlaw = "poisson"', "restitution.law"),
        ("[effects.contour_friction]\ncoulomb = 1e-3", "contour_friction"),
        ("[effects.air_film]\nviscosity = 1.8e-5", "air_film"),
    ],
)
def test_what_an_engine_cannot_represent_is_refused_naming_the_key_and_those_that_can(
    rockingcan: Command, scene_file: Callable[..., Path], law: str, key: str
) -> None:
    path = scene_file(("[effects]", law))
    for engine in ("mujoco", "pybullet"):
        is_one_clear_message(rockingcan("run", str(path), "--engine", engine), key, able(key))

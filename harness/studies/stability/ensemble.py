"""Perturbed releases of a hard case that are just as hard.

The boundary of a stable timestep depends on where in a bounce a step happens to fall. Members of an
ensemble differ by a thousandth: in the rates, and in phi as far as phi is from flat, from balance
and from lying on the side, whichever is nearest; so a can released 1e-12 rad off balance stays
that near to it. Each has a heading of its own, which changes nothing but an engine's round-off and
the directions that its friction prefers.
"""

from dataclasses import replace

from harness.studies.errors.ensemble import departure
from models.scene import Scene

SIZE = 1e-3
"""Relative: far beyond round-off, and too small to be seen in the exact motion."""


def member(scene: Scene, number: int) -> Scene:
    """Return a member of the ensemble of a scene, under a name of its own; the first is itself."""
    if number == 0:
        return scene
    release, balance = scene.release, scene.can.balancing_angle
    phi, psi, theta = (SIZE * share for share in departure(number))
    # a release that balances to the last digit stays there
    room = min(release.phi, abs(release.phi - balance))
    return replace(
        scene,
        name=f"{scene.name[:56]}.member-{number}"[:64],
        release=replace(
            release,
            phi=release.phi + phi * room,
            psi=release.psi + float(number),
            phi_dot=release.phi_dot,
            psi_dot=release.psi_dot * (1.0 + psi),
            theta_dot=release.theta_dot * (1.0 + theta),
        ),
    )

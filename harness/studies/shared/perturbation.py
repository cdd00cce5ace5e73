"""Slightly perturbed releases, closer to each other than a measurement of a release resolves.

The perturbations of phi, psi' and theta' are relative and quasi-random: Roberts's sequence, whose
points k (1/g, 1/g^2, 1/g^3) mod 1, with g^4 = g + 1, fill the cube evenly for any number of them.

Perturbed releases of a hard case that are just as hard.

The boundary of a stable timestep depends on where in a bounce a step happens to fall. Members of an
ensemble differ by a thousandth: in the rates, and in phi as far as phi is from flat, from balance
and from lying on the side, whichever is nearest; so a can released 1e-12 rad off balance stays
that near to it. Each has a heading of its own, which changes nothing but an engine's round-off and
the directions that its friction prefers.
"""

from dataclasses import replace

from models.scene import Scene

SIZES = (1e-9, 1e-8, 1e-7, 1e-6)
"""Relative to each of phi, psi' and theta'; 1e-6 of 0.03 rad moves the rim by a nanometre."""

MEMBERS = 6
"""Releases of each size: enough for the order of magnitude of the spread."""

_G = 1.2207440846057596
_MIDDLE = 0.5  # of the cube: the sequence starts there


def departure(number: int) -> tuple[float, float, float]:
    """Return the departures of a member, each in [-1, 1)."""
    phi, psi, theta = (
        2.0 * ((_MIDDLE + (number + 1) * _G**-power) % 1.0) - 1.0 for power in (1, 2, 3)
    )
    return phi, psi, theta


def perturbed(scene: Scene, size: float, number: int) -> Scene:
    """Return a scene with a slightly other release, under a name of its own."""
    release = scene.release
    phi, psi, theta = (size * share for share in departure(number))
    name = f"{scene.name[:50]}.{size:.0e}.{number}"  # a name has 64 letters at most
    return replace(
        scene,
        name=name,
        release=replace(
            release,
            phi=release.phi * (1.0 + phi),
            psi_dot=release.psi_dot * (1.0 + psi),
            theta_dot=release.theta_dot * (1.0 + theta),
        ),
    )


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

"""The exact motion as a function of time.

In the clock's time u (`reference.integrable.elliptic`) the rates of t, psi and psi + theta are even
periodic functions; their Fourier series integrate term by term,

    t(u) = c_0 u + sum c_k sin(k pi u/K) K/(k pi),

with u = 0 at a minimum of phi, K at the next maximum and so on for ever. The contact point moves
with Theta (-sin psi, cos psi): in the plane of complex numbers i Theta exp(i psi) is a periodic
function times exp(i omega u), omega the mean precession, and integrates term by term as well. So
states are known at every time, after any number of bounces, without integrating through them.

Periodic functions by their harmonics: integrals term by term, exact to round-off.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from reference.equations.reaction_force import contact_from_centre
from reference.integrable.cycle import released_potential
from reference.integrable.elliptic import EllipticSubstitution
from reference.integrable.frobenius import can_constants, series_of
from reference.integrable.quadrature import (
    elliptic_substitution,
    energy_left,
    nodes_needed,
    rates,
    unresolved,
)
from reference.integrable.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.numerics.batching import in_blocks
from reference.numerics.rootfinding import bracketed_roots
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, States, initial_states, select_states
from reference.smooth.extrema import Extrema, Run

# Harmonics below this share of the greatest cannot be told from round-off.
SILENT = 1e-16


@dataclass(frozen=True, slots=True, kw_only=True)
class Harmonics:
    """An integral over u: slope u + sum of waves sin(k pi u/K)."""

    slope: float
    waves: Floats

    def at(self, phase: Floats) -> Floats:
        """Value at u = phase K, shape of `phase`."""
        k = np.arange(1, self.waves.size + 1)
        return np.asarray(
            self.slope * phase + summed(np.sin(np.pi * phase[:, None] * k), self.waves)
        )


def summed(waves: Floats, weights: Floats) -> Floats:
    """Sum of waves of shape (m, k), in one order whatever the number of threads, shape (m,).

    A library of linear algebra shares a large product among threads, on whose number its last bits
    depend.
    """
    return np.asarray(np.einsum("mk,k->m", waves, weights))


def harmonics_of(rate: Floats) -> Harmonics:
    """Integrate an even periodic function given at the midpoints of [0, 1] in u/K."""
    n = rate.size
    waves = dct(rate)[1:] / (n * np.pi * np.arange(1, n))
    heard = np.flatnonzero(np.abs(waves) > SILENT * np.abs(waves).max(initial=0.0))
    last = int(heard[-1]) + 1 if heard.size else 0
    return Harmonics(slope=float(rate.mean()), waves=waves[:last])


def locus_harmonics(rotation: Floats, precession: Harmonics) -> NDArray[np.complex128]:
    """Fourier coefficients of theta' exp(i (psi - mean)), from midpoints of a half period."""
    n = rotation.size
    phase = (np.arange(-n, n) + 0.5) / n
    wobble = precession.at(phase) - precession.slope * phase
    signal = np.concatenate([rotation[::-1], rotation]) * np.exp(1j * wobble)
    # the first midpoint is at -1 + 1/(2 n): a half turn back, and half a step on, in every wave
    shift = np.exp(-1j * np.pi * np.arange(-n, n) * phase[0])
    return np.asarray(shift * np.fft.fftshift(np.fft.fft(signal)) / (2 * n))


# The quadrature is exact with the harmonics a function needs for half its digits; histories need
# all.
MORE_NODES = 3
# Newton on a monotone function between brackets.
MOST_ROUNDS = 80
# At least so many samples of a half period, among which peaks are looked for and grids begin.
SAMPLES = 48


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactPath:
    """The motion of one release, known at every time.

    Attributes
    ----------
    points : TurningPoints
    clock : Clock
    start : float
        u/K at release, in [-1, 1).
    time, precession, total : Harmonics
        Of t, psi and psi + theta, zero at u = 0.
    locus : ndarray of complex or None
        Fourier coefficients of the contact velocity, for k = -n .. n - 1.
    t_end : float
    evaluations : int
        Nodes at which the rates were computed.
    """

    problem: Problem
    points: TurningPoints
    clock: EllipticSubstitution
    start: float
    time: Harmonics
    precession: Harmonics
    total: Harmonics
    locus: NDArray[np.complex128] | None
    t_end: float
    evaluations: int

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        return in_blocks(lambda block: self._states(self.phase(block)), times)

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states on an even grid of the clock, without the contact point."""
        end = float(self.phase(np.array([self.t_end]))[0])
        # a long wait beside balance leaves little of the clock to the bounce: more samples then
        a_half = max(SAMPLES, int(nodes_needed(self.clock)[0]))
        count = int(np.ceil((end - self.start) * a_half)) + 1
        phase = np.linspace(self.start, end, max(count, 2))
        times = np.clip(self.time.at(phase) - self._at_start(self.time), 0.0, self.t_end)
        times[-1] = self.t_end
        return times, self._states(phase, locus=False)

    def time_at(self, phase: float) -> float:
        """Time at u = phase K."""
        return float(self.time.at(np.array([phase]))[0] - self._at_start(self.time))

    def phase(self, times: Floats) -> Floats:
        """u/K at the given times."""
        wanted = times + self._at_start(self.time)
        half = self.time.slope
        cycle = np.round(wanted / (2 * half))
        wanted = wanted - 2 * half * cycle
        low, high = np.full(times.shape, -1.0), np.full(times.shape, 1.0)
        phase = np.clip(wanted / half, -1, 1)
        k = np.arange(1, self.time.waves.size + 1)
        slopes = np.pi * k * self.time.waves
        eps = np.finfo(float).eps
        open_ = np.arange(times.size)
        for _ in range(MOST_ROUNDS):
            x, goal = phase[open_], wanted[open_]
            angle = np.pi * x[:, None] * k
            excess = half * x + summed(np.sin(angle), self.time.waves) - goal
            gradient = half + summed(np.cos(angle), slopes)
            low[open_] = np.where(excess < 0, x, low[open_])
            high[open_] = np.where(excess > 0, x, high[open_])
            new = x - excess / np.where(gradient > 0, gradient, np.inf)
            outside = (new <= low[open_]) | (new >= high[open_])
            new = np.where(outside, (low[open_] + high[open_]) / 2, new)
            # a residual below the resolution of the time, or of the sum of waves, means nothing
            done = np.abs(excess) <= np.spacing(times[open_]) + eps * half * np.abs(x)
            phase[open_] = np.where(done, x, new)
            open_ = open_[~done & (np.abs(new - x) > np.spacing(np.abs(x)))]
            if not open_.size:
                break
        return np.asarray(phase + 2 * cycle)

    def extrema(self, phases: Floats) -> States:
        """States at whole numbers of u/K, where phi' is exactly zero; the release keeps its own."""
        states = self._states(phases)
        released = phases == self.start
        return States(
            phi=np.where(released, self.problem.phi, states.phi),
            phi_dot=np.where(released, self.problem.phi_dot, 0.0),
            psi=np.where(released, self.problem.psi, states.psi),
            psi_dot=np.where(released, self.problem.psi_dot, states.psi_dot),
            theta=np.where(released, self.problem.theta, states.theta),
            theta_dot=np.where(released, self.problem.theta_dot, states.theta_dot),
            spin=states.spin,
        )

    def _at_start(self, harmonics: Harmonics) -> float:
        return float(harmonics.at(np.array([self.start]))[0])

    def _states(self, phase: Floats, *, locus: bool = True) -> States:
        local = phase - 2 * np.round(phase / 2)
        phi, rise, gap = self.clock.nutation(np.abs(local)[:, None])
        state, left, _ = energy_left(self.points, phi, rise, gap, careful=True)
        speed = np.sqrt(2 * left / self.problem.parameters.pendulum_inertia)[:, 0]
        turned = self.precession.at(phase) - self._at_start(self.precession)
        psi = self.problem.psi + turned
        released = self.problem.psi + self.problem.theta
        total = released + self.total.at(phase) - self._at_start(self.total)
        psi_dot = (state.b / state.sine**2)[:, 0]
        spin = state.spin[:, 0]
        x = y = None
        if locus and self.locus is not None:
            place = self._contact(phase)
            x, y = place.real, place.imag
        return States(
            phi=phi[:, 0],
            phi_dot=np.sign(local) * speed * (np.abs(local) < 1),
            psi=psi,
            psi_dot=psi_dot,
            theta=total - psi,
            theta_dot=spin - psi_dot,
            spin=spin,
            x=x,
            y=y,
        )

    def _contact(self, phase: Floats) -> NDArray[np.complex128]:
        if self.locus is None:
            raise ValueError("the contact locus was not asked for")
        size = np.abs(self.locus)
        heard = np.flatnonzero(size > SILENT * size.max())
        wave = np.arange(heard[0], heard[-1] + 1) - self.locus.size // 2
        rate = self.precession.slope + np.pi * wave
        slowest = np.abs(rate).argmin()
        part = self.locus[heard[0] : heard[-1] + 1]
        weight = np.delete(part, slowest) / np.delete(rate, slowest)

        def moved(at: Floats) -> NDArray[np.complex128]:
            # the integral of i exp(i w u) is (exp(i w u) - 1)/w, each wave the one before turned on
            waves = np.empty((rate.size, at.size), dtype=complex)
            waves[0] = np.exp(1j * rate[0] * at)
            waves[1:] = np.exp(1j * np.pi * at)
            np.multiply.accumulate(waves, axis=0, out=waves)
            swift = np.einsum("k,km->m", weight, np.delete(waves, slowest, axis=0)) - weight.sum()
            # of the slowest the rate may be as good as zero
            half = at * (rate[slowest] / 2)
            slow = 1j * at * np.exp(1j * half) * np.sinc(half / np.pi)
            return np.asarray(swift + part[slowest] * slow)

        turn = np.exp(1j * (self.problem.psi - self._at_start(self.precession)))
        start = contact_from_centre(initial_states(self.problem), self.problem.parameters)[0]
        shift = moved(phase) - moved(np.array([self.start]))
        return np.asarray(complex(start[0], start[1]) + turn * shift)


def solve_exactly(problem: Problem, *, locus: bool) -> Run | None:
    """Return the exact motion, or None if the can does not bounce for ever.

    Parameters
    ----------
    problem : Problem
    locus : bool
        Whether the contact point is wanted.
    """
    path = exact_path(problem, locus=locus)
    return None if isinstance(path, Outcome) else until_horizon(problem, path)


def exact_path(problem: Problem, *, locus: bool) -> ExactPath | Outcome:
    """Return the exact motion without an end, or how it ends if the can does not bounce for ever.

    Parameters
    ----------
    problem : Problem
        Its horizon does not matter.
    locus : bool
        Whether the contact point is wanted.
    """
    can = can_constants(problem.parameters)
    release = {
        name: np.array([getattr(problem, name)])
        for name in ("phi", "phi_dot", "psi_dot", "theta_dot")
    }
    series = series_of(problem.parameters)
    points = turning_points(released_potential(can, series, **release), certain=True)
    outcome = OUTCOMES[int(points.code[0])]
    if outcome is not Outcome.FINISHED:
        return outcome
    clock = elliptic_substitution(points)
    nodes = MORE_NODES * int(nodes_needed(clock)[0])
    fraction = (np.arange(nodes)[:, None] + 0.5) / nodes
    at_nodes = rates(points, clock, fraction, careful=True)
    # the turning points are certain: what is not positive between them, or has harmonics that do
    # not fall, has lost its digits
    if not (at_nodes.room > 0).all() or unresolved(at_nodes)[0]:
        return Outcome.UNRESOLVED
    K = float(clock.quarter[0])
    time, precession, total = (
        harmonics_of(K * part[:, 0])
        for part in (at_nodes.time, at_nodes.precession, at_nodes.total)
    )
    return ExactPath(
        problem=problem,
        points=points,
        clock=clock,
        start=_phase_at_release(problem, points, clock),
        time=time,
        precession=precession,
        total=total,
        locus=locus_harmonics(K * (at_nodes.total - at_nodes.precession)[:, 0], precession)
        if locus
        else None,
        t_end=0.0,
        evaluations=nodes,
    )


def _phase_at_release(
    problem: Problem, points: TurningPoints, clock: EllipticSubstitution
) -> float:
    """u/K of the release: -1 at rest on a maximum, 0 at rest on a minimum.

    A release that hardly moves is near a turning point by a distance that phi has no digits for:
    it is computed from the distance, and not from phi.
    """
    if problem.phi_dot == 0:
        return -1.0 if points.climb[0] == 0 else 0.0
    upper = bool(points.climb[0] < points.fall[0])
    goal = points.climb if upper else points.fall

    def apart(fraction: Floats) -> Floats:
        _, rise, gap = clock.nutation(fraction[None])
        return np.asarray((goal - gap[0]) if upper else (rise[0] - goal))

    share = float(bracketed_roots(apart, np.zeros(1), np.ones(1))[0])
    # it moves: a maximum that it rises to, or a minimum that it falls to, is still ahead
    if problem.phi_dot > 0:
        return min(share, math.nextafter(1.0, 0.0))
    return -max(share, math.ulp(0.0))


def until_horizon(problem: Problem, path: ExactPath) -> Run:
    """Follow a motion up to the horizon of a problem that has its release, and list the extrema."""
    # a falling release counts as the maximum that opens the first bounce
    falling = path.start < 0
    if problem.bounces is not None:
        last = 2 * problem.bounces - 1 if falling else 2 * problem.bounces + 1
        t_end = path.time_at(last)
    else:
        t_end = float(problem.duration or 0.0)
        last = int(np.floor(path.phase(np.array([t_end]))[0]))
    first = int(np.floor(path.start)) + 1
    phases = np.arange(first, last + 1, dtype=float)
    if falling or path.start == 0:
        phases = np.append(path.start, phases)
    maximum = np.mod(phases, 2) != 0
    times = path.time.at(phases) - path.time.at(np.array([path.start]))
    times = np.where(phases == path.start, 0.0, times)
    if problem.bounces is not None:
        times[-1] = t_end
    inside = times <= t_end
    track = Extrema(
        outcome=Outcome.FINISHED,
        t_end=t_end,
        times=times[inside],
        extrema=select_states(path.extrema(phases), inside),
        maximum=maximum[inside],
    )
    return Run(path=replace(path, t_end=t_end), track=track, steps=0, evaluations=path.evaluations)

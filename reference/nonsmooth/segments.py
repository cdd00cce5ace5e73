"""Dense output of the hybrid integrator: pieces, each a polynomial in the time of the rim."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.equations.compiled_equations import CompiledEquations
from reference.equations.contact_laws import Equations, Mode, Phase
from reference.equations.frames import to_level
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    PSI,
    SUPPLIED,
    TIME,
    TOTAL,
    TURN,
    U1,
    U2,
    W1,
    W2,
    W3,
    Angles,
    X,
    Y,
)
from reference.nonsmooth.level_spin import rolled, stands
from reference.nonsmooth.patch_onset import hardly_moves, towards
from reference.nonsmooth.radau_iia import STAGES, basis, basis_at
from reference.problem.states import Floats, States

# Halvings that find an instant in a piece to round-off.
HALVINGS = 60
# How far into a piece a slip, or a rolling, that begins with it has a direction.
AHEAD = 1e-3
# Where within a piece its nodes are looked at.
LOOKS = (0.0, 0.25, 0.5, 0.75)


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One step, up to the event at which it was cut.

    Attributes
    ----------
    start : ndarray, shape (13,)
    coefficients : ndarray, shape (13, STAGES + 1)
        Of the change since the start, Chebyshev's on [0, 1].
    cut : float
        End of the piece, in (0, 1].
    length : float
        In sigma, uncut.
    mode : Mode
    """

    start: Floats
    coefficients: Floats
    cut: float
    length: float
    mode: Mode

    def at(self, c: Floats) -> Floats:
        """Return the state, shape (13, n)."""
        return self.start[:, None] + self.coefficients @ basis(c).T

    @property
    def end(self) -> Floats:
        """Return the state at the cut, shape (13,)."""
        if self.cut == 1.0:
            return self.looked_at((1.0,))[:, 0]
        return self.at(np.array([self.cut]))[:, 0]

    def looked_at(self, c: tuple[float, ...]) -> Floats:
        """Return the state at the places at which events are sampled, shape (13, n)."""
        return self.start[:, None] + self.coefficients @ basis_at(c).T


class SegmentsPath:
    """A sequence of pieces up to a time, with or without the contact point and the works."""

    def __init__(
        self, pieces: Sequence[Segment], equations: Equations, end: float, *, locus: bool
    ) -> None:
        self.pieces = tuple(pieces)
        self.equations = equations
        self._locus = locus
        self._starts = np.array([piece.start for piece in pieces])
        self._coefficients = np.array([piece.coefficients for piece in pieces])
        self._cuts = np.array([piece.cut for piece in pieces])
        # the time goes on over each switch
        self.end_times = [*self._starts[1:, TIME].tolist(), end]
        self._spans = np.array(self.end_times) - self._starts[:, TIME]
        self._modes: list[Mode] = []
        numbers: list[int] = []
        for piece, before in zip(pieces, (None, *pieces), strict=False):
            if before is not None and piece.mode is before.mode:
                numbers.append(numbers[-1])
                continue
            if piece.mode not in self._modes:
                self._modes.append(piece.mode)
            numbers.append(self._modes.index(piece.mode))
        self._mode = np.array(numbers)
        self.t_end = self.end_times[-1]

    def phases(self) -> tuple[Phase, ...]:
        """Return the intervals of one kind of contact, in order; none of a path of no duration."""
        kinds = [piece.mode.kind for piece in self.pieces if piece.length > 0]
        firsts = [n for n, kind in enumerate(kinds) if n == 0 or kind is not kinds[n - 1]]
        lasts = [*(first - 1 for first in firsts[1:]), len(kinds) - 1]
        starts, ends = self._starts[:, TIME].tolist(), self.end_times
        return tuple(
            Phase(kind=kinds[first], start=starts[first], end=ends[last])
            for first, last in zip(firsts, lasts, strict=False)
        )

    def rows(self, times: Floats) -> tuple[Floats, NDArray[np.intp]]:
        """Return all rows at the given times, shape (13, n), and in which piece each is."""
        number = np.searchsorted(self._starts[:, TIME], times, side="right") - 1
        number = np.minimum(np.maximum(number, 0), len(self._cuts) - 1)
        if isinstance(self.equations, CompiledEquations):
            from reference.nonsmooth import path_kernels

            pieces = self._starts, self._coefficients, self._cuts, self._spans
            return path_kernels.rows_at(*pieces, number, np.ascontiguousarray(times)), number
        return self._rows(number, self._instant(number, times)), number

    def place(self, time: float) -> tuple[int, float]:
        """Return in which piece a time is, and where in it."""
        number = int(np.searchsorted(self._starts[:, TIME], time, side="right")) - 1
        number = min(max(number, 0), len(self._cuts) - 1)
        return number, float(self._instant(np.array([number]), np.array([time]))[0])

    def at(self, times: Floats) -> States:
        """Return states at the given times, shape (n,)."""
        y, number = self.rows(np.asarray(times, dtype=float))
        return self._states(y, number)

    def lost(self, times: Floats) -> Floats:
        """Return the energy dissipated since the release, less the energy supplied, shape (n,)."""
        if not self._locus:
            raise ValueError("the works were not asked for: they come with the contact locus")
        y, _ = self.rows(np.asarray(times, dtype=float))
        return np.asarray(y[DISSIPATED] - y[SUPPLIED])

    def peaks(self, extrema: Floats, tops: NDArray[np.intp]) -> Floats | None:
        """Return the peaks of bounces where compiled code measures them, shape (2, bounces).

        Parameters
        ----------
        extrema : ndarray, shape (n,)
            Times of the extrema of phi.
        tops : ndarray of int, shape (bounces + 1,)
            Which of them are maxima.
        """
        equations = self.equations
        if not isinstance(equations, CompiledEquations) or equations.resistance:
            return None
        from reference.nonsmooth import path_kernels

        slips = np.array([mode.slips for mode in self._modes], dtype=int)[self._mode]
        turns = np.array([mode.turns for mode in self._modes])[self._mode]
        pieces = self._starts, self._coefficients, self._cuts, self._spans, slips, turns
        return path_kernels.peaks_of(equations.constants, pieces, extrema, tops)

    def nodes(self, *, lifts: bool = False) -> tuple[Floats, States]:
        """Return times and states at four instants of each piece, and at the end.

        And just before changes of contact at which friction may be largest: where a static friction
        above the kinetic lets go, and where a rim that friction holds without limit begins to fly.

        Parameters
        ----------
        lifts : bool
            Whether a flight follows the path.
        """
        count, modes = len(self._cuts), [piece.mode for piece in self.pieces]
        places = [(n, look) for n in range(count) for look in LOOKS]
        if not lifts or np.isinf(self.equations.mu):
            # where limited friction lets a rim fly, both forces of the plane are round-offs
            places.append((count - 1, 1.0))
        lifted: list[int] = []
        if self.equations.mu_static > self.equations.mu:
            lets_go = [n for n in range(count - 1) if modes[n + 1].slips and not modes[n].slips]
            places = sorted([*places, *((n, 1.0) for n in lets_go)])
        elif np.isinf(self.equations.mu):
            flies = [*(mode.flies for mode in modes[1:]), lifts]
            lifted = [n for n in range(count) if flies[n] and not modes[n].slips]
            places = sorted({*places, *((n, 1.0) for n in lifted)})
        number = np.array([n for n, _ in places])
        parts = np.array([part for _, part in places])
        y = self._rows(number, parts * self._cuts[number])
        before = (parts == 1.0) & ((number < count - 1) | np.isin(number, lifted))
        # a sum of the series may end a rounding later than what follows begins
        ends = np.minimum(y[TIME], np.array(self.end_times)[number])
        times = np.where(before, np.nextafter(ends, -np.inf), y[TIME])
        keep = np.concatenate([[True], np.diff(np.maximum.accumulate(times)) > 0])
        return times[keep], self._states(y[:, keep], number[keep])

    def _instant(self, number: NDArray[np.intp], times: Floats) -> Floats:
        """Return the place of each time in its piece, by Newton's method within a bisection."""
        target, spans = times - self._starts[number, TIME], self._spans[number]
        series = self._coefficients[number, TIME]
        noise = 2 * np.finfo(float).eps * np.abs(series).sum(axis=1)
        low, high = np.zeros_like(target), self._cuts[number].copy()
        # a piece that takes less than an ulp of the time is over at its beginning
        over = (target >= spans) | (spans == 0.0)
        share = np.divide(target, spans, out=np.ones_like(target), where=~over)
        c = high * np.maximum(share, 0.0)
        for _ in range(HALVINGS):
            residual = np.einsum("ij,ij->i", basis(c), series) - target
            low, high = np.where(residual < 0, c, low), np.where(residual < 0, high, c)
            slope = np.einsum("ij,ij->i", _slopes(c), series)
            with np.errstate(divide="ignore", invalid="ignore"):
                better = c - residual / slope
            inside = (better >= low) & (better <= high)
            new = np.where(inside, better, (low + high) / 2)
            stands = np.abs(new - c) <= 4 * np.finfo(float).eps * (1e-3 + c)
            found = over | stands | (np.abs(residual) <= noise)
            if found.all():
                break
            c = np.where(found, c, new)
        return np.asarray(np.clip(c, 0.0, self._cuts[number]))

    def _rows(self, number: NDArray[np.intp], c: Floats) -> Floats:
        change = np.einsum("ij,ikj->ki", basis(c), self._coefficients[number])
        return np.asarray(self._starts[number].T + change)

    def _states(self, y: Floats, number: NDArray[np.intp]) -> States:
        slips = np.array([mode.slips for mode in self._modes])[self._mode[number]]
        if isinstance(self.equations, CompiledEquations) and not self.equations.resistance:
            return self._compiled_states(self.equations, y, slips, number)
        at = Angles.of(y[LEAN])
        psi_dot = y[W1] / at.S
        cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
        force = np.empty((3, y.shape[1]))
        for index, mode in enumerate(self._modes):
            own = self._mode[number] == index
            if own.any():
                sliding = self._begun(y[:, own], number[own], mode)
                force[:, own] = self.equations.contact(sliding, mode).force / at.S[own]
        u1, u2 = np.where(slips, y[U1], 0.0), np.where(slips, y[U2], 0.0)
        return States(
            phi=2 * np.arctan(at.T),
            phi_dot=-y[W2],
            psi=y[PSI],
            psi_dot=psi_dot,
            theta=y[TOTAL] - y[PSI],
            theta_dot=y[W3] - psi_dot * at.C,
            spin=y[W3] + y[W1] * at.T,
            x=y[X] if self._locus else None,
            y=y[Y] if self._locus else None,
            slip=np.stack([u1 * cos - u2 * sin, u1 * sin + u2 * cos], axis=-1),
            force=np.stack(
                [force[0] * cos - force[1] * sin, force[0] * sin + force[1] * cos, force[2]],
                axis=-1,
            ),
        )

    def _compiled_states(
        self,
        equations: CompiledEquations,
        y: Floats,
        slips: NDArray[np.bool_],
        number: NDArray[np.intp],
    ) -> States:
        from reference.nonsmooth import path_kernels

        turns = np.array([mode.turns for mode in self._modes])[self._mode[number]]
        begins = np.flatnonzero(slips & (y[U1] == 0) & (y[U2] == 0))
        begun = y
        for index, mode in enumerate(self._modes) if begins.size else ():
            own = begins[self._mode[number[begins]] == index]
            begun = y.copy() if begun is y else begun
            begun[:, own] = self._begun(y[:, own], number[own], mode)
        rows = path_kernels.states_of(
            equations.constants, slips.astype(int), turns, np.ascontiguousarray(begun)
        )
        # what begins has a direction, and no velocity yet
        rows[7:9, begins] = 0.0
        phi, phi_dot, psi, psi_dot, theta, theta_dot, spin = rows[:7]
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=psi,
            psi_dot=psi_dot,
            theta=theta,
            theta_dot=theta_dot,
            spin=spin,
            x=y[X] if self._locus else None,
            y=y[Y] if self._locus else None,
            slip=np.ascontiguousarray(rows[7:9].T),
            force=np.ascontiguousarray(rows[9:].T),
        )

    def _begun(self, y: Floats, number: NDArray[np.intp], mode: Mode) -> Floats:
        """Return states with the direction of a slip or rolling that begins at this instant."""
        if self.equations.resistance and not mode.rests and (resting := stands(y)).any():
            ahead = self._coefficients[number[resting]] @ basis_at((AHEAD,))[0]
            level = to_level(ahead.T[TURN], Angles.of(y[LEAN, resting]))[:2]
            y = y.copy()
            y[:, resting] = rolled(y[:, resting], level / np.hypot(*level))
        if not mode.slips or mode.flies:
            return y
        law = self.equations
        still = np.flatnonzero(hardly_moves(law, y) & hardly_moves(law, self._starts[number].T))
        if not still.size:
            return y
        begun, ahead = y.copy(), self._rows(number[still], np.full(still.size, AHEAD))
        begun[:, still] = towards(law, y[:, still], ahead)
        return begun


def _slopes(c: Floats) -> Floats:
    """Return the derivatives of the Chebyshev polynomials at c in [0, 1], shape (n, STAGES + 1)."""
    x = 2 * c - 1
    out = np.zeros((c.size, STAGES + 1))
    previous, current = np.ones_like(x), 2 * x  # Chebyshev's of the second kind
    for k in range(1, STAGES + 1):
        out[:, k] = 2 * k * previous
        previous, current = current, 2 * x * current - previous
    return out

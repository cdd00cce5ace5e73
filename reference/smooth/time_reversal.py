"""The default integrator: half a nutation is integrated, the rest is its mirror image.

The rolling equations (eq01:non_dimensionalised_eom) do not change when time and phi' turn round and
psi', theta' stay. At an extremum of phi, where phi' = 0, the motion is therefore its own mirror
image,

    phi(t_e + t) = phi(t_e - t),        psi(t_e + t) - psi(t_e) = psi(t_e) - psi(t_e - t),

and with it theta; the path of the contact point is reflected in the line through it along psi. A
motion from one extremum to the next therefore determines all of it. The integration
(`reference.smooth.stepping`) runs from the release to the next extremum and, of a moving release,
back to the previous one: it never returns to a height at which round-off of the energy would have
been amplified. A motion with a single extremum is mirrored at it as well; a motion without any is
integrated to its end.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reference.equations.regularised import NUTATION_RATE
from reference.numerics.chebyshev import points, to_coefficients, waves
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, States, select_states
from reference.smooth.dense_output import TIME, ElementsPath, Piece
from reference.smooth.extrema import PROMINENCE, Extrema, ExtremumRecorder, Run
from reference.smooth.stepping import March, integrate, march


class FirstExtremum(ExtremumRecorder):
    """Ends at the first extremum of phi after the release; `met` says whether there was one."""

    met = False

    def extremum(self, time: float, snapshot: Snapshot, *, maximum: bool) -> None:
        """Report that phi' changed sign."""
        super().extremum(time, snapshot, maximum=maximum)
        self.met = not self.ended()
        self.end(time, Outcome.FINISHED)


@dataclass(frozen=True, slots=True, kw_only=True)
class MirroredPath:
    """A periodic motion, known from half of it.

    Attributes
    ----------
    half : ElementsPath
        From one extremum of phi to the next, past the release at time 0.
    start, end : float
        Times of the two extrema; `start` is not positive.
    edges : States
        At the two, shape (2,).
    t_end : float
        Where the motion ends, in sqrt(R/g).
    """

    half: ElementsPath
    start: float
    end: float
    edges: States
    t_end: float

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states at the Chebyshev points of all halves."""
        times, states = self.half.nodes()
        count = int(np.ceil((self.t_end - self.start) / self._span))
        forth, back = times[:-1] - self.start, self.end - times[:0:-1]
        into = np.concatenate([back if n % 2 else forth for n in range(max(count, 1))])
        number = np.repeat(np.arange(max(count, 1)), times.size - 1)
        kept = np.append(self.start + number * self._span + into, self.t_end)
        place = np.tile(
            np.concatenate([np.arange(times.size - 1), np.arange(times.size - 1, 0, -1)]),
            (count + 1) // 2 + 1,
        )[: kept.size - 1]
        inside = (kept >= 0) & (kept < self.t_end)
        mirrored = self._unfolded(
            select_states(states, place[inside[:-1]]), number[inside[:-1]].astype(np.int64)
        )
        edge = round((self.t_end - self.start) / self._span)
        time, last = self.extrema(np.array([edge]))
        if time[0] != self.t_end:
            last = self.at(np.array([self.t_end]))
        return np.append(kept[inside], self.t_end), _joined(mirrored, last)

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        number = np.floor((times - self.start) / self._span).astype(np.int64)
        # rounding may have put the end of a half behind it
        into = np.clip(times - self.start - number * self._span, 0.0, self._span)
        forth = number % 2 == 0
        local = np.where(forth, self.start + into, self.end - into)
        # before the first mirror a time is what it is
        local = np.where(number == 0, np.minimum(times, self.end), local)
        return self._unfolded(self.half.at(local), number)

    def extrema(self, number: NDArray[np.int64]) -> tuple[Floats, States]:
        """Return times and states of the extrema, counted from `start`, shape (n,)."""
        states = self._unfolded(select_states(self.edges, number % 2), number)
        return np.where(number == 1, self.end, self.start + number * self._span), states

    @property
    def _span(self) -> float:
        return self.end - self.start

    def _unfolded(self, states: States, number: NDArray[np.int64]) -> States:
        """States of the half, moved into the halves of the given numbers."""
        odd, cycle = number % 2 == 1, number // 2

        def turned(value: Floats, edges: Floats) -> Floats:
            first, last = edges.tolist()
            folded = np.where(odd, 2 * last - value, value)
            folded += cycle * (2 * (last - first))
            return folded

        x, y = states.x, states.y
        if x is not None and y is not None:
            place = self._placed(x + 1j * y, odd, cycle)
            x, y = place.real, place.imag
        return States(
            phi=states.phi,
            # no negative zero
            phi_dot=np.where(odd, 0.0 - states.phi_dot, states.phi_dot),
            psi=turned(states.psi, self.edges.psi),
            psi_dot=states.psi_dot,
            theta=turned(states.theta, self.edges.theta),
            theta_dot=states.theta_dot,
            spin=states.spin,
            x=x,
            y=y,
        )

    def _placed(
        self, point: NDArray[np.complex128], odd: NDArray[np.bool_], cycle: NDArray[np.int64]
    ) -> NDArray[np.complex128]:
        """Contact points as complex numbers: reflected in a half, turned and moved in a cycle."""
        if self.edges.x is None or self.edges.y is None:
            raise ValueError("the contact locus was not asked for")
        first, last = (self.edges.x + 1j * self.edges.y).tolist()
        heading = np.exp(2j * self.edges.psi[1])

        def reflected(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
            return np.asarray(last + heading * np.conj(z - last))

        turn = 2 * (self.edges.psi[1] - self.edges.psi[0])
        most = int(cycle.max(initial=0))
        step = reflected(np.array([first]))[0] - first
        # where a cycle starts: each moves as far as the one before, in a direction turned further
        starts = np.concatenate([[0.0], np.cumsum(step * np.exp(1j * turn * np.arange(most)))])
        moved = np.where(odd, reflected(point), point) - first
        return np.asarray(first + starts[cycle] + np.exp(1j * turn * cycle) * moved)


def integrate_by_symmetry(problem: Problem, *, locus: bool, compiled: bool = False) -> Run:
    """Integrate the rolling equations to the horizon or an ending.

    Parameters
    ----------
    problem : Problem
    locus : bool
        Whether to integrate the contact point as well.
    compiled : bool
        Whether to take the steps by compiled code.

    Returns
    -------
    Run
    """
    watch = FirstExtremum(problem)
    ahead = march(problem, watch, locus=locus, compiled=compiled)
    if not watch.met:
        # an ending or the horizon came first
        return ahead.run(watch.track())
    half, marches = ahead.path(), [ahead]
    if problem.phi_dot != 0:
        back = replace(problem, phi_dot=-problem.phi_dot, bounces=1, duration=None)
        beyond = FirstExtremum(back)
        behind = march(back, beyond, locus=locus, compiled=compiled)
        if not beyond.met:
            return _back_and_beyond(ahead, watch.track(), behind, beyond.track().outcome)
        values = np.concatenate([_reversed(behind.path().values), half.values], axis=1)
        half = ElementsPath(values=values, release=problem)
        marches.append(behind)
    edges = half.ends()
    low, high = edges.phi.min(), edges.phi.max()
    if high - low < PROMINENCE * high:
        return integrate(problem, locus=locus, compiled=compiled)
    return _until_horizon(half, edges, marches)


def _back_and_beyond(ahead: March, track: Extrema, beyond: March, outcome: Outcome) -> Run:
    """Return a motion that meets one extremum, goes back on its own way, and past its release.

    Followed through the extremum it would have lost, where it almost stops beyond the release, all
    digits of the little energy it has there.

    Parameters
    ----------
    ahead, track : March, Extrema
        From the release to the extremum.
    beyond, outcome : March, Outcome
        From the release turned round to the ending, which no extremum precedes.
    """
    problem, values = ahead.problem, ahead.path().values
    for part in (_reversed(values), beyond.path().values):
        values = np.concatenate([values, _continued(values, part)], axis=1)
    ends = float(values[TIME, -1, -1])
    if problem.duration is not None and problem.duration <= ends:
        values, ends, outcome = _up_to(values, problem.duration), problem.duration, Outcome.FINISHED
    return Run(
        path=ElementsPath(values=values, release=problem),
        track=replace(track, t_end=ends, outcome=outcome),
        steps=len(ahead.pieces) + len(beyond.pieces),
        evaluations=ahead.evaluations + beyond.evaluations,
    )


def _continued(before: Floats, values: Floats) -> Floats:
    """Return a march moved in time, about the vertical and in the plane to where another ends."""
    angles = slice(TIME, TIME + 3)
    moved = values.copy()
    shift = before[angles, -1, -1] - values[angles, 0, 0]
    moved[angles] += shift[:, None, None]
    if len(values) > TIME + 3:
        place, own = (part[-2] + 1j * part[-1] for part in (before, values))
        place = place[-1, -1] + np.exp(1j * shift[1]) * (own - own[0, 0])
        moved[-2], moved[-1] = place.real, place.imag
    return moved


def _up_to(values: Floats, time: float) -> Floats:
    """Return a march up to a time, its last step interpolated."""
    step = max(int(np.searchsorted(values[TIME, :, 0], time)) - 1, 0)
    piece = Piece(length=1.0, values=values[:, step])
    n = values.shape[2]
    node = int(np.clip(np.searchsorted(piece.values[TIME], time) - 1, 0, n - 2))
    nodes = (piece.root(TIME, time, node) + 1) / 2 * (points(n) + 1) - 1
    last = piece.values @ to_coefficients(n).T @ waves(n, nodes.clip(-1, 1))
    last[TIME, -1] = time
    return np.concatenate([values[:, :step], last[:, None]], axis=1)


def _reversed(values: Floats) -> Floats:
    """Return a march with time turned round, about its first instant."""
    back = values[:, ::-1, ::-1].copy()
    origin = values[:, :1, :1]
    back[NUTATION_RATE] *= -1
    angles = slice(TIME, TIME + 3)
    back[angles] = 2 * origin[angles] - back[angles]
    if len(values) > TIME + 3:
        start = origin[-2, 0, 0] + 1j * origin[-1, 0, 0]
        place = np.conj(back[-2] + 1j * back[-1] - start) * np.exp(2j * origin[TIME + 1, 0, 0])
        back[-2], back[-1] = start.real + place.real, start.imag + place.imag
    return np.asarray(back)


def _until_horizon(half: ElementsPath, edges: States, marches: Sequence[March]) -> Run:
    """Return the motion up to the horizon of which the half from edge to edge is known."""
    problem = half.release
    start, end = float(half.values[TIME, 0, 0]), float(half.values[TIME, -1, -1])
    rising = bool(edges.phi[1] > edges.phi[0])
    # a falling release counts as the maximum that opens the first bounce
    first = 0 if start == 0 else 1
    if problem.bounces is not None:
        last = 2 * problem.bounces + (1 if rising else 0)
        t_end = start + last * (end - start)
    else:
        t_end = float(problem.duration or 0.0)
        last = int(np.ceil((t_end - start) / (end - start))) + 1
    path = MirroredPath(half=half, start=start, end=end, edges=edges, t_end=t_end)
    number = np.arange(first, last + 1)
    times, states = path.extrema(number)
    maximum = (number % 2 == 1) == rising
    inside = times <= t_end
    if not inside.all():
        times, states, maximum = times[inside], select_states(states, inside), maximum[inside]
    if not rising and problem.phi_dot != 0:
        times = np.append(0.0, times)
        states = _joined(path.at(np.zeros(1)), states)
        maximum = np.append(True, maximum)
    return Run(
        path=path,
        track=Extrema(
            outcome=Outcome.FINISHED, t_end=t_end, times=times, extrema=states, maximum=maximum
        ),
        steps=sum(len(part.pieces) for part in marches),
        evaluations=sum(part.evaluations for part in marches),
    )


def _joined(one: States, other: States) -> States:
    """Return states after one another."""

    def column(name: str) -> Floats | None:
        left, right = getattr(one, name), getattr(other, name)
        return None if left is None or right is None else np.concatenate([left, right])

    return States(**{name: column(name) for name in States.__slots__})  # type: ignore[arg-type]

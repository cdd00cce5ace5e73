"""The path of a can through phases of contact and of flight."""

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np
import scipy
from numpy.polynomial import chebyshev

from reference.nonsmooth.segments import SegmentsPath
from reference.problem.states import Floats, Snapshot, States
from reference.unilateral.flight import Flight, FreeStates
from reference.unilateral.free_body import Launch

# Nodes of a flight for each time in which it turns by a radian, and more near the vertical: turns
# are counted between them.
A_RADIAN = 8
FEWEST = 17
# Of the distance of the axis from the vertical: the way of the axis within half of an interval, in
# which psi then changes by less than pi/4, and psi + theta of a can upside down by less than pi/2.
AWAY = 0.35
# Of the axis, and how often an interval is halved: round-off.
UNMOVED = 1e-15
HALVINGS = 60
# Nodes of the quadrature of works, for each radian.
QUADRATURE = 24


class FlightPath:
    """A flight that lasts for a time."""

    def __init__(self, flight: Flight, duration: float, *, locus: bool) -> None:
        self.flight, self.duration = flight, duration
        self.start, self.t_end = flight.launch.time, flight.launch.time + duration
        self._locus = locus
        self._after, frames = _counted(flight, duration)
        psi, total = _angles(frames)
        psi[0], total[0] = flight.launch.psi, flight.launch.total
        self._psi, self._total = np.unwrap(psi), np.unwrap(total)

    def angles(self, after: Floats, frames: Floats) -> tuple[Floats, Floats]:
        """Return precession, and its sum with the rotation, with their full turns, shape (n,)."""
        psi, total = _angles(frames)
        place = np.searchsorted(self._after, after, side="right") - 1
        place = np.clip(place, 0, self._after.size - 2)
        counted = []
        for value, known in ((psi, self._psi), (total, self._total)):
            middle = (known[place] + known[place + 1]) / 2
            counted.append(value + 2 * np.pi * np.round((middle - value) / (2 * np.pi)))
        return counted[0], counted[1]

    def at(self, times: Floats) -> States:
        """Return states at the given times, shape (n,)."""
        after = np.clip(np.asarray(times, dtype=float) - self.start, 0.0, self.duration)
        return self._states(after, self.flight.at(after))

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states at which the turns are counted."""
        return self.start + self._after, self._states(self._after, self.flight.at(self._after))

    def lost(self, times: Floats) -> Floats:
        """Return the energy dissipated since the release, less the energy supplied, shape (n,)."""
        after = np.clip(np.asarray(times, dtype=float) - self.start, 0.0, self.duration)
        dissipated, supplied = self.works(after)
        return dissipated - supplied

    def works(self, after: Floats) -> tuple[Floats, Floats]:
        """Return energy dissipated and supplied since the release, shape (n,) each."""
        own, effects, body = self.flight.launch, self.flight.body.effects, self.flight.body
        dissipated = np.full(after.shape, own.dissipated)
        supplied = np.full(after.shape, own.supplied)
        if not (effects.linear_damping or effects.angular_damping or effects.gravity.shaken):
            return dissipated, supplied
        pieces = max(1, int(np.ceil(self.duration * self.flight.rates())))
        edges = np.linspace(0.0, self.duration, pieces + 1)
        x = np.cos(np.pi * np.arange(QUADRATURE + 1) / QUADRATURE)
        to_series = np.linalg.inv(chebyshev.chebvander(x, QUADRATURE))
        number = np.clip(np.searchsorted(edges, after, side="right") - 1, 0, pieces - 1)
        for piece in range(pieces):
            left, length = edges[piece], edges[piece + 1] - edges[piece]
            t = left + length * (x + 1) / 2
            here = self.flight.at(t)
            lever = here.frame @ body.centre
            v = here.velocity + np.cross(here.turning, lever)
            w = np.einsum("nab,na->nb", here.frame, here.turning)
            drag = effects.linear_damping * body.mass * (v * v).sum(1)
            drag += effects.angular_damping * (w * (w @ body.inertia)).sum(1)
            push = body.mass * (effects.gravity.shaking(own.time + t).T * v).sum(1)
            there = number == piece
            for total, power in ((dissipated, drag), (supplied, push)):
                series = chebyshev.chebint(to_series @ power, lbnd=-1.0) * length / 2
                places = 2 * (after[there] - left) / length - 1 if length > 0 else after[there]
                total[there] += chebyshev.chebval(places, series)
                total[number > piece] += series.sum()
        return dissipated, supplied

    def extrema(self) -> Iterator[tuple[float, bool]]:
        """Return times after the launch at which phi' changes sign, and whether phi is largest."""
        times, states = self.nodes()
        slopes = states.phi_dot
        for i in np.flatnonzero(np.sign(slopes[:-1]) * np.sign(slopes[1:]) < 0).tolist():
            after = scipy.optimize.brentq(
                lambda s: float(self.at(np.array([self.start + s])).phi_dot[0]),
                times[i] - self.start,
                times[i + 1] - self.start,
                xtol=1e-15,
                rtol=1e-15,
            )
            yield float(after), bool(slopes[i] > 0)

    def landing(self) -> Launch:
        """Return the state at the end of the flight."""
        states = self.flight.at(np.array([self.duration]))
        psi, total = self.angles(np.array([self.duration]), states.frame)
        dissipated, supplied = self.works(np.array([self.duration]))
        lever = states.frame[0] @ self.flight.body.centre
        return Launch(
            time=self.t_end,
            frame=states.frame[0],
            turning=states.turning[0],
            centre=states.middle[0] + lever,
            velocity=states.velocity[0] + np.cross(states.turning[0], lever),
            psi=float(psi[0]),
            total=float(total[0]),
            dissipated=float(dissipated[0]),
            supplied=float(supplied[0]),
        )

    def snapshot(self, after: float) -> Snapshot:
        """Return the angles and rates at a time after the launch."""
        there = self.at(np.array([self.start + after]))
        return Snapshot(**{name: float(getattr(there, name)[0]) for name in Snapshot.__slots__})

    def _states(self, after: Floats, free: FreeStates) -> States:
        body = self.flight.body
        e = free.frame[:, :, 2]
        S, C = np.hypot(e[:, 0], e[:, 1]), e[:, 2]
        psi, total = self.angles(after, free.frame)
        cos, sin = np.cos(psi), np.sin(psi)
        level = cos * free.turning[:, 0] + sin * free.turning[:, 1]
        aside = cos * free.turning[:, 1] - sin * free.turning[:, 0]
        w1, w3 = C * level + S * free.turning[:, 2], (free.turning * e).sum(1)
        psi_dot = np.divide(w1, S, out=np.zeros_like(w1), where=S > 0)
        theta_dot = w3 - psi_dot * C
        offset = body.lowest(e)
        point = free.middle + offset
        material = free.velocity + np.cross(free.turning, offset)
        n = after.size
        return States(
            phi=np.arctan2(S, C),
            phi_dot=-aside,
            psi=psi,
            psi_dot=psi_dot,
            theta=total - psi,
            theta_dot=theta_dot,
            spin=np.where(C >= 0, w3 + w1 * S / (1 + np.maximum(C, 0.0)), psi_dot + theta_dot),
            x=point[:, 0] if self._locus else None,
            y=point[:, 1] if self._locus else None,
            slip=material[:, :2],
            force=np.zeros((n, 3)),
            gap=np.maximum(point[:, 2], 0.0),
            rise=material[:, 2],
        )


class UnilateralPath:
    """Phases of contact and of flight in a row."""

    def __init__(self, parts: Sequence[SegmentsPath | FlightPath], starts: Sequence[float]) -> None:
        self.parts, self._starts = tuple(parts), np.array(starts)
        self.t_end = parts[-1].t_end
        self.flies_at_end = isinstance(parts[-1], FlightPath)

    def at(self, times: Floats) -> States:
        """Return states at the given times, shape (n,); after an impact, at its instant."""
        times = np.asarray(times, dtype=float)
        number = np.clip(np.searchsorted(self._starts, times, side="right") - 1, 0, None)
        found: list[tuple[np.ndarray[tuple[int, ...], np.dtype[np.intp]], States]] = []
        for part in np.unique(number).tolist():
            own = np.flatnonzero(number == part)
            found.append((own, _with_gap(self.parts[part].at(times[own]))))
        if not found:
            return _with_gap(self.parts[0].at(times))
        order = np.argsort(np.concatenate([own for own, _ in found]), kind="stable")
        return _joined([states for _, states in found], order)

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states that the solver itself has, from the start to the end."""
        flies = [*(isinstance(part, FlightPath) for part in self.parts[1:]), False]
        nodes = [
            part.nodes(lifts=lifts) if isinstance(part, SegmentsPath) else part.nodes()
            for part, lifts in zip(self.parts, flies, strict=True)
        ]
        all_times, states = zip(*nodes, strict=True)
        times = np.concatenate(all_times)
        keep = np.flatnonzero(np.append(np.diff(times) > 0, True))
        return times[keep], _joined([_with_gap(one) for one in states], keep)

    def lost(self, times: Floats) -> Floats:
        """Return the energy dissipated since the release, less the energy supplied, shape (n,)."""
        times = np.asarray(times, dtype=float)
        number = np.clip(np.searchsorted(self._starts, times, side="right") - 1, 0, None)
        out = np.zeros(times.shape)
        for part in np.unique(number).tolist():
            own = number == part
            out[own] = self.parts[part].lost(times[own])
        return out


def _counted(flight: Flight, duration: float) -> tuple[Floats, Floats]:
    """Return times after the launch, shape (n,), between which turns are counted, and the axes.

    However near the vertical the axis passes: the axis moves at the speed |e'|, and psi changes by
    less than the arcsine of its way over its horizontal length.
    """
    count = max(FEWEST, int(A_RADIAN * duration * flight.rates()) + 2)
    after: Floats = np.linspace(0.0, duration, count)
    free = flight.at(after)
    for _ in range(HALVINGS):
        e, length = free.frame[:, :, 2], np.diff(after)
        first = np.cross(free.turning, e)
        second = np.cross(free.turning_rate, e) + np.cross(free.turning, first)
        S, speed = np.hypot(e[:, 0], e[:, 1]), np.linalg.norm(first, axis=1)
        bend = np.linalg.norm(second, axis=1)
        fastest = np.maximum(speed[:-1], speed[1:]) + length * np.maximum(bend[:-1], bend[1:])
        apart = np.maximum(AWAY * np.minimum(S[:-1], S[1:]), UNMOVED)
        wide = fastest * length / 2 > apart
        if not wide.any():
            break
        after = np.sort(np.append(after, after[:-1][wide] + length[wide] / 2))
        free = flight.at(after)
    return after, free.frame


def _angles(frames: Floats) -> tuple[Floats, Floats]:
    """Return the angles psi and psi + theta of axes (n, 3, 3), each up to full turns."""
    psi = np.arctan2(-frames[:, 1, 2], -frames[:, 0, 2])
    total = np.arctan2(frames[:, 1, 0] - frames[:, 0, 1], frames[:, 0, 0] + frames[:, 1, 1])
    return psi, total


def _with_gap(states: States) -> States:
    """Return states on the plane with a gap of zero."""
    if states.gap is not None:
        return states
    zero = np.zeros_like(states.phi)
    return replace(states, gap=zero, rise=zero)


def _joined(
    parts: Sequence[States], order: np.ndarray[tuple[int, ...], np.dtype[np.intp]]
) -> States:
    """Return states in a row, in a given order."""
    columns: dict[str, Any] = {}
    for name in (field.name for field in fields(States)):
        values = [getattr(part, name) for part in parts]
        columns[name] = None if values[0] is None else np.concatenate(values)[order]
    return States(**columns)

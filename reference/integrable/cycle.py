"""The exact bounce: period, turn, rotation and extrema by quadrature, to round-off.

Precession and spin are known functions of nutation (`reference.integrable.frobenius`), energy gives
phi' (`reference.integrable.effective_potential`), and the elliptic clock
(`reference.integrable.elliptic`) makes every integrand an analytic periodic function, so that the
midpoint rule is exact to round-off with about 4 log(8 phi_max/phi_min) nodes: 32 for the paper's
release. How hard the bounce is changes nothing else.

This replaces eq01:hyper_geom, which is not evaluated; the two are compared in the tests.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.integrable.effective_potential import (
    EffectivePotential,
    effective_potential,
    select_potential,
)
from reference.integrable.frobenius import CanConstants, Series, frobenius_series, terms_needed
from reference.integrable.graded_quadrature import graded_integrals
from reference.integrable.quadrature import (
    cycle_integrals,
    elliptic_substitution,
    nodes_needed,
    select_points,
)
from reference.integrable.turning_points import OUTCOMES, TurningPoints, turning_points
from reference.problem.outcome import Outcome
from reference.problem.problem import LEAST
from reference.problem.states import Floats
from reference.problem.validation import RefusedError

# Releases treated together, and numbers in flight in one array: what stays in a processor's cache.
CHUNK = 8192
CACHED = 32768


@dataclass(frozen=True, slots=True, kw_only=True)
class PeriodicMotions:
    """The periodic motions of n cans; every field has shape (n,).

    Where the can does not bounce every number is 0 and `code` says why.

    Attributes
    ----------
    code : ndarray of int8
        Index into `reference.integrable.turning_points.OUTCOMES`; FINISHED where the can bounces.
    period : ndarray
        From maximum to maximum of phi, in sqrt(R/g).
    angle_of_turn, rotation_turn : ndarray
        Signed change of psi and of theta over a period, in rad.
    phi_min, phi_max : ndarray
    peak_psi_dot : ndarray
        Precession rate of largest magnitude, with its sign, in sqrt(g/R).
    """

    code: NDArray[np.int8]
    period: Floats
    angle_of_turn: Floats
    rotation_turn: Floats
    phi_min: Floats
    phi_max: Floats
    peak_psi_dot: Floats

    @property
    def bounced(self) -> NDArray[np.bool_]:
        """Return whether there is a bounce, shape (n,)."""
        return np.asarray(self.code == OUTCOMES.index(Outcome.FINISHED))

    def outcome(self, index: int) -> Outcome:
        """Outcome of one release."""
        return OUTCOMES[int(self.code[index])]


def exact_bounces(
    *,
    a: ArrayLike,
    c: ArrayLike,
    h: ArrayLike,
    phi: ArrayLike,
    phi_dot: ArrayLike = 0.0,
    psi_dot: ArrayLike = 0.0,
    theta_dot: ArrayLike = 0.0,
    compiled: bool = False,
) -> PeriodicMotions:
    """Solve many releases of many cans exactly.

    Parameters
    ----------
    a, c, h : array_like
        The cans (`reference.problem.can`); shape () for one can, which is fastest, or
        broadcastable.
    phi, phi_dot, psi_dot, theta_dot : array_like
        The releases, dimensionless; broadcast together to shape (n,).
    compiled : bool
        Whether kernels compiled by numba solve all but hard releases, one after another. The first
        call in a new environment takes seconds, for compiling.

    Returns
    -------
    PeriodicMotions
        Arrays of shape (n,), in the order of the raveled releases. The number of terms and nodes is
        that of the hardest release of a block, so that a release alone may differ by round-off; one
        that a compiled kernel solves has the same bits alone and among others.

    Raises
    ------
    RefusedError
        If a value is not finite, a can impossible, a nutation outside [1e-150, pi/2), or a rate too
        large for its square.
    ModuleNotFoundError
        If compiled kernels are asked for and numba is not installed.
    """
    cans = [np.asarray(value, dtype=float) for value in (a, c, h)]
    parts = [np.asarray(value, dtype=float) for value in (phi, phi_dot, psi_dot, theta_dot)]
    _refuse(cans, parts)
    many = any(value.size > 1 for value in cans)
    arrays = np.broadcast_arrays(*cans, *parts) if many else np.broadcast_arrays(*parts)
    flat = [np.ascontiguousarray(value, dtype=float).ravel() for value in arrays]
    n = flat[0].size
    fields = [np.zeros(n) for _ in range(6)]
    code = np.zeros(n, dtype=np.int8)
    order = np.argsort(flat[-4], kind="stable")
    if compiled:
        from reference.integrable.compiled_bounce import solve_each  # noqa: PLC0415 - imports numba

        owners = flat[:3] if many else [value.reshape(1) for value in cans]
        numbers, solved = solve_each(tuple(owners), tuple(flat[-4:]))
        fields = [np.ascontiguousarray(column) for column in numbers.T]
        code[solved] = OUTCOMES.index(Outcome.FINISHED)
        order = order[~solved[order]]
    for start in range(0, order.size, CHUNK):
        pick = order[start : start + CHUNK]
        names = ("phi", "phi_dot", "psi_dot", "theta_dot")
        released = {name: value[pick] for name, value in zip(names, flat[-4:], strict=True)}
        owner = [value[pick] for value in flat[:3]] if many else [v.reshape(1) for v in cans]
        result = _chunk(CanConstants(a=owner[0], c=owner[1], h=owner[2]), **released)
        code[pick] = result[0]
        for field, values in zip(fields, result[1:], strict=True):
            field[pick] = values
    return PeriodicMotions(
        code=code,
        period=fields[0],
        angle_of_turn=fields[1],
        rotation_turn=fields[2],
        phi_min=fields[3],
        phi_max=fields[4],
        peak_psi_dot=fields[5],
    )


def _refuse(cans: list[Floats], parts: list[Floats]) -> None:
    """Refuse what no can or release has; the key is the first to blame."""
    can = dict(zip(("a", "c", "h"), cans, strict=True))
    release = dict(zip(("phi", "phi_dot", "psi_dot", "theta_dot"), parts, strict=True))
    for key, value in (can | release).items():
        if not np.isfinite(value).all():
            raise RefusedError(key, value, "finite", "cans and releases must be finite")
    for key, value in can.items():
        if not (value > 0).all() or (key == "c" and (value > 2 * can["a"]).any()):
            allowed = "positive and `c` at most 2 `a`"
            raise RefusedError(key, value, allowed, f"`a`, `c`, `h` must be {allowed}")
    phi = release.pop("phi")
    if not ((phi >= LEAST) & (phi < np.pi / 2)).all():
        allowed = f"inside [{LEAST:g}, pi/2)"
        raise RefusedError("phi", phi, allowed, f"`phi` must lie {allowed}")
    for key, rate in release.items():
        if not (np.abs(rate) < 1 / LEAST).all():
            allowed = f"below {1 / LEAST:g}"
            raise RefusedError(key, rate, allowed, f"rates must be {allowed}")


def released_potential(
    can: CanConstants,
    series: Series,
    *,
    phi: Floats,
    phi_dot: Floats,
    psi_dot: Floats,
    theta_dot: Floats,
) -> EffectivePotential:
    """Return the wells of releases, referred to the release, shape (n,)."""
    excess = (can.a_p + 1) * phi_dot**2 / 2
    return effective_potential(
        can,
        series,
        phi=phi,
        b=np.sin(phi) ** 2 * psi_dot,
        spin=psi_dot + theta_dot,
        excess=excess,
    )


def _chunk(
    can: CanConstants, *, phi: Floats, phi_dot: Floats, psi_dot: Floats, theta_dot: Floats
) -> tuple[NDArray[np.int8], Floats, Floats, Floats, Floats, Floats, Floats]:
    """Solve a few releases that need about as many terms."""
    release = {"phi": phi, "phi_dot": phi_dot, "psi_dot": psi_dot, "theta_dot": theta_dot}
    # phi may rise above its release: only where it rests and falls is the release the highest
    highest = np.pi / 2 if phi_dot.any() else float(phi.max())
    series = frobenius_series(can, terms_needed(highest))
    well = released_potential(can, series, **release)
    points = turning_points(well, certain=False)
    if float(points.high.max()) > highest:
        well = released_potential(can, frobenius_series(can, terms_needed(np.pi / 2)), **release)
        points = turning_points(well, certain=False)
    code, out, doubted = _integrated(points, careful=False)
    if doubted.size:
        # other roots may lie between the two: isolate them all
        certain = turning_points(select_potential(well, doubted), certain=True)
        code[doubted], better, left = _integrated(certain, careful=True)
        for field, values in zip(out, better, strict=True):
            field[doubted] = values
        if left.size:
            refined, converged = graded_integrals(select_points(certain, left))
            code[doubted[left[~converged]]] = OUTCOMES.index(Outcome.UNRESOLVED)
            for field, value in zip(out, refined, strict=True):
                field[doubted[left]] = np.where(converged, value, 0.0)
    return code, out[0], out[1], out[2], out[3], out[4], out[5]


def _integrated(
    points: TurningPoints, *, careful: bool
) -> tuple[NDArray[np.int8], list[Floats], NDArray[np.intp]]:
    """Return codes and integrals of releases, and the numbers of those in doubt."""
    code = points.code.copy()
    out = [np.zeros(code.size) for _ in range(6)]
    doubt = np.zeros(code.size)
    bounced = np.flatnonzero(code == OUTCOMES.index(Outcome.FINISHED))
    if bounced.size:
        points_there = select_points(points, bounced)
        nodes = nodes_needed(elliptic_substitution(points_there))
        for count in np.unique(nodes).tolist():
            group = np.flatnonzero(nodes == count)
            for part in np.array_split(group, 1 + group.size * count // CACHED):
                values = cycle_integrals(select_points(points_there, part), count, careful=careful)
                for field, value in zip([*out, doubt], values, strict=True):
                    field[bounced[part]] = value
    return code, out, np.flatnonzero(doubt)

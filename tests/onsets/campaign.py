"""Random releases whose rim slips, the outcome of each and its least normal force."""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from reference import Effects, Kind, Outcome, ParameterError, Parameters, Problem, Solution, solve
from reference.equations.contact_laws import Mode
from reference.equations.coulomb import CoulombEquations
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import SLIP, TURN, released
from reference.nonsmooth.level_spin import stands
from reference.nonsmooth.segments import SegmentsPath
from reference.nonsmooth.slip_onset import LEAN_OF_CAN, admissible, holding, reserve, slack
from reference.problem.states import Floats

DURATION = 0.3
"""sqrt(R/g) to look ahead: some slips long, and some motions through a whole bounce."""

INSTANTS = np.linspace(0.0, 1.0, 25)
"""Where each step, of order 31, is looked at."""

ROUNDED = 512 * np.finfo(float).eps
"""Of the terms that the normal force is the sum of, (1 + |w|^2)/sin(phi), each rounded some times;
a step is resolved to 3e-14 of a state, a hundredth of which is left of a root on it."""

LEAST_MU, MOST_MU = 0.01, 5.0
"""Coefficients of friction."""

PIECE = 500
"""Onsets of one stream of random numbers: pieces may be followed apart."""

KINDS = ("at rest", "slipping", "with arms", "on the edge")
"""How the rim is released, and whether it meets drilling and rolling friction, too; *on the edge*:
at rest, with the friction that it needs there but for some units of round-off, and every other one
where that is stationary."""

ULPS = 3
"""Units of round-off beside the edge, at most."""


@dataclass
class Tally:
    """What came of releases.

    Parameters
    ----------
    outcomes : Counter
        Of motions in which the rim slips or that end at once, by kind and outcome.
    directions : Counter
        Of rims released at rest that cannot be held so, by how many admissible directions there
        are and whether the free rim would fall.
    held : int
        Releases in which the rim sticks throughout: these are no onsets.
    least : float
        Least normal force over what is its round-off; minus 1 is all of that.
    excess : float
        How far what is held is beyond where it is let go, at most, over its round-off.
    faults : list of (kind, fault, problem)
    """

    outcomes: Counter[tuple[str, str]] = field(default_factory=Counter)
    directions: Counter[tuple[int, bool]] = field(default_factory=Counter)
    held: int = 0
    least: float = 0.0
    excess: float = 0.0
    faults: list[tuple[str, str, Problem]] = field(default_factory=list)

    @property
    def onsets(self) -> int:
        """Motions that were looked at."""
        return self.outcomes.total() + len(self.faults)

    def add(self, other: "Tally") -> None:
        """Count what came of other releases, too."""
        self.outcomes += other.outcomes
        self.directions += other.directions
        self.held += other.held
        self.least = min(self.least, other.least)
        self.excess = max(self.excess, other.excess)
        self.faults += other.faults


def campaign(count: int, seed: int | tuple[int, ...]) -> Tally:
    """Follow random releases until so many rims have slipped."""
    chance, tally = np.random.default_rng(seed), Tally()
    while tally.onsets < count:
        see(tally, *drawn(chance))
    return tally


def drawn(chance: np.random.Generator) -> tuple[str, Problem]:
    """Return a random release, and of which kind it is: mostly at rest."""
    kind = KINDS[int(chance.choice(len(KINDS), p=(0.5, 0.3, 0.1, 0.1)))]
    can: Parameters | None = None
    while can is None:
        a, c, h = 10 ** chance.uniform((-1.3, -1.3, -1.0), (0.5, 0.5, 0.7))
        try:
            can = Parameters(a=float(a), c=float(c), h=float(h))
        except ParameterError:
            continue
    arms = (10 ** chance.uniform(-6.0, -1.0, 2)).tolist() if kind == "with arms" else (0.0, 0.0)
    phi_dot, psi_dot, theta_dot = (chance.normal(size=3) * (0.5, 2.0, 2.0)).tolist()
    ahead, aside = chance.normal(size=2).tolist() if kind == "slipping" else (0.0, 0.0)
    mu = float(10 ** chance.uniform(np.log10(LEAST_MU), np.log10(MOST_MU)))
    problem = Problem(
        parameters=can,
        phi=float(chance.uniform(0.02, 1.4)),
        phi_dot=phi_dot,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        slip=(ahead, aside),
        duration=DURATION,
        effects=Effects(mu=mu, drilling=arms[0], rolling_resistance=arms[1]),
    )
    if kind != "on the edge":
        return kind, problem
    if chance.random() < 1 / 2:
        problem = replace(problem, phi_dot=0.0)
    needed = _needed(problem) * (1 + np.finfo(float).eps * float(chance.integers(-ULPS, ULPS + 1)))
    if not LEAST_MU < needed < MOST_MU:
        return "at rest", problem
    return kind, replace(problem, effects=Effects(mu=needed))


def _needed(problem: Problem) -> float:
    """Return the friction that a rim at rest needs; infinite if none holds it."""
    equations = CoulombEquations(parameters=problem.parameters, mu=1.0)
    force = equations.contact(released(problem)[:, None], Mode()).force[:, 0]
    return float(np.hypot(*force[:2]) / force[2]) if force[2] > 0 else np.inf


def see(tally: Tally, kind: str, problem: Problem) -> None:
    """Follow one release and count what came of it."""
    try:
        found = solve(problem)
    except Exception as error:  # noqa: BLE001 - whatever comes out is a crash
        tally.faults.append((kind, f"{type(error).__name__}: {error}", problem))
        return
    least, excess = pulls_and_excess(found)
    tally.least, tally.excess = min(tally.least, least), max(tally.excess, excess)
    if least < -1 or excess > 1:
        fault = f"N falls to {least:.3g}, what is held is {excess:.3g} beyond its cone"
        tally.faults.append((kind, f"{fault}, in units of round-off", problem))
        return
    if found.outcome in {Outcome.STALLED, Outcome.OUTWORKED}:
        tally.faults.append((kind, found.outcome.value, problem))
        return
    if found.t_end > 0 and all(phase.kind is Kind.STICK for phase in found.phases):
        tally.held += 1
        return
    if kind == "at rest":
        directions(tally, problem)
    tally.outcomes[kind, found.outcome.name] += 1


def directions(tally: Tally, problem: Problem) -> None:
    """Count the directions in which a rim at rest may slip, if it cannot be held."""
    mu = problem.effects.mu or 0.0
    equations = CoulombEquations(parameters=problem.parameters, mu=mu)
    y = released(replace(problem, slip=(0.0, 0.0)))
    held = equations.contact(y[:, None], Mode())
    if slack(equations, held)[0] > 0:
        return
    # in any direction: without a force the rim falls if one holds it where the mobility is positive
    sliding = equations.contact(_aside(y)[:, None], Mode(slips=True))
    falls = bool(sliding.force[2, 0] * sliding.normal_mobility[0] > 0)
    tally.directions[len(admissible(equations, y, Mode(slips=True))), falls] += 1


def _aside(y: Floats) -> Floats:
    moved = y.copy()
    moved[SLIP] = 0.0, 1.0
    return moved


def pulls_and_excess(found: Solution) -> tuple[float, float]:
    """Return the least normal force, and how far what is held is beyond its cone at most.

    Both over the size of their round-off, and 0 of a motion that ends where it begins; looked at
    with the equations of the general can, whichever were followed.
    """
    if found.t_end == 0:
        return 0.0, 0.0
    assert isinstance(found.path, SegmentsPath)
    problem = found.problem
    equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
    least, most = np.inf, -np.inf
    for piece in found.path.pieces:
        y, mode = piece.at(piece.cut * INSTANTS), piece.mode
        # what begins has no direction yet
        if mode.slips:
            y = y[:, np.hypot(*y[SLIP]) > 0]
        if equations.resistance and not mode.rests:
            y = y[:, np.logical_not(stands(y))]
        touch, size = equations.contact(y, mode), ROUNDED * (1 + (y[TURN] ** 2).sum(axis=0))
        least = min(least, float((touch.force[2] / size).min(initial=np.inf)))
        beyond = [] if mode.slips else [reserve(equations, touch)]
        beyond += [reserve(equations, touch, LEAN_OF_CAN)] if mode.rests else []
        beyond += [holding(equations, touch)] if equations.drilling and not mode.turns else []
        # nor does a moment ever drive what it is against
        beyond += [mode.turns * equations.turning(y)] if mode.turns else []
        most = max([most, *(float((-left / size).max(initial=-np.inf)) for left in beyond)])
    return least, most

"""Random releases whose rim slips, the outcome of each and its least normal force."""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from reference import Effects, Kind, ParameterError, Parameters, Problem, Solution, solve
from reference.equations.contact_laws import Mode
from reference.equations.coulomb import CoulombEquations
from reference.equations.state_vector import LEAN, SLIP, TURN, Angles, released
from reference.nonsmooth.segments import SegmentsPath
from reference.nonsmooth.slip_onset import admissible, slack
from reference.problem.states import Floats

DURATION = 0.3
"""sqrt(R/g) to look ahead: some slips long, and some motions through a whole bounce."""

BETWEEN = 5
"""Instants between two nodes of a path, of which each step of order 31 has four."""

ROUNDED = 512 * np.finfo(float).eps
"""Of the terms that the normal force is the sum of, (1 + |w|^2)/sin(phi), each rounded some times;
a step is resolved to 3e-14 of a state, a hundredth of which is left of a root on it."""

PIECE = 500
"""Onsets of one stream of random numbers: pieces may be followed apart."""

KINDS = ("at rest", "slipping", "with arms")
"""How the rim is released, and whether it meets drilling and rolling friction, too."""


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
    faults : list of (kind, fault, problem)
    """

    outcomes: Counter[tuple[str, str]] = field(default_factory=Counter)
    directions: Counter[tuple[int, bool]] = field(default_factory=Counter)
    held: int = 0
    least: float = 0.0
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
        self.faults += other.faults


def campaign(count: int, seed: int | tuple[int, ...]) -> Tally:
    """Follow random releases until so many rims have slipped."""
    chance, tally = np.random.default_rng(seed), Tally()
    while tally.onsets < count:
        see(tally, *drawn(chance))
    return tally


def drawn(chance: np.random.Generator) -> tuple[str, Problem]:
    """Return a random release, and of which kind it is: mostly at rest."""
    kind = KINDS[int(chance.choice(3, p=(0.6, 0.3, 0.1)))]
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
    mu = float(10 ** chance.uniform(-2.0, np.log10(5.0)))
    return kind, Problem(
        parameters=can,
        phi=float(chance.uniform(0.02, 1.4)),
        phi_dot=phi_dot,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        slip=(ahead, aside),
        duration=DURATION,
        effects=Effects(mu=mu, drilling=arms[0], rolling_resistance=arms[1]),
    )


def see(tally: Tally, kind: str, problem: Problem) -> None:
    """Follow one release and count what came of it."""
    try:
        found = solve(problem)
    except Exception as error:  # noqa: BLE001 - whatever comes out is a crash
        tally.faults.append((kind, f"{type(error).__name__}: {error}", problem))
        return
    if found.t_end > 0 and all(phase.kind is Kind.STICK for phase in found.phases):
        tally.held += 1
        return
    if kind == "at rest":
        directions(tally, problem)
    least = least_force(found)
    tally.least = min(tally.least, least)
    if least < -1:
        tally.faults.append((kind, f"N falls to {least:.3g} of its round-off", problem))
        return
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
    falls = bool(sliding.force[2, 0] * sliding.grip[0] > 0)
    tally.directions[len(admissible(equations, y, Mode(slips=True))), falls] += 1


def _aside(y: Floats) -> Floats:
    moved = y.copy()
    moved[SLIP] = 0.0, 1.0
    return moved


def least_force(found: Solution) -> float:
    """Return the least normal force of a motion over the size of its round-off; 0 of none."""
    if found.t_end == 0:
        return 0.0
    assert isinstance(found.path, SegmentsPath)
    nodes, _ = found.path.nodes()
    parts = np.arange(BETWEEN + 1) / (BETWEEN + 1)
    times = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * parts).ravel(), nodes[-1])
    force, (rows, _) = found.at(times).force, found.path.rows(times)
    assert force is not None
    size = (1 + (rows[TURN] ** 2).sum(axis=0)) / Angles.of(rows[LEAN]).S
    return float((force[:, 2] / (ROUNDED * size)).min())

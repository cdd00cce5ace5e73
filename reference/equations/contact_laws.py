"""Modes of the contact: sticking or slipping, rolling or at rest, turning or held."""

from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from reference.equations.state_vector import Index
from reference.problem.states import Floats


class Kind(Enum):
    """Kinds of contact of the rim, or none of it; the value is the word for a kind."""

    STICK = "stick"
    SLIP = "slip"
    FLIGHT = "flight"


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """An interval of time in which the rim sticks, slips, or is not pushed by the plane.

    Attributes
    ----------
    kind : Kind
    start, end : float
        In sqrt(R/g), those of a `Solution`.
    """

    kind: Kind
    start: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Impact:
    """One impact of a motion, dimensionless.

    Attributes
    ----------
    time : float
    normal_impulse : float
        In m sqrt(g R).
    restitution : float
        Normal velocity after, over that before; 0 of an impact without a normal velocity.
    energy_lost : float
        In m g R, not negative.
    law : str
        "newton", "poisson", or "energetic" where the declared law would have made energy, where
        Newton's has no answer inside the cone of friction, and where a sliding rim jams and
        Newton's, which is of the normal velocity alone, is silent.
    made_energy : bool
        Whether the declared law would have made energy (Kane's paradox).
    ends_at : float or None
        Of an impact that is the first of an infinite sequence in a time below round-off: when that
        sequence ends. The sequence is one impact without restitution.
    """

    time: float
    normal_impulse: float
    restitution: float
    energy_lost: float
    law: str
    made_energy: bool
    ends_at: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """Laws that are in force.

    Attributes
    ----------
    slips : bool
        Of a patch of contact: whether it slips or turns.
    turns : int
        Sense of turning about the normal where that meets friction; 0 where friction holds it, and
        where there is none.
    runs : int
        Sense of theta', in which the contact point runs along the rim, where that meets dry
        friction; 0 where friction holds it, and where there is none.
    creeps : bool
        Whether the contact point of a can that falls on its face runs as dry friction along the
        rim, with next to no normal force, lets it (`reference.equations.creeping`).
    lands : bool
        Whether fluid below a can that falls flat has stopped the contact point: theta' = 0.
    rests : bool
        Whether rolling resistance holds the level part of the angular velocity at zero.
    flies : bool
        Whether the plane exerts no force; only where contact may be lost and found again. The rim
        then moves freely, so that it slips as well.
    """

    slips: bool = False
    turns: int = 0
    runs: int = 0
    creeps: bool = False
    lands: bool = False
    rests: bool = False
    flies: bool = False

    @property
    def kind(self) -> Kind:
        """In a word."""
        if self.flies:
            return Kind.FLIGHT
        return Kind.SLIP if self.slips else Kind.STICK


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """Force of the plane, and the accelerations that it causes; all times sin(phi).

    Attributes
    ----------
    force : ndarray, shape (3, n)
        Along (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical, in m g.
    moment : ndarray, shape (3, n)
        Of drilling and rolling friction, in the same directions, in m g R.
    turning : ndarray, shape (3, n)
        Angular acceleration, in frame B.
    slipping : ndarray, shape (2, n)
        Acceleration of the slip, in the directions of the force.
    normal_mobility : ndarray, shape (n,)
        Normal mobility: how much the rim yields upwards to a unit of normal force and what that
        brings with it, with all that is held; not positive where rigid sliding has no solution, or
        several.
    """

    force: Floats
    moment: Floats
    turning: Floats
    slipping: Floats
    normal_mobility: Floats


class Equations(Protocol):
    """The equations of motion of one can, in each mode."""

    @property
    def mu(self) -> float:
        """Coefficient of friction; infinite for a rim that never slips."""
        ...

    @property
    def drilling(self) -> float:
        """Arm of the moment against turning about the normal."""
        ...

    @property
    def resistance(self) -> float:
        """Arm of the moment against rolling."""
        ...

    @property
    def mu_static(self) -> float:
        """Coefficient of friction up to which the rim sticks, at least `mu`."""
        ...

    @property
    def patch(self) -> float:
        """Radius of the patch in which the rim touches; zero is a point."""
        ...

    @property
    def contour(self) -> float:
        """Coefficient of dry friction against the motion of the contact point along the rim."""
        ...

    @property
    def fluid(self) -> bool:
        """Return whether a law without a threshold opposes the motion along the rim."""
        ...

    @property
    def bilateral_normal(self) -> bool:
        """Return whether the plane may pull: whether the contact is bilateral.

        That of the ideal can is, to which nothing is declared: rolling without slipping is the
        paper's problem, a constraint that takes the force it needs, and where that is a pull a
        finding says so (`reference.analysis.validity`). A can with any effect is a real one, on a
        plane that only pushes: its contact is unilateral, whatever the effect and however small,
        and where the normal force reaches zero the motion ends as lifted, in every mode and model.
        """
        ...

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on; the others are quadratures."""
        ...

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return force and accelerations at the contact, from states of shape (13, n)."""
        ...

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (13, n); zero without `along` of what nothing needs."""
        ...

    def turning(self, y: Floats) -> Floats:
        """Return the angular velocity about the normal, shape (n,)."""
        ...

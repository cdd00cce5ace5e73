"""Equations of motion whose contact and rates are computed by compiled code.

Beside another set of equations, whose numbers they give to within round-off; the kernels
(`reference.equations.kernels`) are imported with the first state, numba with them.
"""

from collections.abc import Set as AbstractSet
from dataclasses import dataclass, fields
from functools import cache
from math import inf

import numpy as np

from reference.equations.contact_laws import Contact, Equations, Mode
from reference.equations.state_vector import Index
from reference.problem.effects import Effects
from reference.problem.problem import Problem
from reference.problem.states import Floats

Laws = tuple[bool, int, bool]
"""Whether the rim slips, in which sense the can turns, and whether it rests: a `Mode`."""

# What a node of the contact is made of, one after another: force, moment, turning, slipping,
# normal mobility, and for the works the velocity of the centre, shaking and angular momentum.
FORCE, MOMENT, TURNING, SLIPPING, MOBILITY, VELOCITY, SHAKING, MOMENTUM = 0, 3, 6, 9, 11, 12, 15, 18
CONTACT_ROWS = 21

# Effects that are among the constants; an effect that is not sends a problem to numpy.
CARRIED = frozenset(
    {
        "mu",
        "drilling",
        "rolling_resistance",
        "linear_damping",
        "angular_damping",
        "rim",
        "gravity",
        "mass",
    }
)

IMPACTS = frozenset({"restitution"})
"""Effects that are no part of the equations of motion on the rim."""


@cache
def _others(kind: type[Effects]) -> tuple[tuple[str, object], ...]:
    """Return the effects of a class that are not among the constants, each with its ideal limit."""
    return tuple((each.name, each.default) for each in fields(kind) if each.name not in CARRIED)


def laws_of(mode: Mode) -> Laws:
    """Return the laws that are in force in a mode."""
    return mode.slips, mode.turns, mode.rests


@dataclass(frozen=True, slots=True, kw_only=True)
class CompiledEquations:
    """The vector fields of one can, compiled.

    Attributes
    ----------
    plain : Equations
        The same in numpy.
    constants : ndarray, shape (21,)
        The can and its effects, in the order in which the kernels take them.
    mu, mu_static, contour, drilling, resistance : float
    fluid, bilateral_normal : bool
        Of the equations in numpy, as all of these coefficients are; no kernel carries a `mu_static`
        beside `mu`, a contour friction or a fluid.
    """

    plain: Equations
    constants: Floats
    mu: float
    mu_static: float
    contour: float
    fluid: bool
    drilling: float
    resistance: float
    bilateral_normal: bool

    @property
    def patch(self) -> float:
        """A point: there are no kernels of a patch."""
        return 0.0

    @staticmethod
    def know(effects: Effects, *, but: AbstractSet[str] = frozenset()) -> bool:
        """Return whether the kernels carry all effects that differ from their ideal limits.

        Effects named in `but` are not asked about.
        """
        others = _others(type(effects))  # type: ignore[arg-type] # a class is hashable
        return all(getattr(effects, name) == limit for name, limit in others if name not in but)

    @classmethod
    def of(cls, plain: Equations, problem: Problem) -> "CompiledEquations":
        """Return the compiled equations of a problem beside its plain ones.

        Raises
        ------
        ValueError
            If the problem has a law that no kernel carries; impacts are none of the equations'.
        """
        p, e = problem.parameters, problem.effects
        if not cls.know(e, but=IMPACTS):
            raise ValueError("an effect of this problem has no kernel: its equations are numpy's")
        mass = (0.0,) * 4 if e.mass is None else (e.mass.share, e.mass.x, e.mass.y, e.mass.z)
        shaking = (*e.gravity.amplitude, e.gravity.rate, e.gravity.phase)
        laws = (inf if e.mu is None else e.mu, e.drilling, e.rolling_resistance)
        rest = (e.linear_damping, e.angular_damping, e.rim)
        return cls(
            plain=plain,
            constants=np.array([p.a, p.c, p.h, *mass, *e.gravity.constant, *shaking, *laws, *rest]),
            mu=plain.mu,
            mu_static=plain.mu_static,
            contour=plain.contour,
            fluid=plain.fluid,
            drilling=plain.drilling,
            resistance=plain.resistance,
            bilateral_normal=plain.bilateral_normal,
        )

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on; the others are quadratures."""
        return self.plain.core(mode)

    def turning(self, y: Floats) -> Floats:
        """Return the angular velocity about the normal, shape (n,)."""
        return self.plain.turning(y)

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return force and accelerations at the contact, from states of shape (13, n)."""
        from reference.equations import kernels

        rows = kernels.contacts(self.constants, laws_of(mode), np.ascontiguousarray(y))
        return Contact(
            force=rows[FORCE:MOMENT],
            moment=rows[MOMENT:TURNING],
            turning=rows[TURNING:SLIPPING],
            slipping=rows[SLIPPING:MOBILITY],
            normal_mobility=rows[MOBILITY],
        )

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (13, n); zero without `along` of what nothing needs."""
        from reference.equations import kernels

        states = np.ascontiguousarray(y)
        return np.asarray(kernels.rates(self.constants, laws_of(mode), states, along))

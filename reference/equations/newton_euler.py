"""Newton and Euler for a can with every effect of a rigid contact.

The can and its point mass are one rigid body of mass M (in that of the can), its centre of mass G
at d from the can's centre, with the inertia I about G. The contact is at p from G, the contact
point moves through the body with velocity k, so that dp/dt = k + w x p, and u is the velocity of
the body's material at the contact. With the force F and the moment Q of the plane, gravity g(t) in
the plane's frame, and drag,

    M a_G = F + M g - M lambda v_G              v_G = u - w x p
    I w'  = p x F + Q - w x I w - nu I w        u'  = a_G + w' x p + w x dp/dt

hence (w', u') = (w', u')_free + D (Q, F) with a matrix D that is symmetric and positive definite:
what is held (u_z always; u while the rim sticks; the turning about the normal while drilling
friction holds it, and the level part w_h of the turning while rolling resistance does) fixes as
many components of (Q, F), and what slides has a moment or force that is proportional to the normal
force:

    F = -mu N u/|u|,    Q_z = -l_d N sign(w_z),    Q_h = -l_r N w_h/|w_h|.

A patch of contact shares one friction between F and Q_z (`reference.equations.patch_friction`); it
is held as a whole, or moves.

A rim rounded to an arc of radius r touches at p_O = -(1 - r) e1 - (h - r) e3 - r z from the can's
centre; e1, e2, e3 are the axes of frame B and z = S e1 + C e3 is the vertical. Everything is times
S, in the time of `reference.equations.state_vector`, and analytic in the state: complex states
give derivatives (`reference.analysis.linearisation`).
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.equations.contact_laws import Contact, Mode
from reference.equations.creeping import NORMAL_FORCE, pushed, rate_of_normal_force
from reference.equations.dissipation import along_the_rim, moment_of_fluid
from reference.equations.frames import applied, cross, dot, length, to_body, to_level, to_precessing
from reference.equations.patch_friction import friction_of_patch
from reference.equations.rigid_body import Setting, body_of, mobility_of
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
    Index,
    X,
    Y,
)
from reference.problem.can import Parameters
from reference.problem.effects import Effects
from reference.problem.states import Floats

# Components of (w', u') and of (Q, F) along (cos psi, sin psi, 0), (-sin psi, cos psi, 0), z.
ROLLING_1, ROLLING_2, TURNING_Z, SLIP_1, SLIP_2, NORMAL = range(6)
NO_MOBILITY = 1e-100


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneralEquations:
    """The vector fields of one can and its effects.

    Attributes
    ----------
    parameters : Parameters
    effects : Effects
    """

    parameters: Parameters
    effects: Effects

    @property
    def mu(self) -> float:
        """Coefficient of friction; infinite for a rim that never slips."""
        return np.inf if self.effects.mu is None else self.effects.mu

    @property
    def drilling(self) -> float:
        """Arm of the moment against turning about the normal."""
        return self.effects.drilling

    @property
    def mu_static(self) -> float:
        """Coefficient of friction up to which the rim sticks."""
        return self.mu if self.effects.mu_static is None else self.effects.mu_static

    @property
    def patch(self) -> float:
        """Radius of the patch in which the rim touches; zero is a point."""
        return self.effects.patch

    @property
    def contour(self) -> float:
        """Coefficient of dry friction along the rim."""
        return self.effects.contour

    @property
    def fluid(self) -> bool:
        """Return whether a law without a threshold opposes the motion along the rim."""
        return along_the_rim(self.effects)

    @property
    def resistance(self) -> float:
        """Arm of the moment against rolling."""
        return self.effects.rolling_resistance

    @property
    def bilateral_normal(self) -> bool:
        """Return whether the plane may pull: under the ideal can alone."""
        return not self.effects.declared()

    def turning(self, y: Floats) -> Floats:
        """Return the angular velocity about the normal, shape (n,)."""
        at = Angles.of(y[LEAN])
        return np.asarray(at.S * y[W1] + at.C * y[W3])

    def core(self, mode: Mode) -> Index:
        """Rows that the rates depend on; the others are quadratures."""
        e = self.effects
        rows = [LEAN, W1, W2, W3]
        if e.mass is not None or e.gravity.tilted or e.gravity.shaken:
            rows += [PSI, TOTAL]
        if e.gravity.shaken:
            rows += [TIME]
        if mode.slips:
            rows += [U1, U2]
        return np.array([*rows, NORMAL_FORCE] if mode.creeps else rows)

    def contact(self, y: Floats, mode: Mode) -> Contact:
        """Return force and accelerations at the contact, from states of shape (13, n)."""
        found = self._contact(mode, self._setting(y, mode), self._law(y, mode))
        return pushed(found, y) if mode.creeps else found

    def sliding_friction(self, y: Floats, mode: Mode) -> Floats:
        """Return friction over the normal force, however small, of a rim that slips, (2, n)."""
        return self._law(y, mode)[[SLIP_1, SLIP_2]]

    def normal_reaction(self, y: Floats, mode: Mode) -> Floats:
        """Return the normal force that keeps the rim on the plane, times sin phi, shape (n,)."""
        found = self._contact(mode, self._setting(y, mode), self._law(y, mode))
        return np.asarray(found.force[2])

    def begun(self, y: Floats, mode: Mode, motion: Floats) -> Contact:
        """Return the same of a patch at rest that begins to move: with the friction of `motion`.

        Parameters
        ----------
        y : ndarray, shape (13, n)
        mode : Mode
            In which the patch moves.
        motion : ndarray, shape (3, n)
            Directions of (u1, u2, a omega_z).
        """
        here = self._setting(y, replace(mode, slips=False))
        return self._contact(mode, here, self._law(y, mode, motion))

    def rates(self, y: Floats, mode: Mode, *, along: bool = True) -> Floats:
        """Rates of all rows in sigma, shape (13, n); zero without `along` of what nothing needs."""
        here = self._setting(y, mode)
        contact = self._contact(mode, here, self._law(y, mode))
        out = self._rates(y, mode, here, contact, along=along)
        if mode.creeps:
            out[NORMAL_FORCE] = rate_of_normal_force(self, y, mode, out)
        return out

    def _rates(
        self, y: Floats, mode: Mode, here: Setting, contact: Contact, *, along: bool
    ) -> Floats:
        e, at = self.effects, here.at
        w1, w2, w3 = y[TURN]
        # without level turning the axes stay, to the last bit
        rotation = np.zeros_like(w1) if self._still(mode) else at.S * w3 - at.C * w1
        out = np.zeros_like(y)
        out[LEAN] = -w2
        out[TURN] = contact.turning + rotation * np.array([-w2, w1, np.zeros_like(w1)])
        out[PSI], out[TOTAL], out[TIME] = w1, at.S * (w3 + at.T * w1), at.S
        u1, u2 = y[U1], y[U2]
        if mode.slips:
            out[U1] = contact.slipping[0] + w1 * u2
            out[U2] = contact.slipping[1] - w1 * u1
        if not along:
            return out
        radius = 1 - e.rim + e.rim * at.S
        ahead, aside = at.S * e.rim * w2, radius * rotation
        if mode.slips:
            ahead, aside = ahead + at.S * u1, aside + at.S * u2
            out[DISSIPATED] = -(contact.force[0] * u1 + contact.force[1] * u2)
        cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
        out[X], out[Y] = ahead * cos - aside * sin, ahead * sin + aside * cos
        out[DISSIPATED] -= dot(contact.moment, to_level(here.turning, at))
        if e.linear_damping or e.angular_damping:
            drag = e.linear_damping * here.mass * dot(here.velocity, here.velocity)
            drag += e.angular_damping * dot(here.turning, applied(here.inertia, here.turning))
            out[DISSIPATED] += at.S * drag
        if self.fluid and not mode.flies:
            out[DISSIPATED] += moment_of_fluid(e, rotation, at) * rotation
        out[SUPPLIED] = at.S * here.mass * dot(here.shaking, here.velocity)
        return out

    def energy(self, y: Floats, mode: Mode) -> Floats:
        """Kinetic and potential energy, without the shaking, over m g R, shape (n,)."""
        here = self._setting(y, mode)
        turning = dot(here.turning, applied(here.inertia, here.turning))
        kinetic = (here.mass * dot(here.velocity, here.velocity) + turning) / 2
        cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
        up = to_level(-here.arm, here.at)
        place = np.array(
            [y[X] + up[0] * cos - up[1] * sin, y[Y] + up[0] * sin + up[1] * cos, up[2]]
        )
        gravity = np.asarray(self.effects.gravity.constant)
        return np.asarray(kinetic - here.mass * gravity @ place)

    def _still(self, mode: Mode) -> bool:
        """Return whether friction holds the contact point on the rim: theta' = 0."""
        return mode.rests or self._held_on_rim(mode)

    def _held_about_normal(self, mode: Mode) -> bool:
        return bool(self.patch and not mode.slips) or bool(self.drilling and not mode.turns)

    def _held_on_rim(self, mode: Mode) -> bool:
        return not mode.flies and (mode.lands or (bool(self.contour) and not mode.runs))

    def _setting(self, y: Floats, mode: Mode) -> Setting:
        p, e, at = self.parameters, self.effects, Angles.of(y[LEAN])
        zero = np.zeros_like(at.S)
        mass, centre, inertia = body_of(p, e, y[TOTAL] - y[PSI])
        point = np.array(
            [zero - (1 - e.rim) - e.rim * at.S, zero, zero - (p.h - e.rim) - e.rim * at.C]
        )
        arm = point - centre
        turning = y[TURN]
        slip = self._rim_velocity(y, mode)
        rotation = at.S * y[W3] - at.C * y[W1]
        through = np.array(
            [
                e.rim * at.S * at.C * y[W2],
                (1 - e.rim + e.rim * at.S) * rotation,
                -e.rim * at.S * at.S * y[W2],
            ]
        )
        cos, sin = np.cos(y[PSI]), np.sin(y[PSI])
        constant = np.asarray(e.gravity.constant)[:, None] + np.zeros_like(zero)
        shaking = e.gravity.shaking(y[TIME])
        shaking = to_body(to_precessing(shaking, cos, sin), at)
        return Setting(
            at=at,
            mass=mass,
            inertia=inertia,
            centre=centre,
            arm=arm,
            turning=turning,
            velocity=to_body(slip, at) - cross(turning, arm),
            arm_rate=through + at.S * cross(turning, arm),
            gravity=to_body(to_precessing(constant, cos, sin), at) + shaking,
            shaking=shaking,
            moment=e.contour * mode.runs * y[NORMAL_FORCE] if mode.creeps else zero,
        )

    def _rim_velocity(self, y: Floats, mode: Mode) -> Floats:
        """Return the velocity of the material at the contact, level directions, shape (3, n)."""
        zero = np.zeros_like(y[U1])
        return np.array([y[U1], y[U2], zero] if mode.slips else [zero, zero, zero])

    def moments_that_hold(self, mode: Mode) -> list[int]:
        """Return the components of (w, u) that moments of friction hold at zero in a mode."""
        turning = [TURNING_Z] if self._held_about_normal(mode) else []
        running = [ROLLING_1] if self._held_on_rim(mode) else []
        return [*turning, *([ROLLING_1, ROLLING_2] if mode.rests else running)]

    def impulses(self, y: Floats, mode: Mode) -> Floats:
        """Return changes of (w in frame B, u1, u2) by unit impulses of the holding moments.

        Parameters
        ----------
        y : ndarray, shape (13,)
        mode : Mode

        Returns
        -------
        ndarray, shape (5, k)
            In the metric of the mass: what else the contact holds answers, and does not move.
        """
        D, moments = self.mobility(y), self.moments_that_hold(mode)
        rim = [NORMAL] if mode.slips else [SLIP_1, SLIP_2, NORMAL]
        answers = np.column_stack([D[:, rim[:-1]], D @ self._law(y[:, None], mode)[:, 0]])
        change = D[:, moments] - answers @ np.linalg.solve(answers[rim], D[np.ix_(rim, moments)])
        turned = to_body(change[:3], Angles.of(y[LEAN]))
        return np.concatenate([turned, change[[SLIP_1, SLIP_2]]])

    def mobility(self, y: Floats) -> Floats:
        """Return changes of velocities at the contact by impulses there, shape (6, 6).

        Of the turning w and the velocity u of the material at the contact, by unit impulses of the
        moment Q and of the force F, all along (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the
        vertical.

        Parameters
        ----------
        y : ndarray, shape (13,)
        """
        here = self._setting(y[:, None], Mode())
        inverse = np.asarray(np.linalg.inv(here.inertia[..., 0]))[None]
        return np.asarray(mobility_of(inverse, here, here.at)[0])

    def _law(self, y: Floats, mode: Mode, motion: Floats | None = None) -> Floats:
        """Return the moments and forces that a unit of normal force causes, shape (6, n).

        A patch has those of `motion`, (u1, u2, a omega_z), if it is given.
        """
        e = self.effects
        kind = y.dtype if motion is None else np.result_type(y, motion)
        law = np.zeros((6, y.shape[1]), dtype=kind)
        law[NORMAL] = 1.0
        if mode.slips and e.patch:
            if motion is None:
                motion = np.array([y[U1], y[U2], e.patch * self.turning(y)])
            shared = self.mu * friction_of_patch(motion)
            law[[SLIP_1, SLIP_2]], law[TURNING_Z] = shared[:2], e.patch * shared[2]
        elif mode.slips:
            law[[SLIP_1, SLIP_2]] = -self.mu * y[[U1, U2]] / length(y[U1], y[U2])
        if e.drilling and mode.turns:
            law[TURNING_Z] = -e.drilling * mode.turns
        if e.contour and mode.runs and not mode.creeps:
            law[ROLLING_1] = e.contour * mode.runs / Angles.of(y[LEAN]).S
        if e.rolling_resistance and not mode.rests:
            level = to_level(y[TURN], Angles.of(y[LEAN]))[:2]
            law[[ROLLING_1, ROLLING_2]] = -e.rolling_resistance * level / length(*level)
        return law

    def _free(self, here: Setting, mode: Mode) -> tuple[Floats, Floats]:
        """Return (w', u') without a force of the plane, shape (6, n), and D, shape (n, 6, 6)."""
        e, at, w = self.effects, here.at, here.turning
        inverse: Floats = np.asarray(np.linalg.inv(here.inertia.transpose(2, 0, 1)))
        momentum = applied(here.inertia, w)
        torque = -at.S * (cross(w, momentum) + e.angular_damping * momentum)
        if self.fluid and not mode.flies and not self._still(mode):
            moment = moment_of_fluid(e, at.S * w[2] - at.C * w[0], at)
            torque = torque + moment * np.array([at.C, np.zeros_like(at.C), -at.S])
        free = np.einsum("nij,jn->in", inverse, torque)
        fall = at.S * (here.gravity - e.linear_damping * here.velocity)
        slide = fall + cross(free, here.arm) + cross(w, here.arm_rate)
        start = np.concatenate([to_level(free, at), to_level(slide, at)])
        return start, mobility_of(inverse, here, at)

    def _contact(self, mode: Mode, here: Setting, law: Floats) -> Contact:
        at, w, on_rim = here.at, here.turning, self._held_on_rim(mode)
        start, mobility = self._free(here, mode)
        if mode.creeps:
            start = start + mobility[:, :, ROLLING_1].T * here.moment
        held = [NORMAL]
        if not mode.slips:
            held = [SLIP_1, SLIP_2, NORMAL]
        if self._held_about_normal(mode):
            held = [TURNING_Z, *held]
        held = [ROLLING_1, *held] if on_rim and not mode.rests else held
        if mode.rests:
            held = [ROLLING_1, ROLLING_2, *held]
        if on_rim:
            # theta' = 0 is kept in directions that precess with the can
            start[ROLLING_1] += w[0] * w[1]
        answer = np.einsum("nij,jn->in", mobility, law)
        columns = mobility[:, :, held].transpose(1, 2, 0)
        columns[:, -1] = answer
        matrix = columns[held].transpose(2, 0, 1)
        normal_mobility = answer[NORMAL]
        if len(held) > 1:
            # what is held answers, too; the law of the normal force in the last column
            rows = held[:-1]
            others = np.linalg.solve(mobility[:, rows][:, :, rows], answer[rows].T[..., None])
            normal_mobility = normal_mobility - np.einsum(
                "ni,ni->n", mobility[:, NORMAL][:, rows], others[..., 0]
            )
        # of a mobility that is zero to the last bit the force has no bound
        none = np.where(normal_mobility == 0.0, NO_MOBILITY, 0.0)
        normal_mobility = normal_mobility + none
        matrix[:, -1, -1] += none
        share = np.linalg.solve(matrix, -start[held].T[..., None])[..., 0].T
        wrench = law * share[-1]
        for row, index in enumerate(held[:-1]):
            wrench[index] += share[row]
        both = start + np.einsum("nij,jn->in", mobility, wrench)
        both[held] = 0.0
        if on_rim:
            both[ROLLING_1] = -w[0] * w[1]
        if mode.creeps:
            wrench[ROLLING_1] += here.moment
        return Contact(
            force=wrench[3:],
            moment=wrench[:3],
            turning=to_body(both[:3], at),
            slipping=both[[SLIP_1, SLIP_2]],
            normal_mobility=normal_mobility * here.mass,
        )

"""Events of a piece in compiled code, which looks at a few places first, against all places."""

from dataclasses import replace

import numpy as np

from reference import PAPER_CAN, Effects, Problem, solve
from reference.equations.compiled_equations import CompiledEquations
from reference.equations.newton_euler import GeneralEquations
from reference.nonsmooth.events import EventKind, events
from reference.nonsmooth.segments import SegmentsPath
from tests.support.compiled import needs_numba


@needs_numba
def test_events_that_a_coarse_look_leaves_to_a_fine_one_are_found() -> None:
    """Pieces that roll, under coefficients of friction that the motion needs somewhere."""
    rng = np.random.default_rng(8)
    met = 0
    for _ in range(5):
        rolling = Problem(
            parameters=PAPER_CAN,
            phi=float(rng.uniform(0.1, 0.6)),
            psi_dot=float(rng.normal() * 0.3),
            theta_dot=float(rng.normal() * 0.3),
            duration=4.0,
        )
        path = solve(rolling, model="general").path
        assert isinstance(path, SegmentsPath)
        force = path.nodes()[1].force
        assert force is not None
        needed = np.hypot(force[:, 0], force[:, 1]) / np.maximum(force[:, 2], 0.1)
        for piece in path.pieces:
            mu = float(needed.max() * rng.choice([rng.uniform(0.3, 0.99), 1.0 + 1e-6]))
            problem = replace(rolling, effects=Effects(mu=mu))
            plain = GeneralEquations(parameters=PAPER_CAN, effects=problem.effects)
            compiled = CompiledEquations.of(plain, problem)
            ours, theirs = (events(piece, each, 100.0) for each in (compiled, plain))
            # two that are at one place may be in either order
            kinds = [[event.what.name for event in found] for found in (ours, theirs)]
            assert sorted(kinds[0]) == sorted(kinds[1])
            places = [np.array([event.c for event in found]) for found in (ours, theirs)]
            assert np.abs(places[0] - places[1]).max(initial=0.0) < 1e-9
            met += sum(event.what is EventKind.SLIPS for event in ours)
    assert met > 10

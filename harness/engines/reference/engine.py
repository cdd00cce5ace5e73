"""The reference in the role of an engine."""

import time
from dataclasses import replace
from importlib.metadata import version

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import Capabilities, resolve
from harness.engines.reference.to_reference_problem import HONOURS, refusal
from harness.engines.reference.truth import (
    SETTINGS,
    TOLERANCES,
    VARIANTS,
    WITHOUT_LOCUS,
    sample_truth,
    solve_case,
)
from reference import Outcome as Ending
from reference import Solution, is_regular


class ReferenceEngine:
    """The mathematics of the paper."""

    name = "reference"
    settings = SETTINGS
    variants = VARIANTS
    tolerances = TOLERANCES
    capabilities = Capabilities(honours=HONOURS, imposes={})

    @property
    def version(self) -> str:
        """The version of this package."""
        return version("rockingcan")

    def timestep(self, case: Case) -> None:
        """Return None: the solver chooses its own steps.

        Raises
        ------
        InvalidSettingError
            If the case asks for one.
        """
        if case.timestep is not None:
            raise InvalidSettingError(
                "timestep", case.timestep, "none at all: the reference chooses its own steps"
            )

    def simulate(self, case: Case) -> Simulation:
        """Solve a case to its horizon.

        Raises
        ------
        UnknownSettingError, InvalidSettingError
            If the case asks for a model or method that does not exist, or for a model that is too
            small for its scene.
        """
        self.timestep(case)
        chosen = resolve(case, SETTINGS, 0.0)
        refused = Simulation(
            case=case,
            outcome=Outcome.NO_SOLUTION,
            note=refusal(case.scene),
            trajectory=None,
            engine_version=self.version,
            model=str(chosen["model"]),
            settings=chosen,
        )
        if refused.note:
            return refused
        started, cpu = time.perf_counter(), time.process_time()
        motion = solve_case(case)
        outcome, note = _ending(motion.solution)
        trajectory = None
        if chosen["model"] in WITHOUT_LOCUS:
            note = f"{note} The model knows no contact locus: no motion to show.".lstrip()
        else:
            trajectory = sample_truth(motion)
        return replace(
            refused,
            outcome=outcome,
            note=note,
            trajectory=trajectory,
            model=motion.solution.model,
            steps=motion.solution.steps,
            wall_s=time.perf_counter() - started,
            cpu_s=time.process_time() - cpu,
        )


def _ending(solution: Solution) -> tuple[Outcome, str]:
    """Return how a solution ended, in the harness's terms and in the reference's words."""
    if solution.outcome is Ending.FINISHED:
        return Outcome.FINISHED, solution.caveat
    if solution.outcome is Ending.OVERTURNED:
        return Outcome.OVERTURNED, solution.outcome.value
    if is_regular(solution):
        return Outcome.FLAT, solution.outcome.value
    if solution.outcome is Ending.CAME_TO_REST:
        return Outcome.FINISHED, solution.outcome.value
    return Outcome.NO_SOLUTION, solution.outcome.value

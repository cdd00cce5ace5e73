"""From verdicts to artefacts: words, maps, tables."""

from collections.abc import Sequence

from harness.artefact import Artefact
from harness.studies.stability.figures import limit_figure, map_figures
from harness.studies.stability.limits import Limit
from harness.studies.stability.plan import Suite
from harness.studies.stability.survey import Finding
from harness.studies.stability.tables import case_table, limit_table, run_table, survey_table
from harness.studies.stability.verdict import Judged
from harness.studies.stability.words import engine_page, summary


def read(
    suite: Suite,
    judged: Sequence[Judged],
    limits: Sequence[Limit],
    hard: Sequence[Finding],
    random: Sequence[Finding],
) -> tuple[Artefact, ...]:
    """Return the artefacts of the study.

    Parameters
    ----------
    suite : Suite
    judged : sequence of Judged
        Every run: of the map and of the searches.
    limits : sequence of Limit
    hard, random : sequence of Finding
        Of the reference on the hard cases and on random scenes.
    """
    names = suite.scenes
    engines = dict.fromkeys(one.simulation.case.engine for one in judged)
    on_grid = [
        one
        for one in judged
        if one.simulation.case.timestep is None or one.simulation.case.timestep in suite.timesteps
    ]
    return (
        summary(judged, hard, random),
        *(engine_page(engine, on_grid, limits, names) for engine in engines),
        *map_figures(on_grid, names),
        limit_figure(limits, names),
        limit_table(limits),
        case_table(hard),
        survey_table(random),
        run_table(judged),
    )

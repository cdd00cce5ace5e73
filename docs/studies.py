"""Numbers of the texts on studies: stability, tolerance, gradients."""

import pandas as pd

from docs.formatting import ENGINES, Row, csv, digits, markdown

_PROFILES = {"default": "as it ships", "matched": "matched", "adaptive": "adaptive"}


def stability() -> dict[str, str]:
    """Return how many runs on hard cases have each verdict, and how the reference fares."""
    counts, hard = csv("stability/verdict-counts.csv"), csv("stability/hard-cases.csv")
    survey = csv("stability/random-scenes.csv")
    wide = counts.pivot_table(
        index="verdict", columns=["engine", "profile"], values="runs", fill_value=0, sort=False
    )
    columns = [(engine, profile) for engine in ENGINES for profile in _PROFILES]
    rows = [
        [str(verdict), *(f"{row.get(column, 0):.0f}" for column in columns)]
        for verdict, row in wide.iterrows()
    ]
    head = ["runs that are", *(f"{ENGINES[e]}, {_PROFILES[p]}" for e, p in columns)]
    return {
        "table": markdown(head, rows),
        "runs": f"{counts['runs'].sum():,}",
        "cases": str(len(hard)),
        "solved": str(hard["reference"].str.startswith("solved").sum()),
        "refused": str(hard["reference"].str.startswith("refused").sum()),
        "disagreement": f"{hard['disagreement'].max():.1e}",
        "random": f"{survey['scenes'].sum():,}",
        "random_refused": str(survey[survey["ends"] == "refused"]["scenes"].sum()),
        "random_failed": str(survey["failures"].sum()),
    }


_KINDS = ("honest", "delivers_more_than_asked", "always_to_round-off")
"""Verdicts that keep what is promised."""


def tolerance() -> dict[str, str]:
    """Return for each setting that asks for an accuracy what it delivers on hard cases."""
    table = csv("tolerance/settings.csv")
    judged = table.set_index("setting")
    rows = [
        (
            str(name),
            f"{row['coarsest']:.0e} to {row['finest']:.0e}",
            _number(row["median_slope"], 2),
            _number(row["worst_factor"], 2),
            _number(row["level_rad"], 2),
            f"{sum(row[kind] for kind in _KINDS):.0f}",
            f"{row['optimistic'] + row['does_not_follow'] + row['saturates']:.0f}",
            f"{row['changes_nothing']:.0f}",
            f"{row['loses_the_motion']:.0f}",
        )
        for name, row in judged.iterrows()
    ]
    head = (
        *("setting", "asked", "slope", "worst factor", "level, rad", "keeps it", "does not"),
        *("changes nothing", "loses the motion"),
    )
    runs, ladders = csv("tolerance/delivered.csv"), csv("tolerance/ladders.csv")
    return {
        "table": markdown(head, rows, words=2),
        "runs": f"{len(runs):,}",
        "cases": str(ladders["scene"].nunique()),
    }


def _number(value: float, count: int) -> str:
    """Return a number with so many digits, or a dash where there is none."""
    return "-" if pd.isna(value) else digits(float(value), count)


def gradients() -> dict[str, str]:
    """Return how far derivatives of engines are from the exact ones, by differences and own."""
    table, own = (csv(f"gradients/paper-release-{part}.csv") for part in ("gradients", "own"))
    finest = table[table["timestep_s"] == table.groupby("engine")["timestep_s"].transform("min")]
    turn = finest[finest["quantity"] == "angle_of_turn_deg"]
    rows = [
        (str(key), f"{by['exact'].iloc[0]:.4g}", *(_percent(by, engine) for engine in ENGINES))
        for key, by in turn.groupby("key", sort=False)
    ]
    last = own[own["timestep_s"] == own["timestep_s"].min()]
    last = last[last["quantity"] == "angle_of_turn_deg"]
    by_step = last.pivot_table(
        index="key", columns="engine_step", values="relative_error", sort=False
    )
    steps = sorted(by_step.columns)
    return {
        "table": markdown(("by", "exact", *ENGINES.values()), rows),
        "own": markdown(
            ("by", *(f"{step:.0e}" for step in steps)),
            [(str(key), *(_share(row[step]) for step in steps)) for key, row in by_step.iterrows()],
        ),
        "timestep": f"{turn['timestep_s'].min():g}",
    }


def _percent(by: pd.DataFrame, engine: str) -> str:
    """Return the error of the difference of an engine that settles."""
    row: Row = by.set_index("engine").loc[engine].to_dict()
    return _share(float(row["settled_error"]))


def _share(error: float) -> str:
    """Return a relative error in percent."""
    return f"{digits(100.0 * error, 2)} %"

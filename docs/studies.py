"""Numbers of the texts on studies: stability, tolerance, gradients, dissipation."""

import json
import math

import pandas as pd

from docs.formatting import BASELINE, ENGINES, csv, digits, markdown

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
            f"{row['not_judged']:.0f}",
        )
        for name, row in judged.iterrows()
    ]
    head = (
        *("setting", "asked", "slope", "worst factor", "level, rad", "keeps it", "does not"),
        *("changes nothing", "loses the motion", "not judged"),
    )
    runs, ladders = csv("tolerance/delivered.csv"), csv("tolerance/ladders.csv")
    return {
        "table": markdown(head, rows, words=2),
        "runs": f"{len(runs):,}",
        "cases": str(ladders["scene"].nunique()),
    }


def _number(value: float, count: int) -> str:
    """Return a number with so many digits, or a dash where there is none."""
    return "-" if math.isnan(value) else digits(value, count)


def gradients() -> dict[str, str]:
    """Return how far derivatives of engines are from the exact ones, by differences and own."""
    facts: dict[str, str] = {}
    for short, scene in (("gentle", "gentle-rock"), ("paper", "paper-release")):
        folder = f"gradients-{short}/{scene}"
        turn = _of_turn(csv(f"{folder}-gradients.csv"))
        rows = [
            (f"`{key}`", f"{by['exact'].iloc[0]:.4g}", *_columns(by))
            for key, by in turn.groupby("key", sort=False)
        ]
        head = [f"{name}, {steps}" for name in ENGINES.values() for steps in _STEPS.values()]
        facts[f"{short}_table"] = markdown(("turn by", "exact", *head), rows)
        facts[f"{short}_timestep"] = f"{turn['timestep_s'].min():g}"
        own = _of_turn(csv(f"{folder}-own.csv")).pivot_table(
            index="key", columns="engine_step", values="relative_error", sort=False
        )
        steps = sorted(own.columns, reverse=True)
        facts[f"{short}_own"] = markdown(
            ("turn by", *(f"{step:.0e}" for step in steps)),
            [(f"`{key}`", *(_share(row[step]) for step in steps)) for key, row in own.iterrows()],
        )
        adaptive = turn[turn["profile"] == "adaptive"]
        right = adaptive["right_from"].notna().groupby(adaptive["key"]).all()
        facts[f"{short}_right"] = f"{right.sum()} of {len(right)}"
    return facts


_STEPS = {"matched": "fixed step", "adaptive": "steps that follow the motion"}


def _of_turn(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the turn, at the finest timestep and at steps that follow the motion."""
    turn = table[table["quantity"] == "angle_of_turn_deg"]
    finest = turn["timestep_s"] == turn["timestep_s"].min()
    chosen: pd.DataFrame = turn.loc[finest | (turn["profile"] == "adaptive")]
    return chosen


def _columns(by: pd.DataFrame) -> list[str]:
    """Return the errors of one derivative, settled and best, by engine and kind of steps."""
    rows = by.set_index(["engine", "profile"])
    settled, best = rows["settled_error"].to_dict(), rows["relative_error"].to_dict()
    of = [(engine, profile) for engine in ENGINES for profile in _STEPS]
    return [f"{_share(settled[one])} / {_share(best[one])}" for one in of]


def _share(error: float) -> str:
    """Return a relative error in percent, or a dash where there is none."""
    return "-" if math.isnan(error) else f"{digits(100.0 * error, 2)} %"


_DISSIPATION = ("film", "boundary-layer", "contour-viscous", "contour-dry", "rolling-resistance")


def dissipation() -> dict[str, str]:
    """Return how a disk comes to rest under each law: exponents of theory and of the motion."""
    rows = []
    for name in _DISSIPATION:
        file = BASELINE / f"dissipation-{name}" / "printed.json"
        rest = json.loads(file.read_text(encoding="utf-8"))["rest"]
        window = f"{digits(rest['from_phi_rad'], 2)} to {digits(rest['to_phi_rad'], 2)}"
        numbers = (rest["exponent_predicted"], rest["exponent"])
        rows.append([rest["law"], *(f"{p:.4f}" for p in numbers), f"{rest['t_f_s']:.6f}", window])
    head = ("law", "p of the theory", "p, fitted", "flat at, s", "fitted from and to, rad")
    return {"table": markdown(head, rows)}

"""Numbers of the texts on studies: stability, tolerance, gradients, dissipation, effects."""

import json
import math

import pandas as pd

from docs.formatting import BASELINE, ENGINES, csv, digits, markdown
from harness.studies.gradients.derivatives import PROGRAM
from harness.studies.tolerance.design import SUITES
from harness.sweep.plan import FEWEST_REDUCED, REDUCED_ROWS
from models.catalogue import hard_names

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
    table = pd.concat([csv("tolerance/settings.csv"), csv("tolerance-drake/settings.csv")])
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
    ladders = csv("tolerance/ladders.csv")
    every = pd.concat([ladders, csv("tolerance-drake/ladders.csv")])
    cases = set(ladders["scene"])
    left_out = [f"`{name}`" for name in hard_names() if name not in cases]
    return {
        "table": markdown(head, rows, words=2),
        "runs": f"{every['values'].sum():,}",
        "unpaid": f"{every['unpaid'].sum():,}",
        "most_steps": f"{SUITES['full'].most_steps:,.0f}",
        "cases": str(len(cases)),
        "hard": str(len(cases & set(hard_names()))),
        "of_hard": str(len(hard_names())),
        "left_out": ", ".join(left_out),
    }


def _number(value: float, count: int) -> str:
    """Return a number with so many digits, or a dash where there is none."""
    return "-" if math.isnan(value) else digits(value, count)


_BILLION = 1_000_000_000


def sweep_reduced() -> dict[str, str]:
    """Return what a sweep without rows took, and what a thousand million releases would."""
    folder = BASELINE / "sweep-reduced"
    told = json.loads((folder / "printed.json").read_text(encoding="utf-8"))
    took = json.loads((folder / "made.json").read_text(encoding="utf-8"))["took"]
    processor = took["processor_seconds"] / told["scenes"]
    return {
        "scenes": f"{told['scenes']:,}",
        "most": f"{REDUCED_ROWS:,}",
        "fewest": str(FEWEST_REDUCED),
        "partitions": str(told["partitions"]),
        "kilobytes": f"{told['largest_partition_bytes'] / 1e3:,.0f}",
        "seconds": f"{took['seconds']:,.0f}",
        "processor": f"{took['processor_seconds']:,.0f}",
        "microseconds": digits(1e6 * processor, 2),
        "megabytes": f"{took['largest_process_mb']:,.0f}",
        "billion": digits(_BILLION * processor / 2.0 / 60.0, 2),
    }


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
        facts[f"{short}_causes"] = _causes(csv(f"{folder}-gradients.csv"))
        own = csv(f"{folder}-own.csv")
        facts[f"{short}_own"] = _own(own)
        facts[f"{short}_shortest"] = _shortest(own)
        adaptive = turn[turn["profile"] == "adaptive"]
        right = adaptive["right_from"].notna().groupby(adaptive["key"]).all()
        facts[f"{short}_right"] = f"{right.sum()} of {len(right)}"
    facts["settings"] = _settings(csv("gradients-gentle/gentle-rock-settings.csv"))
    facts |= _chaos(csv("gradients-chaos/chaotic-can-phi.csv"))
    facts["autodiff"] = _autodiff(csv("gradients-autodiff/gentle-rock-own.csv"))
    return facts


def derivatives() -> dict[str, str]:
    """Return how large derivatives are beside a separatrix."""
    rows = csv("separatrix/rows.csv")
    columns = ("period_s", "d_period_s/d_release.psi_dot", "d_angle_of_turn_deg/d_release.psi_dot")
    table = [
        (f"{row['release_psi_dot_rad_s']:.0e}", *(f"{row[column]:.4g}" for column in columns))
        for _, row in rows.iterrows()
    ]
    head = ("`release.psi_dot`, rad/s", "period, s", "of the period", "of the turn")
    return {"separatrix": markdown(head, table, words=0)}


_QUANTITIES = {
    "angle_of_turn_deg": "turn",
    "period_s": "period",
    "phi_min_rad": "smallest phi",
    "peak_psi_dot_rad_s": "peak rate",
}
"""Quantities that an engine's own derivatives know, by their columns."""


def _by_step(table: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of an engine's own differences at its finest timestep, a column a step."""
    finest = table[table["timestep_s"] == table["timestep_s"].min()]
    judged = finest[finest["quantity"].isin(_QUANTITIES) & (finest["engine_step"] != PROGRAM)]
    wide: pd.DataFrame = judged.assign(step=judged["engine_step"].astype(float)).pivot_table(
        index=["quantity", "key"], columns="step", values="relative_error", sort=False
    )
    return wide


def _shortest(table: pd.DataFrame) -> str:
    """Return in how many derivatives the shortest of the engine's own steps has the least error."""
    wide = _by_step(table)
    return f"{(wide.idxmin(axis=1) == min(wide.columns)).sum()} of {len(wide)}"


def _own(table: pd.DataFrame) -> str:
    """Return the errors of MuJoCo's own derivatives at its finest timestep, by their step."""
    wide = _by_step(table)
    steps = sorted(wide.columns, reverse=True)
    rows = [
        (_QUANTITIES[quantity], f"`{key}`", *(_share(row[step]) for step in steps))
        for (quantity, key), row in zip(wide.index, wide.to_dict("records"), strict=True)
    ]
    return markdown(("", "by", *(f"{step:.0e}" for step in steps)), rows, words=2)


def _autodiff(table: pd.DataFrame) -> str:
    """Return the errors of derivatives of MJX's program beside MuJoCo's best differences."""
    finest = table[table["timestep_s"] == table["timestep_s"].min()]
    judged = finest[finest["relative_error"].notna()]
    program = judged[judged["engine"] == "mjx"].set_index(["quantity", "key"])
    best = judged[judged["engine"] == "mujoco"].groupby(["quantity", "key"])["relative_error"].min()
    rows = [
        (
            _QUANTITIES[quantity],
            f"`{key}`",
            f"{row['exact']:.4g}",
            f"{row['value']:.4g}",
            _share(row["relative_error"]),
            _share(best[quantity, key]),
        )
        for (quantity, key), row in program.iterrows()
    ]
    head = ("", "by", "exact", "MJX's program", "error", "MuJoCo, best step")
    return markdown(head, rows, words=2)


def _causes(table: pd.DataFrame) -> str:
    """Return what goes wrong at short and at long steps, how often, by engine and steps."""
    rows = []
    for engine, profile in [(engine, profile) for engine in ENGINES for profile in _STEPS]:
        own = table[(table["engine"] == engine) & (table["profile"] == profile)]
        for end in ("short", "long"):
            named = own[own[f"{end}_cause"].notna()]
            for cause, of in named.groupby(f"{end}_cause"):
                first, last = of[f"{end}_from"].min(), of[f"{end}_from"].max()
                rows.append(
                    (
                        f"{ENGINES[engine]}, {_STEPS[profile]}",
                        f"{cause}, {end} steps",
                        f"{len(of)} of {len(own)}",
                        f"{first:.0e} to {last:.0e}",
                    )
                )
    return markdown(("engine", "what takes over", "derivatives", "from steps of"), rows, words=2)


def _settings(table: pd.DataFrame) -> str:
    """Return the settings that move the turn most: four of each engine, or those that do."""
    rows = []
    for engine in ENGINES:
        own = table[table["engine"] == engine]
        wide = own.pivot_table(index="setting", columns="quantity", values="per_percent")
        size = wide["angle_of_turn_deg"].abs().sort_values(ascending=False)
        rows += [
            (ENGINES[engine], f"`{setting}`", *(f"{wide.loc[setting, q]:.1e}" for q in _MOVED))
            for setting in size[size > 0.0].index[:4]
        ]
    return markdown(("engine", "setting", "turn, degrees", "period, s"), rows, words=2)


_MOVED = ("angle_of_turn_deg", "period_s")


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


def _chaos(table: pd.DataFrame) -> dict[str, str]:
    """Return the exact growth along the chaotic motion, and what MuJoCo says of it."""
    of = table[table["key"] == "release.phi"]
    fixed, adaptive, truth = (
        of[(of["engine"] == engine) & (of["profile"] == profile)]
        for engine, profile in (
            ("mujoco", "matched"),
            ("mujoco", "adaptive"),
            ("reference", "matched"),
        )
    )
    finest = fixed[fixed["timestep_s"] == fixed["timestep_s"].min()].set_index("time_s")
    moving = adaptive.set_index("time_s")
    rows = [
        (
            f"{row['time_s']:g}",
            f"{row['growth']:.3g}",
            f"{row['right_to']:.0e}",
            _share(finest.loc[row["time_s"], "settled_error"]),
            _share(moving.loc[row["time_s"], "settled_error"]),
        )
        for _, row in truth.iterrows()
    ]
    head = (
        "time, s",
        "growth, rad",
        "longest right step",
        "MuJoCo, fixed step",
        "MuJoCo, adaptive",
    )
    growth, errors = truth["growth"].abs(), finest["settled_error"]
    return {
        "chaos": markdown(head, rows, words=0),
        "chaos_growth": f"{growth.max() / growth.iloc[0]:,.0f}",
        "chaos_lost": f"{errors[errors > 1.0].index.min():g}",
        "chaos_worst": _share(moving["settled_error"].max()),
        "chaos_until": f"{moving['settled_error'].dropna().index.max():g}",
    }

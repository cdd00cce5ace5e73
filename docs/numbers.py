"""Fill the numbers of the texts from committed files: ``make numbers``.

A number stands in a text between marks that name it, ``<!-- = audit.holds -->159<!-- / -->``, and
so does a table. Its source is a file that a command has written: see `docs/measured.toml`.
"""

import json
import math
import re
import sys
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache

import pandas as pd

from docs.effects import capabilities, compliance, dissipation, effects, restitution
from docs.field_guide import guide
from docs.formatting import (
    BASELINE,
    ENGINES,
    ROOT,
    Row,
    adapter_of,
    csv,
    digits,
    error_words,
    markdown,
)
from docs.history import history
from docs.studies import derivatives, gradients, stability, sweep_reduced, tolerance
from harness.core.errors import HarnessError
from harness.engines.registry import description_of, is_constraint
from harness.execution.atomic_write import write_atomically
from harness.gate.comparison import FACTOR, SPREADS
from harness.gate.spread import FEWEST, MOST, SIZES
from models.effects import Effects

BUILT = ROOT / "docs" / "_build"
"""Where the site is built: copies, whose numbers have no marks."""

TEXTS = (
    *("README.md", "CONTRIBUTING.md"),
    *(
        path.relative_to(ROOT).as_posix()
        for path in sorted((ROOT / "docs").rglob("*.md"))
        if not path.is_relative_to(BUILT) and not path.is_relative_to(ROOT / "docs" / "site")
    ),
)

MARKED = re.compile(r"(<!-- = ([\w.-]+) -->)(.*?)(<!-- / -->)", flags=re.DOTALL)


Source = Callable[[], Mapping[str, str]]


def exact() -> dict[str, str]:
    """Return what is told of the paper's release."""
    printed = json.loads((BASELINE / "paper-release" / "printed.json").read_text())
    (bounce,) = printed["bounces"]
    return {
        "turn": f"{bounce['angle_of_turn_deg']:.2f}",
        "gap_um": f"{printed['guard']['least_gap_m'] * 1e6:.1f}",
        "turns_per_s": f"{bounce['peak_psi_dot_rad_s'] / 6.283185307179586:,.0f}",
        "fall_ms": f"{bounce['time_s'] * 1e3:.0f}",
    }


def quick() -> dict[str, str]:
    """Return the steps that the paper's release takes in the quick suite."""
    results = csv("quick/results.csv")
    steps = results[results["scene"] == "paper-release"].groupby("profile")["steps"]
    return {
        "adaptive_steps": f"{steps.max()['adaptive']:,.0f}",
        "matched_steps": f"{steps.max()['matched']:,.0f}",
    }


def engines() -> dict[str, str]:
    """Return the errors of every engine by scene: as it ships on the first, at its best on all."""
    best, shipped = (csv(f"engines/{side}.csv").set_index("engine") for side in ("best", "shipped"))
    scenes = [c for c in best.columns if f"{c}_verdict" in best.columns][:_SHOWN]
    names = [scene.rpartition("_")[0] for scene in scenes]
    order = best[f"{HEADLINE}_deg"].abs().sort_values(kind="stable").index
    rows = [
        [description_of(adapter_of(name)).label or name, error_words(shipped.loc[name], scenes[0])]
        + [error_words(best.loc[name], scene) for scene in scenes]
        for name in sorted(order, key=lambda name: is_constraint(adapter_of(name)))
    ]
    heads = [
        f"{name}, {_UNITS[c.rpartition('_')[2]]}" for name, c in zip(names, scenes, strict=True)
    ]
    return {
        "table": markdown(("engine", f"{names[0]}, as it ships", *heads), rows),
        "count": str(len(best)),
    }


def field() -> dict[str, str]:
    """Return for each scene of the field guide the errors of every engine."""
    best, shipped = (csv(f"field/{side}.csv").set_index("engine") for side in ("best", "shipped"))
    facts = {}
    for column in (c for c in best.columns if f"{c}_verdict" in best.columns):
        scene, _, unit = column.rpartition("_")
        rows = [
            [
                description_of(adapter_of(name)).label or name,
                *(error_words(table.loc[name], column) for table in (shipped, best)),
            ]
            for name in best.index
            if not str(best.loc[name, f"{column}_verdict"]).startswith("unsupported")
        ]
        head = ("engine", f"as it ships, {_UNITS[unit]}", f"at its best, {_UNITS[unit]}")
        facts[scene] = markdown(head, rows)
    return facts


_UNITS = {"deg": "degrees", "rad": "rad of phi"}
"""Of the error of the turn, and of phi where nothing turns."""

HEADLINE = "paper-release"
"""Scene by whose error the engines are sorted."""

_SHOWN = 6
"""Scenes in the table of README: those in which engines are not asked to pull."""


def attribution() -> dict[str, str]:
    """Return for each engine what closing one gap after another takes away of the turn."""
    facts = {}
    for engine, label in ENGINES.items():
        place = f"attribution-{engine}/gentle-rock-{engine}"
        gaps, whole = csv(f"{place}-gaps.csv"), csv(f"{place}-interactions.csv")
        turn = gaps[gaps["quantity"] == "turn_error_deg"].sort_values("place")
        total = whole[whole["quantity"] == "turn_error_deg"].iloc[0]
        rows = [
            (str(gap), f"{taken:+.2f}") for gap, taken in zip(turn.gap, turn.in_order, strict=True)
        ]
        rows += [("what remains", f"{total['remains']:+.2f}")]
        rows += [("**as it ships**", f"**{total['as_shipped']:+.2f}**")]
        facts[engine] = markdown((label, "degrees"), rows)
    return facts


def rim() -> dict[str, str]:
    """Return of each collider from which tilt on it sees the rim, and where its contact is else."""
    rows = []
    for engine, label in ENGINES.items():
        table = csv(f"rim-{engine}/rim-findings.csv")
        for variant, own in table.groupby("variant", sort=False):
            # the first of its findings on the place, or the first
            first = own.assign(other=own["kind"] != "place").sort_values("other", kind="stable")
            seen = _seen_from(own["seen_from_rad"].iloc[0])
            rows.append((f"{label}, {variant}", seen, first["finding"].iloc[0]))
    head = ("collider", "rim seen from", "what it does under the rim")
    jumps = {}
    for engine, variant in _JUMPS.items():
        table = csv(f"rim-{engine}/rim-findings.csv")
        own = table[table["variant"].eq(variant) & table["kind"].eq("place")]
        jumps[f"{engine}_tilt"] = f"{own['below_tilt_rad'].iloc[0]:.4g}"
        jumps[f"{engine}_off"] = f"{1e3 * own['place_error_m'].iloc[0]:.2g}"
    colliders = csv("rim-dart/rim-findings.csv").groupby("variant")["finding"].agg(tuple)
    return jumps | {
        "table": markdown(head, rows, words=3),
        "dart_colliders": str(len(set(colliders))),
    }


def _seen_from(tilt: float) -> str:
    """Return in words from which tilt on (rad) the rim is seen."""
    if math.isnan(tilt):
        return "no tilt"
    if tilt < _ALWAYS:
        return "any tilt"
    return f"{tilt:.2g} rad" if tilt < _LYING else "lying alone"


_ALWAYS, _LYING = 2e-12, 1.5707
"""rad: next to the smallest and the largest tilt that are asked."""

_JUMPS = {"dart": "FCLCollisionDetector", "drake": "half-space", "ode": "cylinder"}
"""Colliders that leave the rim all at once."""


_CHOICES = {
    "settings as shipped": "as it ships, its own step or a shorter one",
    "tuned elsewhere, fixed step": "matched, fixed step",
    "tuned elsewhere, steps follow the motion": "matched, steps that follow the motion",
}


def cost() -> dict[str, str]:
    """Return the price of an accuracy, and how the price of a degree grows with hardness."""
    prices = csv("cost/paper-release-prices.csv")
    targets = sorted(prices["target_deg"].unique(), reverse=True)
    rows = []
    for engine in ("reference", *ENGINES):
        for choice, words in _CHOICES.items():
            own = prices[(prices["engine"] == engine) & (prices["choice"] == choice)]
            if own.empty or (engine == "reference" and "fixed" not in choice):
                continue
            who = "exact motion" if engine == "reference" else f"{ENGINES[engine]}, {words}"
            by_target = own.set_index("target_deg").to_dict("index")
            rows.append([who, *(_price(by_target[target]) for target in targets)])
    degree = csv("cost/paper-release-degree.csv")
    growth = {}
    for steps, own in degree[~degree["engine"].eq("reference")].groupby("steps"):
        ends = own.sort_values("epsilon").groupby("engine")["cost_s_s"]
        growth[steps] = ends.first() / ends.last()
    return {
        "table": markdown(
            ["to an error of, degrees", *(f"{target:g}" for target in targets)], rows
        ),
        "growth_fixed": _span(growth["fixed step"]),
        "growth_adaptive": _span(growth["adaptive"]),
        "easiest": digits(degree["epsilon"].max(), 1),
        "hardest": digits(degree["epsilon"].min(), 1),
    }


def _price(row: Row) -> str:
    verdict = str(row["verdict"])
    if verdict.startswith("not reached"):
        return verdict.removesuffix(" degrees")
    return digits(float(row["cost_s_s"]), 2)


def _span(values: "pd.Series[float]") -> str:
    low, high = (digits(float(value), 2) for value in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def gate() -> dict[str, str]:
    """Return how many quantities a gate finds worse when friction is made soft."""
    table = csv("gate/gate.csv")
    return {"worse": str((table["verdict"] == "worse").sum()), "quantities": str(len(table))}


def benchmark() -> dict[str, str]:
    """Return the ratios that the program claims about its speed."""
    printed = json.loads((BASELINE / "benchmark" / "printed.json").read_text())
    rows = [
        (
            ratio["what"],
            digits(ratio["ratio"]),
            ratio["claim"],
            "yes" if ratio["holds"] else "**no**",
        )
        for ratio in printed["ratios"]
        if ratio["claim"]
    ]
    lean = pd.DataFrame(printed["lean"])
    lean["what"] = lean["who"].where(lean["model"] != "general", "general")
    return {
        "table": markdown(("measured", "ratio", "claimed", "holds"), rows),
        **{f"lean_{what}": _span(own) for what, own in lean.groupby("what")["ratio"]},
    }


_QUOTED = 5
"""Errors that README quotes: of those that change something, the shortest to say."""


def audit() -> dict[str, str]:
    """Return how many claims of the paper stand how, and how many errors there are."""
    verdicts = pd.read_csv(ROOT / "reports" / "audit.csv")["verdict"].value_counts()
    holds, order = verdicts["holds"], verdicts["holds to stated order"]
    unknown = verdicts["not checkable"]
    with (ROOT / "harness/paper/audit/claims.toml").open("rb") as file:
        errors = tomllib.load(file)["errors"]
    gravest = [error for error in errors if error["weight"] == "substantial"]
    shortest = sorted(gravest, key=lambda error: len(error["printed"] + error["right"]))[:_QUOTED]
    return {
        "claims": str(verdicts.sum()),
        "holds": str(holds),
        "to_order": str(order),
        "not_checkable": str(unknown),
        "wrong": str(verdicts.sum() - holds - order - unknown),
        "errors": str(len(errors)),
        "substantial": str(len(gravest)),
        "gravest": markdown(
            ("error", "printed", "right"),
            ((error["name"], error["printed"], error["right"]) for error in shortest),
            words=3,
        ),
    }


def rules() -> dict[str, str]:
    """Return constants of the program that the texts name."""
    return {
        "effects": str(len(fields(Effects))),
        "factor": digits(FACTOR),
        "spreads": digits(SPREADS),
        "fewest": str(FEWEST),
        "most": str(MOST),
        "least": digits(min(SIZES)),
        "largest": digits(max(SIZES)),
    }


SOURCES: Mapping[str, Source] = {
    source.__name__: source
    for source in (
        exact,
        quick,
        engines,
        field,
        guide,
        history,
        attribution,
        compliance,
        effects,
        capabilities,
        restitution,
        rim,
        cost,
        stability,
        sweep_reduced,
        tolerance,
        gradients,
        derivatives,
        dissipation,
        gate,
        benchmark,
        audit,
        rules,
    )
}


@cache
def facts(source: str) -> Mapping[str, str]:
    """Return the numbers of a source by name."""
    return SOURCES[source]()


def filled(text: str) -> str:
    """Return a text with every number between marks written anew.

    Raises
    ------
    HarnessError
        If no source has a number of that name.
    """

    def replace(found: re.Match[str]) -> str:
        source, _, name = found[2].partition(".")
        if source not in SOURCES or name not in facts(source):
            known = facts(source) if source in SOURCES else SOURCES
            raise HarnessError(f"no number `{found[2]}`; there are {', '.join(known)}")
        return f"{found[1]}{facts(source)[name]}{found[4]}"

    return MARKED.sub(replace, text)


def main() -> None:
    """Write the numbers of all texts anew."""
    for name in TEXTS:
        path = ROOT / name
        write_atomically(path, filled(path.read_text(encoding="utf-8")).encode())


if __name__ == "__main__":
    try:
        main()
    except HarnessError as error:
        sys.exit(f"docs.numbers: {error}")

"""Numbers of the effects of a scene: what they do, who carries them, and how they are measured."""

import json
import re
from collections.abc import Mapping
from typing import Any

import pandas as pd

from docs.formatting import BASELINE, ENGINES, csv, digits, markdown
from harness.engines.description import Method
from harness.studies.effects.plan import FACTORS, HEIGHT

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


def effects() -> dict[str, str]:
    """Return by how much each effect changes the turn: exactly, and in each engine."""
    table = csv("effects/gentle-rock-effects.csv")
    changes = table.pivot_table(
        index="effect", columns="engine", values="change_turn_deg", dropna=False, sort=False
    )
    strengths = dict(zip(table["effect"], table["strength"], strict=True))
    known = changes[changes["reference"].notna()]
    known = known.reindex(known["reference"].abs().sort_values(ascending=False).index)
    rows = [
        [f"{effect if '.' in effect else effect.replace('_', ' ')}, {strengths[effect]}"]
        + ["cannot" if pd.isna(row[e]) else f"{row[e]:+.4f}" for e in ("reference", *ENGINES)]
        for effect, row in zip(map(str, known.index), known.to_dict("records"), strict=True)
    ]
    return {"table": markdown(("effect, strength", "exact", *ENGINES.values()), rows)}


def capabilities() -> dict[str, str]:
    """Return which effect each engine honours, imposes on every scene, or refuses."""
    found = {
        told["name"]: told
        for name in ("capabilities", "capabilities-physx")
        for told in json.loads((BASELINE / name / "printed.json").read_text())["engines"]
        if told["installed"] and told["name"] != "reference"
    }
    each = [found[name] for name in sorted(found)]
    rows = [[f"`{key}`", *(_carries(key, told) for told in each)] for key in FACTORS]
    honoured = {key for key in FACTORS if any(_carries(key, told) != "no" for told in each)}
    return {
        "table": markdown(("key", *(told["label"] for told in each)), rows),
        "nobody": ", ".join(f"`{key}`" for key in FACTORS if key not in honoured),
        "engines": str(len(each)),
    }


def _carries(key: str, told: Mapping[str, Any]) -> str:
    """Return in a word what an engine makes of a factor of the study of effects."""
    if key == HEIGHT:
        return "no" if told["method"] == Method.CONSTRAINT.value else "yes"
    words = {
        (True, True): "yes, and imposes",
        (True, False): "yes",
        (False, True): "imposes",
        (False, False): "no",
    }
    return words[key in told["honours"], key in told["imposes"]]


def compliance() -> dict[str, str]:
    """Return of each engine the parts of the error of the turn on a contact that gives way."""
    rows = []
    for engine, label in {**ENGINES, "drake": "Drake"}.items():
        table = csv(f"compliance-{engine}/soft-rock-{engine}-matched-split.csv")
        turn = table[table["quantity"] == "turn_deg"].iloc[0]
        parts = ("softness", "model_form", "limit_uncertainty", "discretisation", "total")
        rows.append([label, *(f"{turn[part]:+.2g}" for part in parts)])
    head = ("engine", "softness", "model form", "known to", "discretisation", "total")
    return {"table": markdown(head, rows)}


_REBOUND = re.compile(
    r"rebound of a declared ([\d.]+)(?: at ([\d.]+) sqrt\(g R\)|, slipping through)"
)


def restitution() -> dict[str, str]:
    """Return by how much rebounds miss a declared coefficient, by engine, speed and timestep."""
    misses, largest = dict[str, list[str]](), dict[str, list[str]]()
    heads = ["coefficient"]
    for engine, label in ENGINES.items():
        for name in (f"restitution-{engine}", f"restitution-{engine}-fine"):
            printed = json.loads((BASELINE / name / "printed.json").read_text())
            found = dict[str, list[float]]()
            for finding in printed["findings"]:
                told = _REBOUND.fullmatch(finding["quantity"])
                if told is None:
                    continue
                miss = finding["value"] - finding["expected"]
                how = f"{told[2]} sqrt(g R)" if told[2] else "slipping through"
                found.setdefault(how, []).append(abs(miss))
                if name == f"restitution-{engine}":
                    misses.setdefault(told[1], [told[1]]).append(f"{miss:+.4f}")
            if name == f"restitution-{engine}":
                heads += [f"{label}, {how}" for how in found]
            for sizes in found.values():
                key = f"{label}, {printed['timestep_s']:g} s"
                largest.setdefault(key, [key]).append(f"{max(sizes):.4f}")
    hows = [head.partition(", ")[2] for head in heads[1 : 1 + len(found)]]
    return {
        "table": markdown(heads, misses.values()),
        "largest": markdown(("engine, timestep", *hows), largest.values()),
    }

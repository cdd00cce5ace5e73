"""A report of four small studies, its texts as given, and texts that try to break out."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Body, Prose, Replay, Table
from harness.core.verdict import Status, Verdict
from harness.report.layout import Section
from harness.report.write import write_chapters
from tests.support.reports import Words, provenance

HOSTILE = (
    "=1+1</script><script>document.title='owned'</script><img src=x onerror=owned()>&\"'\x0b]]>"
)

DIGEST = "0123456789abcdef"
"""Of a case that the small report lists too."""

EXPERIMENT = "aaaabbbbccccdddd"


def table(name: str, rows: list[dict[str, Any]], scene: str = "") -> Table:
    frame = pd.DataFrame(rows)
    told = {str(column): f"What {column} means." for column in frame.columns}
    return Table(name=name, title=name, frame=frame, columns=told, scene=scene)


def fidelity(words: Words) -> Table:
    """Return verdicts of one engine as it ships and matched."""
    verdicts = {
        "default": (
            Verdict(Status.DEVIATES, "deviates by a factor 3"),
            Verdict(Status.DEVIATES, "deviates by a factor 2"),
            Verdict(Status.FAILED, "failed: flat"),
        ),
        "matched": (
            Verdict(Status.AGREES, "agrees"),
            Verdict(Status.AGREES, "agrees"),
            Verdict(Status.UNDECIDABLE, "not decidable: the scene has no bounce"),
        ),
    }
    numbers = {"turn_error_deg": 0.3, "contact_locus_m": 1e-3, "friction_ratio_error": np.nan}
    return table(
        "fidelity",
        [
            {
                "scene": words("gentle-rock"),
                "engine": words("mujoco"),
                "profile": profile,
                "timestep_s": 2e-3 if profile == "default" else 1e-5,
                "quantity": quantity,
                "value": value,
                "allowed": 0.1,
                "verdict": verdict,
                "case": DIGEST,
                "command": words("rockingcan run gentle-rock --engine mujoco"),
            }
            for profile, told in verdicts.items()
            for (quantity, value), verdict in zip(numbers.items(), told, strict=True)
        ],
    )


def replay(words: Words) -> Replay:
    """Return two cans that fall, bounce at frame 50, and rise."""
    frames = np.arange(100.0)
    phi = 0.3 * np.abs(frames - 50.0) / 50.0 + 1e-4

    def body(label: str, kind: str, late: float) -> Body:
        psi = np.arctan((frames - 50.0 - late) / 5.0)
        return Body(
            label=words(label),
            kind=words(kind),
            phi=phi,
            psi=psi,
            theta=-psi,
            contact=0.037 * np.column_stack((np.cos(psi), np.sin(psi))),
            height=np.zeros(100),
        )

    return Replay(
        name=words("gentle-rock-replay"),
        title=words("Replay"),
        seen=words("One second. It is slow at the bounce."),
        radius=0.037,
        height=0.1,
        time=frames / 100.0,
        bodies=(body("exact", "reference", 0.0), body("MuJoCo", "mujoco", 3.0)),
        scene=words("gentle-rock"),
    )


def gaps(words: Words) -> list[Artefact]:
    """Return what an attribution says: two causes of the turn, the second one the larger."""
    scene, engine = words("gentle-rock"), words("mujoco")
    own = {"scene": scene, "engine": engine}
    parts = {"compliance": -0.05, "timestep": 0.35}
    return [
        Prose(name="why", title="Why", text=words("It is the timestep."), scene=scene),
        table(
            f"{scene}-{engine}-gaps",
            [
                own
                | {
                    "gap": words(gap),
                    "quantity": "turn_error_deg",
                    "in_order": part,
                    "alone": part,
                    "what_it_does": words(f"{gap} is open."),
                }
                for gap, part in parts.items()
            ],
            scene,
        ),
        table(
            f"{scene}-{engine}-runs",
            [
                own
                | {
                    "step": "in order",
                    "gap": words(gap),
                    "case": EXPERIMENT if gap == "timestep" else "unlisted",
                    "command": words(f"rockingcan run --close {gap}"),
                }
                for gap in parts
            ],
            scene,
        ),
    ]


def stability(words: Words) -> Table:
    """Return verdicts on two hard cases; of the second the coarser timestep fails."""
    return table(
        "verdicts",
        [
            {
                "scene": scene,
                "engine": words("mujoco"),
                "profile": "matched",
                "timestep_s": step,
                "verdict": verdict,
                "case": DIGEST,
            }
            for scene, step, verdict in (
                ("tall", 1e-3, "accurate"),
                ("tiny", 1e-3, "diverges"),
                ("tiny", 1e-4, "stable but inaccurate"),
                ("tiny.member-1", 1e-4, "diverges"),
            )
        ],
    )


def chapters(
    artefacts: tuple[Artefact, ...], made: Provenance, cases: list[dict[str, Any]], words: Words
) -> list[Section]:
    """Return four studies, the comparison not the first."""
    scene = words("gentle-rock")
    moved = tuple(replace(a, scene=scene) if a.scene else a for a in artefacts)
    price = {
        "engine": words("mujoco"),
        "choice": "tuned elsewhere, fixed step",
        "target_deg": 0.1,
        "verdict": Verdict(Status.REACHED, "cheapest"),
        "cost_s_s": 2.5,
    }
    experiment = {
        "digest": EXPERIMENT,
        "label": words("timestep closed"),
        "command": words("rockingcan run --close timestep"),
    }
    others = replace(made, rockingcan="0.0.9")
    told: list[tuple[str, tuple[Artefact, ...], list[dict[str, Any]]]] = [
        ("rockingcan, stability", (stability(words),), cases[:1]),
        ("rockingcan, quick suite", (*moved, fidelity(words), replay(words)), cases),
        ("Attribution", tuple(gaps(words)), [experiment]),
        ("rockingcan, cost", (table(f"{scene}-prices", [price], scene),), []),
    ]
    return [
        Section(
            title=words(title),
            artefacts=own,
            cases=tuple(listed),
            provenance=others if "stability" in title else made,
        )
        for title, own, listed in told
    ]


CASES = [
    {"digest": DIGEST, "label": "a case", "command": "rockingcan run gentle-rock"},
    {"digest": "fedcba9876543210", "label": "another", "command": "rockingcan run petals"},
]


def hostile_words(text: str) -> str:
    """Return a text that tries to break out."""
    return f"{HOSTILE} {text}"


def write_joined_report(artefacts: tuple[Artefact, ...], out: Path, words: Words = str) -> Path:
    """Write a report of four studies, and return its folder."""
    cases = [
        {key: words(value) if key != "digest" else value for key, value in case.items()}
        for case in CASES
    ]
    sections = chapters(artefacts, provenance(), cases, words)
    write_chapters(sections, out, title=words("All studies"), provenance=provenance())
    return out

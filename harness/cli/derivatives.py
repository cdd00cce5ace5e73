"""The part of the answer of `reference` on the derivatives of the first bounce."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

import typer
from rich.table import Table

from harness.cli import terminal
from harness.engines.reference.derivatives import derivatives_of
from models.scene import Scene

WithDerivatives = Annotated[
    bool,
    typer.Option(
        "--derivatives",
        help="Also the exact derivatives of the first bounce by release, can and effects.",
    ),
]


def derivatives_json(scene: Scene) -> dict[str, Any]:
    """Return the part of the answer of `reference` on the derivatives of the first bounce."""
    own = derivatives_of(scene)
    return {
        "derivatives": own.slopes,
        "derivatives_why": own.why,
        "derivatives_method": own.method,
        "derivatives_caveats": list(own.caveats),
    }


def derivatives_table(answer: Mapping[str, Any]) -> Table:
    """Return the table of derivatives: a row a key of the scene, a column a quantity."""
    derivatives = answer["derivatives"]
    keys = next(iter(derivatives.values()))
    rows = [[key, *(of[key] for of in derivatives.values())] for key in keys]
    return terminal.table("Derivatives of the first bounce", ["by", *derivatives], rows)


def derivatives_sentences(answer: Mapping[str, Any]) -> Iterable[str]:
    """Yield why there are no derivatives of some quantities, and what limits the others."""
    reasons: dict[str, list[str]] = {}
    for quantity, reason in answer["derivatives_why"].items():
        reasons.setdefault(reason.rstrip("."), []).append(quantity)
    for reason, quantities in reasons.items():
        yield f"No derivative of {', '.join(quantities)}: {reason}."
    yield from answer["derivatives_caveats"]

"""Divergence of two motions, and chaos, as data and in words."""

from collections.abc import Iterable
from typing import Any

from harness.engines.reference import PARTED
from harness.engines.reference.assumption_checks import Divergence

Answer = dict[str, Any]


def divergence_json(divergence: Divergence | None) -> Answer | None:
    """Return how disturbed releases part; None of a scene that cannot be chaotic."""
    if divergence is None:
        return None
    return {
        "chaotic": divergence.chaotic,
        "growth": divergence.growth,
        "lyapunov_time_s": divergence.lyapunov_time,
        "parted_s": divergence.parted,
    }


def chaos_sentences(answer: Answer) -> Iterable[str]:
    """Yield how fast disturbances of a chaotic motion grow, in words; nothing of any other."""
    if is_chaotic(answer):
        chaos = answer["divergence"]
        yield (
            f"Chaotic: a disturbance grows by e in {chaos['lyapunov_time_s']:.3g} s; one part in "
            f"1e12 becomes {PARTED:g} rad at {chaos['parted_s']:.3g} s, and beyond nothing can be "
            "compared."
        )


def divergence_sentences(answer: Answer) -> Iterable[str]:
    """Yield in words how long a run can be compared with the exact motion, a paragraph each."""
    yield from chaos_sentences(answer)
    at, why = answer["parts_at_s"], ""
    if is_chaotic(answer):
        why = " What differs in the end is no error, so no errors are given."
    if at is not None:
        yield f"The engine is {PARTED:g} rad away from the exact motion from {at:.3g} s on.{why}"
    elif why:
        yield f"The engine is never {PARTED:g} rad away from the exact motion.{why}"


def is_chaotic(answer: Answer) -> bool:
    """Whether an answer says that a motion is chaotic."""
    return bool(answer.get("divergence") and answer["divergence"]["chaotic"])

"""The effects study in words: what the scene needs, what it lacks, what engines add."""

from harness.studies.effects.plan import Plan
from harness.studies.effects.verdict import Effect, Verdict
from models.effects import KINDS

_KNOWN = frozenset({Verdict.NEEDED, Verdict.HARMLESS, Verdict.MISSING})


def sentences(made: Plan, effects: tuple[Effect, ...]) -> tuple[str, ...]:
    """Return a sentence on what is declared, one on what is not, and one for each engine."""
    first = [one for one in effects if one.mover == made.engines[0]]
    said = []
    declared = [one for one in first if one.declared]
    if declared:
        told = "; ".join(f"{one.name} is {one.verdict.value}" for one in declared)
        said.append(f"Of what {made.scene.name} declares: {told}.")
    else:
        said.append(f"{made.scene.name} declares no effect, and none is simulated.")
    missing = [one for one in _first_known(effects) if one.verdict is Verdict.MISSING]
    if missing:
        worst = "; ".join(f"{one.name} (by {one.mover}: {_lower(one.why)})" for one in missing)
        said.append(
            f"Not declared, though at the strength assumed they change the outcome: {worst}."
        )
    else:
        said.append("Nothing that is left out would change the outcome.")
    nobody = [name for name in KINDS if name not in {one.name for one in _first_known(effects)}]
    if nobody:
        said.append(f"None of these engines can tell what these would do: {', '.join(nobody)}.")
    for mover in made.engines:
        own = [one.name for one in effects if one.mover == mover and one.verdict is Verdict.IMPOSED]
        if own:
            said.append(
                f"{mover} adds of its own accord, and it cannot be removed: {', '.join(own)}."
            )
    return tuple(said)


def _first_known(effects: tuple[Effect, ...]) -> list[Effect]:
    """Return of each effect what the first engine says that can tell."""
    found: dict[str, Effect] = {}
    for one in effects:
        if one.verdict in _KNOWN:
            found.setdefault(one.name, one)
    return list(found.values())


def _lower(sentence: str) -> str:
    """Return a sentence as a part of another."""
    return sentence[0].lower() + sentence[1:].rstrip(".")

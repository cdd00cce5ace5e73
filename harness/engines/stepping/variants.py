"""What else an engine can be run with: settings worth a price, a way to paste them, its iterations.

All three are optional on an engine: `variants`, a tuple of `Variant`; `paste`, a function of a case
that returns text for the engine itself; `counted_step`, a function that steps a world and returns
the iterations of its solver.
"""

from collections.abc import Callable
from dataclasses import dataclass

from harness.core.case import Case, Value
from harness.engines.base import Engine, World
from harness.engines.registry import engine

Options = tuple[tuple[str, Value], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """A choice of settings, to be run over a ladder.

    Parameters
    ----------
    name : str
        In a few words.
    profile : str
    settings : tuple of (str, Value)
        On top of the profile.
    along : str
        What the ladder changes: "timestep", "" for a single run, or the name of a setting.
    values : tuple
        Of that setting, from coarse to fine; a timestep's are chosen by whoever runs it.
    imposes : str
        What the settings make of the can that the scene does not declare; empty if nothing.
    thorough : bool
        Whether a quick look may do without it, since another variant says nearly the same.
    """

    name: str
    profile: str = "matched"
    settings: Options = ()
    along: str = "timestep"
    values: tuple[Value, ...] = ()
    imposes: str = ""
    thorough: bool = False


COMMON = (
    Variant(name="as shipped", profile="default", imposes="everything that the engine ships with"),
    Variant(name="matched"),
    Variant(name="adaptive", profile="adaptive"),
)
"""What every stepping engine is run with."""


def variants(name: str) -> tuple[Variant, ...]:
    """Return the variants of an engine: its own, or the profiles and each word that it allows."""
    chosen = engine(name)
    own: tuple[Variant, ...] | None = getattr(chosen, "variants", None)
    return own if own is not None else COMMON + _words(chosen)


def _words(chosen: Engine) -> tuple[Variant, ...]:
    """Return a variant for each word of each setting that `matched` does not take."""
    return tuple(
        Variant(name=f"{setting.name} {word}", settings=((setting.name, word),))
        for setting in chosen.settings
        for word in setting.choices
        if word != setting.matched
    )


def export_settings(case: Case) -> str:
    """Return a case in the engine's own language, or the command that runs it."""
    own: Callable[[Case], str] | None = getattr(engine(case.engine), "paste", None)
    return case.command() if own is None else own(case)


def counted_step(name: str) -> Callable[[World], int] | None:
    """Return what steps a world of an engine and counts its solver's iterations, if it can."""
    own: Callable[[World], int] | None = getattr(engine(name), "counted_step", None)
    return own

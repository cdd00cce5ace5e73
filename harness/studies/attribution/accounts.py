"""Who accounts for what: the effects of gaps in turn, alone and last, in numbers, words and bars.

With the discrepancy D(S) in which the set S of gaps is closed, and gaps 1 to n:

- the whole, D({}) - D({1..n}), is what closing all of them takes away;
- in order, D({1..k-1}) - D({1..k}), which sum to the whole: each level is added and taken once;
- alone, D({}) - D({k}), whose sum is off the whole by the *interaction*: what they do together;
- left open, D(all but k) - D(all), likewise, seen from the matched end.

A level that is not known leaves what rests on it unknown, and nothing else.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.report_model import Panel, Series
from harness.core.trajectory import Floats
from harness.metrics.quantities import Quantity
from harness.studies.shared.ablation import AblationPath, Closed

_NOTHING = 1e-6
"""Share of the largest discrepancy on the path below which a gap takes away nothing."""

_HARDLY = 0.01
"""Share of the whole below which an interaction is not worth a word."""

Level = float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Account:
    """One quantity, all gaps. None is not known.

    Parameters
    ----------
    names : tuple of str, length n
        Gaps in the order of closing.
    levels : tuple, length n + 1
        Discrepancy as shipped and after each gap.
    in_order, alone, left_open : tuple, length n
        What each gap takes away: after those before it, by itself, and as the last one.
    """

    names: tuple[str, ...]
    levels: tuple[Level, ...]
    in_order: tuple[Level, ...]
    alone: tuple[Level, ...]
    left_open: tuple[Level, ...]

    @property
    def shipped(self) -> Level:
        """Discrepancy with all gaps open."""
        return self.levels[0]

    @property
    def remains(self) -> Level:
        """Discrepancy with all gaps closed."""
        return self.levels[-1]

    @property
    def whole(self) -> Level:
        """What closing all gaps takes away."""
        return difference(self.shipped, self.remains)

    @property
    def interaction(self) -> Level:
        """What the gaps alone take away, all together, beyond the whole."""
        return difference(total(self.alone), self.whole)

    @property
    def interaction_left_open(self) -> Level:
        """The same, seen from the matched end."""
        return difference(total(self.left_open), self.whole)


def account(names: Sequence[str], level: Callable[[Closed], Level]) -> Account:
    """Return who accounts for what.

    Parameters
    ----------
    names : sequence of str, length n
        Gaps in the order of closing.
    level : callable
        Discrepancy with a set of gaps closed.
    """
    whole = frozenset(names)
    levels = tuple(level(frozenset(names[:count])) for count in range(len(names) + 1))
    return Account(
        names=tuple(names),
        levels=levels,
        in_order=tuple(map(difference, levels[:-1], levels[1:])),
        alone=tuple(difference(levels[0], level(frozenset((name,)))) for name in names),
        left_open=tuple(difference(level(whole - {name}), levels[-1]) for name in names),
    )


def difference(first: Level, second: Level) -> Level:
    """Return the first less the second, if both are known."""
    return None if first is None or second is None else first - second


def total(parts: Sequence[Level]) -> Level:
    """Return the sum, if every part is known."""
    known = [part for part in parts if part is not None]
    return sum(known) if len(known) == len(parts) else None


def in_order_sentence(path: AblationPath, quantity: Quantity, found: Account) -> str:
    """Return what each gap takes away, largest first."""
    parts = sorted(
        zip(path.names, found.in_order, strict=True),
        key=lambda part: -abs(part[1]) if part[1] is not None else 0.0,
    )
    least = _NOTHING * max(abs(value) for value in found.levels if value is not None)
    told = "; ".join(
        f"{name} nothing"
        if value is not None and abs(value) <= least
        else f"{name} {amount(quantity, value, unit=False)}"
        for name, value in parts
    )
    return (
        f"As it ships, {path.engine} is off by {amount(quantity, found.shipped)} in the "
        f"{quantity.label} of {path.scene.name}, and matched, at a timestep of "
        f"{path.matched_timestep:.2g} s, by {amount(quantity, found.remains)}; closing the gaps "
        f"in the order {', '.join(path.names)} takes away, largest first: {told}"
    )


def interaction_sentence(path: AblationPath, quantity: Quantity, found: Account) -> str:
    """Return how far the gaps alone are from the whole, and which gap is behind it most."""
    whole, alone, interaction = found.whole, total(found.alone), found.interaction
    if whole is None or alone is None or interaction is None:
        pairs = zip(path.names, found.alone, strict=True)
        unknown = ", ".join(name for name, value in pairs if value is None)
        return (
            f"Together they take away {amount(quantity, whole)}; how they interact is not known, "
            f"because the discrepancy with one gap closed alone is not, for {unknown}"
        )
    opening = (
        f"Closed one by one from the engine as it ships, they add up to {amount(quantity, alone)}"
    )
    if abs(interaction) <= _HARDLY * abs(whole):
        return f"{opening}, the whole to within {_HARDLY:.0%}, so that they hardly interact"
    told = (
        f"{opening}, where the whole is {amount(quantity, whole)}: an interaction of "
        f"{amount(quantity, interaction)}"
    )
    shifts = [
        (abs(late - early), name, early, late)
        for name, early, late in zip(path.names, found.alone, found.in_order, strict=True)
        if early is not None and late is not None
    ]
    if not shifts:
        return told
    _, name, early, late = max(shifts)
    return (
        f"{told}, most of it in {name}, which takes away {amount(quantity, early)} alone and "
        f"{amount(quantity, late)} after those before it"
    )


def amount(quantity: Quantity, value: Level, *, unit: bool = True) -> str:
    """Return a discrepancy in words; what is not known is said to be so."""
    if value is None:
        return "an unknown part"
    word, scale = _unit(quantity)
    number = f"{value * scale:+.3g}"
    return f"{number} {word}".rstrip() if unit else number


def _unit(quantity: Quantity) -> tuple[str, float]:
    """Return the unit in words and figures, and the factor from the unit of the column to it."""
    return {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}.get(quantity.unit, (quantity.unit, 1.0))


def waterfall_panel(path: AblationPath, quantity: Quantity, found: Account) -> Panel:
    """Return the waterfall of one quantity."""
    word, scale = _unit(quantity)

    def numbers(values: Sequence[Level]) -> Floats:
        return np.array([math.nan if value is None else value * scale for value in values])

    def takes_away(values: Sequence[Level], words: str) -> tuple[str, ...]:
        return tuple(
            f"{name}{words}: "
            + ("not known" if value is None else f"takes away {amount(quantity, value)}")
            for name, value in zip(path.names, values, strict=True)
        )

    levels, count = numbers(found.levels), len(path.names)
    places = np.arange(1.0, count + 1.0)
    return Panel(
        title=quantity.label.capitalize(),
        x_label="gaps, closed from left to right",
        y_label=f"off by [{word}]" if word else "off by",
        x_names=("as shipped", *path.names, "matched"),
        series=(
            Series(
                label="discrepancy",
                kind=path.engine,
                x=np.array((0.0, count + 1.0)),
                y=levels[[0, -1]],
                base=np.zeros(2),
                mark="bars",
            ),
            Series(
                label="taken away by a gap, in this order",
                kind=path.engine,
                x=places,
                y=levels[1:],
                base=levels[:-1],
                mark="bars",
                hover=takes_away(found.in_order, ""),
            ),
            Series(
                label="where it would end if it took away as much as alone",
                kind="reference",
                x=places,
                y=levels[:-1] - numbers(found.alone),
                mark="points",
                hover=takes_away(found.alone, ", alone"),
            ),
        ),
    )

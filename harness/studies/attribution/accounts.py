"""Who accounts for what: effects of the gaps in turn, alone and last, and their interaction.

With the discrepancy D(S) in which the set S of gaps is closed, and gaps 1 to n:

- the whole, D({}) - D({1..n}), is what closing all of them takes away;
- in order, D({1..k-1}) - D({1..k}), which sum to the whole: each level is added and taken once;
- alone, D({}) - D({k}), whose sum is off the whole by the *interaction*: what they do together;
- left open, D(all but k) - D(all), likewise, seen from the matched end.

A level that is not known leaves what rests on it unknown, and nothing else.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

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


def account(names: Sequence[str], level: Callable[[frozenset[str]], Level]) -> Account:
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

"""The report of a run: scores, and every survivor with the reason why it may live."""

import platform
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.mutation.mutants import Mutant
from tests.mutation.trial import Trial, Verdict

REASONS = Path(__file__).parent / "survivors.toml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reasons:
    """Why survivors may live: by module and line, of one change of it or of all."""

    told: Mapping[tuple[str, str, str], str]

    def of(self, mutant: Mutant) -> str:
        """Return the reason, empty if there is none."""
        place = (str(mutant.path), mutant.was)
        return self.told.get((*place, mutant.becomes), self.told.get((*place, ""), ""))


def reasons() -> Reasons:
    """Return the reasons that are committed."""
    told: dict[tuple[str, str, str], str] = {}
    for path, entries in tomllib.loads(REASONS.read_text(encoding="utf-8")).items():
        for entry in entries:
            told[path, entry["was"], entry.get("becomes", "")] = entry["reason"]
    return Reasons(told=told)


@dataclass(slots=True, kw_only=True)
class Tally:
    """What became of a module's mutants."""

    path: Path
    every: int
    tried: int = 0
    hung: int = 0
    seconds: float = 0.0
    survived: list[Mutant] = field(default_factory=list)

    def add(self, mutant: Mutant, trial: Trial) -> None:
        """Count a mutant."""
        self.tried += 1
        self.seconds += trial.seconds
        self.hung += trial.verdict is Verdict.HUNG
        if trial.verdict is Verdict.SURVIVED:
            self.survived.append(mutant)

    @property
    def killed(self) -> int:
        """How many the tests noticed."""
        return self.tried - len(self.survived)


_PREFACE = """\
One small change of a module at a time: an operator exchanged, a comparison moved or turned round, a
float doubled or halved, an integer moved by one, `min` for `max`, a loop left out. A mutant that
the tests of its module do not notice has survived. Those that hang or crash count as killed.
"""


def page(tallies: Sequence[Tally], known: Reasons, *, module: str, share: float, seed: int) -> str:
    """Return the report as Markdown."""
    drawn = f" --module {module}" if module else ""
    drawn += "" if share == 1.0 else f" --share {share:g} --seed {seed}"
    machine = f"{platform.platform()}, Python {platform.python_version()}"
    made = f"`python -m tests.mutation{drawn} --out reports/mutation.md`"
    lines = [
        f"# Mutants\n\nTried on {machine}. Written by {made}; `make mutants` tries all.\n",
        _PREFACE,
        "| module | mutants | tried | killed | of these hung | survived | score |",
        "|---|---:|---:|---:|---:|---:|---:|",
        *(_row(f"`{one.path}`", [one]) for one in tallies if one.tried),
        _row("all", tallies),
    ]
    lines += ["", "## Survivors", ""]
    survivors = [mutant for one in tallies for mutant in one.survived]
    if not survivors:
        lines.append("None.")
    groups: dict[tuple[str, str], list[Mutant]] = {}
    for mutant in survivors:
        reason = known.of(mutant) or "**no reason yet**"
        groups.setdefault((str(mutant.path), reason), []).append(mutant)
    for path in dict.fromkeys(path for path, _ in groups):
        lines += [f"### `{path}`", ""]
        for (place, reason), own in groups.items():
            if place == path:
                lines.append(f"- {reason}")
                lines += [f"  - line {one.line}: `{_change(one)}`" for one in own]
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def _row(name: str, own: Sequence[Tally]) -> str:
    every, tried = sum(one.every for one in own), sum(one.tried for one in own)
    killed, hung = sum(one.killed for one in own), sum(one.hung for one in own)
    score = f"{100.0 * killed / tried:.1f} %" if tried else ""
    return f"| {name} | {every} | {tried} | {killed} | {hung} | {tried - killed} | {score} |"


def _change(one: Mutant) -> str:
    """Return what changed of a line, with the words about it."""
    return f"{one.was}` becomes `{one.becomes}"

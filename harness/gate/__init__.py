"""The gate: results held against accepted ones, within a tolerance that was measured."""

from harness.gate.baseline import FILE, check_place, read_baseline, write_baseline
from harness.gate.comparison import Change, Difference, differences
from harness.gate.errors import BaselineError
from harness.gate.gate import owed
from harness.gate.measuring import count, measured
from harness.gate.reading import read, table
from harness.gate.reports import gate_keys, read_scores
from harness.gate.scores import Score, Scores, scored
from harness.gate.words import GATE, SIDES, changed, regressions, sentences

__all__ = [
    "FILE",
    "GATE",
    "SIDES",
    "BaselineError",
    "Change",
    "Difference",
    "Score",
    "Scores",
    "changed",
    "check_place",
    "count",
    "differences",
    "gate_keys",
    "measured",
    "owed",
    "read",
    "read_baseline",
    "read_scores",
    "regressions",
    "scored",
    "sentences",
    "table",
    "write_baseline",
]

"""The gate: results held against accepted ones, within a tolerance that was measured."""

from harness.gate.baseline import FILE, BaselineError, check_place, read_baseline, write_baseline
from harness.gate.comparison import Change, Difference, differences
from harness.gate.report import GATE, SIDES, changed, gate_report, regressions, sentences, table
from harness.gate.scores import Score, Scores, scored
from harness.gate.spread import count, measured
from harness.gate.stored_scores import gate_keys, read_scores, required_cases

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
    "gate_report",
    "measured",
    "read_baseline",
    "read_scores",
    "regressions",
    "required_cases",
    "scored",
    "sentences",
    "table",
    "write_baseline",
]

"""The attribution study: which of an engine's gaps causes which part of its discrepancy."""

from harness.studies.attribution.ablation import AblationPath, ablation_path, attribution_cases
from harness.studies.attribution.report import Attribution, attribution, attribution_report

__all__ = [
    "AblationPath",
    "Attribution",
    "ablation_path",
    "attribution",
    "attribution_cases",
    "attribution_report",
]

"""What a report looks like: artefacts in, one folder out."""

from harness.report.folder import check_writable
from harness.report.write import write_report

__all__ = ["check_writable", "write_report"]

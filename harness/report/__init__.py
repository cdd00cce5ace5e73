"""What a report looks like: artefacts in, one folder out."""

from harness.report.atomic_folder import check_writable
from harness.report.layout import Section
from harness.report.stored import read_report
from harness.report.write import write_chapters, write_report

__all__ = ["Section", "check_writable", "read_report", "write_chapters", "write_report"]

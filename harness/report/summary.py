"""The headline in Markdown, for pasting into a pull request."""

from harness.report.contents import Report
from harness.report.tables import markdown, plain_text


def summary(report: Report) -> str:
    """Return title, headline texts and tables, and one line of provenance."""
    opening = report.opening
    parts = [f"# {plain_text(report.title)}\n"]
    for text in opening.leading_texts.values():
        parts += [plain_text(paragraph) + "\n" for paragraph in text.text.split("\n\n")]
    for table in opening.leading_tables.values():
        parts.append(f"## {plain_text(table.title)}\n")
        parts.append(markdown(table))
    parts.append(_made_by(report) + "\n")
    return "\n".join(parts)


def _made_by(report: Report) -> str:
    told = report.provenance
    engines = (f"{n} {told.packages[n]}" for n in ("mujoco", "pybullet") if n in told.packages)
    words = [f"rockingcan {told.rockingcan}", *engines, f"python {told.python}"]
    if told.commit is not None:
        words.append(
            f"commit {told.commit.digest[:12]}{' + changes' if told.commit.changed else ''}"
        )
    return plain_text(", ".join([*words, told.processor, told.written]))

"""The pages of the field guide, and the tables of what they say in short."""

import re

from docs.formatting import ROOT, markdown

GUIDE = ROOT / "docs" / "field-guide"
PAGES = tuple(sorted(page for page in GUIDE.glob("*.md") if page.name != "README.md"))


def guide() -> dict[str, str]:
    """Return the complaints of the field guide, from what its pages say in short."""
    rows, still = [], []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        engine, _, complaint = text.splitlines()[0].removeprefix("# ").partition(": ")
        short = dict(re.findall(r"^- (status|exact|happens|cure): (.*)$", text, flags=re.MULTILINE))
        told = [short[part] for part in ("exact", "happens", "cure")]
        rows.append((f"[{complaint}]({page.name})", engine, short["status"], *told))
        if short["status"] == "happens":
            still.append((f"[{complaint}](docs/field-guide/{page.name})", engine, *told))
    parts = ("what is exact", "what happens", "what cures it")
    head, short_head = ("complaint", "engine", "status", *parts), ("complaint", "engine", *parts)
    return {
        "index": markdown(head, rows, words=len(head)),
        "table": markdown(short_head, still, words=len(short_head)),
        "pages": str(len(PAGES)),
        "still": str(len(still)),
    }

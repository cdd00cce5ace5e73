"""The pages of the field guide, and the tables of what they say in short."""

import re

from docs.formatting import ROOT, markdown

GUIDE = ROOT / "docs" / "field-guide"
PAGES = tuple(sorted(page for page in GUIDE.glob("*.md") if page.name != "README.md"))


def guide() -> dict[str, str]:
    """Return the complaints of the field guide, from what its pages say in short."""
    still, others = [], []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        engine, _, complaint = text.splitlines()[0].removeprefix("# ").partition(": ")
        short = dict(re.findall(r"^- (status|exact|happens|cure): (.*)$", text, flags=re.MULTILINE))
        linked = f"[{complaint}]({page.name})"
        told = [short[part] for part in ("exact", "happens", "cure")]
        if short["status"] == "happens":
            still.append((linked, engine, *told))
        else:
            others.append((linked, engine, short["status"], *told))
    parts = ("what is exact", "what happens", "what cures it")
    head, others_head = ("complaint", "engine", *parts), ("complaint", "engine", "status", *parts)
    return {
        "table": markdown(head, still, words=len(head)),
        "others": markdown(others_head, others, words=len(others_head)),
        "pages": str(len(PAGES)),
        "still": str(len(still)),
    }

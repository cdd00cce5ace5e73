"""What the theme writes into every page and axe-core complains of, mended in the pages."""

from pathlib import Path

from harness.core.errors import HarnessError
from harness.execution.atomic_write import write_atomically

MENDED = {
    # a heading has a level
    '<p class="caption" role="heading">': '<p class="caption">',
    # landmarks of one kind have names
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="Site">',
    '<aside class="toc-drawer">': '<aside class="toc-drawer" aria-label="On this page">',
    '<aside class="toc-drawer no-toc">': '<aside class="toc-drawer no-toc" aria-label="Page">',
    # a page has a title
    '<div id="search-results"></div>': '<h1>Search</h1><div id="search-results"> </div>',
    # a head of a column has words, or is none
    '<th class="head"><p></p></th>': '<td class="head"></td>',
    '<th class="head text-right"><p></p></th>': '<td class="head text-right"></td>',
}
"""What stands in the pages of the theme, and what is to stand there."""


def mend(site: Path) -> None:
    """Mend every page below a folder; those of an earlier build stay as they are.

    Raises
    ------
    HarnessError
        If no page has what is to be mended: a new version of the theme writes something else.
    """
    seen = set[str]()
    for page in sorted(site.rglob("*.html")):
        text = mended = page.read_text(encoding="utf-8")
        for was, to_be in MENDED.items():
            if was in mended or to_be in mended:
                seen.add(was)
            mended = mended.replace(was, to_be)
        if mended != text:
            write_atomically(page, mended.encode())
    if lost := sorted(set(MENDED) - seen):
        raise HarnessError(f"no page of the theme has `{lost[0]}`: see docs/site/mending.py")

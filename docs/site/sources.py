"""The sources of the site: the repository's texts, with links that lead within the site.

Texts stay where they read well in the repository; here each gets its place in the site, numbers
lose their marks, and links are written anew. What is linked and is no page, such as a table of
results, comes with the site as a file.
"""

import posixpath
import re
from collections.abc import Mapping
from pathlib import Path

from docs.formatting import ROOT
from docs.numbers import BUILT, MARKED, TEXTS
from harness.core.errors import HarnessError

SOURCE, SITE = BUILT / "source", BUILT / "site"
GALLERY = ROOT / "docs" / "gallery"
FILES = "files"
"""Folder of the site for what is linked and is no page."""

ELSEWHERE = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "harness/engines/SETTINGS.md": "settings.md",
    "reports/README.md": "how-to/read-a-report.md",
    "reports/audit.md": "audit.md",
    "reports/faults.md": "trials/faults.md",
    "reports/fuzz.md": "trials/fuzz.md",
    "reports/hostile.md": "trials/hostile.md",
    "reports/mutation.md": "trials/mutation.md",
    "reports/onsets.md": "trials/onsets.md",
}
"""Places in the site of texts that are not below `docs`; that of README is the first page."""

FOLDERS = ("docs/findings/README.md", "docs/field-guide/README.md")
"""First pages of folders that lead to all others there, which the site's contents do too."""

_CONTENTS = "\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n"

LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s]+)(\))")
_CODE = re.compile(r"(^```.*?^```|^~~~.*?^~~~|^ {4}[^\n]*$|`[^`\n]+`)", re.MULTILINE | re.DOTALL)


def places() -> dict[str, str]:
    """Return for each text of the repository, by its path there, its place in the site."""
    docs = {text: text.removeprefix("docs/") for text in TEXTS if text.startswith("docs/")}
    return {text: _index(place) for text, place in docs.items()} | ELSEWHERE


def _index(place: str) -> str:
    """Return the place of a text in the site: that of the first of a folder is `index.md`."""
    return re.sub(r"(^|/)README\.md$", r"\1index.md", place)


def relinked(text: str, folder: str, home: str, known: Mapping[str, str]) -> tuple[str, set[str]]:
    """Return a text with its links written anew, and the files that it links to.

    Parameters
    ----------
    text : str
        Markdown, without marks of numbers.
    folder : str
        Folder of the repository from which the links of the text lead.
    home : str
        Folder of the site in which the text is to stand.
    known : mapping of str to str
        As `places` returns it.

    Raises
    ------
    HarnessError
        If a link leads to nothing.
    """
    files = set[str]()

    def replace(found: re.Match[str]) -> str:
        target, _, anchor = found[2].partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return found[0]
        path = posixpath.normpath(posixpath.join(folder, target))
        if f"{path}/README.md" in known:
            path = f"{path}/README.md"
        place = known.get(path)
        if place is None:
            if not (ROOT / path).is_file():
                raise HarnessError(f"a link to `{found[2]}` leads to {path}, and there is none")
            files.add(path)
            place = f"{FILES}/{path}"
        way = posixpath.relpath(place, home or ".")
        return f"{found[1]}{way}{'#' * bool(anchor)}{anchor}{found[3]}"

    parts = _CODE.split(text)
    return "".join(p if n % 2 else LINK.sub(replace, p) for n, p in enumerate(parts)), files


def unmarked(text: str) -> str:
    """Return a text whose numbers have no marks."""
    return MARKED.sub(lambda found: found[3], text)


def gather(into: Path, pages: Mapping[str, str]) -> None:
    """Write all sources into a folder; what is there and has not changed stays as it is.

    Parameters
    ----------
    into : Path
    pages : mapping of str to str
        Further pages by their place: Markdown whose links lead as if from `docs`.

    Raises
    ------
    HarnessError
        If a link leads to nothing.
    """
    known = places() | {f"docs/{page}": _index(page) for page in pages}
    texts = {f"docs/{page}": (text, "docs") for page, text in pages.items()}
    linked = known | {"docs/gallery": "gallery/index.rst"}
    written = set[Path]()
    for origin, place in known.items():
        if origin == "README.md":
            continue  # the site has a first page of its own
        if origin in texts:
            text, folder = texts[origin]
        else:
            text, folder = (ROOT / origin).read_text(encoding="utf-8"), posixpath.dirname(origin)
            text += _CONTENTS * (origin in FOLDERS)
        text, files = relinked(unmarked(text), folder, posixpath.dirname(place), linked)
        written.add(_write(into / place, text.encode()))
        for file in files:
            written.add(_write(into / FILES / file, (ROOT / file).read_bytes()))
    for path in sorted(into.rglob("*")):
        kept = path in written or path.is_relative_to(into / "gallery")
        if path.is_file() and not kept:
            path.unlink()


def _write(path: Path, content: bytes) -> Path:
    """Write a file if it is another, so that Sphinx reads again only what changed."""
    if not path.is_file() or path.read_bytes() != content:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return path

"""Reading the paper's LaTeX source: equation numbers, and every number that it prints.

The source is not part of this repository. What is read from it is committed, the equation numbers
in `claims.toml` and the numbers in `literals.csv`, and compared with the source wherever that is at
hand.
"""

import re
from collections.abc import Iterator

_DISPLAY = r"align\*?|equation\*?"
_TOKEN = re.compile(
    rf"\\(?:(appendix)\b|(section)\{{|begin\{{({_DISPLAY}|subequations)\}}|(end)\{{subequations\}})"
)
_LABEL = re.compile(r"\\label\{([^}]*)\}")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?")
BEFORE, AFTER = 28, 12
"""Characters of context kept on either side of a number: enough to find it by searching."""


def folded(tex: str) -> str:
    """Return LaTeX without comments and labels, each stretch of white space as one blank."""
    plain = re.sub(r"(?<!\\)%.*", "", tex)
    return " ".join(re.sub(r"\\label\{[^}]*\}|\\nonumber", "", plain).split())


def _body(tex: str) -> str:
    plain = re.sub(r"(?<!\\)%.*", "", tex)
    return plain[plain.index(r"\begin{document}") :]


def _rows(display: str) -> list[str]:
    """Split a display at the line breaks that are not inside a matrix."""
    rows, depth = [""], 0
    for piece in re.split(r"(\\\\|\\begin\{[^}]*\}|\\end\{[^}]*\})", display):
        depth += piece.startswith(r"\begin") - piece.startswith(r"\end")
        if piece == r"\\" and not depth:
            rows.append("")
        else:
            rows[-1] += piece
    return rows if rows[-1].strip() else rows[:-1]


def numbered_rows(tex: str) -> Iterator[tuple[str, str]]:
    """Yield number and text of every numbered row of a display, as the SIAM class numbers them.

    By section, an appendix by its letter; the rows of `subequations` by letters, and the group
    itself with a text of its label alone. A row with a backslash-nonumber has none.

    Parameters
    ----------
    tex : str
        A LaTeX source, with its document environment.
    """
    body, place = _body(tex), 0
    section, equation, letter = 0, 0, -1
    appendix = False
    while match := _TOKEN.search(body, place):
        place = match.end()
        named = chr(ord("@") + section) if appendix else str(section)
        if match[1]:
            appendix, section = True, 0
        elif match[2]:
            section, equation = section + 1, 0
        elif match[4]:
            letter = -1
        elif match[3] == "subequations":
            equation, letter = equation + 1, 0
            if label := re.match(r"\s*\\label\{[^}]*\}", body[place:]):
                yield f"({named}.{equation})", label[0].strip()
        else:
            end = body.index(rf"\end{{{match[3]}}}", place)
            starred, rows = match[3].endswith("*"), _rows(body[place:end])
            place = end
            for row in rows:
                if starred or r"\nonumber" in row:
                    continue
                if letter < 0:
                    equation += 1
                    yield f"({named}.{equation})", row
                else:
                    letter += 1
                    yield f"({named}.{equation}{chr(ord('`') + letter)})", row


def numbers_of_labels(tex: str) -> dict[str, str]:
    """Return the number of each labelled equation."""
    return {label: number for number, row in numbered_rows(tex) for label in _LABEL.findall(row)}


def literals(tex: str) -> list[tuple[str, str]]:
    """Return every number in running text, footnotes and captions, with the words around it.

    Numbers in displays belong to the equation; those of subscripts, exponents, references, labels
    and the placing of figures are not statements. 0 and 1 are left out: they say where a condition
    or a limit is, or are part of a formula.

    Parameters
    ----------
    tex : str
        A LaTeX source.

    Returns
    -------
    list of (str, str)
        Number and quotation, in the order of the text.
    """
    text = _body(tex)
    text = re.sub(
        rf"\\begin\{{({_DISPLAY})\}}.*?\\end\{{\1\}}", " [display] ", text, flags=re.DOTALL
    )
    text = re.sub(r"\\begin\{(overpic|minipage)\}.*|\\put\(.*", " ", text)
    text = re.sub(
        r"\\(?:label|ref|eqref|cref|Cref|cite|email)(?:\[[^]]*\])?\{[^}]*\}", "[ref]", text
    )
    text = re.sub(r"10\^\{(-?\d+)\}", r"1e\1", text)
    text = re.sub(r"([\d.]+)\s*\\times\s*1e", r"\1e", text)
    text = re.sub(r"[_^]\{[^{}]*\}|[_^]\d", "", text)
    text = re.sub(r"(\\[A-Za-z]+)", r"\1 ", text)
    text = " ".join(text.split())
    return [
        (match[0], text[max(0, match.start() - BEFORE) : match.end() + AFTER])
        for match in _NUMBER.finditer(text)
        if match[0] not in {"0", "1"}
    ]

"""A picture for paper as an address that holds all of it, without what only makes it longer.

Percent signs take the place of base64, which makes a text a third longer. Of the picture itself
nothing is lost: line ends, names that nothing refers to, and what is said several times of how
things look are not seen.
"""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from urllib.parse import quote

_HEADER = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>|<!--.*?-->", re.DOTALL)
_TAG = re.compile("<[^<>]*>")
_BETWEEN = re.compile(r">\s*\n\s*<")
_PATH = re.compile(r'(?<= d=")[^"]*')
_LETTER = re.compile(r"\s*([A-Za-z])\s*")
_STYLE = re.compile(r'(?<= style=")[^"]*')
_STYLE_SIGN = re.compile(r"([:;])\s+")
_NAME = re.compile(r' id="([^"]*)"')
_TICK = re.compile(r'<path id="([\w-]+)" d="M[-\d. ]+L[-\d. ]+" style="stroke:[^"]*"/>')
"""A line of two points, which has nothing to fill, with a colour and a width of its own."""

_LINK = re.compile(r'((?:href="|url\()#)([\w-]+)')
_WHOLE_STYLE = re.compile(r' style="([^"<>&]*)"')
_USE = re.compile(r'(<use xlink:href="#([\w-]+)"[^>]*?) style="[^"]*"')

_PLAIN = " !$()*+,-./:;=?@[]_|~"
"""Signs that need no escape, neither in an address nor in an attribute of HTML."""


def address(svg: str) -> str:
    """Return an SVG picture as the address of an image."""
    return f"data:image/svg+xml,{quote(_short(svg), safe=_PLAIN)}"


def _short(svg: str) -> str:
    """Return the same picture in fewer letters."""
    text = _BETWEEN.sub("><", _HEADER.sub("", svg).strip())
    text = _in_tags(_PATH, lambda found: _LETTER.sub(r"\1", found[0]).strip(), text)
    text = _in_tags(_STYLE, lambda found: _STYLE_SIGN.sub(r"\1", found[0]), text)
    named = {name for _, name in _LINK.findall(text)}
    text = _in_tags(_NAME, lambda found: found[0] if found[1] in named else "", text)
    ticks = set(_TICK.findall(text))
    text = _in_tags(_USE, lambda found: found[1] if found[2] in ticks else found[0], text)
    return _classed(_renamed(text, sorted(named)))


def _in_tags(pattern: re.Pattern[str], change: Callable[[re.Match[str]], str], text: str) -> str:
    """Return a text with its tags changed: the words of a figure may look like attributes."""
    return _TAG.sub(lambda tag: pattern.sub(change, tag[0]), text)


def _renamed(text: str, names: Sequence[str]) -> str:
    """Return a picture with names of a few letters."""
    brief = {name: f"n{number}" for number, name in enumerate(names)}
    text = _in_tags(_NAME, lambda found: f' id="{brief[found[1]]}"', text)
    return _in_tags(_LINK, lambda found: f"{found[1]}{brief[found[2]]}", text)


def _classed(text: str) -> str:
    """Return a picture that says only once what several of its elements look like."""
    styles = Counter(_WHOLE_STYLE.findall("".join(_TAG.findall(text))))
    classes = {style: f"c{n}" for n, style in enumerate(s for s, k in styles.items() if k > 1)}
    rules = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    text = _in_tags(
        _WHOLE_STYLE,
        lambda found: f' class="{classes[found[1]]}"' if found[1] in classes else found[0],
        text,
    )
    return text.replace("</style>", f"{rules}</style>", 1)

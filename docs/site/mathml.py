"""Equations as MathML, which every browser draws without a script, a font or a network."""

from typing import Any

from latex2mathml.converter import convert
from sphinx.application import Sphinx


def mathml(latex: str, *, block: bool) -> str:
    """Return an equation as a MathML element.

    Parameters
    ----------
    latex : str
        What stands between the dollars.
    block : bool
        Whether it stands on lines of its own.
    """
    return str(convert(latex.strip(), display="block" if block else "inline"))


def _visit_inline(translator: Any, node: Any) -> None:  # noqa: ANN401 - docutils' own
    translator.body.append(mathml(node.astext(), block=False))
    _leave()


def _visit_block(translator: Any, node: Any) -> None:  # noqa: ANN401 - docutils' own
    translator.body.append(f'<div class="equation">{mathml(node.astext(), block=True)}</div>')
    _leave()


def _leave() -> None:
    """End a node here: the text in it is LaTeX."""
    from docutils import nodes  # noqa: PLC0415

    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Name the renderer, for `html_math_renderer`."""
    app.add_html_math_renderer("mathml", (_visit_inline, None), (_visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""Expressions changed in one place: the wrong claims of a form for which none are listed."""

from collections.abc import Iterator

import sympy as sp

from harness.paper.audit.symbols import ZERO, Expr, disagreement

HALF = sp.Rational(1, 2)
MOST = 6
"""Mutations kept of a form, spread over it: each costs an evaluation to forty digits."""


def mutated(form: Expr) -> list[Expr]:
    """Return forms that differ from a form in one place, at most `MOST`.

    A place is the sign or the coefficient of a term, a power, or an entry.

    Parameters
    ----------
    form : Expr
        An expression or a matrix of expressions, in which every entry is mutated in turn.
    """
    if isinstance(form, sp.MatrixBase):
        found = [other for place in range(len(form)) for other in with_entry(form, place)]
    else:
        found = list(_in_one_place(sp.sympify(form)))
    step = max(1, -(-len(found) // MOST))
    return [other for other in found[::step] if disagreement(other, form) >= ZERO]


def with_entry(form: Expr, place: int) -> Iterator[Expr]:
    """Yield the matrices in which one entry is mutated."""
    for entry in mutated(form[place]):
        other = form.as_mutable()
        other[place] = entry
        yield other


def _in_one_place(form: Expr) -> Iterator[Expr]:
    if form.is_zero:
        yield sp.Integer(1)
        return
    yield -form
    yield 2 * form
    for node in sp.preorder_traversal(form, keys=True):
        if node.is_Add:
            for term in node.args:
                yield form.xreplace({node: node - 2 * term})
                yield form.xreplace({node: node + term})
        elif node.is_Pow and node.exp.is_Integer:
            yield form.xreplace({node: node * node.base})

"""Mutations of a printed form: what a check that reads the claim has to refuse.

A mutation changes one place: the sign or the coefficient of one term, one power, one entry.
"""

from collections.abc import Iterator

import sympy as sp

from harness.paper.audit.symbols import ZERO, Expr, disagreement

MOST = 6
"""Mutations kept of a form, spread over it: each costs an evaluation to forty digits."""


def mutated(form: Expr) -> list[Expr]:
    """Return forms that differ from a form in one place, at most `MOST`.

    Parameters
    ----------
    form : Expr
        An expression or a matrix of expressions, in which every entry is mutated in turn.
    """
    if isinstance(form, sp.MatrixBase):
        everywhere = (x for place in range(len(form)) for x in _with_entry(form, place))
        return _spread(list(everywhere), form)
    return _spread(list(_in_one_place(sp.sympify(form))), form)


def _with_entry(form: Expr, place: int) -> Iterator[Expr]:
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


def _spread(found: list[Expr], form: Expr) -> list[Expr]:
    """Keep at most `MOST`, evenly over the list, and none that equals the form."""
    step = max(1, -(-len(found) // MOST))
    return [x for x in found[::step] if disagreement(x, form) >= ZERO]

"""The mutants of a module: one small change each, by the operators of Cosmic Ray.

Its full set replaces each binary operator by ten others and each comparison by seven, most of which
raise at once and show nothing. Here an operator is exchanged for its inverse, a comparison is moved
by one value or turned round, an integer is moved by one, and a float is doubled or halved, as a
constant is that somebody tunes.
"""

import ast
import difflib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast, is_number
from cosmic_ray.mutating import mutate_code
from cosmic_ray.operators.operator import Example, Operator
from cosmic_ray.plugins import get_operator
from parso.python import tree

EXCHANGED = (
    *("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "FloorDiv_Mul", "Mod_Mul"),
    *("BitAnd_BitOr", "BitOr_BitAnd"),
)
COMPARED = (
    *("Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE", "GtE_Gt", "GtE_Lt"),
    *("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"),
)
_NAMES = (
    *(f"ReplaceBinaryOperator_{pair}" for pair in EXCHANGED),
    *(f"ReplaceComparisonOperator_{pair}" for pair in COMPARED),
    *("ReplaceUnaryOperator_USub_UAdd", "ReplaceUnaryOperator_Delete_Not"),
    *("ReplaceAndWithOr", "ReplaceOrWithAnd", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue"),
    *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak"),
    *("ExceptionReplacer", "ZeroIterationForLoop"),
)


class NumberChanged(Operator):
    """A float doubled and halved; an integer, or a zero, one more and one less."""

    def mutation_positions(self, node: tree.PythonNode) -> Iterator[tuple[object, object]]:
        """Yield the place of a number, twice."""
        if is_number(node):
            yield from [(node.start_pos, node.end_pos)] * 2

    def mutate(self, node: tree.Number, index: int) -> tree.Number:
        """Return the changed number."""
        value = ast.literal_eval(node.value)
        if isinstance(value, float) and value:
            changed = value * (2.0, 0.5)[index]
        else:
            changed = value + (1, -1)[index]
        return tree.Number(repr(changed), node.start_pos, prefix=node.prefix)

    @classmethod
    def examples(cls) -> Iterable[Example]:
        """Return what it does."""
        return (Example("x = 0.5", "x = 1.0"), Example("x = 2", "x = 1", occurrence=1))


class ExtremumSwapped(Operator):
    """The smaller for the larger, and the other way."""

    def mutation_positions(self, node: tree.PythonNode) -> Iterator[tuple[object, object]]:
        """Yield the place of a name that is called."""
        if isinstance(node, tree.Name) and node.value in {"min", "max"}:
            yield node.start_pos, node.end_pos

    def mutate(self, node: tree.Name, index: int) -> tree.Name:
        """Return the other name."""
        del index
        other = {"min": "max", "max": "min"}[node.value]
        return tree.Name(other, node.start_pos, prefix=node.prefix)

    @classmethod
    def examples(cls) -> Iterable[Example]:
        """Return what it does."""
        return (Example("x = max(1, 2)", "x = min(1, 2)"),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mutant:
    """A changed module.

    Parameters
    ----------
    path : Path
    line : int
        Of the change.
    was, becomes : str
        That line, without indentation.
    source : str
        The whole module.
    """

    path: Path
    line: int
    was: str
    becomes: str
    source: str


def sources(path: Path) -> tuple[str, ...]:
    """Return every mutant of a module, each once."""
    source = path.read_text(encoding="utf-8")
    parsed = get_ast(source)
    operators = [get_operator(f"core/{name}")() for name in _NAMES]
    found: dict[str, None] = {}
    for operator in (*operators, NumberChanged(), ExtremumSwapped()):
        count = sum(1 for node in ast_nodes(parsed) for _ in operator.mutation_positions(node))
        for occurrence in range(count):
            changed = mutate_code(source, operator, occurrence)
            if changed is not None and _differs(source, changed):
                found[changed] = None
    return tuple(found)


def _differs(source: str, changed: str) -> bool:
    """Whether a change is one of what is computed: not of an annotation or a dataclass's flags."""
    try:
        return _computed(source) != _computed(changed)
    except SyntaxError:  # the two stars before keywords are taken for a power
        return False


@lru_cache(maxsize=2)
def _computed(source: str) -> str:
    """Return what a module computes."""
    parsed = ast.parse(source)
    for node in ast.walk(parsed):
        for name in ("annotation", "returns"):
            if getattr(node, name, None) is not None:
                setattr(node, name, ast.Constant(value=None))
        if isinstance(node, ast.ClassDef):
            node.decorator_list = []
        if isinstance(node, ast.arguments):  # the bare star is taken for a product
            node.args = [*node.posonlyargs, *node.args, *node.kwonlyargs]
            node.defaults = [*node.defaults, *(one for one in node.kw_defaults if one)]
            node.posonlyargs, node.kwonlyargs, node.kw_defaults = [], [], []
    return ast.dump(parsed)


def mutant(path: Path, changed: str) -> Mutant:
    """Return a mutant with the line that it changes."""
    source = path.read_text(encoding="utf-8")
    before, after = source.splitlines(), changed.splitlines()
    matcher = difflib.SequenceMatcher(a=before, b=after, autojunk=False)
    _, start, stop, first, last = next(op for op in matcher.get_opcodes() if op[0] != "equal")
    return Mutant(
        path=path,
        line=start + 1,
        was=" ".join(line.strip() for line in before[start:stop]),
        becomes=" ".join(line.strip() for line in after[first:last]),
        source=changed,
    )

"""Artefacts that a study gives to the report: tables, figures, replays and prose.

An artefact knows nothing of files. A figure is data with its axes; the report chooses the library
that draws it.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import PlainSerializer, PlainValidator

from harness.core.plain_json import Floats, Words, is_missing, to_plain
from harness.core.verdict import Status, Verdict

if TYPE_CHECKING:
    import pandas as pd

    DataFrame: TypeAlias = pd.DataFrame
else:
    DataFrame = Any
    """Pandas takes half a second to import, in each worker that unpickles a task of a study."""


def _encode_cell(value: object) -> object:
    if is_missing(value):
        return None
    if isinstance(value, Verdict):
        return {"status": value.status.name, "text": value.text}
    if isinstance(value, float) and math.isinf(value):
        return {"inf": 1 if value > 0.0 else -1}
    return to_plain(value)


def _decode_cell(stored: object) -> object:
    if not isinstance(stored, dict):
        return stored
    if "inf" in stored:
        return stored["inf"] * math.inf
    return Verdict(Status[stored["status"]], stored["text"])


def _encode_frame(frame: DataFrame) -> dict[str, Any]:
    """Return each column with its type; infinite and missing cells have encodings of their own."""
    return {
        str(name): {
            "dtype": str(frame[name].dtype),
            "values": [_encode_cell(value) for value in frame[name].tolist()],
        }
        for name in frame.columns
    }


def _decode_frame(stored: Any) -> DataFrame:  # noqa: ANN401 - whatever JSON holds
    import pandas as pd  # noqa: PLC0415

    return pd.DataFrame(
        {
            name: pd.Series([_decode_cell(v) for v in column["values"]], dtype=column["dtype"])
            for name, column in stored.items()
        }
    )


Frame = Annotated[DataFrame, PlainValidator(_decode_frame), PlainSerializer(_encode_frame)]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Series:
    """One curve, cloud of points or row of bars.

    Parameters
    ----------
    label : str
        Text of the legend; series of the same label in one figure share a legend entry.
    kind : str
        An engine's name, which sets the colour of the curve; "reference" is the truth.
    x, y : ndarray, shape (n,)
        In the units that the panel's labels state; NaN breaks the line.
    mark : str
        "line", "points", "both", or "bars": upright at x, from `base` to y.
    dashed : bool
    hover : tuple of str
        A text for each point, or nothing.
    base : ndarray, shape (n,), optional
        Where bars begin; at zero if left out.
    """

    label: str
    kind: str
    x: Floats
    y: Floats
    mark: Literal["line", "points", "both", "bars"] = "line"
    dashed: bool = False
    hover: tuple[str, ...] = ()
    base: Floats | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Heatmap:
    """A quantity over a rectangle of cells, shown by colour.

    Parameters
    ----------
    label : str
        Of the quantity, with the unit in brackets.
    x, y : ndarray, shape (columns + 1,), (rows + 1,)
        Edges of the cells, increasing.
    z : ndarray, shape (rows, columns)
        NaN leaves a cell blank.
    signed : bool
        Whether the colours change at zero.
    """

    label: str
    x: Floats
    y: Floats
    z: Floats
    signed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panel:
    """One pair of axes.

    Parameters
    ----------
    title, x_label, y_label : str
        With the unit in brackets.
    series : tuple of Series
    log_x, log_y : bool
    equal : bool
        Same scale on both axes: for a curve in the plane.
    x_names : tuple of str
        Labels at 0, 1, 2, ... of the horizontal axis in place of numbers.
    y_names : tuple of str
        The same of the vertical axis, upwards, of a panel with `heat`.
    x_range, y_range : tuple of 2 floats, optional
        Ends of the axes, for figures with equal axes; from the data if left out.
    heat : Heatmap, optional
        Drawn below the series.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    log_x: bool = False
    log_y: bool = False
    equal: bool = False
    x_names: tuple[str, ...] = ()
    y_names: tuple[str, ...] = ()
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    heat: Heatmap | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Figure:
    """Panels side by side on one topic, with two sentences on what they show.

    Parameters
    ----------
    name : str
        Lower-case words joined by dashes; unique within a report; the name of its file.
    title : str
    seen : str
        Two plain sentences made from the numbers.
    panels : tuple of Panel
    columns : int
        Panels in a row on a wide screen.
    scene : str
        Scene in whose section the figure stands; empty for a figure over all scenes.
    cases : tuple of str
        Digests of the cases whose curves are drawn.
    """

    name: str
    title: str
    seen: str
    panels: tuple[Panel, ...]
    columns: int = 2
    scene: str = ""
    cases: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """A tidy table: a row a case (or a bounce, or a property), units in the column names.

    Parameters
    ----------
    name, title : str
    frame : DataFrame
    columns : mapping of str to str
        Meaning of each column, in one sentence.
    shown : tuple of str
        Columns that the page shows, in this order; the files have all.
    scene : str
        As for `Figure`.
    verdicts, cases : mapping of str to str
        For a column of numbers, the column with their verdicts in words, and the one with the
        digests of the cases that made them.
    """

    name: str
    title: str
    frame: Frame
    columns: Words
    shown: tuple[str, ...] = field(default=())
    scene: str = ""
    verdicts: Words = field(default_factory=dict)
    cases: Words = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table, declared once; frame, dictionary, page, terminal and JSON follow.

    Parameters
    ----------
    name : str
        Words joined by underscores, the unit last: "angle_of_turn_deg".
    meaning : str
        One sentence for the dictionary of columns.
    value : str or callable, optional
        From the record of a row to its cell: a function, or the path to an attribute or a method
        without parameters, such as "limit.value", which is None where a part of it is None; the
        path `name` if left out. A record that is a mapping with the key `name` gives the cell.
    shown : bool
        Whether the page and the terminal show it; files have every column.
    verdict, case : str
        Of a column of numbers: the column with their verdicts, and the one with the digests of the
        cases that made them; empty if there is none.
    """

    name: str
    meaning: str
    value: str | Callable[[Any], object] | None = None
    shown: bool = True
    verdict: str = ""
    case: str = ""

    def of(self, value: str | Callable[[Any], object]) -> "Column":
        """Return the column for records whose cell is found elsewhere."""
        return replace(self, value=value)

    def cell(self, record: object) -> object:
        """Return the cell of a record; None if a mapping has no such key."""
        if isinstance(record, Mapping) and self.name in record:
            return record[self.name]
        if callable(self.value):
            return self.value(record)
        value: object = record
        for part in (self.value or self.name).split("."):
            value = value.get(part) if isinstance(value, Mapping) else getattr(value, part)
            if value is None:
                return None
        return value() if callable(value) else value


def table_of(
    name: str,
    title: str,
    columns: Sequence[Column],
    records: Iterable[object],
    **fields: Any,  # noqa: ANN401 - as `Table` has them
) -> Table:
    """Return a table with a row for each record.

    Parameters
    ----------
    name, title : str
    columns : sequence of Column
    records : iterable
        Objects or mappings from which the columns read their cells.
    **fields
        Further fields of `Table`, such as the scene.
    """
    import pandas as pd  # noqa: PLC0415

    rows = [[column.cell(record) for column in columns] for record in records]
    return Table(
        name=name,
        title=title,
        frame=pd.DataFrame(rows, columns=[column.name for column in columns]),
        columns={column.name: column.meaning for column in columns},
        shown=tuple(column.name for column in columns if column.shown),
        verdicts={column.name: column.verdict for column in columns if column.verdict},
        cases={column.name: column.case for column in columns if column.case},
        **fields,
    )


def rows_of(columns: Sequence[Column], records: Iterable[object]) -> list[dict[str, Any]]:
    """Return each record as a dictionary by column name, as `--json` prints it."""
    return [{column.name: column.cell(record) for column in columns} for record in records]


@dataclass(frozen=True, slots=True, kw_only=True)
class Prose:
    """A few sentences, made from the numbers."""

    name: str
    title: str
    text: str
    scene: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """One can in a replay, with its angles and its contact point in each frame.

    Parameters
    ----------
    label, kind : str
        As for `Series`.
    phi, psi, theta : ndarray, shape (n,)
        rad, without jumps.
    contact : ndarray, shape (n, 2)
        Lowest point of the rim, from above, m.
    height : ndarray, shape (n,)
        Of that point above the plane, m, of a can that flies; else zero.
    """

    label: str
    kind: str
    phi: Floats
    psi: Floats
    theta: Floats
    contact: Floats
    height: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Replay:
    """Cans that roll side by side, frame by frame.

    Parameters
    ----------
    name, title, seen, scene : str
        As for `Figure`.
    radius, height : float
        Of the can, m.
    time : ndarray, shape (n,)
        Of the frames, s; dense during a bounce, which the replay shows in slow motion.
    tilt : float
        Factor by which phi is drawn larger than it is, to be visible.
    """

    name: str
    title: str
    seen: str
    radius: float
    height: float
    time: Floats
    bodies: tuple[Body, ...]
    tilt: float = 1.0
    scene: str = ""


Artefact = Figure | Table | Prose | Replay

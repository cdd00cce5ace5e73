"""What a notebook shows of a result: a table, and a figure that needs no script.

Jupyter runs no script of a notebook that it does not trust, and a network may be missing: so the
figure is the picture for paper, and the interactive one is asked for with `harness.plot`.
"""

from jinja2 import Environment

from harness.core.report_model import Figure, Table
from harness.report.matplotlib_renderer import address, render
from harness.report.simplify_curves import PAPER, simplify
from harness.report.style import palette
from harness.report.tables import grid

_TABLE = """\
<div style="overflow-x: auto">
<table>
<caption style="text-align: left; caption-side: top">{{ table.title }}</caption>
<thead><tr>{% for head in table.heads %}
<th style="text-align: {{ "right" if head.numeric else "left" }}" title="{{ head.meaning }}">
{{- head.words }}{% if head.unit %} [{{ head.unit }}]{% endif %}</th>{% endfor %}</tr></thead>
{% for group in (table.rows, table.apart) if group %}<tbody>
{%- if not loop.first %}
<tr><th colspan="{{ table.heads|length }}" style="text-align: left">{{ table.why_apart }}</th></tr>
{%- endif %}{% for row in group %}
<tr>{% for cell in row %}
<td style="text-align: {{ "right; white-space: nowrap" if cell.numeric else "left" }}
{%- if cell.long %}; min-width: 16em{% endif %}"
{%- if cell.exact %} title="{{ cell.exact }}"{% endif %}>{{ cell.text }}</td>{% endfor %}</tr>
{%- endfor %}
</tbody>{% endfor %}
</table>
</div>
"""

_FIGURE = """\
<figure style="margin: 0.5em 0">
<img src="{{ picture }}" alt="{{ figure.title }}" style="max-width: 100%; background: white">
<figcaption>{{ figure.title }}{% if figure.seen %}. {{ figure.seen }}{% endif %}</figcaption>
</figure>
"""


def table_html(table: Table) -> str:
    """Return a table as HTML that stands in a page of its own or in a notebook."""
    return _filled(_TABLE, table=grid("table", table, ()))


def figure_html(figure: Figure) -> str:
    """Return a figure as HTML that stands in a page of its own or in a notebook."""
    inks = palette(series.kind for panel in figure.panels for series in panel.series)
    picture = address(render(simplify(figure, PAPER), inks).svg)
    return _filled(_FIGURE, figure=figure, picture=picture)


def _filled(template: str, **parts: object) -> str:
    return Environment(autoescape=True).from_string(template).render(parts)

"""Templates of the site: pages in Markdown as they are, pieces in HTML with every text escaped."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape


def render(template: str, **parts: object) -> str:
    """Return a template with its parts filled in; a part that is missing is an error.

    Parameters
    ----------
    template : str
        Name of a file in `docs/site/templates`; texts are escaped where it ends in ``.html``.
    **parts : object
    """
    return _environment().get_template(template).render(parts)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        undefined=StrictUndefined,
        autoescape=select_autoescape(["html"]),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["exactly"] = lambda value: "" if value is None else f"{value:.6g}"
    return environment

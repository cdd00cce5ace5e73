"""Settings of Sphinx for the site; `python -m docs.site` gathers its sources and builds it."""

import re
from importlib.resources import files

from sphinx.application import Sphinx

from docs.site.sources import GALLERY
from harness.core.provenance import version_of

project = "rockingcan"
author = "the rockingcan authors"
release = version_of("rockingcan")
html_title = f"rockingcan {release}"
html_show_copyright = False
html_last_updated_fmt = None  # the same sources give the same pages

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "docs.site.mathml",
]
default_role = "literal"  # docstrings put code between single backticks
nitpicky = False  # types of numpy, pandas and plotly have no page here
suppress_warnings = ["config.cache"]  # the gallery's order is a class

myst_enable_extensions = ["attrs_block", "attrs_inline", "colon_fence", "dollarmath"]
myst_heading_anchors = 4
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False

html_theme = "furo"
html_static_path = [
    "site/static",
    str(files("ziamath") / "fonts" / "STIXTwoMath-Regular.ttf"),  # under the SIL Open Font License
]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_search_summary = False  # it would be fetched, which a page from disk may not
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0a5a91", "color-brand-content": "#0a5a91"},
    "dark_css_variables": {"color-brand-primary": "#7cc4f5", "color-brand-content": "#7cc4f5"},
}
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"

sphinx_gallery_conf = {
    "examples_dirs": str(GALLERY),
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 3600,  # s
    "write_computation_times": False,  # the same sources give the same pages
    "show_signature": False,
    "remove_config_comments": True,
    "plot_gallery": True,
}


def plain_bars(
    _app: object, _what: str, _name: str, _value: object, _options: object, lines: list[str]
) -> None:
    """Keep the bars of an absolute value in a docstring, which mean a substitution to docutils."""
    code = re.compile(r"(`[^`]*`)")
    for n, line in enumerate(lines):
        pieces = code.split(line)
        lines[n] = "".join(p if k % 2 else p.replace("|", r"\|") for k, p in enumerate(pieces))


def setup(app: Sphinx) -> None:
    """Hear of each docstring."""
    app.connect("autodoc-process-docstring", plain_bars)

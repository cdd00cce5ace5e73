"""Build the site: ``make docs``. It opens from disk: ``docs/_build/site/index.html``."""

import shutil
import sys

from sphinx.application import Sphinx

from docs.formatting import ROOT
from docs.numbers import BUILT
from docs.site.mending import mend
from docs.site.pages import pages
from docs.site.sources import SITE, SOURCE, gather
from harness.core.errors import HarnessError


def main() -> int:
    """Gather the sources and build the pages; return 0, or 1 where Sphinx warned of something."""
    gather(SOURCE, pages())
    shutil.rmtree(SITE, ignore_errors=True)  # whose pages have the contents of the last build
    app = Sphinx(
        srcdir=SOURCE,
        confdir=ROOT / "docs",
        outdir=SITE,
        doctreedir=BUILT / "doctrees",
        buildername="html",
        freshenv=True,
        warningiserror=True,
    )
    app.build()
    if app.statuscode == 0:
        mend(SITE)
    return int(app.statuscode)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except HarnessError as error:
        sys.exit(f"docs.site: {error}")

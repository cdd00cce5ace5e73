"""The gallery: every figure of the paper drawn from our own solutions."""

from collections.abc import Callable

from harness.core.report_model import Figure, Prose
from harness.paper.gallery.approximations import exact_and_reduced, family, inner_and_outer
from harness.paper.gallery.energy import contours, surface, wells
from harness.paper.gallery.motion import constants, equilibria, fall, hypergeometric, time_series
from harness.paper.gallery.phenomena import friction, loci, sign_map

ABOUT = Prose(
    name="summary",
    title="About these figures",
    text=(
        "Each figure of Collins, Hall and Hogan, The rocking can (arXiv:2302.08335), drawn again "
        "from our own solutions of the same release, and named after the paper's label. Where a "
        "caption's number differs from the paper's, the audit says why. The last figure is not in "
        "the paper: where there is a second well, which the paper does not mention."
    ),
)
FIGURES: tuple[Callable[[], Figure], ...] = (
    fall,
    time_series,
    equilibria,
    hypergeometric,
    constants,
    exact_and_reduced,
    family,
    inner_and_outer,
    sign_map,
    loci,
    friction,
    surface,
    contours,
    wells,
)
"""In the order of the paper."""

__all__ = ["ABOUT", "FIGURES"]

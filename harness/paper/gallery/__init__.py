"""The gallery: every figure of the paper drawn from our own solutions."""

from harness.paper.gallery.figures import ABOUT, FIGURES, gallery

__all__ = ["ABOUT", "FIGURES", "gallery"]

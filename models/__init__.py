"""The simulated scene: the can, its release, its effects, and the models that engines open."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

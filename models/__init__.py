"""The simulated scene: the can, its release, its effects, and the models that engines open."""

import sys

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# The folders of model files are no packages: importing one would hide the function of its name.
sys.modules.update(dict.fromkeys(("models.mjcf", "models.urdf")))  # type: ignore[arg-type]

"""The openable model files: one MJCF and one URDF for each scene of the catalogue.

`python -m models.export` writes them anew into `models/mjcf` and `models/urdf`; a test holds them
equal to what is generated.
"""

from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from models.catalogue import load, names
from models.to_mjcf import mjcf
from models.to_urdf import ground_urdf, urdf


def model_files() -> Iterator[tuple[PurePosixPath, str]]:
    """Yield the path of each model file, relative to the package, and its text."""
    yield PurePosixPath("urdf/ground.urdf"), ground_urdf()
    for name in names():
        scene = load(name)
        yield PurePosixPath(f"mjcf/{name}.xml"), mjcf(scene)
        yield PurePosixPath(f"urdf/{name}.urdf"), urdf(scene)


def write_model_files(package: Path) -> None:
    """Write every model file into the package folder, and remove those of scenes that are gone."""
    wanted = {package / path: text for path, text in model_files()}
    for folder in sorted({path.parent for path in wanted}):
        folder.mkdir(exist_ok=True)
        for stale in sorted(set(folder.iterdir()) - wanted.keys()):
            stale.unlink()
    for path, text in wanted.items():
        path.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    write_model_files(Path(__file__).parent)

# Written by script/make_stubs.
from collections.abc import Callable, Sequence
import os

import partpose.pipeline


class EngineOptions:
    """What the Engine may be told."""

    def __init__(self, *, min_score: float = ...) -> None: ...

    @property
    def min_score(self) -> float:
        """A candidate that agrees less with the frame is not believed, 0 to 1."""

    def __repr__(self) -> str: ...

class Engine(partpose.pipeline.PartRecognizer):
    """
    Recognizes parts by their shape alone: depth templates find them, a distance field and rendering decide. All objects of a frame are in the detections.
    """

    def __init__(self, catalogue: partpose.pipeline.Catalogue, options: EngineOptions = ...) -> None: ...

    @staticmethod
    def from_files(paths: Sequence[str | os.PathLike[str]], options: EngineOptions = ..., cache_folder: str | os.PathLike[str] | None = None, progress: Callable[[str, int, int], object] | None = None) -> Engine:
        """
        Of model files, or folders of them. The catalogue is made on first use and kept under the cache folder.
        """

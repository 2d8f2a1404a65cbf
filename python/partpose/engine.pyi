# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import os
from typing import Any, Self

import partpose.io
import partpose.pipeline


class EngineOptions:
    """
    What the Engine may be told.

    min_score = 0.5: least probability that a part is what is seen for it to be believed, 0 to 1
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, min_score: float = 0.5) -> None: ...

    @property
    def min_score(self) -> float:
        """
        least probability that a part is what is seen for it to be believed, 0 to 1
        """

    @min_score.setter
    def min_score(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Engine(partpose.pipeline.PartRecognizer):
    """
    Recognizes parts by their shape alone: depth templates find them, a distance field and rendering decide. All objects of a frame are in the detections.
    """

    def __init__(self, catalogue: partpose.pipeline.Catalogue, options: EngineOptions = ...) -> None: ...

    @staticmethod
    def from_files(paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], options: EngineOptions = ..., progress: Callable[[str, int, int], object] | None = None) -> Engine:
        """Of model files, or folders of them. Nothing is kept on disk."""

    def add(self, part: partpose.io.NamedMesh) -> None:
        """
        One more part; the others are not touched. Raises Error when there is one of that name. Not while another thread recognizes.
        """

    def remove(self, name: str) -> None:
        """
        Raises Error when there is no part of that name, or no other. Not while another thread recognizes.
        """

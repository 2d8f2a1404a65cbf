# Written by script/make_stubs.
from typing import Annotated, Any

import numpy
import numpy.typing
from numpy.typing import NDArray


class DescriptorIndex:
    """Histograms of equal length, searched exhaustively by L1 distance."""

    def __init__(self, bins: int) -> None: ...

    def add(self, histogram: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None,))]) -> None:
        """A row more."""

    def bins(self) -> int:
        """The length of a row."""

    def __len__(self) -> int: ...

    def row(self, index: int) -> Annotated[NDArray[numpy.float32], dict(shape=(None,))]:
        """A copy of one histogram."""

    def nearest(self, histogram: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None,))], k: int) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.float32], dict(shape=(None,))]]:
        """Rows and distances, nearest first."""

# Written by script/make_stubs.
from collections.abc import Callable
import os


class ReportSummary:
    """What write_report wrote."""

    @property
    def frames(self) -> int:
        """That the page shows."""

    @property
    def bytes(self) -> int:
        """Of the file."""

    @property
    def thinned(self) -> bool:
        """Some frame's points or depth are not shown in full."""

    @property
    def problems(self) -> list[str]:
        """Files that could not be read."""

    def __repr__(self) -> str: ...

def write_report(folder: str | os.PathLike[str], file: str | os.PathLike[str], title: str = '', limit_deg: float = 15.0, limit_mm: float = 15.0, most_bytes: int = 28000000, progress: Callable[[str, int, int], object] | None = None) -> ReportSummary:
    """
    Makes one self-contained HTML page of an output folder: all frames in numbers, each frame in 3-D. A pose is right below both limits; points and depth images are thinned so that the file stays below `most_bytes`.
    """

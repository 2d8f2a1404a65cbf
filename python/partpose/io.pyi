# Written by script/make_stubs.
from collections.abc import Mapping
import enum
import os
import pathlib
from typing import Annotated, Any, Self, overload

import numpy
from numpy.typing import NDArray

import partpose.core


def read_stl(path: str | os.PathLike[str]) -> partpose.core.TriangleMesh:
    """A binary or ASCII STL file in mm, equal vertices merged."""

def parse_stl(content: bytes, name: str) -> partpose.core.TriangleMesh:
    """The same from the content of a file; `name` is what errors call it."""

def write_stl(path: str | os.PathLike[str], mesh: partpose.core.TriangleMesh) -> None:
    """Binary, in mm."""

def read_ply_mesh(path: str | os.PathLike[str]) -> partpose.core.TriangleMesh:
    """The mesh of a PLY file in mm."""

def write_ply_mesh(path: str | os.PathLike[str], mesh: partpose.core.TriangleMesh) -> None:
    """ASCII PLY in mm with vertex normals."""

def read_ply(path: str | os.PathLike[str]) -> partpose.core.PointCloud:
    """The vertices of a PLY file in mm."""

def write_ply(path: str | os.PathLike[str], cloud: partpose.core.PointCloud) -> None:
    """Binary PLY in mm."""

def read_pcd(path: str | os.PathLike[str]) -> partpose.core.PointCloud:
    """A PCD file in mm."""

class PcdEncoding(enum.Enum):
    """How a PCD file stores its points."""

    ascii = 0

    binary = 1

    binary_compressed = 2

def write_pcd(path: str | os.PathLike[str], cloud: partpose.core.PointCloud, encoding: PcdEncoding = PcdEncoding.binary_compressed) -> None:
    """PCD 0.7 in mm."""

def read_cloud(path: str | os.PathLike[str]) -> partpose.core.PointCloud:
    """A point cloud file in mm, by its extension."""

def model_files(file_or_folder: str | os.PathLike[str]) -> list[pathlib.Path]:
    """The file itself, or a folder's model files by name."""

def read_depth_png(path: str | os.PathLike[str], depth_scale_mm: float) -> partpose.core.DepthImage:
    """A 16-bit greyscale PNG."""

def write_depth_png(path: str | os.PathLike[str], depth: partpose.core.DepthImage, depth_scale_mm: float) -> None:
    """Depth rounded to the nearest unit of depth_scale_mm mm."""

def read_png(path: str | os.PathLike[str]) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None, 3))]:
    """An 8-bit PNG as height x width x 3."""

def write_png(path: str | os.PathLike[str], pixels: Annotated[NDArray[numpy.uint8], dict(shape=(None, None, 3), order='C', device='cpu', writable=False)]) -> None:
    """Height x width x 3, 8-bit RGB."""

class CameraFile:
    """
    What a camera JSON says.

    width: image width [px]
    height: image height [px]
    fx: focal length in x [px]
    fy: focal length in y [px]
    cx: principal point in x [px], pixel centres at integers
    cy: principal point in y [px], pixel centres at integers
    depth_scale_mm: length of one unit of the depth image [mm]
    baseline_mm: distance between a stereo camera's imagers [mm]
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, width: int = ..., height: int = ..., fx: float = ..., fy: float = ..., cx: float = ..., cy: float = ..., depth_scale_mm: float = ..., baseline_mm: float | None = ...) -> None: ...

    @property
    def width(self) -> int:
        """image width [px]"""

    @width.setter
    def width(self, value: int, /) -> None: ...

    @property
    def height(self) -> int:
        """image height [px]"""

    @height.setter
    def height(self, value: int, /) -> None: ...

    @property
    def fx(self) -> float:
        """focal length in x [px]"""

    @fx.setter
    def fx(self, value: float, /) -> None: ...

    @property
    def fy(self) -> float:
        """focal length in y [px]"""

    @fy.setter
    def fy(self, value: float, /) -> None: ...

    @property
    def cx(self) -> float:
        """principal point in x [px], pixel centres at integers"""

    @cx.setter
    def cx(self, value: float, /) -> None: ...

    @property
    def cy(self) -> float:
        """principal point in y [px], pixel centres at integers"""

    @cy.setter
    def cy(self, value: float, /) -> None: ...

    @property
    def depth_scale_mm(self) -> float:
        """length of one unit of the depth image [mm]"""

    @depth_scale_mm.setter
    def depth_scale_mm(self, value: float, /) -> None: ...

    @property
    def baseline_mm(self) -> float | None:
        """distance between a stereo camera's imagers [mm]"""

    @baseline_mm.setter
    def baseline_mm(self, value: float | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    @property
    def intrinsics(self) -> partpose.core.Intrinsics: ...

def read_camera(path: str | os.PathLike[str]) -> CameraFile: ...

def write_camera(path: str | os.PathLike[str], camera: CameraFile) -> None: ...

def camera_file_of(depth_image: str | os.PathLike[str]) -> pathlib.Path:
    """
    The camera of NAME.png: NAME.camera.json beside it, or else camera.json in its folder.
    """

class Scene:
    """What a camera measured: a depth image with its camera, or a cloud."""

    @overload
    def __init__(self, cloud: partpose.core.PointCloud) -> None: ...

    @overload
    def __init__(self, depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics) -> None: ...

    @property
    def path(self) -> pathlib.Path: ...

    @property
    def cloud(self) -> partpose.core.PointCloud: ...

    @property
    def depth(self) -> partpose.core.DepthImage | None: ...

    @property
    def intrinsics(self) -> partpose.core.Intrinsics | None: ...

    def __repr__(self) -> str: ...

def read_scene(path: str | os.PathLike[str], unit_mm: float = 1.0, camera_file: str | os.PathLike[str] | None = None) -> Scene:
    """A 16-bit depth PNG with its camera JSON, or a PCD or PLY cloud."""

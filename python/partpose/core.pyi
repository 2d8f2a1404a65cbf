# Written by script/make_stubs.
from collections.abc import Sequence
from typing import Annotated, Any

import numpy
import numpy.typing
from numpy.typing import NDArray


class Error(ValueError):
    """
    Bad input or a wrong argument. The message says where, what is wrong and what would be right. Nothing recognized is never an Error.
    """

class Intrinsics:
    """
    Pinhole camera without distortion, in px. Pixel centres are at integer coordinates; camera frame: x right, y down, z forward.
    """

    def __init__(self, width: int, height: int, fx: float, fy: float, cx: float, cy: float) -> None: ...

    @staticmethod
    def from_field_of_view(width: int, height: int, horizontal_fov_deg: float, vertical_fov_deg: float) -> Intrinsics:
        """Image edges at +-fov/2, the principal point in the image's centre."""

    @property
    def width(self) -> int:
        """Of the image, px."""

    @property
    def height(self) -> int:
        """Of the image, px."""

    @property
    def fx(self) -> float:
        """Focal length in x, px."""

    @property
    def fy(self) -> float:
        """Focal length in y, px."""

    @property
    def cx(self) -> float:
        """Principal point in x, px."""

    @property
    def cy(self) -> float:
        """Principal point in y, px."""

    def unproject(self, u: float, v: float, z_mm: float) -> Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')]:
        """Point in the camera frame (mm) at a pixel and a depth (mm)."""

    def project(self, point_mm: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]) -> Annotated[NDArray[numpy.float64], dict(shape=(2), order='C')]:
        """Pixel coordinates of a point with z > 0."""

    def __eq__(self, other: object, /) -> bool: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    __hash__: None = None  # type: ignore[assignment]

    def __repr__(self) -> str: ...

class PointCloud:
    """
    Points in millimetres, optionally with unit normals and curvatures. Immutable; the arrays are read-only views of it. An organized cloud has width x height points, row by row, missing ones NaN.
    """

    def __init__(self, points: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], normals: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))] | None = None, curvatures: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None,))] | None = None, width: int = 0, height: int = 0) -> None: ...

    @property
    def points(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]:
        """N x 3, mm."""

    @property
    def normals(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]:
        """No rows when there are none."""

    @property
    def curvatures(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None,))]:
        """Empty when there are none."""

    @property
    def width(self) -> int:
        """Of an organized cloud; otherwise the number of points."""

    @property
    def height(self) -> int:
        """Of an organized cloud; otherwise 1."""

    def __len__(self) -> int: ...

    def has_normals(self) -> bool:
        """Whether each point has a normal."""

    def has_curvatures(self) -> bool:
        """Whether each point has a curvature."""

    def is_organized(self) -> bool:
        """Whether the points are those of an image, row by row."""

    def __repr__(self) -> str: ...

def select(cloud: PointCloud, indices: Sequence[int]) -> PointCloud:
    """The points at these indices, in that order."""

def every_nth(cloud: PointCloud, step: int) -> PointCloud:
    """Points 0, step, 2 step, ..."""

def without_missing(cloud: PointCloud) -> PointCloud:
    """Without points (or normals) that are not finite."""

def before_camera(cloud: PointCloud) -> PointCloud:
    """The finite points that a camera at the origin can see."""

def transformed(cloud: PointCloud, target_from_cloud: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> PointCloud:
    """Points and normals moved."""

def centroid(cloud: PointCloud) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
    """The mean of the points, in mm. Zero for an empty cloud."""

def append(cloud: PointCloud, other: PointCloud) -> PointCloud:
    """A new cloud: the points of `other` behind those of `cloud`."""

class DepthImage:
    """Depth along the optical axis (z) in mm; 0 means no value. Immutable."""

    def __init__(self, pixels: Annotated[numpy.typing.NDArray[numpy.uint16 | numpy.float32 | numpy.float64], dict(shape=(None, None))], depth_scale_mm: float = 1.0) -> None:
        """uint16 or float pixels in units of `depth_scale_mm` mm."""

    @property
    def width(self) -> int:
        """px."""

    @property
    def height(self) -> int:
        """px."""

    @property
    def z_mm(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, None))]:
        """Height x width, a view."""

    def __repr__(self) -> str: ...

def to_point_cloud(depth: DepthImage, intrinsics: Intrinsics, organized: bool = False) -> PointCloud:
    """One point per pixel; missing ones are NaN when `organized`."""

def to_depth_image(cloud: PointCloud, intrinsics: Intrinsics) -> DepthImage:
    """Each point into its nearest pixel, the nearest point wins."""

def intrinsics_covering(cloud: PointCloud, pixel_size_rad: float, margin_px: int = 2, widest_px: int = 2000) -> Intrinsics:
    """The camera at the origin whose image just covers a cloud."""

class TriangleMesh:
    """
    Triangles in millimetres, counter-clockwise seen from outside. Immutable.
    """

    def __init__(self, vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], triangles: Annotated[numpy.typing.NDArray[numpy.integer[Any]], dict(shape=(None, 3))]) -> None: ...

    @property
    def vertices(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]:
        """N x 3, mm."""

    @property
    def triangles(self) -> Annotated[numpy.typing.NDArray[numpy.int32], dict(shape=(None, 3))]:
        """M x 3 indices of vertices."""

    def face_normal(self, t: int) -> Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')]:
        """Unit normal by the winding; zero for a degenerate triangle."""

    def __repr__(self) -> str: ...

def bounding_box(mesh: TriangleMesh) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]]:
    """Lower and upper corner, in mm."""

def with_merged_vertices(mesh: TriangleMesh) -> TriangleMesh:
    """Vertices with equal coordinates made one."""

def bounding_box_diagonal(mesh: TriangleMesh) -> float:
    """In mm."""

def diameter(mesh: TriangleMesh) -> float:
    """The largest distance of two vertices, in mm."""

def rotation_error_deg(a: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], b: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> float:
    """Angle between two rotations (reference, eq. 2.2)."""

def translation_error_mm(a: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], b: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> float:
    """Distance between two origins (eq. 2.3)."""

def rotation_from_vector(omega_rad: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]) -> Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='F')]:
    """The rotation by |omega| rad about omega."""

def is_rigid(matrix: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='F')], tolerance: float = 0.0001) -> bool:
    """Whether a 4 x 4 matrix is a rigid motion."""

def nearest_rigid(matrix: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='F')]) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
    """The nearest proper rotation with the same translation."""

class ThreadLimit:
    """
    with ThreadLimit(2): the library uses at most so many threads (0: all).
    """

    def __init__(self, threads: int) -> None: ...

    def __enter__(self) -> ThreadLimit: ...

    def __exit__(self, *args: object) -> None: ...

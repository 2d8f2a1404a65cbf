# Written by script/make_stubs.
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

import numpy
import numpy.typing

import partpose.core
import partpose.geometry


class PreprocessOptions:
    """
    The steps run in the order of the keys.

    scale_flag = False: multiply all coordinates by scale_factor
    scale_factor = 1000.0: 1000 for clouds in metres; > 0
    xyz_filter_flag = False: keep only the points within xyz_limits
    xyz_limits = (-10000.0, 10000.0, -10000.0, 10000.0, -10000.0, 10000.0): x min, x max, y min, y max, z min, z max [mm], camera frame
    voxel_grid_flag = True: replace the points of each voxel by their centroid
    voxel_size = 1.0: edge of a voxel [mm], > 0
    plane_removal_flag = False: remove the dominant plane (the table)
    plane_removal_distance_threshold = 10.0: points this near to the plane are removed [mm], > 0
    radius_outlier_removal_flag = False: remove points with few neighbours
    radius_outlier_removal_radius = 10.0: radius around each point [mm], > 0
    radius_outlier_removal_min_points_in_radius = 50: a point is kept with at least so many others within the radius, >= 0
    statistical_outlier_removal_flag = False: remove points whose mean distance to their neighbours is unusual
    statistical_outlier_removal_num_of_k_nearest_neighbors = 50: how many neighbours are looked at, 1 to 1000
    statistical_outlier_removal_std_deviation_multiplier = 1.0: a point is removed when its mean distance exceeds the cloud's mean by so many standard deviations
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, scale_flag: bool = False, scale_factor: float = 1000.0, xyz_filter_flag: bool = False, xyz_limits: Sequence[float] = (-10000.0, 10000.0, -10000.0, 10000.0, -10000.0, 10000.0), voxel_grid_flag: bool = True, voxel_size: float = 1.0, plane_removal_flag: bool = False, plane_removal_distance_threshold: float = 10.0, radius_outlier_removal_flag: bool = False, radius_outlier_removal_radius: float = 10.0, radius_outlier_removal_min_points_in_radius: int = 50, statistical_outlier_removal_flag: bool = False, statistical_outlier_removal_num_of_k_nearest_neighbors: int = 50, statistical_outlier_removal_std_deviation_multiplier: float = 1.0) -> None: ...

    @property
    def scale_flag(self) -> bool:
        """multiply all coordinates by scale_factor"""

    @scale_flag.setter
    def scale_flag(self, value: bool, /) -> None: ...

    @property
    def scale_factor(self) -> float:
        """1000 for clouds in metres; > 0"""

    @scale_factor.setter
    def scale_factor(self, value: float, /) -> None: ...

    @property
    def xyz_filter_flag(self) -> bool:
        """keep only the points within xyz_limits"""

    @xyz_filter_flag.setter
    def xyz_filter_flag(self, value: bool, /) -> None: ...

    @property
    def xyz_limits(self) -> tuple[float, ...]:
        """x min, x max, y min, y max, z min, z max [mm], camera frame"""

    @xyz_limits.setter
    def xyz_limits(self, value: Sequence[float], /) -> None: ...

    @property
    def voxel_grid_flag(self) -> bool:
        """replace the points of each voxel by their centroid"""

    @voxel_grid_flag.setter
    def voxel_grid_flag(self, value: bool, /) -> None: ...

    @property
    def voxel_size(self) -> float:
        """edge of a voxel [mm], > 0"""

    @voxel_size.setter
    def voxel_size(self, value: float, /) -> None: ...

    @property
    def plane_removal_flag(self) -> bool:
        """remove the dominant plane (the table)"""

    @plane_removal_flag.setter
    def plane_removal_flag(self, value: bool, /) -> None: ...

    @property
    def plane_removal_distance_threshold(self) -> float:
        """points this near to the plane are removed [mm], > 0"""

    @plane_removal_distance_threshold.setter
    def plane_removal_distance_threshold(self, value: float, /) -> None: ...

    @property
    def radius_outlier_removal_flag(self) -> bool:
        """remove points with few neighbours"""

    @radius_outlier_removal_flag.setter
    def radius_outlier_removal_flag(self, value: bool, /) -> None: ...

    @property
    def radius_outlier_removal_radius(self) -> float:
        """radius around each point [mm], > 0"""

    @radius_outlier_removal_radius.setter
    def radius_outlier_removal_radius(self, value: float, /) -> None: ...

    @property
    def radius_outlier_removal_min_points_in_radius(self) -> int:
        """a point is kept with at least so many others within the radius, >= 0"""

    @radius_outlier_removal_min_points_in_radius.setter
    def radius_outlier_removal_min_points_in_radius(self, value: int, /) -> None: ...

    @property
    def statistical_outlier_removal_flag(self) -> bool:
        """remove points whose mean distance to their neighbours is unusual"""

    @statistical_outlier_removal_flag.setter
    def statistical_outlier_removal_flag(self, value: bool, /) -> None: ...

    @property
    def statistical_outlier_removal_num_of_k_nearest_neighbors(self) -> int:
        """how many neighbours are looked at, 1 to 1000"""

    @statistical_outlier_removal_num_of_k_nearest_neighbors.setter
    def statistical_outlier_removal_num_of_k_nearest_neighbors(self, value: int, /) -> None: ...

    @property
    def statistical_outlier_removal_std_deviation_multiplier(self) -> float:
        """
        a point is removed when its mean distance exceeds the cloud's mean by so many standard deviations
        """

    @statistical_outlier_removal_std_deviation_multiplier.setter
    def statistical_outlier_removal_std_deviation_multiplier(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class NormalEstimationOptions:
    """
    Normals of the scene.

    search_radius = 9.0: radius of the neighbourhood that a normal is fitted to [mm], > 0
    normal_to_view_angle_deviation_degrees = 89.0: points whose normal is turned further than this from the camera's -z axis are dropped [deg], 0 to 180
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, search_radius: float = 9.0, normal_to_view_angle_deviation_degrees: float = 89.0) -> None: ...

    @property
    def search_radius(self) -> float:
        """radius of the neighbourhood that a normal is fitted to [mm], > 0"""

    @search_radius.setter
    def search_radius(self, value: float, /) -> None: ...

    @property
    def normal_to_view_angle_deviation_degrees(self) -> float:
        """
        points whose normal is turned further than this from the camera's -z axis are dropped [deg], 0 to 180
        """

    @normal_to_view_angle_deviation_degrees.setter
    def normal_to_view_angle_deviation_degrees(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class PreprocessedScene:
    """What is left of a scene."""

    @property
    def cloud(self) -> partpose.core.PointCloud:
        """What is left."""

    @property
    def plane(self) -> partpose.geometry.Plane | None:
        """The plane that was removed; None: none was."""

    def __repr__(self) -> str: ...

def preprocess(scene: partpose.core.PointCloud, options: PreprocessOptions) -> PreprocessedScene:
    """Points that are not finite are dropped first."""

def scaled(cloud: partpose.core.PointCloud, factor: float) -> partpose.core.PointCloud:
    """All points times a factor."""

def cropped(cloud: partpose.core.PointCloud, xyz_limits_mm: Sequence[float]) -> partpose.core.PointCloud:
    """x min, x max, y min, y max, z min, z max."""

def without_radius_outliers(cloud: partpose.core.PointCloud, radius_mm: float, min_points: int) -> partpose.core.PointCloud:
    """
    Without points that have fewer than `min_points` others within the radius.
    """

def without_statistical_outliers(cloud: partpose.core.PointCloud, neighbours: int, deviations: float) -> partpose.core.PointCloud:
    """
    Without points whose mean distance to their neighbours is far above the cloud's.
    """

def with_normals(cloud: partpose.core.PointCloud, options: NormalEstimationOptions) -> partpose.core.PointCloud:
    """Normals and curvatures of a scene seen from the origin."""

def segment(depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, largest_part_mm: float = 300, smallest_part_mm: float = 10, min_pixels: int = 60, most_segments: int = 16) -> list[Annotated[numpy.typing.NDArray[numpy.int32], dict(shape=(None,))]]:
    """
    What may be single objects in a frame, largest first: the indices of their pixels (v * width + u).
    """

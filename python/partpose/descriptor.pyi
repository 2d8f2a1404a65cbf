# Written by script/make_stubs.
from collections.abc import Mapping
from typing import Annotated, Any, Self

import numpy
import numpy.typing
from numpy.typing import NDArray

import partpose.core


class VfhOptions:
    """
    Viewpoint Feature Histogram (Rusu et al. 2010).

    k_nn = 6: number of nearest neighbours, >= 1
    use_fill_size_component = True: fill the 45 bins of the distances to the centroid; zeros otherwise
    use_normalized_bins = True: bins in per cent of the points rather than in points
    use_normalized_distances = True: distances to the centroid relative to the largest; otherwise in steps of 10 mm
    leak_as_pcl = False: repeat a fault of PCL 1.13: two lengths d are sqrt(d^2 + 1), which matters for clouds in metres
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, k_nn: int = 6, use_fill_size_component: bool = True, use_normalized_bins: bool = True, use_normalized_distances: bool = True, leak_as_pcl: bool = False) -> None: ...

    @property
    def k_nn(self) -> int:
        """number of nearest neighbours, >= 1"""

    @k_nn.setter
    def k_nn(self, value: int, /) -> None: ...

    @property
    def use_fill_size_component(self) -> bool:
        """fill the 45 bins of the distances to the centroid; zeros otherwise"""

    @use_fill_size_component.setter
    def use_fill_size_component(self, value: bool, /) -> None: ...

    @property
    def use_normalized_bins(self) -> bool:
        """bins in per cent of the points rather than in points"""

    @use_normalized_bins.setter
    def use_normalized_bins(self, value: bool, /) -> None: ...

    @property
    def use_normalized_distances(self) -> bool:
        """
        distances to the centroid relative to the largest; otherwise in steps of 10 mm
        """

    @use_normalized_distances.setter
    def use_normalized_distances(self, value: bool, /) -> None: ...

    @property
    def leak_as_pcl(self) -> bool:
        """
        repeat a fault of PCL 1.13: two lengths d are sqrt(d^2 + 1), which matters for clouds in metres
        """

    @leak_as_pcl.setter
    def leak_as_pcl(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class CvfhOptions:
    """
    Clustered Viewpoint Feature Histogram (Aldoma et al. 2011).

    k_nn = 6: number of nearest neighbours, >= 1
    min_points = 200: minimum number of points in a cluster, >= 1
    cluster_tolerance_distance = 9.0: points of a cluster are at most this far from the next [mm], > 0
    eps_angle_threshold_deg = 20.0: normals of neighbours in a cluster differ by less than this [deg], > 0
    radius_normals = 9.0: radius of the neighbourhood of the normals that clusters are found by [mm], > 0
    use_normalized_bins = True: bins in per cent of the points rather than in points
    curvature_threshold = 0.03: points of a higher curvature belong to no cluster, 0 to 1/3 (1/3: none is left out)
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, k_nn: int = 6, min_points: int = 200, cluster_tolerance_distance: float = 9.0, eps_angle_threshold_deg: float = 20.0, radius_normals: float = 9.0, use_normalized_bins: bool = True, curvature_threshold: float = 0.03) -> None: ...

    @property
    def k_nn(self) -> int:
        """number of nearest neighbours, >= 1"""

    @k_nn.setter
    def k_nn(self, value: int, /) -> None: ...

    @property
    def min_points(self) -> int:
        """minimum number of points in a cluster, >= 1"""

    @min_points.setter
    def min_points(self, value: int, /) -> None: ...

    @property
    def cluster_tolerance_distance(self) -> float:
        """points of a cluster are at most this far from the next [mm], > 0"""

    @cluster_tolerance_distance.setter
    def cluster_tolerance_distance(self, value: float, /) -> None: ...

    @property
    def eps_angle_threshold_deg(self) -> float:
        """normals of neighbours in a cluster differ by less than this [deg], > 0"""

    @eps_angle_threshold_deg.setter
    def eps_angle_threshold_deg(self, value: float, /) -> None: ...

    @property
    def radius_normals(self) -> float:
        """
        radius of the neighbourhood of the normals that clusters are found by [mm], > 0
        """

    @radius_normals.setter
    def radius_normals(self, value: float, /) -> None: ...

    @property
    def use_normalized_bins(self) -> bool:
        """bins in per cent of the points rather than in points"""

    @use_normalized_bins.setter
    def use_normalized_bins(self, value: bool, /) -> None: ...

    @property
    def curvature_threshold(self) -> float:
        """
        points of a higher curvature belong to no cluster, 0 to 1/3 (1/3: none is left out)
        """

    @curvature_threshold.setter
    def curvature_threshold(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class OurCvfhOptions:
    """
    Oriented, Unique and Repeatable CVFH (Aldoma et al. 2012).

    k_nn = 6: number of nearest neighbours, >= 1
    min_points = 200: minimum number of points in a cluster, >= 1
    cluster_tolerance_distance = 9.0: points of a cluster are at most this far from the next [mm], > 0
    eps_angle_threshold_deg = 20.0: normals of neighbours in a cluster differ by less than this [deg], > 0
    radius_normals = 9.0: radius of the neighbourhood of the normals that clusters are found by [mm], > 0
    use_normalized_bins = True: bins in per cent of the points rather than in points
    curvature_threshold = 0.03: points of a higher curvature belong to no cluster, 0 to 1/3 (1/3: none is left out)
    refine_clusters = 1.0: a cluster keeps the points whose normal is within this times eps_angle_threshold_deg of its mean, > 0
    axis_ratio = 0.8: two axes whose signs are about equally clear, by more than this ratio, both give reference frames, 0 to 1
    min_axis_value = 0.925: both axes' two sides balanced to more than this: both signs of both give frames (four), 0 to 1
    octant_sigma = 10.0: points this near to a plane between octants count in part on its other side [mm], > 0
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, k_nn: int = 6, min_points: int = 200, cluster_tolerance_distance: float = 9.0, eps_angle_threshold_deg: float = 20.0, radius_normals: float = 9.0, use_normalized_bins: bool = True, curvature_threshold: float = 0.03, refine_clusters: float = 1.0, axis_ratio: float = 0.8, min_axis_value: float = 0.925, octant_sigma: float = 10.0) -> None: ...

    @property
    def k_nn(self) -> int:
        """number of nearest neighbours, >= 1"""

    @k_nn.setter
    def k_nn(self, value: int, /) -> None: ...

    @property
    def min_points(self) -> int:
        """minimum number of points in a cluster, >= 1"""

    @min_points.setter
    def min_points(self, value: int, /) -> None: ...

    @property
    def cluster_tolerance_distance(self) -> float:
        """points of a cluster are at most this far from the next [mm], > 0"""

    @cluster_tolerance_distance.setter
    def cluster_tolerance_distance(self, value: float, /) -> None: ...

    @property
    def eps_angle_threshold_deg(self) -> float:
        """normals of neighbours in a cluster differ by less than this [deg], > 0"""

    @eps_angle_threshold_deg.setter
    def eps_angle_threshold_deg(self, value: float, /) -> None: ...

    @property
    def radius_normals(self) -> float:
        """
        radius of the neighbourhood of the normals that clusters are found by [mm], > 0
        """

    @radius_normals.setter
    def radius_normals(self, value: float, /) -> None: ...

    @property
    def use_normalized_bins(self) -> bool:
        """bins in per cent of the points rather than in points"""

    @use_normalized_bins.setter
    def use_normalized_bins(self, value: bool, /) -> None: ...

    @property
    def curvature_threshold(self) -> float:
        """
        points of a higher curvature belong to no cluster, 0 to 1/3 (1/3: none is left out)
        """

    @curvature_threshold.setter
    def curvature_threshold(self, value: float, /) -> None: ...

    @property
    def refine_clusters(self) -> float:
        """
        a cluster keeps the points whose normal is within this times eps_angle_threshold_deg of its mean, > 0
        """

    @refine_clusters.setter
    def refine_clusters(self, value: float, /) -> None: ...

    @property
    def axis_ratio(self) -> float:
        """
        two axes whose signs are about equally clear, by more than this ratio, both give reference frames, 0 to 1
        """

    @axis_ratio.setter
    def axis_ratio(self, value: float, /) -> None: ...

    @property
    def min_axis_value(self) -> float:
        """
        both axes' two sides balanced to more than this: both signs of both give frames (four), 0 to 1
        """

    @min_axis_value.setter
    def min_axis_value(self, value: float, /) -> None: ...

    @property
    def octant_sigma(self) -> float:
        """
        points this near to a plane between octants count in part on its other side [mm], > 0
        """

    @octant_sigma.setter
    def octant_sigma(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class EsfOptions:
    """
    Ensemble of Shape Functions (Wohlkinger and Vincze 2011).

    k_nn = 6: number of nearest neighbours, >= 1
    samples = 20000: triangles drawn from the points, 1 to 10000000
    seed = 1: of the draws, >= 0
    steady_extent = True: lengths and areas relative to the mean of the largest of five draws; false: to the draw's largest, as PCL
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, k_nn: int = 6, samples: int = 20000, seed: int = 1, steady_extent: bool = True) -> None: ...

    @property
    def k_nn(self) -> int:
        """number of nearest neighbours, >= 1"""

    @k_nn.setter
    def k_nn(self, value: int, /) -> None: ...

    @property
    def samples(self) -> int:
        """triangles drawn from the points, 1 to 10000000"""

    @samples.setter
    def samples(self, value: int, /) -> None: ...

    @property
    def seed(self) -> int:
        """of the draws, >= 0"""

    @seed.setter
    def seed(self, value: int, /) -> None: ...

    @property
    def steady_extent(self) -> bool:
        """
        lengths and areas relative to the mean of the largest of five draws; false: to the draw's largest, as PCL
        """

    @steady_extent.setter
    def steady_extent(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class GoodOptions:
    """
    Global Orthographic Object Descriptor (Kasaei et al. 2016).

    k_nn = 6: number of nearest neighbours, >= 1
    num_of_bins = 6: bins along each side of an orthographic view, 1 to 100
    threshold = 200.0: points nearer than this to a plane of the frame have no vote on its sign [mm], >= 0
    ambiguous_frames = False: one description for each plausible frame where signs or order of the axes are in doubt
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, k_nn: int = 6, num_of_bins: int = 6, threshold: float = 200.0, ambiguous_frames: bool = False) -> None: ...

    @property
    def k_nn(self) -> int:
        """number of nearest neighbours, >= 1"""

    @k_nn.setter
    def k_nn(self, value: int, /) -> None: ...

    @property
    def num_of_bins(self) -> int:
        """bins along each side of an orthographic view, 1 to 100"""

    @num_of_bins.setter
    def num_of_bins(self, value: int, /) -> None: ...

    @property
    def threshold(self) -> float:
        """
        points nearer than this to a plane of the frame have no vote on its sign [mm], >= 0
        """

    @threshold.setter
    def threshold(self, value: float, /) -> None: ...

    @property
    def ambiguous_frames(self) -> bool:
        """
        one description for each plausible frame where signs or order of the axes are in doubt
        """

    @ambiguous_frames.setter
    def ambiguous_frames(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DescriptorOptions:
    """
    The options of every global descriptor.

    vfh: Viewpoint Feature Histogram
    cvfh: Clustered Viewpoint Feature Histogram
    ourcvfh: Oriented, Unique and Repeatable CVFH
    esf: Ensemble of Shape Functions
    good: Global Orthographic Object Descriptor
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, vfh: VfhOptions | Mapping[str, Any] = ..., cvfh: CvfhOptions | Mapping[str, Any] = ..., ourcvfh: OurCvfhOptions | Mapping[str, Any] = ..., esf: EsfOptions | Mapping[str, Any] = ..., good: GoodOptions | Mapping[str, Any] = ...) -> None: ...

    @property
    def vfh(self) -> VfhOptions:
        """Viewpoint Feature Histogram"""

    @vfh.setter
    def vfh(self, value: VfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def cvfh(self) -> CvfhOptions:
        """Clustered Viewpoint Feature Histogram"""

    @cvfh.setter
    def cvfh(self, value: CvfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def ourcvfh(self) -> OurCvfhOptions:
        """Oriented, Unique and Repeatable CVFH"""

    @ourcvfh.setter
    def ourcvfh(self, value: OurCvfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def esf(self) -> EsfOptions:
        """Ensemble of Shape Functions"""

    @esf.setter
    def esf(self, value: EsfOptions | Mapping[str, Any], /) -> None: ...

    @property
    def good(self) -> GoodOptions:
        """Global Orthographic Object Descriptor"""

    @good.setter
    def good(self, value: GoodOptions | Mapping[str, Any], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def descriptor_names() -> list[str]:
    """The names that a configuration may give."""

class Description:
    """One histogram of a cloud, and what it was measured on."""

    @property
    def histogram(self) -> Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None,))]: ...

    @property
    def centroid_mm(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
        """Of the points described."""

    @property
    def support(self) -> int:
        """How many points are described."""

    @property
    def valid(self) -> bool:
        """False: nothing can be said of these points."""

    @property
    def camera_from_reference(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')] | None:
        """The descriptor's reference frame; None: it has none."""

    def __repr__(self) -> str: ...

class GlobalDescriptor:
    """A descriptor of a whole, segmented cloud with normals."""

    def bins(self) -> int:
        """The length of its histograms."""

    def describe(self, cloud: partpose.core.PointCloud) -> list[Description]:
        """Nothing for a cloud that it is not defined for."""

def make_global_descriptor(name: str, options: DescriptorOptions = ...) -> GlobalDescriptor:
    """By its name in the configuration."""

def neighbours_of(name: str, options: DescriptorOptions = ...) -> int:
    """How many nearest neighbours the configuration asks for."""

def camera_roll_histogram(cloud: partpose.core.PointCloud) -> Annotated[NDArray[numpy.float32], dict(shape=(None,))]:
    """
    90 bins of 4 degrees about the line of sight to the centroid (Aldoma et al. 2011).
    """

# Written by script/make_stubs.
from collections.abc import Mapping
from typing import Annotated, Any, Self

import numpy
from numpy.typing import NDArray

import partpose.core


class CoarseAlignmentOptions:
    """
    First guess of a candidate's pose.

    use_crh = True: turn the candidate about the line of sight by the Camera Roll Histogram
    use_descriptor_if_possible = True: align by the descriptor's own reference frame too ("ourcvfh" and "good" have one)
    use_correction_by_centroids = True: move the candidate's centroid to the scene's
    crh_peaks = 4: how many of the histogram's best turns are tried for each candidate, >= 1
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, use_crh: bool = True, use_descriptor_if_possible: bool = True, use_correction_by_centroids: bool = True, crh_peaks: int = 4) -> None: ...

    @property
    def use_crh(self) -> bool:
        """
        turn the candidate about the line of sight by the Camera Roll Histogram
        """

    @use_crh.setter
    def use_crh(self, value: bool, /) -> None: ...

    @property
    def use_descriptor_if_possible(self) -> bool:
        """
        align by the descriptor's own reference frame too ("ourcvfh" and "good" have one)
        """

    @use_descriptor_if_possible.setter
    def use_descriptor_if_possible(self, value: bool, /) -> None: ...

    @property
    def use_correction_by_centroids(self) -> bool:
        """move the candidate's centroid to the scene's"""

    @use_correction_by_centroids.setter
    def use_correction_by_centroids(self, value: bool, /) -> None: ...

    @property
    def crh_peaks(self) -> int:
        """
        how many of the histogram's best turns are tried for each candidate, >= 1
        """

    @crh_peaks.setter
    def crh_peaks(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class PoseRefinementOptions:
    """
    Iterative closest points.

    voxelize_scene = True: thin out the scene before the refinement
    voxelize_view = True: thin out the candidates' views before the refinement
    voxel_size = 3.0: edge of a voxel for both [mm], > 0
    enforce_same_direction_normals = True: pairs whose normals are more than 90 degrees apart do not count
    euclidean_fitness_epsilon = 0.1: converged when an iteration changes the mean squared distance of the pairs by less [mm^2] and transformation_epsilon holds too
    max_correspondence_distance = 1500.0: pairs farther apart do not count [mm], > 0
    max_iterations = 150: gives up after so many iterations, >= 1
    transformation_epsilon = 0.1: converged when an iteration moves no point by more [mm] and euclidean_fitness_epsilon holds too
    use_symmetric_objective = True: symmetric objective (Rusinkiewicz 2019) instead of point-to-plane
    correspondence_gate_factor = 3.0: pairs farther apart than so many times the median distance do not count; 0: no such gate
    two_sided_fitness = True: icp_fitness is the mean of both directions, view to scene and scene to view; otherwise the first alone
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, voxelize_scene: bool = True, voxelize_view: bool = True, voxel_size: float = 3.0, enforce_same_direction_normals: bool = True, euclidean_fitness_epsilon: float = 0.1, max_correspondence_distance: float = 1500.0, max_iterations: int = 150, transformation_epsilon: float = 0.1, use_symmetric_objective: bool = True, correspondence_gate_factor: float = 3.0, two_sided_fitness: bool = True) -> None: ...

    @property
    def voxelize_scene(self) -> bool:
        """thin out the scene before the refinement"""

    @voxelize_scene.setter
    def voxelize_scene(self, value: bool, /) -> None: ...

    @property
    def voxelize_view(self) -> bool:
        """thin out the candidates' views before the refinement"""

    @voxelize_view.setter
    def voxelize_view(self, value: bool, /) -> None: ...

    @property
    def voxel_size(self) -> float:
        """edge of a voxel for both [mm], > 0"""

    @voxel_size.setter
    def voxel_size(self, value: float, /) -> None: ...

    @property
    def enforce_same_direction_normals(self) -> bool:
        """pairs whose normals are more than 90 degrees apart do not count"""

    @enforce_same_direction_normals.setter
    def enforce_same_direction_normals(self, value: bool, /) -> None: ...

    @property
    def euclidean_fitness_epsilon(self) -> float:
        """
        converged when an iteration changes the mean squared distance of the pairs by less [mm^2] and transformation_epsilon holds too
        """

    @euclidean_fitness_epsilon.setter
    def euclidean_fitness_epsilon(self, value: float, /) -> None: ...

    @property
    def max_correspondence_distance(self) -> float:
        """pairs farther apart do not count [mm], > 0"""

    @max_correspondence_distance.setter
    def max_correspondence_distance(self, value: float, /) -> None: ...

    @property
    def max_iterations(self) -> int:
        """gives up after so many iterations, >= 1"""

    @max_iterations.setter
    def max_iterations(self, value: int, /) -> None: ...

    @property
    def transformation_epsilon(self) -> float:
        """
        converged when an iteration moves no point by more [mm] and euclidean_fitness_epsilon holds too
        """

    @transformation_epsilon.setter
    def transformation_epsilon(self, value: float, /) -> None: ...

    @property
    def use_symmetric_objective(self) -> bool:
        """symmetric objective (Rusinkiewicz 2019) instead of point-to-plane"""

    @use_symmetric_objective.setter
    def use_symmetric_objective(self, value: bool, /) -> None: ...

    @property
    def correspondence_gate_factor(self) -> float:
        """
        pairs farther apart than so many times the median distance do not count; 0: no such gate
        """

    @correspondence_gate_factor.setter
    def correspondence_gate_factor(self, value: float, /) -> None: ...

    @property
    def two_sided_fitness(self) -> bool:
        """
        icp_fitness is the mean of both directions, view to scene and scene to view; otherwise the first alone
        """

    @two_sided_fitness.setter
    def two_sided_fitness(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def coarse_alignments(view: partpose.core.PointCloud, scene: partpose.core.PointCloud, options: CoarseAlignmentOptions = ...) -> list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]:
    """
    The transformations that may bring a view onto the scene, at least one.
    """

class IcpResult:
    """What icp found."""

    @property
    def target_from_source(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The motion found."""

    @property
    def converged(self) -> bool:
        """Whether the motion got as small as asked for."""

    @property
    def iterations(self) -> int:
        """How many were made."""

    @property
    def pairs(self) -> int:
        """In the last iteration."""

    def __repr__(self) -> str: ...

def icp(source: partpose.core.PointCloud, target: partpose.core.PointCloud, options: PoseRefinementOptions = ...) -> IcpResult:
    """
    Registers source to target, both with normals, starting from where the source lies.
    """

class ProjectiveRefinement:
    """What refine_projectively found."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The pose found."""

    @property
    def pixels(self) -> int:
        """That were compared last."""

    @property
    def rms_mm(self) -> float:
        """Of their distances."""

    def __repr__(self) -> str: ...

def refine_projectively(mesh: partpose.core.TriangleMesh, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, gate_mm: float = 10.0, max_iterations: int = 10, converged_mm: float = 0.019999999552965164) -> ProjectiveRefinement:
    """Moves a part so that its rendered surface meets the measured depth."""

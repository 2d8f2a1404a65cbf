# Written by script/make_stubs.
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

import numpy
from numpy.typing import NDArray

import partpose.core


class HypothesisVerificationOptions:
    """
    Which candidates are believed.

    model_representation_voxel_size = 3.0: voxel of the part's fused views [mm], > 0
    inlier_threshold = 10.0: model and scene points this near explain each other [mm], > 0
    occlusion_reasoning = True: model points that cannot be seen do not count
    occlusion_threshold = 6.0: a point this far behind the surface seen in its direction is hidden [mm], >= 0
    regularizer = 45.0: how many explained scene points one visible but unexplained model point outweighs, >= 0
    verification_voxel_size = 5.0: voxel of scene and model in the verification [mm], > 0
    resolution = None: another name of verification_voxel_size, which it overrides
    min_scene_coverage = 0.8: share of the scene's points that an accepted candidate explains, 0 to 1; 0 switches it off
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, model_representation_voxel_size: float = 3.0, inlier_threshold: float = 10.0, occlusion_reasoning: bool = True, occlusion_threshold: float = 6.0, regularizer: float = 45.0, verification_voxel_size: float = 5.0, resolution: float | None = None, min_scene_coverage: float = 0.8) -> None: ...

    @property
    def model_representation_voxel_size(self) -> float:
        """voxel of the part's fused views [mm], > 0"""

    @model_representation_voxel_size.setter
    def model_representation_voxel_size(self, value: float, /) -> None: ...

    @property
    def inlier_threshold(self) -> float:
        """model and scene points this near explain each other [mm], > 0"""

    @inlier_threshold.setter
    def inlier_threshold(self, value: float, /) -> None: ...

    @property
    def occlusion_reasoning(self) -> bool:
        """model points that cannot be seen do not count"""

    @occlusion_reasoning.setter
    def occlusion_reasoning(self, value: bool, /) -> None: ...

    @property
    def occlusion_threshold(self) -> float:
        """
        a point this far behind the surface seen in its direction is hidden [mm], >= 0
        """

    @occlusion_threshold.setter
    def occlusion_threshold(self, value: float, /) -> None: ...

    @property
    def regularizer(self) -> float:
        """
        how many explained scene points one visible but unexplained model point outweighs, >= 0
        """

    @regularizer.setter
    def regularizer(self, value: float, /) -> None: ...

    @property
    def verification_voxel_size(self) -> float:
        """voxel of scene and model in the verification [mm], > 0"""

    @verification_voxel_size.setter
    def verification_voxel_size(self, value: float, /) -> None: ...

    @property
    def resolution(self) -> float | None:
        """another name of verification_voxel_size, which it overrides"""

    @resolution.setter
    def resolution(self, value: float | None, /) -> None: ...

    @property
    def min_scene_coverage(self) -> float:
        """
        share of the scene's points that an accepted candidate explains, 0 to 1; 0 switches it off
        """

    @min_scene_coverage.setter
    def min_scene_coverage(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Verification:
    """How well a model at a pose and a scene explain each other."""

    @property
    def accepted(self) -> bool:
        """Whether the candidate is believed."""

    @property
    def visible_model_points(self) -> int:
        """Of the model, not hidden by itself."""

    @property
    def unexplained_model_points(self) -> int:
        """Of them: the scene has nothing there."""

    @property
    def scene_points(self) -> int:
        """Of the scene."""

    @property
    def explained_scene_points(self) -> int:
        """Of them: the model is there."""

    @property
    def reason(self) -> str:
        """Why it was not accepted, empty when it was."""

    def __repr__(self) -> str: ...

def verify_greedy(mesh: partpose.core.TriangleMesh, surface: partpose.core.PointCloud, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], scene: partpose.core.PointCloud, options: HypothesisVerificationOptions = ...) -> Verification:
    """
    Greedy hypothesis verification (Aldoma et al. 2012) of one candidate against a segmented scene. `surface`: the part's points, model frame.
    """

class RenderComparison:
    """Counts of pixels, in both directions."""

    @property
    def model(self) -> int:
        """Pixels where the part is rendered."""

    @property
    def free_space(self) -> int:
        """Of them: before a background that was seen."""

    @property
    def hidden(self) -> int:
        """Of them: behind or at the background."""

    @property
    def nothing(self) -> int:
        """Of them: nothing was measured."""

    @property
    def object(self) -> int:
        """Pixels of the object."""

    @property
    def unexplained(self) -> int:
        """Of them: no part is rendered at or beside them."""

    @property
    def cost(self) -> float:
        """The lower the better."""

    @property
    def score(self) -> float:
        """1: they explain each other; 0: nothing in common."""

    def __repr__(self) -> str: ...

def render_and_compare(mesh: partpose.core.TriangleMesh, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, object_pixels: Sequence[int] | None = None, tolerance_mm: float = 4.0, nothing_cost: float = 0.6000000238418579, hidden_cost: float = 0.20000000298023224) -> RenderComparison:
    """
    Renders the part at a pose and compares its depth with what was measured. `object_pixels` (v * width + u): those of the object, as `segment` gives them; None: all that was measured.
    """

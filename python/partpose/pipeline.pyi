# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import os
import pathlib
from typing import Annotated, Any, Self, overload

import numpy
import numpy.typing
from numpy.typing import NDArray

import partpose.core
import partpose.dataset
import partpose.descriptor
import partpose.geometry
import partpose.io
import partpose.matching
import partpose.preprocess
import partpose.registration
import partpose.verification


class Result:
    """
    C.2.2. Nothing recognized is candidate_id -1.

    T_final: camera_from_model, 4x4 [mm]
    candidate_id: -1: nothing recognized
    icp_converged: whether the refinement converged
    icp_fitness: mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane
    match_distance: L1 distance of the descriptors
    model_id: the part
    model_name: the part
    timestamp: names the iteration's folder
    view_id: the view that matched
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, T_final: numpy.typing.ArrayLike = ..., candidate_id: int = ..., icp_converged: bool = ..., icp_fitness: float = ..., match_distance: float = ..., model_id: int = ..., model_name: str = ..., timestamp: str = ..., view_id: int = ...) -> None: ...

    @property
    def T_final(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """camera_from_model, 4x4 [mm]"""

    @T_final.setter
    def T_final(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def candidate_id(self) -> int:
        """-1: nothing recognized"""

    @candidate_id.setter
    def candidate_id(self, value: int, /) -> None: ...

    @property
    def icp_converged(self) -> bool:
        """whether the refinement converged"""

    @icp_converged.setter
    def icp_converged(self, value: bool, /) -> None: ...

    @property
    def icp_fitness(self) -> float:
        """
        mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane
        """

    @icp_fitness.setter
    def icp_fitness(self, value: float, /) -> None: ...

    @property
    def match_distance(self) -> float:
        """L1 distance of the descriptors"""

    @match_distance.setter
    def match_distance(self, value: float, /) -> None: ...

    @property
    def model_id(self) -> int:
        """the part"""

    @model_id.setter
    def model_id(self, value: int, /) -> None: ...

    @property
    def model_name(self) -> str:
        """the part"""

    @model_name.setter
    def model_name(self, value: str, /) -> None: ...

    @property
    def timestamp(self) -> str:
        """names the iteration's folder"""

    @timestamp.setter
    def timestamp(self, value: str, /) -> None: ...

    @property
    def view_id(self) -> int:
        """the view that matched"""

    @view_id.setter
    def view_id(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class CandidateExtras:
    """
    What became of one candidate.

    T_1: centred_from_model, 4x4 [mm]
    T_2: camera_from_centred, 4x4 [mm]
    T_3: coarse alignment, 4x4 [mm]
    T_4: refinement, 4x4 [mm]
    T_final: T_4 T_3 T_2 T_1 = camera_from_model, 4x4 [mm]
    icp_converged = False: whether the refinement converged
    icp_fitness = -1.0: mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane
    id = -1: rank before the last sorting
    match_distance = -1.0: L1 distance of the descriptors
    model_id = -1: the part
    model_name = '': the part
    num_of_points = 0: of the view in the dataset
    num_of_points_refinement = 0: of the view in the refinement
    view_id = -1: the view
    score = -1.0: how well model and scene explain each other, 0 to 1; -1: not looked at
    verdict = '': "accepted", or why not
    mesh = '': the part's mesh, relative to the output folder; empty: not saved
    visible_model_points = None: of the part's surface in the greedy verification
    unexplained_model_points = None: of them: no scene point is near
    scene_points = None: of the thinned scene in the greedy verification
    explained_scene_points = None: of them: near the part's visible surface
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, T_1: numpy.typing.ArrayLike = ..., T_2: numpy.typing.ArrayLike = ..., T_3: numpy.typing.ArrayLike = ..., T_4: numpy.typing.ArrayLike = ..., T_final: numpy.typing.ArrayLike = ..., icp_converged: bool = False, icp_fitness: float = -1.0, id: int = -1, match_distance: float = -1.0, model_id: int = -1, model_name: str = '', num_of_points: int = 0, num_of_points_refinement: int = 0, view_id: int = -1, score: float = -1.0, verdict: str = '', mesh: str = '', visible_model_points: int | None = None, unexplained_model_points: int | None = None, scene_points: int | None = None, explained_scene_points: int | None = None) -> None: ...

    @property
    def T_1(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """centred_from_model, 4x4 [mm]"""

    @T_1.setter
    def T_1(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def T_2(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """camera_from_centred, 4x4 [mm]"""

    @T_2.setter
    def T_2(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def T_3(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """coarse alignment, 4x4 [mm]"""

    @T_3.setter
    def T_3(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def T_4(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """refinement, 4x4 [mm]"""

    @T_4.setter
    def T_4(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def T_final(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """T_4 T_3 T_2 T_1 = camera_from_model, 4x4 [mm]"""

    @T_final.setter
    def T_final(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def icp_converged(self) -> bool:
        """whether the refinement converged"""

    @icp_converged.setter
    def icp_converged(self, value: bool, /) -> None: ...

    @property
    def icp_fitness(self) -> float:
        """
        mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane
        """

    @icp_fitness.setter
    def icp_fitness(self, value: float, /) -> None: ...

    @property
    def id(self) -> int:
        """rank before the last sorting"""

    @id.setter
    def id(self, value: int, /) -> None: ...

    @property
    def match_distance(self) -> float:
        """L1 distance of the descriptors"""

    @match_distance.setter
    def match_distance(self, value: float, /) -> None: ...

    @property
    def model_id(self) -> int:
        """the part"""

    @model_id.setter
    def model_id(self, value: int, /) -> None: ...

    @property
    def model_name(self) -> str:
        """the part"""

    @model_name.setter
    def model_name(self, value: str, /) -> None: ...

    @property
    def num_of_points(self) -> int:
        """of the view in the dataset"""

    @num_of_points.setter
    def num_of_points(self, value: int, /) -> None: ...

    @property
    def num_of_points_refinement(self) -> int:
        """of the view in the refinement"""

    @num_of_points_refinement.setter
    def num_of_points_refinement(self, value: int, /) -> None: ...

    @property
    def view_id(self) -> int:
        """the view"""

    @view_id.setter
    def view_id(self, value: int, /) -> None: ...

    @property
    def score(self) -> float:
        """how well model and scene explain each other, 0 to 1; -1: not looked at"""

    @score.setter
    def score(self, value: float, /) -> None: ...

    @property
    def verdict(self) -> str:
        """"accepted", or why not"""

    @verdict.setter
    def verdict(self, value: str, /) -> None: ...

    @property
    def mesh(self) -> str:
        """the part's mesh, relative to the output folder; empty: not saved"""

    @mesh.setter
    def mesh(self, value: str, /) -> None: ...

    @property
    def visible_model_points(self) -> int | None:
        """of the part's surface in the greedy verification"""

    @visible_model_points.setter
    def visible_model_points(self, value: int | None, /) -> None: ...

    @property
    def unexplained_model_points(self) -> int | None:
        """of them: no scene point is near"""

    @unexplained_model_points.setter
    def unexplained_model_points(self, value: int | None, /) -> None: ...

    @property
    def scene_points(self) -> int | None:
        """of the thinned scene in the greedy verification"""

    @scene_points.setter
    def scene_points(self, value: int | None, /) -> None: ...

    @property
    def explained_scene_points(self) -> int | None:
        """of them: near the part's visible surface"""

    @explained_scene_points.setter
    def explained_scene_points(self, value: int | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class SceneExtras:
    """
    Points of the scene.

    num_of_points_input = 0: as it came
    num_of_points_normal_estimation = 0: after the preprocessing
    num_of_points_refinement = 0: in the refinement
    num_of_points_normals = 0: that have a normal
    input_unit_mm = 1.0: length of one unit of scene_original.ply [mm]
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, num_of_points_input: int = 0, num_of_points_normal_estimation: int = 0, num_of_points_refinement: int = 0, num_of_points_normals: int = 0, input_unit_mm: float = 1.0) -> None: ...

    @property
    def num_of_points_input(self) -> int:
        """as it came"""

    @num_of_points_input.setter
    def num_of_points_input(self, value: int, /) -> None: ...

    @property
    def num_of_points_normal_estimation(self) -> int:
        """after the preprocessing"""

    @num_of_points_normal_estimation.setter
    def num_of_points_normal_estimation(self, value: int, /) -> None: ...

    @property
    def num_of_points_refinement(self) -> int:
        """in the refinement"""

    @num_of_points_refinement.setter
    def num_of_points_refinement(self, value: int, /) -> None: ...

    @property
    def num_of_points_normals(self) -> int:
        """that have a normal"""

    @num_of_points_normals.setter
    def num_of_points_normals(self, value: int, /) -> None: ...

    @property
    def input_unit_mm(self) -> float:
        """length of one unit of scene_original.ply [mm]"""

    @input_unit_mm.setter
    def input_unit_mm(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class MeasuredOperation:
    """
    A step and its time.

    measure_ms = 0.0: wall-clock time [ms]
    tag = '': the step
    points_in = None: of the scene, that the step was given
    points_out = None: of the scene, that it left
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, measure_ms: float = 0.0, tag: str = '', points_in: int | None = None, points_out: int | None = None) -> None: ...

    @property
    def measure_ms(self) -> float:
        """wall-clock time [ms]"""

    @measure_ms.setter
    def measure_ms(self, value: float, /) -> None: ...

    @property
    def tag(self) -> str:
        """the step"""

    @tag.setter
    def tag(self, value: str, /) -> None: ...

    @property
    def points_in(self) -> int | None:
        """of the scene, that the step was given"""

    @points_in.setter
    def points_in(self, value: int | None, /) -> None: ...

    @property
    def points_out(self) -> int | None:
        """of the scene, that it left"""

    @points_out.setter
    def points_out(self, value: int | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Extras:
    """
    C.2.3.

    candidate_extras = (): in the order of the verification
    scene_extras: the scene
    time_profiling = (): each step
    timestamp = '': names the iteration's folder
    scene = '': the file that the scene was read from; empty: none
    reason = '': why nothing was recognized; empty when something was
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, candidate_extras: Sequence[CandidateExtras | Mapping[str, Any]] = (), scene_extras: SceneExtras | Mapping[str, Any] = ..., time_profiling: Sequence[MeasuredOperation | Mapping[str, Any]] = (), timestamp: str = '', scene: str = '', reason: str = '') -> None: ...

    @property
    def candidate_extras(self) -> tuple[CandidateExtras, ...]:
        """in the order of the verification"""

    @candidate_extras.setter
    def candidate_extras(self, value: Sequence[CandidateExtras | Mapping[str, Any]], /) -> None: ...

    @property
    def scene_extras(self) -> SceneExtras:
        """the scene"""

    @scene_extras.setter
    def scene_extras(self, value: SceneExtras | Mapping[str, Any], /) -> None: ...

    @property
    def time_profiling(self) -> tuple[MeasuredOperation, ...]:
        """each step"""

    @time_profiling.setter
    def time_profiling(self, value: Sequence[MeasuredOperation | Mapping[str, Any]], /) -> None: ...

    @property
    def timestamp(self) -> str:
        """names the iteration's folder"""

    @timestamp.setter
    def timestamp(self, value: str, /) -> None: ...

    @property
    def scene(self) -> str:
        """the file that the scene was read from; empty: none"""

    @scene.setter
    def scene(self, value: str, /) -> None: ...

    @property
    def reason(self) -> str:
        """why nothing was recognized; empty when something was"""

    @reason.setter
    def reason(self, value: str, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Evaluation:
    """
    C.2.4.

    ground_truth_model_id: -1 when the scene is not of a dataset
    ground_truth_model_name: the part that was shown; empty: none of them
    ground_truth_transformation_matrix: camera_from_model, 4x4 [mm]
    ground_truth_view_id: -1 when the scene is not of a dataset
    timestamp: names the iteration's folder
    recognized_correctly: whether the result names the part shown
    rotation_error_deg: eq. 2.2 [deg], -1 when the part is not the one shown
    translation_error_mm: eq. 2.3 [mm], -1 when the part is not the one shown
    diameter_mm: of the part shown: largest distance of two vertices [mm]
    add_mm: ADD [mm], symmetry ignored
    adi_mm: ADI [mm]
    mssd_mm: MSSD [mm], up to the part's symmetries
    mspd_px: MSPD [px of an image 640 px wide], up to the part's symmetries
    vsd: VSD, 0 to 1, mean over the ten taus of BOP
    indistinguishable: whether this camera cannot tell the result, part and pose, from the truth
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, ground_truth_model_id: int = ..., ground_truth_model_name: str = ..., ground_truth_transformation_matrix: numpy.typing.ArrayLike = ..., ground_truth_view_id: int = ..., timestamp: str = ..., recognized_correctly: bool = ..., rotation_error_deg: float = ..., translation_error_mm: float = ..., diameter_mm: float | None = ..., add_mm: float | None = ..., adi_mm: float | None = ..., mssd_mm: float | None = ..., mspd_px: float | None = ..., vsd: float | None = ..., indistinguishable: bool | None = ...) -> None: ...

    @property
    def ground_truth_model_id(self) -> int:
        """-1 when the scene is not of a dataset"""

    @ground_truth_model_id.setter
    def ground_truth_model_id(self, value: int, /) -> None: ...

    @property
    def ground_truth_model_name(self) -> str:
        """the part that was shown; empty: none of them"""

    @ground_truth_model_name.setter
    def ground_truth_model_name(self, value: str, /) -> None: ...

    @property
    def ground_truth_transformation_matrix(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """camera_from_model, 4x4 [mm]"""

    @ground_truth_transformation_matrix.setter
    def ground_truth_transformation_matrix(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def ground_truth_view_id(self) -> int:
        """-1 when the scene is not of a dataset"""

    @ground_truth_view_id.setter
    def ground_truth_view_id(self, value: int, /) -> None: ...

    @property
    def timestamp(self) -> str:
        """names the iteration's folder"""

    @timestamp.setter
    def timestamp(self, value: str, /) -> None: ...

    @property
    def recognized_correctly(self) -> bool:
        """whether the result names the part shown"""

    @recognized_correctly.setter
    def recognized_correctly(self, value: bool, /) -> None: ...

    @property
    def rotation_error_deg(self) -> float:
        """eq. 2.2 [deg], -1 when the part is not the one shown"""

    @rotation_error_deg.setter
    def rotation_error_deg(self, value: float, /) -> None: ...

    @property
    def translation_error_mm(self) -> float:
        """eq. 2.3 [mm], -1 when the part is not the one shown"""

    @translation_error_mm.setter
    def translation_error_mm(self, value: float, /) -> None: ...

    @property
    def diameter_mm(self) -> float | None:
        """of the part shown: largest distance of two vertices [mm]"""

    @diameter_mm.setter
    def diameter_mm(self, value: float | None, /) -> None: ...

    @property
    def add_mm(self) -> float | None:
        """ADD [mm], symmetry ignored"""

    @add_mm.setter
    def add_mm(self, value: float | None, /) -> None: ...

    @property
    def adi_mm(self) -> float | None:
        """ADI [mm]"""

    @adi_mm.setter
    def adi_mm(self, value: float | None, /) -> None: ...

    @property
    def mssd_mm(self) -> float | None:
        """MSSD [mm], up to the part's symmetries"""

    @mssd_mm.setter
    def mssd_mm(self, value: float | None, /) -> None: ...

    @property
    def mspd_px(self) -> float | None:
        """MSPD [px of an image 640 px wide], up to the part's symmetries"""

    @mspd_px.setter
    def mspd_px(self, value: float | None, /) -> None: ...

    @property
    def vsd(self) -> float | None:
        """VSD, 0 to 1, mean over the ten taus of BOP"""

    @vsd.setter
    def vsd(self, value: float | None, /) -> None: ...

    @property
    def indistinguishable(self) -> bool | None:
        """
        whether this camera cannot tell the result, part and pose, from the truth
        """

    @indistinguishable.setter
    def indistinguishable(self, value: bool | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class VisualizeOptions:
    """
    Which steps are drawn.

    preprocess = False: picture of the preprocessed scene
    normal_estimation = False: picture of the normals
    coarse_alignment = False: picture of the candidates after the coarse alignment
    pose_refinement = False: picture of the candidates after the refinement
    result = False: picture of the result
    result_with_candidates = False: picture of the result and all candidates
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, preprocess: bool = False, normal_estimation: bool = False, coarse_alignment: bool = False, pose_refinement: bool = False, result: bool = False, result_with_candidates: bool = False) -> None: ...

    @property
    def preprocess(self) -> bool:
        """picture of the preprocessed scene"""

    @preprocess.setter
    def preprocess(self, value: bool, /) -> None: ...

    @property
    def normal_estimation(self) -> bool:
        """picture of the normals"""

    @normal_estimation.setter
    def normal_estimation(self, value: bool, /) -> None: ...

    @property
    def coarse_alignment(self) -> bool:
        """picture of the candidates after the coarse alignment"""

    @coarse_alignment.setter
    def coarse_alignment(self, value: bool, /) -> None: ...

    @property
    def pose_refinement(self) -> bool:
        """picture of the candidates after the refinement"""

    @pose_refinement.setter
    def pose_refinement(self, value: bool, /) -> None: ...

    @property
    def result(self) -> bool:
        """picture of the result"""

    @result.setter
    def result(self, value: bool, /) -> None: ...

    @property
    def result_with_candidates(self) -> bool:
        """picture of the result and all candidates"""

    @result_with_candidates.setter
    def result_with_candidates(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DebugOptions:
    """
    What is reported and saved.

    result_to_cout = False: report the result as it is found
    step_notion_to_cout = False: report each step as it begins
    save_extras_json = False: write extras.json to the iteration's folder
    save_point_clouds = False: write the point clouds to the iteration's folder
    save_used_dataset_json = False: write used_dataset.json to the iteration's folder
    save_used_pipeline_config_json = False: write used_pipeline_config.json to the iteration's folder
    visualize_flag = False: write pictures of the steps chosen in visualize
    visualize: which steps
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, result_to_cout: bool = False, step_notion_to_cout: bool = False, save_extras_json: bool = False, save_point_clouds: bool = False, save_used_dataset_json: bool = False, save_used_pipeline_config_json: bool = False, visualize_flag: bool = False, visualize: VisualizeOptions | Mapping[str, Any] = ...) -> None: ...

    @property
    def result_to_cout(self) -> bool:
        """report the result as it is found"""

    @result_to_cout.setter
    def result_to_cout(self, value: bool, /) -> None: ...

    @property
    def step_notion_to_cout(self) -> bool:
        """report each step as it begins"""

    @step_notion_to_cout.setter
    def step_notion_to_cout(self, value: bool, /) -> None: ...

    @property
    def save_extras_json(self) -> bool:
        """write extras.json to the iteration's folder"""

    @save_extras_json.setter
    def save_extras_json(self, value: bool, /) -> None: ...

    @property
    def save_point_clouds(self) -> bool:
        """write the point clouds to the iteration's folder"""

    @save_point_clouds.setter
    def save_point_clouds(self, value: bool, /) -> None: ...

    @property
    def save_used_dataset_json(self) -> bool:
        """write used_dataset.json to the iteration's folder"""

    @save_used_dataset_json.setter
    def save_used_dataset_json(self, value: bool, /) -> None: ...

    @property
    def save_used_pipeline_config_json(self) -> bool:
        """write used_pipeline_config.json to the iteration's folder"""

    @save_used_pipeline_config_json.setter
    def save_used_pipeline_config_json(self, value: bool, /) -> None: ...

    @property
    def visualize_flag(self) -> bool:
        """write pictures of the steps chosen in visualize"""

    @visualize_flag.setter
    def visualize_flag(self, value: bool, /) -> None: ...

    @property
    def visualize(self) -> VisualizeOptions:
        """which steps"""

    @visualize.setter
    def visualize(self, value: VisualizeOptions | Mapping[str, Any], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DatabaseOptions:
    """
    How the views are made comparable with a scene.

    normals = 'estimated': "estimated": the views go through the scene's voxel grid and normal estimation; "mesh": as they are in the dataset, as the reference does
    noise_levels_mm = (0.0, 1.5, 3.0): each view is described once with noise of each of these standard deviations along its rays [mm], >= 0
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, normals: str = 'estimated', noise_levels_mm: Sequence[float] = (0.0, 1.5, 3.0)) -> None: ...

    @property
    def normals(self) -> str:
        """
        "estimated": the views go through the scene's voxel grid and normal estimation; "mesh": as they are in the dataset, as the reference does
        """

    @normals.setter
    def normals(self, value: str, /) -> None: ...

    @property
    def noise_levels_mm(self) -> tuple[float, ...]:
        """
        each view is described once with noise of each of these standard deviations along its rays [mm], >= 0
        """

    @noise_levels_mm.setter
    def noise_levels_mm(self, value: Sequence[float], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class GlobalPipelineConfig:
    """
    Appendix C.2.1 of the reference.

    preprocessing: what is done to the scene first
    normal_estimation: normals of the scene
    global_descriptor = 'vfh': "vfh", "cvfh", "ourcvfh", "good" or "esf"
    vfh: Viewpoint Feature Histogram
    cvfh: Clustered Viewpoint Feature Histogram
    ourcvfh: Oriented, Unique and Repeatable CVFH
    esf: Ensemble of Shape Functions
    good: Global Orthographic Object Descriptor
    database: how the dataset's views are made comparable with a scene
    coarse_alignment: first guess of a candidate's pose
    pose_refinement: iterative closest points
    hypothesis_verification: which candidates are believed
    debug: what is reported and saved
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, preprocessing: partpose.preprocess.PreprocessOptions | Mapping[str, Any] = ..., normal_estimation: partpose.preprocess.NormalEstimationOptions | Mapping[str, Any] = ..., global_descriptor: str = 'vfh', vfh: partpose.descriptor.VfhOptions | Mapping[str, Any] = ..., cvfh: partpose.descriptor.CvfhOptions | Mapping[str, Any] = ..., ourcvfh: partpose.descriptor.OurCvfhOptions | Mapping[str, Any] = ..., esf: partpose.descriptor.EsfOptions | Mapping[str, Any] = ..., good: partpose.descriptor.GoodOptions | Mapping[str, Any] = ..., database: DatabaseOptions | Mapping[str, Any] = ..., coarse_alignment: partpose.registration.CoarseAlignmentOptions | Mapping[str, Any] = ..., pose_refinement: partpose.registration.PoseRefinementOptions | Mapping[str, Any] = ..., hypothesis_verification: partpose.verification.HypothesisVerificationOptions | Mapping[str, Any] = ..., debug: DebugOptions | Mapping[str, Any] = ...) -> None: ...

    @property
    def preprocessing(self) -> partpose.preprocess.PreprocessOptions:
        """what is done to the scene first"""

    @preprocessing.setter
    def preprocessing(self, value: partpose.preprocess.PreprocessOptions | Mapping[str, Any], /) -> None: ...

    @property
    def normal_estimation(self) -> partpose.preprocess.NormalEstimationOptions:
        """normals of the scene"""

    @normal_estimation.setter
    def normal_estimation(self, value: partpose.preprocess.NormalEstimationOptions | Mapping[str, Any], /) -> None: ...

    @property
    def global_descriptor(self) -> str:
        """"vfh", "cvfh", "ourcvfh", "good" or "esf\""""

    @global_descriptor.setter
    def global_descriptor(self, value: str, /) -> None: ...

    @property
    def vfh(self) -> partpose.descriptor.VfhOptions:
        """Viewpoint Feature Histogram"""

    @vfh.setter
    def vfh(self, value: partpose.descriptor.VfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def cvfh(self) -> partpose.descriptor.CvfhOptions:
        """Clustered Viewpoint Feature Histogram"""

    @cvfh.setter
    def cvfh(self, value: partpose.descriptor.CvfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def ourcvfh(self) -> partpose.descriptor.OurCvfhOptions:
        """Oriented, Unique and Repeatable CVFH"""

    @ourcvfh.setter
    def ourcvfh(self, value: partpose.descriptor.OurCvfhOptions | Mapping[str, Any], /) -> None: ...

    @property
    def esf(self) -> partpose.descriptor.EsfOptions:
        """Ensemble of Shape Functions"""

    @esf.setter
    def esf(self, value: partpose.descriptor.EsfOptions | Mapping[str, Any], /) -> None: ...

    @property
    def good(self) -> partpose.descriptor.GoodOptions:
        """Global Orthographic Object Descriptor"""

    @good.setter
    def good(self, value: partpose.descriptor.GoodOptions | Mapping[str, Any], /) -> None: ...

    @property
    def database(self) -> DatabaseOptions:
        """how the dataset's views are made comparable with a scene"""

    @database.setter
    def database(self, value: DatabaseOptions | Mapping[str, Any], /) -> None: ...

    @property
    def coarse_alignment(self) -> partpose.registration.CoarseAlignmentOptions:
        """first guess of a candidate's pose"""

    @coarse_alignment.setter
    def coarse_alignment(self, value: partpose.registration.CoarseAlignmentOptions | Mapping[str, Any], /) -> None: ...

    @property
    def pose_refinement(self) -> partpose.registration.PoseRefinementOptions:
        """iterative closest points"""

    @pose_refinement.setter
    def pose_refinement(self, value: partpose.registration.PoseRefinementOptions | Mapping[str, Any], /) -> None: ...

    @property
    def hypothesis_verification(self) -> partpose.verification.HypothesisVerificationOptions:
        """which candidates are believed"""

    @hypothesis_verification.setter
    def hypothesis_verification(self, value: partpose.verification.HypothesisVerificationOptions | Mapping[str, Any], /) -> None: ...

    @property
    def debug(self) -> DebugOptions:
        """what is reported and saved"""

    @debug.setter
    def debug(self, value: DebugOptions | Mapping[str, Any], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def read_pipeline_config(path: str | os.PathLike[str]) -> GlobalPipelineConfig:
    """Absent keys keep their defaults."""

class CataloguePart:
    """A part of a catalogue."""

    @property
    def id(self) -> int:
        """Its number in the dataset."""

    @property
    def name(self) -> str:
        """As its file or its CAD product is called."""

    @property
    def T1(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """centred_from_model"""

    @property
    def mesh(self) -> partpose.core.TriangleMesh:
        """Model frame."""

    @property
    def surface(self) -> partpose.core.PointCloud:
        """All views fused, model frame, with normals."""

    def __repr__(self) -> str: ...

class Catalogue:
    """Everything that the online stage needs to know of the parts."""

    @property
    def dataset(self) -> partpose.dataset.Dataset:
        """The dataset that it was made of."""

    @property
    def parts(self) -> list[CataloguePart]:
        """In the order of their numbers."""

    @property
    def index(self) -> partpose.matching.DescriptorIndex:
        """The descriptors of all views."""

    @property
    def view_count(self) -> int:
        """Of all parts together."""

    def __repr__(self) -> str: ...

def load_catalogue(dataset: partpose.dataset.Dataset, config: GlobalPipelineConfig, progress: Callable[[str, int, int], object] | None = None) -> Catalogue:
    """The offline stage; kept in the dataset's folder."""

def without_part(catalogue: Catalogue, name: str) -> Catalogue:
    """The same catalogue without one of its parts."""

def comparable_view(view: partpose.core.PointCloud, config: GlobalPipelineConfig) -> partpose.core.PointCloud:
    """
    Points and normals of a dataset's view as a scene of it would have them.
    """

def default_cache_folder() -> pathlib.Path:
    """$XDG_CACHE_HOME/partpose, or else ~/.cache/partpose."""

def cached_catalogue(model_paths: Sequence[str | os.PathLike[str]], dataset: partpose.dataset.DatasetPreparationConfig, pipeline: GlobalPipelineConfig, cache_folder: str | os.PathLike[str] | None = None, progress: Callable[[str, int, int], object] | None = None) -> Catalogue:
    """The catalogue of some STL files, made on first use and kept."""

class Alternative:
    """Another part or pose that explains an object too."""

    @property
    def part(self) -> str:
        """Its name."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Its pose."""

    @property
    def probability(self) -> float:
        """0 to 1."""

    def __repr__(self) -> str: ...

class Explanation:
    """
    How a part at its pose and a frame explain each other: what the engine's score is made of.

    explained_pixels = 0: of those looked at
    agreement = 0.0: mean of both directions, 0 to 1
    deviation = 0.0: rms of the depths' differences, in the noise's standard deviations
    roughness = 0.0: the same from their mean within some pixels, in standard deviations of what neighbouring pixels differ by
    unexplained = 0.0: share of the object's pixels
    free_space = 0.0: share of the part's visible pixels before what was measured, or beneath the table, not beside an outline
    not_measured = 0.0: share of the part's visible pixels where nothing was measured
    beside = 0.0: share of the part's visible pixels that are not the object's, but next to its outline
    narrower = 0.0: share of the part's visible pixels that are beside where something else was measured
    size_ratio = 1.0: pixels where the part shows, as far as anything was measured there, over the object's
    edges = 0.0: of the jumps in depth within the object and within the part: the share that both have
    fine_shape = 0.0: correlation of both depths' differences from their mean within three pixels
    fine_gain = 0.0: so much of the part's such differences is measured; 1: all
    noise = 0.0: standard deviation of a depth, over the extent of what is seen
    local_noise = 1.0: of that: what neighbouring pixels differ by; 1: each errs for itself
    relief = 0.0: of what is seen from its best plane, in the noise's standard deviations
    height = 0.0: of the part's lowest place above the table, in diameters; below 0 it sinks in
    height_deviations = 0.0: the same in the noise's standard deviations
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, explained_pixels: int = 0, agreement: float = 0.0, deviation: float = 0.0, roughness: float = 0.0, unexplained: float = 0.0, free_space: float = 0.0, not_measured: float = 0.0, beside: float = 0.0, narrower: float = 0.0, size_ratio: float = 1.0, edges: float = 0.0, fine_shape: float = 0.0, fine_gain: float = 0.0, noise: float = 0.0, local_noise: float = 1.0, relief: float = 0.0, height: float = 0.0, height_deviations: float = 0.0) -> None: ...

    @property
    def explained_pixels(self) -> int:
        """of those looked at"""

    @explained_pixels.setter
    def explained_pixels(self, value: int, /) -> None: ...

    @property
    def agreement(self) -> float:
        """mean of both directions, 0 to 1"""

    @agreement.setter
    def agreement(self, value: float, /) -> None: ...

    @property
    def deviation(self) -> float:
        """rms of the depths' differences, in the noise's standard deviations"""

    @deviation.setter
    def deviation(self, value: float, /) -> None: ...

    @property
    def roughness(self) -> float:
        """
        the same from their mean within some pixels, in standard deviations of what neighbouring pixels differ by
        """

    @roughness.setter
    def roughness(self, value: float, /) -> None: ...

    @property
    def unexplained(self) -> float:
        """share of the object's pixels"""

    @unexplained.setter
    def unexplained(self, value: float, /) -> None: ...

    @property
    def free_space(self) -> float:
        """
        share of the part's visible pixels before what was measured, or beneath the table, not beside an outline
        """

    @free_space.setter
    def free_space(self, value: float, /) -> None: ...

    @property
    def not_measured(self) -> float:
        """share of the part's visible pixels where nothing was measured"""

    @not_measured.setter
    def not_measured(self, value: float, /) -> None: ...

    @property
    def beside(self) -> float:
        """
        share of the part's visible pixels that are not the object's, but next to its outline
        """

    @beside.setter
    def beside(self, value: float, /) -> None: ...

    @property
    def narrower(self) -> float:
        """
        share of the part's visible pixels that are beside where something else was measured
        """

    @narrower.setter
    def narrower(self, value: float, /) -> None: ...

    @property
    def size_ratio(self) -> float:
        """
        pixels where the part shows, as far as anything was measured there, over the object's
        """

    @size_ratio.setter
    def size_ratio(self, value: float, /) -> None: ...

    @property
    def edges(self) -> float:
        """
        of the jumps in depth within the object and within the part: the share that both have
        """

    @edges.setter
    def edges(self, value: float, /) -> None: ...

    @property
    def fine_shape(self) -> float:
        """
        correlation of both depths' differences from their mean within three pixels
        """

    @fine_shape.setter
    def fine_shape(self, value: float, /) -> None: ...

    @property
    def fine_gain(self) -> float:
        """so much of the part's such differences is measured; 1: all"""

    @fine_gain.setter
    def fine_gain(self, value: float, /) -> None: ...

    @property
    def noise(self) -> float:
        """standard deviation of a depth, over the extent of what is seen"""

    @noise.setter
    def noise(self, value: float, /) -> None: ...

    @property
    def local_noise(self) -> float:
        """of that: what neighbouring pixels differ by; 1: each errs for itself"""

    @local_noise.setter
    def local_noise(self, value: float, /) -> None: ...

    @property
    def relief(self) -> float:
        """
        of what is seen from its best plane, in the noise's standard deviations
        """

    @relief.setter
    def relief(self, value: float, /) -> None: ...

    @property
    def height(self) -> float:
        """
        of the part's lowest place above the table, in diameters; below 0 it sinks in
        """

    @height.setter
    def height(self, value: float, /) -> None: ...

    @property
    def height_deviations(self) -> float:
        """the same in the noise's standard deviations"""

    @height_deviations.setter
    def height_deviations(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Detection:
    """A part found in a frame."""

    @property
    def part(self) -> str:
        """Its name."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The pose, mm."""

    @property
    def score(self) -> float:
        """0 to 1."""

    @property
    def confidence(self) -> float | None:
        """
        Probability that part and pose are right, up to what this camera cannot tell apart; 0 to 1. None: this recognizer states none.
        """

    @property
    def covariance(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(6, 6))] | None:
        """
        6 x 6, of a small rotation vector [rad] and translation [mm] of the part, about its box's middle, in the camera's axes. None: this recognizer states none.
        """

    @property
    def explanation(self) -> Explanation | None:
        """
        What the score is made of. None: of another recognizer than the engine.
        """

    @property
    def alternatives(self) -> list[Alternative]:
        """Likeliest first; poses that are the same by symmetry are not listed."""

    def __repr__(self) -> str: ...

class Recognition:
    """What happened to one scene; false when nothing was recognized."""

    @property
    def part(self) -> str | None:
        """Its name; None: nothing was recognized."""

    @property
    def camera_from_model(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))] | None:
        """The pose, mm."""

    @property
    def score(self) -> float:
        """0 to 1, of the best candidate, accepted or not; -1: there was none."""

    @property
    def confidence(self) -> float | None:
        """
        Probability that part and pose are right, up to what this camera cannot tell apart; 0 to 1. None: nothing was recognized, or this recognizer states none.
        """

    @property
    def alternatives(self) -> list[Alternative]:
        """Other parts and poses that explain the object too, likeliest first."""

    @property
    def detections(self) -> list[Detection]:
        """All objects that were recognized, the result first."""

    @property
    def candidates(self) -> list[CandidateExtras]:
        """
        In the order of the decision, each with its pose T_final and its verdict.
        """

    @property
    def stages(self) -> list[MeasuredOperation]:
        """The steps and their times."""

    @property
    def reason(self) -> str:
        """Why nothing was recognized; empty when something was."""

    @property
    def total_ms(self) -> float:
        """Of all stages."""

    @property
    def result(self) -> Result:
        """C.2.2."""

    @property
    def extras(self) -> Extras:
        """C.2.3."""

    @property
    def symmetries(self) -> partpose.geometry.Symmetries:
        """Of the part recognized, model frame."""

    def equivalent_poses(self, max_step: float = 0.1) -> list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]:
        """
        All camera_from_model that look the same because of the part's symmetries, the one found first; turns about an axis so small that no point moves by more than max_step of the diameter.
        """

    def __bool__(self) -> bool: ...

    @property
    def preprocessed(self) -> partpose.core.PointCloud:
        """The scene after the preprocessing, camera frame."""

    @property
    def with_normals(self) -> partpose.core.PointCloud:
        """The same with normals."""

    @property
    def refinement_scene(self) -> partpose.core.PointCloud:
        """What the refinement was given."""

    @property
    def num_of_points_input(self) -> int:
        """Before the preprocessing."""

    def __repr__(self) -> str: ...

class PartRecognizer:
    """
    What recognizes the part in a scene: one of the pipelines with its catalogue. Immutable; several threads may use it at once.
    """

    @overload
    def recognize(self, depth: Annotated[numpy.typing.NDArray[numpy.uint16 | numpy.float32 | numpy.float64], dict(shape=(None, None))], intrinsics: partpose.core.Intrinsics, depth_scale_mm: float = 1.0) -> Recognition:
        """
        A full depth frame, or a part of one: pixels in units of depth_scale_mm mm, 0: no value.
        """

    @overload
    def recognize(self, depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics) -> Recognition: ...

    @overload
    def recognize(self, points: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))]) -> Recognition:
        """Points in mm, taken by a camera at the origin that looks along z."""

    @overload
    def recognize(self, cloud: partpose.core.PointCloud) -> Recognition: ...

    @overload
    def recognize(self, scene: partpose.io.Scene) -> Recognition: ...

    @overload
    def recognize(self, scene: str | os.PathLike[str]) -> Recognition:
        """A scene's file, as of read_scene."""

    @property
    def catalogue(self) -> Catalogue:
        """The parts that it knows."""

    def __repr__(self) -> str: ...

class RecognizerOptions:
    """
    What the Recognizer may be told.

    min_score = 0.72: a candidate whose render-and-compare score is lower is not believed, 0 to 1
    shortlist_views = 400: views that go on from the matching, >= 1
    rolls = 12: turns about the line of sight that each is tried at, >= 1
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, min_score: float = 0.72, shortlist_views: int = 400, rolls: int = 12) -> None: ...

    @property
    def min_score(self) -> float:
        """
        a candidate whose render-and-compare score is lower is not believed, 0 to 1
        """

    @min_score.setter
    def min_score(self, value: float, /) -> None: ...

    @property
    def shortlist_views(self) -> int:
        """views that go on from the matching, >= 1"""

    @shortlist_views.setter
    def shortlist_views(self, value: int, /) -> None: ...

    @property
    def rolls(self) -> int:
        """turns about the line of sight that each is tried at, >= 1"""

    @rolls.setter
    def rolls(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Recognizer(PartRecognizer):
    """The pipeline without a configuration."""

    def __init__(self, catalogue: Catalogue, options: RecognizerOptions = ...) -> None: ...

    @staticmethod
    def from_files(paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], options: RecognizerOptions = ..., cache_folder: str | os.PathLike[str] | None = None, progress: Callable[[str, int, int], object] | None = None) -> Recognizer:
        """
        Of model files, or folders of them. The catalogue is made on first use and kept under the cache folder.
        """

    @staticmethod
    def catalogue_config() -> GlobalPipelineConfig:
        """The pipeline configuration that its catalogue is to be made with."""

class GlobalPipeline(PartRecognizer):
    """
    The online stage of the reference: matches, aligns, refines and verifies.
    """

    def __init__(self, catalogue: Catalogue, config: GlobalPipelineConfig, step_notion: Callable[[str], object] | None = None) -> None: ...

    @property
    def config(self) -> GlobalPipelineConfig:
        """What it was made with."""

def write_iteration(folder: str | os.PathLike[str], recognition: Recognition, scene: partpose.io.Scene, catalogue: Catalogue, config: GlobalPipelineConfig) -> pathlib.Path:
    """Writes the iteration output folder of the reference and returns it."""

def draw_overlay(depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, mesh: partpose.core.TriangleMesh | None = None, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')] | None = None) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None, 3))]:
    """
    The measured depth as a shaded relief with the part drawn over it, height x width x 3, RGB.
    """

# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import os
import pathlib
from typing import Annotated, Any, Self

import numpy
import numpy.typing
from numpy.typing import NDArray

import partpose.core
import partpose.dataset
import partpose.geometry
import partpose.io
import partpose.pipeline


def add_mm(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> float:
    """ADD: mean distance of each vertex from itself."""

def adi_mm(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> float:
    """ADI (ADD-S): mean distance from the nearest vertex."""

def mssd_mm(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], symmetries: partpose.geometry.Symmetries = ...) -> float:
    """
    MSSD: the largest distance of a vertex from itself, at the nearest of the equivalent poses.
    """

def mspd_px(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], symmetries: partpose.geometry.Symmetries, intrinsics: partpose.core.Intrinsics) -> float:
    """MSPD: the same in the image, px."""

def ad_mm(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], symmetric: bool) -> float:
    """AD: ADI of a symmetric object, or else ADD."""

def projection_error_px(vertices: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], intrinsics: partpose.core.Intrinsics) -> float:
    """
    The mean distance of the vertices' projections in px, symmetry ignored.
    """

def visible_surface_discrepancy(mesh: partpose.core.TriangleMesh, measured: partpose.core.DepthImage, estimate: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], intrinsics: partpose.core.Intrinsics, diameter_mm: float, delta_mm: float = 15.0) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
    """
    VSD for each tau of bop_fractions(), in shares of the diameter. The part is rendered at both poses.
    """

def bop_fractions() -> list[float]:
    """
    0.05, 0.10, ..., 0.50: the thresholds of MSSD (shares of the diameter) and VSD, and its taus.
    """

def bop_pixels() -> list[float]:
    """5, 10, ..., 50: the thresholds of MSPD in px of an image 640 px wide."""

class GroundTruth:
    """What a scene shows. An empty name: none of the catalogue's parts."""

    def __init__(self, model_name: str, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], model_id: int = -1, view_id: int = -1) -> None: ...

    @property
    def model_name(self) -> str:
        """Of the part shown."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Its pose."""

    @property
    def model_id(self) -> int:
        """Its number in the dataset; -1: not known."""

    @property
    def view_id(self) -> int:
        """Of the dataset's view; -1: it is none."""

    def __repr__(self) -> str: ...

def evaluate(result: partpose.pipeline.Result, truth: GroundTruth) -> partpose.pipeline.Evaluation:
    """Compares a result with the truth (C.2.4; eq. 2.2 and 2.3)."""

class ProtocolFrame:
    """A dataset's view as a test scene."""

    @property
    def truth(self) -> GroundTruth:
        """What was shown."""

    @property
    def result(self) -> partpose.pipeline.Result:
        """What was recognized."""

    @property
    def evaluation(self) -> partpose.pipeline.Evaluation:
        """How they compare."""

    @property
    def time_ms(self) -> float:
        """Of the recognition."""

    def __repr__(self) -> str: ...

class ProtocolSummary:
    """What some frames came to."""

    @property
    def frames(self) -> int:
        """How many."""

    @property
    def correct(self) -> int:
        """The part is right."""

    @property
    def wrong(self) -> int:
        """Another part."""

    @property
    def none(self) -> int:
        """Nothing recognized."""

    @property
    def pose_right(self) -> int:
        """Correct, and within both limits."""

    @property
    def median_ms(self) -> float:
        """Time of a frame."""

    @property
    def p95_ms(self) -> float:
        """Time of a frame that 95 % stay below."""

    def correct_percent(self) -> float:
        """Of all frames."""

    def wrong_percent(self) -> float:
        """Of all frames."""

    def none_percent(self) -> float:
        """Of all frames."""

    def pose_right_percent(self) -> float:
        """Of all frames."""

    def __repr__(self) -> str: ...

def run_protocol(pipeline: partpose.pipeline.GlobalPipeline, test: partpose.dataset.Dataset, progress: Callable[[str, int, int], object] | None = None, output: str | os.PathLike[str] | None = None) -> list[ProtocolFrame]:
    """
    Runs the pipeline on every view of every model of `test` (reference, 6.2.1). `output`: where each frame's iteration folder, with evaluation.json, goes.
    """

def summarize(frames: Sequence[ProtocolFrame], limit_deg: float = 15.0, limit_mm: float = 15.0) -> ProtocolSummary:
    """Counts; a pose is right below both limits, symmetry ignored."""

class BoundRecord:
    """
    How well a frame's pose can be known at best (Cramer-Rao), and how well it was.

    determined: whether the ranges determine the pose; without it the rest is 0
    rotation_deg: bound of the rotation: root of the trace [deg]
    translation_mm: bound of the translation: root of the trace [mm]
    rotation_error_deg: reached [deg]
    translation_error_mm: reached [mm]
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, determined: bool = ..., rotation_deg: float = ..., translation_mm: float = ..., rotation_error_deg: float = ..., translation_error_mm: float = ...) -> None: ...

    @property
    def determined(self) -> bool:
        """whether the ranges determine the pose; without it the rest is 0"""

    @determined.setter
    def determined(self, value: bool, /) -> None: ...

    @property
    def rotation_deg(self) -> float:
        """bound of the rotation: root of the trace [deg]"""

    @rotation_deg.setter
    def rotation_deg(self, value: float, /) -> None: ...

    @property
    def translation_mm(self) -> float:
        """bound of the translation: root of the trace [mm]"""

    @translation_mm.setter
    def translation_mm(self, value: float, /) -> None: ...

    @property
    def rotation_error_deg(self) -> float:
        """reached [deg]"""

    @rotation_error_deg.setter
    def rotation_error_deg(self, value: float, /) -> None: ...

    @property
    def translation_error_mm(self) -> float:
        """reached [mm]"""

    @translation_error_mm.setter
    def translation_error_mm(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class ObjectRecord:
    """
    A part of the catalogue that is in a frame, and whether it was found.

    part: the part
    visible_fraction: of its silhouette, 0 to 1
    detection: index of the detection that names its part where it is; -1: not found
    pose_right: whether a detection has MSSD below 10 % of the diameter, or cannot be told from the truth by this camera
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, part: str = ..., visible_fraction: float = ..., detection: int = ..., pose_right: bool = ...) -> None: ...

    @property
    def part(self) -> str:
        """the part"""

    @part.setter
    def part(self, value: str, /) -> None: ...

    @property
    def visible_fraction(self) -> float:
        """of its silhouette, 0 to 1"""

    @visible_fraction.setter
    def visible_fraction(self, value: float, /) -> None: ...

    @property
    def detection(self) -> int:
        """index of the detection that names its part where it is; -1: not found"""

    @detection.setter
    def detection(self, value: int, /) -> None: ...

    @property
    def pose_right(self) -> bool:
        """
        whether a detection has MSSD below 10 % of the diameter, or cannot be told from the truth by this camera
        """

    @pose_right.setter
    def pose_right(self, value: bool, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DetectionRecord:
    """
    What one detection is worth.

    part: the part
    camera_from_model: 4x4 [mm]
    score: 0 to 1
    confidence: stated probability that part and pose are right, 0 to 1
    object: index of the object that it stands for; -1: none
    part_right: whether it names that object's part
    right: whether part and pose are right, or cannot be told from the truth by this camera
    explanation: what the engine's score is made of
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, part: str = ..., camera_from_model: numpy.typing.ArrayLike = ..., score: float = ..., confidence: float = ..., object: int = ..., part_right: bool = ..., right: bool = ..., explanation: partpose.pipeline.Explanation | Mapping[str, Any] | None = ...) -> None: ...

    @property
    def part(self) -> str:
        """the part"""

    @part.setter
    def part(self, value: str, /) -> None: ...

    @property
    def camera_from_model(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """4x4 [mm]"""

    @camera_from_model.setter
    def camera_from_model(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def score(self) -> float:
        """0 to 1"""

    @score.setter
    def score(self, value: float, /) -> None: ...

    @property
    def confidence(self) -> float:
        """stated probability that part and pose are right, 0 to 1"""

    @confidence.setter
    def confidence(self, value: float, /) -> None: ...

    @property
    def object(self) -> int:
        """index of the object that it stands for; -1: none"""

    @object.setter
    def object(self, value: int, /) -> None: ...

    @property
    def part_right(self) -> bool:
        """whether it names that object's part"""

    @part_right.setter
    def part_right(self, value: bool, /) -> None: ...

    @property
    def right(self) -> bool:
        """
        whether part and pose are right, or cannot be told from the truth by this camera
        """

    @right.setter
    def right(self, value: bool, /) -> None: ...

    @property
    def explanation(self) -> partpose.pipeline.Explanation | None:
        """what the engine's score is made of"""

    @explanation.setter
    def explanation(self, value: partpose.pipeline.Explanation | Mapping[str, Any] | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: Any, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class FrameObjects:
    """
    What is in a frame, and what was recognized in it.

    objects: parts of the catalogue that are in the frame
    detections: what was recognized, likeliest first
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, objects: Sequence[ObjectRecord | Mapping[str, Any]] = ..., detections: Sequence[DetectionRecord | Mapping[str, Any]] = ...) -> None: ...

    @property
    def objects(self) -> tuple[ObjectRecord, ...]:
        """parts of the catalogue that are in the frame"""

    @objects.setter
    def objects(self, value: Sequence[ObjectRecord | Mapping[str, Any]], /) -> None: ...

    @property
    def detections(self) -> tuple[DetectionRecord, ...]:
        """what was recognized, likeliest first"""

    @detections.setter
    def detections(self, value: Sequence[DetectionRecord | Mapping[str, Any]], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class FrameRecord:
    """
    What one frame of one run of an experiment gave.

    run: group, protocol, configuration and descriptor
    group: the parts
    protocol: the scenes
    configuration: the pipeline
    descriptor: its descriptor; "-": the Recognizer's own
    frame: names the frame within its protocol
    left_out: whether the part shown is missing from the catalogue
    result: C.2.2
    evaluation: C.2.4
    score: of the best candidate, accepted or not, 0 to 1; -1: there was none
    best_is_right: whether that candidate names the part shown
    reason: why nothing was recognized
    stages: time of each step
    time_ms: time of the frame [ms]
    objects: each object of the frame and each detection
    bound: the physical limit beside the error; where the noise is known and the part is right
    folder: of the frame's output; empty: not kept
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, run: str = ..., group: str = ..., protocol: str = ..., configuration: str = ..., descriptor: str = ..., frame: str = ..., left_out: bool = ..., result: partpose.pipeline.Result | Mapping[str, Any] = ..., evaluation: partpose.pipeline.Evaluation | Mapping[str, Any] = ..., score: float = ..., best_is_right: bool = ..., reason: str = ..., stages: Sequence[partpose.pipeline.MeasuredOperation | Mapping[str, Any]] = ..., time_ms: float = ..., objects: FrameObjects | Mapping[str, Any] | None = ..., bound: BoundRecord | Mapping[str, Any] | None = ..., folder: str = ...) -> None: ...

    @property
    def run(self) -> str:
        """group, protocol, configuration and descriptor"""

    @run.setter
    def run(self, value: str, /) -> None: ...

    @property
    def group(self) -> str:
        """the parts"""

    @group.setter
    def group(self, value: str, /) -> None: ...

    @property
    def protocol(self) -> str:
        """the scenes"""

    @protocol.setter
    def protocol(self, value: str, /) -> None: ...

    @property
    def configuration(self) -> str:
        """the pipeline"""

    @configuration.setter
    def configuration(self, value: str, /) -> None: ...

    @property
    def descriptor(self) -> str:
        """its descriptor; "-": the Recognizer's own"""

    @descriptor.setter
    def descriptor(self, value: str, /) -> None: ...

    @property
    def frame(self) -> str:
        """names the frame within its protocol"""

    @frame.setter
    def frame(self, value: str, /) -> None: ...

    @property
    def left_out(self) -> bool:
        """whether the part shown is missing from the catalogue"""

    @left_out.setter
    def left_out(self, value: bool, /) -> None: ...

    @property
    def result(self) -> partpose.pipeline.Result:
        """C.2.2"""

    @result.setter
    def result(self, value: partpose.pipeline.Result | Mapping[str, Any], /) -> None: ...

    @property
    def evaluation(self) -> partpose.pipeline.Evaluation:
        """C.2.4"""

    @evaluation.setter
    def evaluation(self, value: partpose.pipeline.Evaluation | Mapping[str, Any], /) -> None: ...

    @property
    def score(self) -> float:
        """of the best candidate, accepted or not, 0 to 1; -1: there was none"""

    @score.setter
    def score(self, value: float, /) -> None: ...

    @property
    def best_is_right(self) -> bool:
        """whether that candidate names the part shown"""

    @best_is_right.setter
    def best_is_right(self, value: bool, /) -> None: ...

    @property
    def reason(self) -> str:
        """why nothing was recognized"""

    @reason.setter
    def reason(self, value: str, /) -> None: ...

    @property
    def stages(self) -> tuple[partpose.pipeline.MeasuredOperation, ...]:
        """time of each step"""

    @stages.setter
    def stages(self, value: Sequence[partpose.pipeline.MeasuredOperation | Mapping[str, Any]], /) -> None: ...

    @property
    def time_ms(self) -> float:
        """time of the frame [ms]"""

    @time_ms.setter
    def time_ms(self, value: float, /) -> None: ...

    @property
    def objects(self) -> FrameObjects | None:
        """each object of the frame and each detection"""

    @objects.setter
    def objects(self, value: FrameObjects | Mapping[str, Any] | None, /) -> None: ...

    @property
    def bound(self) -> BoundRecord | None:
        """
        the physical limit beside the error; where the noise is known and the part is right
        """

    @bound.setter
    def bound(self, value: BoundRecord | Mapping[str, Any] | None, /) -> None: ...

    @property
    def folder(self) -> str:
        """of the frame's output; empty: not kept"""

    @folder.setter
    def folder(self, value: str, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def run_experiment(spec_file: str | os.PathLike[str], output: str | os.PathLike[str], progress: Callable[[str, int, int], object] | None = None) -> list[FrameRecord]:
    """
    Runs all frames that `output` does not have yet, and writes the tables.
    """

def read_frame_records(output: str | os.PathLike[str]) -> list[FrameRecord]:
    """The finished frames of an experiment's folder."""

class AmbiguityOptions:
    """
    When two depth images are the same to a camera.

    disparity_sigma_px = 0.08: standard deviation of the disparity [px], >= 0
    baseline_mm = 55.0: distance of the stereo camera's imagers [mm], > 0
    floor_mm = 0.3: standard deviation that is there at any depth [mm], > 0 (1 mm steps: 0.29)
    slow_percent = 0.0: largest error of the depth, of either sign, that is the same all over a part [%], 0 to 20
    sigmas = 3.0: depths farther apart than so many standard deviations differ, > 0
    max_share = 0.01: share of the pixels that may differ, 0 to 1
    max_px = 25: pixels that may differ in any case, >= 0
    max_rms_sigmas = 1.0: root mean square difference of the others [standard deviations], > 0
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, disparity_sigma_px: float = 0.08, baseline_mm: float = 55.0, floor_mm: float = 0.3, slow_percent: float = 0.0, sigmas: float = 3.0, max_share: float = 0.01, max_px: int = 25, max_rms_sigmas: float = 1.0) -> None: ...

    @property
    def disparity_sigma_px(self) -> float:
        """standard deviation of the disparity [px], >= 0"""

    @disparity_sigma_px.setter
    def disparity_sigma_px(self, value: float, /) -> None: ...

    @property
    def baseline_mm(self) -> float:
        """distance of the stereo camera's imagers [mm], > 0"""

    @baseline_mm.setter
    def baseline_mm(self, value: float, /) -> None: ...

    @property
    def floor_mm(self) -> float:
        """
        standard deviation that is there at any depth [mm], > 0 (1 mm steps: 0.29)
        """

    @floor_mm.setter
    def floor_mm(self, value: float, /) -> None: ...

    @property
    def slow_percent(self) -> float:
        """
        largest error of the depth, of either sign, that is the same all over a part [%], 0 to 20
        """

    @slow_percent.setter
    def slow_percent(self, value: float, /) -> None: ...

    @property
    def sigmas(self) -> float:
        """depths farther apart than so many standard deviations differ, > 0"""

    @sigmas.setter
    def sigmas(self, value: float, /) -> None: ...

    @property
    def max_share(self) -> float:
        """share of the pixels that may differ, 0 to 1"""

    @max_share.setter
    def max_share(self, value: float, /) -> None: ...

    @property
    def max_px(self) -> int:
        """pixels that may differ in any case, >= 0"""

    @max_px.setter
    def max_px(self, value: int, /) -> None: ...

    @property
    def max_rms_sigmas(self) -> float:
        """root mean square difference of the others [standard deviations], > 0"""

    @max_rms_sigmas.setter
    def max_rms_sigmas(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DepthDifference:
    """How far apart two depth images are."""

    @property
    def union_px(self) -> int:
        """Pixels where either part is seen."""

    @property
    def differing_px(self) -> int:
        """Of them: those that differ by more than noise."""

    @property
    def rms_sigmas(self) -> float:
        """Of the others, in standard deviations."""

    def share(self) -> float:
        """differing_px / union_px."""

    def indistinguishable(self, options: AmbiguityOptions = ...) -> bool:
        """Whether a camera with this noise sees no difference."""

    def __repr__(self) -> str: ...

def depth_difference(part_a: partpose.core.TriangleMesh, camera_from_a: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], part_b: partpose.core.TriangleMesh, camera_from_b: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], intrinsics: partpose.core.Intrinsics, options: AmbiguityOptions = ...) -> DepthDifference:
    """As rendered by this camera, nothing else in view."""

class AmbiguousPose:
    """Another pose, perhaps of another part, that looks the same."""

    @property
    def part(self) -> int:
        """Index of whose; may be another part than the one seen."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The other pose."""

    @property
    def difference(self) -> DepthDifference:
        """How the two depth images differ."""

    @property
    def displacement_mm(self) -> float:
        """How far a point of the part is moved at most."""

    def __repr__(self) -> str: ...

class AmbiguitySearch:
    """
    Finds, for a part at a pose, other poses of it and poses of other parts that a camera cannot tell from it.
    """

    def __init__(self, catalogue: partpose.pipeline.Catalogue, intrinsics: partpose.core.Intrinsics, difference: AmbiguityOptions = ..., min_displacement: float = 0.05, turn_step_deg: float = 10.0, most_poses: int = 40) -> None: ...

    @property
    def names(self) -> list[str]:
        """Of its parts."""

    def at(self, part: str, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]) -> list[AmbiguousPose]:
        """Best first; empty when the view determines part and pose."""

class PoseJudge:
    """
    Judges results by figures that know the parts' symmetries and what a camera can tell apart.
    """

    def __init__(self, catalogue: partpose.pipeline.Catalogue) -> None: ...

    def judge(self, result: partpose.pipeline.Result, truth: GroundTruth, intrinsics: partpose.core.Intrinsics, depth: partpose.core.DepthImage | None = None, noise: AmbiguityOptions = ...) -> partpose.pipeline.Evaluation:
        """
        `evaluate` with ADD, ADI, MSSD, MSPD and VSD beside, and whether the camera can tell part and pose from the truth. `depth`: as measured; None: VSD takes all of the part for visible.
        """

    def diameter_mm(self, part: str) -> float:
        """The largest distance of two vertices."""

def mssd_below(evaluation: partpose.pipeline.Evaluation, share_of_diameter: float) -> bool:
    """
    Whether the largest deviation (MSSD) is below a share of the part's diameter.
    """

class CapturedScene:
    """One object in a scene of a set, or none."""

    @property
    def path(self) -> pathlib.Path:
        """Its file."""

    @property
    def kind(self) -> str:
        """What it shows beside the object, as with_table."""

    @property
    def model_name(self) -> str:
        """Empty: the scene shows none of the set's models."""

    @property
    def camera_from_model(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]:
        """All equivalent poses."""

    def __repr__(self) -> str: ...

class CapturedSet:
    """Scenes with ground truth."""

    @property
    def folder(self) -> pathlib.Path:
        """Where it is."""

    @property
    def scenes(self) -> list[CapturedScene]:
        """As gt.json lists them."""

    @property
    def symmetries(self) -> dict[str, list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]]:
        """By model name: model_from_model, the identity first."""

    def __repr__(self) -> str: ...

def read_captured_set(folder: str | os.PathLike[str]) -> CapturedSet:
    """A folder with models/, gt.json and, if it likes, symmetries.json."""

class SymmetricPoseError:
    """How far a pose is from the nearest equivalent one."""

    @property
    def rotation_deg(self) -> float:
        """Angle between the two."""

    @property
    def translation_mm(self) -> float:
        """Distance of the two origins."""

    @property
    def largest_displacement_mm(self) -> float:
        """Of a corner of the part's bounding box."""

    def __repr__(self) -> str: ...

def symmetric_pose_error(camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], truth: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]], symmetries: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]], mesh: partpose.core.TriangleMesh) -> SymmetricPoseError:
    """
    `truth`: equivalent poses; `symmetries`: model_from_model, the identity at least.
    """

def bop_catalogue(dataset: partpose.io.BopDataset, cache_folder: str | os.PathLike[str] | None = None, progress: Callable[[str, int, int], object] | None = None) -> partpose.pipeline.Catalogue:
    """The catalogue of those objects of a dataset that its targets ask for."""

def recognize_bop_image(recognizer: partpose.pipeline.PartRecognizer, depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, wanted: Mapping[int, int], min_score: float) -> list[partpose.io.BopEstimate]:
    """The instances that are wanted, by obj_id, in one depth image."""

def recognize_bop(dataset: partpose.io.BopDataset, recognizer: partpose.pipeline.PartRecognizer, min_score: float, progress: Callable[[str, int, int], object] | None = None) -> list[partpose.io.BopEstimate]:
    """The estimates of all targets' images."""

class BopScoreOptions:
    """
    How a results file is scored.

    vsd = True: whether VSD is taken, where there are depth images
    vsd_delta_mm = 15.0: a surface this far behind what was measured still counts as visible [mm]
    image_width = 0: px; 0: of camera.json, or else of the depth images
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, vsd: bool = True, vsd_delta_mm: float = 15.0, image_width: int = 0) -> None: ...

    @property
    def vsd(self) -> bool:
        """whether VSD is taken, where there are depth images"""

    @vsd.setter
    def vsd(self, value: bool, /) -> None: ...

    @property
    def vsd_delta_mm(self) -> float:
        """
        a surface this far behind what was measured still counts as visible [mm]
        """

    @vsd_delta_mm.setter
    def vsd_delta_mm(self, value: float, /) -> None: ...

    @property
    def image_width(self) -> int:
        """px; 0: of camera.json, or else of the depth images"""

    @image_width.setter
    def image_width(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class BopMatch:
    """An estimate that found a ground truth."""

    @property
    def scene_id(self) -> int:
        """In which scene."""

    @property
    def im_id(self) -> int:
        """In which image."""

    @property
    def gt_id(self) -> int:
        """The ground truth found."""

    @property
    def est_id(self) -> int:
        """The estimate that found it."""

    def __repr__(self) -> str: ...

class BopRecall:
    """What is found at one threshold."""

    @property
    def threshold(self) -> float:
        """Of the error."""

    @property
    def targets_count(self) -> int:
        """Valid ground truths."""

    @property
    def tp_count(self) -> int:
        """Of them: found."""

    @property
    def recall(self) -> float:
        """Of all targets together."""

    @property
    def mean_obj_recall(self) -> float:
        """Mean of the objects' recalls."""

    @property
    def mean_scene_recall(self) -> float:
        """Mean of the scenes' recalls."""

    @property
    def obj_recall(self) -> dict[int, float]:
        """By obj_id."""

    @property
    def scene_recall(self) -> dict[int, float]:
        """By scene_id."""

    @property
    def matches(self) -> list[BopMatch]:
        """Which estimate found what."""

    def __repr__(self) -> str: ...

class BopScore:
    """Recalls by one error."""

    @property
    def recalls(self) -> list[BopRecall]:
        """By threshold; of VSD by tau, then by threshold."""

    @property
    def average_recall(self) -> float:
        """Mean over the thresholds."""

    @property
    def obj_recall(self) -> dict[int, float]:
        """The same of each object alone."""

    def __repr__(self) -> str: ...

class BopScores:
    """Everything about a results file."""

    @property
    def targets_count(self) -> int:
        """Instances to be found."""

    @property
    def estimates_kept(self) -> int:
        """The best of each target."""

    @property
    def vsd(self) -> BopScore | None:
        """None without depth images."""

    @property
    def mssd(self) -> BopScore:
        """By MSSD."""

    @property
    def mspd(self) -> BopScore:
        """By MSPD."""

    @property
    def average_recall(self) -> float | None:
        """AR: the mean of AR_VSD, AR_MSSD and AR_MSPD."""

    @property
    def average_time_per_image_s(self) -> float:
        """-1: not known."""

    def __repr__(self) -> str: ...

def score_bop(dataset: partpose.io.BopDataset, estimates: Sequence[partpose.io.BopEstimate], options: BopScoreOptions = ..., progress: Callable[[str, int, int], object] | None = None) -> BopScores:
    """Scores estimates as the BOP benchmark's localization task does."""

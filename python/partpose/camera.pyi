# Written by script/make_stubs.
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

import numpy
from numpy.typing import NDArray

import partpose.core


class StereoSensorOptions:
    """
    What a stereo depth camera does to the ideal depth; the defaults resemble a D415.

    baseline_mm = 55.0: distance between left and right imager [mm], > 0
    disparity_noise_px = 0.08: standard deviation of the disparity's noise [px], >= 0
    correlation_px = 8.0: distance over which the noise's correlation falls to 1/e [px], 0 to 64
    white_share = 0.05: share of the noise's variance that is new at each pixel, 0 to 1
    frozen_share = 0.0: share of the correlated variance that is the same in each frame, 0 to 1
    subpixel_wave_px = 0.04: amplitude of the error that repeats with each pixel of disparity [px]
    static_pattern_percent = 1.0: the unit's slow depth error over the image, peak to peak [% of the depth], 0 to 20
    pattern_seed = 1: the unit: which static pattern and frozen noise it has
    smoothing_px = 3: half the width of the matching window that averages a surface [px], 0 to 16
    fattening_px = 3.0: how far a foreground grows over its background [px], 0 to 16
    fattening_jitter_px = 1.0: standard deviation of that along an edge [px], 0 to 4
    edge_jump_px = 0.75: a larger disparity difference of neighbours is an edge [px], > 0
    mixed_pixel_probability = 0.15: that a pixel beside an edge lies between foreground and background, 0 to 1
    edge_loss_px = 4: width of the band of background beside an edge that may be missing [px], 0 to 16
    edge_loss_probability = 0.35: that a pixel of this band is missing (in patches), 0 to 1
    hole_share = 0.0: share of all pixels missing for want of texture, 0 to 1
    grazing_drop_deg = (76.0, 86.0): angles between line of sight and surface normal from which pixels begin to be, and all are, missing [deg]
    invalid_band = True: no depth at the left, where the right imager does not look
    occlusion_shadow = True: no depth where a foreground hides the surface from the right imager
    max_disparity_px = 126.0: nearer surfaces are missing [px], > 0
    disparity_step_px = 0.03125: the disparity's quantisation [px], >= 0
    depth_step_mm = 1.0: the depth's quantisation [mm], >= 0
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, baseline_mm: float = 55.0, disparity_noise_px: float = 0.08, correlation_px: float = 8.0, white_share: float = 0.05, frozen_share: float = 0.0, subpixel_wave_px: float = 0.04, static_pattern_percent: float = 1.0, pattern_seed: int = 1, smoothing_px: int = 3, fattening_px: float = 3.0, fattening_jitter_px: float = 1.0, edge_jump_px: float = 0.75, mixed_pixel_probability: float = 0.15, edge_loss_px: int = 4, edge_loss_probability: float = 0.35, hole_share: float = 0.0, grazing_drop_deg: Sequence[float] = (76.0, 86.0), invalid_band: bool = True, occlusion_shadow: bool = True, max_disparity_px: float = 126.0, disparity_step_px: float = 0.03125, depth_step_mm: float = 1.0) -> None: ...

    @property
    def baseline_mm(self) -> float:
        """distance between left and right imager [mm], > 0"""

    @baseline_mm.setter
    def baseline_mm(self, value: float, /) -> None: ...

    @property
    def disparity_noise_px(self) -> float:
        """standard deviation of the disparity's noise [px], >= 0"""

    @disparity_noise_px.setter
    def disparity_noise_px(self, value: float, /) -> None: ...

    @property
    def correlation_px(self) -> float:
        """distance over which the noise's correlation falls to 1/e [px], 0 to 64"""

    @correlation_px.setter
    def correlation_px(self, value: float, /) -> None: ...

    @property
    def white_share(self) -> float:
        """share of the noise's variance that is new at each pixel, 0 to 1"""

    @white_share.setter
    def white_share(self, value: float, /) -> None: ...

    @property
    def frozen_share(self) -> float:
        """
        share of the correlated variance that is the same in each frame, 0 to 1
        """

    @frozen_share.setter
    def frozen_share(self, value: float, /) -> None: ...

    @property
    def subpixel_wave_px(self) -> float:
        """amplitude of the error that repeats with each pixel of disparity [px]"""

    @subpixel_wave_px.setter
    def subpixel_wave_px(self, value: float, /) -> None: ...

    @property
    def static_pattern_percent(self) -> float:
        """
        the unit's slow depth error over the image, peak to peak [% of the depth], 0 to 20
        """

    @static_pattern_percent.setter
    def static_pattern_percent(self, value: float, /) -> None: ...

    @property
    def pattern_seed(self) -> int:
        """the unit: which static pattern and frozen noise it has"""

    @pattern_seed.setter
    def pattern_seed(self, value: int, /) -> None: ...

    @property
    def smoothing_px(self) -> int:
        """
        half the width of the matching window that averages a surface [px], 0 to 16
        """

    @smoothing_px.setter
    def smoothing_px(self, value: int, /) -> None: ...

    @property
    def fattening_px(self) -> float:
        """how far a foreground grows over its background [px], 0 to 16"""

    @fattening_px.setter
    def fattening_px(self, value: float, /) -> None: ...

    @property
    def fattening_jitter_px(self) -> float:
        """standard deviation of that along an edge [px], 0 to 4"""

    @fattening_jitter_px.setter
    def fattening_jitter_px(self, value: float, /) -> None: ...

    @property
    def edge_jump_px(self) -> float:
        """a larger disparity difference of neighbours is an edge [px], > 0"""

    @edge_jump_px.setter
    def edge_jump_px(self, value: float, /) -> None: ...

    @property
    def mixed_pixel_probability(self) -> float:
        """
        that a pixel beside an edge lies between foreground and background, 0 to 1
        """

    @mixed_pixel_probability.setter
    def mixed_pixel_probability(self, value: float, /) -> None: ...

    @property
    def edge_loss_px(self) -> int:
        """
        width of the band of background beside an edge that may be missing [px], 0 to 16
        """

    @edge_loss_px.setter
    def edge_loss_px(self, value: int, /) -> None: ...

    @property
    def edge_loss_probability(self) -> float:
        """that a pixel of this band is missing (in patches), 0 to 1"""

    @edge_loss_probability.setter
    def edge_loss_probability(self, value: float, /) -> None: ...

    @property
    def hole_share(self) -> float:
        """share of all pixels missing for want of texture, 0 to 1"""

    @hole_share.setter
    def hole_share(self, value: float, /) -> None: ...

    @property
    def grazing_drop_deg(self) -> tuple[float, ...]:
        """
        angles between line of sight and surface normal from which pixels begin to be, and all are, missing [deg]
        """

    @grazing_drop_deg.setter
    def grazing_drop_deg(self, value: Sequence[float], /) -> None: ...

    @property
    def invalid_band(self) -> bool:
        """no depth at the left, where the right imager does not look"""

    @invalid_band.setter
    def invalid_band(self, value: bool, /) -> None: ...

    @property
    def occlusion_shadow(self) -> bool:
        """no depth where a foreground hides the surface from the right imager"""

    @occlusion_shadow.setter
    def occlusion_shadow(self, value: bool, /) -> None: ...

    @property
    def max_disparity_px(self) -> float:
        """nearer surfaces are missing [px], > 0"""

    @max_disparity_px.setter
    def max_disparity_px(self, value: float, /) -> None: ...

    @property
    def disparity_step_px(self) -> float:
        """the disparity's quantisation [px], >= 0"""

    @disparity_step_px.setter
    def disparity_step_px(self, value: float, /) -> None: ...

    @property
    def depth_step_mm(self) -> float:
        """the depth's quantisation [mm], >= 0"""

    @depth_step_mm.setter
    def depth_step_mm(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class NoiseOptions:
    """
    What is added to the depth.

    model = 'none': "none", "gaussian" (independent in x, y and z), "gaussianray" (along the line of sight) or "stereo" (a stereo camera's errors)
    standard_deviation_mm = 0.0: standard deviation of the noise of "gaussian" and "gaussianray" [mm], >= 0
    stereo = None: the sensor of "stereo"; without it a D415
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, model: str = 'none', standard_deviation_mm: float = 0.0, stereo: StereoSensorOptions | Mapping[str, Any] | None = None) -> None: ...

    @property
    def model(self) -> str:
        """
        "none", "gaussian" (independent in x, y and z), "gaussianray" (along the line of sight) or "stereo" (a stereo camera's errors)
        """

    @model.setter
    def model(self, value: str, /) -> None: ...

    @property
    def standard_deviation_mm(self) -> float:
        """
        standard deviation of the noise of "gaussian" and "gaussianray" [mm], >= 0
        """

    @standard_deviation_mm.setter
    def standard_deviation_mm(self, value: float, /) -> None: ...

    @property
    def stereo(self) -> StereoSensorOptions | None:
        """the sensor of "stereo"; without it a D415"""

    @stereo.setter
    def stereo(self, value: StereoSensorOptions | Mapping[str, Any] | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class VirtualDepthCameraOptions:
    """
    The camera that takes the views.

    field_of_view_deg = (50.0, 40.0): horizontal and vertical field of view [deg], 0 to 180
    noise: what is added to the depth
    resolution_px = (640, 480): horizontal and vertical resolution [px]
    normals = 'mesh': "mesh" (of the triangle seen) or "estimated" (from the captured points)
    normal_estimation_radius_mm = 9.0: radius for "estimated" normals [mm], > 0
    noise_seed = 1: the same seed gives the same noise
    organized_output = None: the same as the key of this name one level up
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, field_of_view_deg: Sequence[float] = (50.0, 40.0), noise: NoiseOptions | Mapping[str, Any] = ..., resolution_px: Sequence[int] = (640, 480), normals: str = 'mesh', normal_estimation_radius_mm: float = 9.0, noise_seed: int = 1, organized_output: bool | None = None) -> None: ...

    @property
    def field_of_view_deg(self) -> tuple[float, ...]:
        """horizontal and vertical field of view [deg], 0 to 180"""

    @field_of_view_deg.setter
    def field_of_view_deg(self, value: Sequence[float], /) -> None: ...

    @property
    def noise(self) -> NoiseOptions:
        """what is added to the depth"""

    @noise.setter
    def noise(self, value: NoiseOptions | Mapping[str, Any], /) -> None: ...

    @property
    def resolution_px(self) -> tuple[int, ...]:
        """horizontal and vertical resolution [px]"""

    @resolution_px.setter
    def resolution_px(self, value: Sequence[int], /) -> None: ...

    @property
    def normals(self) -> str:
        """
        "mesh" (of the triangle seen) or "estimated" (from the captured points)
        """

    @normals.setter
    def normals(self, value: str, /) -> None: ...

    @property
    def normal_estimation_radius_mm(self) -> float:
        """radius for "estimated" normals [mm], > 0"""

    @normal_estimation_radius_mm.setter
    def normal_estimation_radius_mm(self, value: float, /) -> None: ...

    @property
    def noise_seed(self) -> int:
        """the same seed gives the same noise"""

    @noise_seed.setter
    def noise_seed(self, value: int, /) -> None: ...

    @property
    def organized_output(self) -> bool | None:
        """the same as the key of this name one level up"""

    @organized_output.setter
    def organized_output(self, value: bool | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    def intrinsics(self) -> partpose.core.Intrinsics:
        """Of that field of view and resolution."""

def render(mesh: partpose.core.TriangleMesh, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], intrinsics: partpose.core.Intrinsics) -> tuple[partpose.core.DepthImage, Annotated[NDArray[numpy.int32], dict(shape=(None, None))]]:
    """
    The depth as an ideal pinhole camera sees it, and the triangle seen at each pixel (-1: none).
    """

def look_at(position_mm: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], target_mm: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
    """Pose of a camera at a position that looks at a target."""

def capture(mesh: partpose.core.TriangleMesh, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], options: VirtualDepthCameraOptions, organized: bool = False, frame: int = 0) -> partpose.core.PointCloud:
    """
    One frame of a mesh: the visible points in the camera frame with normals, with noise.
    """

def stereo_capture(left: partpose.core.DepthImage, right: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, options: StereoSensorOptions, seed: int) -> tuple[partpose.core.DepthImage, Annotated[NDArray[numpy.int32], dict(shape=(None, None))]]:
    """
    The measured depth of what both imagers would ideally see, and the pixel whose surface was measured (-1: none).
    """

def right_from_left(options: StereoSensorOptions) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
    """Moves the left imager's coordinates to the right one's."""

def predicted_depth_noise_mm(options: StereoSensorOptions, intrinsics: partpose.core.Intrinsics, z_mm: float) -> float:
    """Standard deviation of the depth on a surface."""

class StereoSensorFit:
    """
    What captures of a flat wall tell about a stereo camera.

    frames = 0: captures of the wall
    pixels = 0: pixels on the wall
    distance_mm = 0.0: median depth of the wall [mm]
    mm_per_px = 0.0: depth for each pixel of disparity there [mm]
    tilt_deg = 0.0: between the optical axis and the wall's normal [deg]
    fill_rate = 0.0: measured pixels of all in the region
    plane_rms_mm = 0.0: RMS distance to the plane [mm]
    subpixel_rms_px = 0.0: the same as disparity [px]
    disparity_noise_px = 0.0: standard deviation without pattern, waves and quantisation [px]
    correlation_px = 0.0: distance over which its correlation falls to 1/e [px]
    white_share = 0.0: share of its variance that is new at each pixel
    static_pattern_percent = 0.0: slow error, peak to peak [% of the depth]
    subpixel_wave_px = None: amplitude of the waves [px]
    disparity_step_px = None: the disparity's quantisation [px]
    depth_step_mm = None: the depth's quantisation [mm]
    temporal_noise_px = None: of one pixel from frame to frame [px]
    temporal_noise_mm = None: of one pixel from frame to frame [mm]
    frozen_share = None: share of the correlated variance that is the same in each frame
    notes = (): what could not be told, and how to
    stereo: for the key "stereo" of the noise
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, frames: int = 0, pixels: int = 0, distance_mm: float = 0.0, mm_per_px: float = 0.0, tilt_deg: float = 0.0, fill_rate: float = 0.0, plane_rms_mm: float = 0.0, subpixel_rms_px: float = 0.0, disparity_noise_px: float = 0.0, correlation_px: float = 0.0, white_share: float = 0.0, static_pattern_percent: float = 0.0, subpixel_wave_px: float | None = None, disparity_step_px: float | None = None, depth_step_mm: float | None = None, temporal_noise_px: float | None = None, temporal_noise_mm: float | None = None, frozen_share: float | None = None, notes: Sequence[str] = (), stereo: StereoSensorOptions | Mapping[str, Any] = ...) -> None: ...

    @property
    def frames(self) -> int:
        """captures of the wall"""

    @frames.setter
    def frames(self, value: int, /) -> None: ...

    @property
    def pixels(self) -> int:
        """pixels on the wall"""

    @pixels.setter
    def pixels(self, value: int, /) -> None: ...

    @property
    def distance_mm(self) -> float:
        """median depth of the wall [mm]"""

    @distance_mm.setter
    def distance_mm(self, value: float, /) -> None: ...

    @property
    def mm_per_px(self) -> float:
        """depth for each pixel of disparity there [mm]"""

    @mm_per_px.setter
    def mm_per_px(self, value: float, /) -> None: ...

    @property
    def tilt_deg(self) -> float:
        """between the optical axis and the wall's normal [deg]"""

    @tilt_deg.setter
    def tilt_deg(self, value: float, /) -> None: ...

    @property
    def fill_rate(self) -> float:
        """measured pixels of all in the region"""

    @fill_rate.setter
    def fill_rate(self, value: float, /) -> None: ...

    @property
    def plane_rms_mm(self) -> float:
        """RMS distance to the plane [mm]"""

    @plane_rms_mm.setter
    def plane_rms_mm(self, value: float, /) -> None: ...

    @property
    def subpixel_rms_px(self) -> float:
        """the same as disparity [px]"""

    @subpixel_rms_px.setter
    def subpixel_rms_px(self, value: float, /) -> None: ...

    @property
    def disparity_noise_px(self) -> float:
        """standard deviation without pattern, waves and quantisation [px]"""

    @disparity_noise_px.setter
    def disparity_noise_px(self, value: float, /) -> None: ...

    @property
    def correlation_px(self) -> float:
        """distance over which its correlation falls to 1/e [px]"""

    @correlation_px.setter
    def correlation_px(self, value: float, /) -> None: ...

    @property
    def white_share(self) -> float:
        """share of its variance that is new at each pixel"""

    @white_share.setter
    def white_share(self, value: float, /) -> None: ...

    @property
    def static_pattern_percent(self) -> float:
        """slow error, peak to peak [% of the depth]"""

    @static_pattern_percent.setter
    def static_pattern_percent(self, value: float, /) -> None: ...

    @property
    def subpixel_wave_px(self) -> float | None:
        """amplitude of the waves [px]"""

    @subpixel_wave_px.setter
    def subpixel_wave_px(self, value: float | None, /) -> None: ...

    @property
    def disparity_step_px(self) -> float | None:
        """the disparity's quantisation [px]"""

    @disparity_step_px.setter
    def disparity_step_px(self, value: float | None, /) -> None: ...

    @property
    def depth_step_mm(self) -> float | None:
        """the depth's quantisation [mm]"""

    @depth_step_mm.setter
    def depth_step_mm(self, value: float | None, /) -> None: ...

    @property
    def temporal_noise_px(self) -> float | None:
        """of one pixel from frame to frame [px]"""

    @temporal_noise_px.setter
    def temporal_noise_px(self, value: float | None, /) -> None: ...

    @property
    def temporal_noise_mm(self) -> float | None:
        """of one pixel from frame to frame [mm]"""

    @temporal_noise_mm.setter
    def temporal_noise_mm(self, value: float | None, /) -> None: ...

    @property
    def frozen_share(self) -> float | None:
        """share of the correlated variance that is the same in each frame"""

    @frozen_share.setter
    def frozen_share(self, value: float | None, /) -> None: ...

    @property
    def notes(self) -> tuple[str, ...]:
        """what could not be told, and how to"""

    @notes.setter
    def notes(self, value: Sequence[str], /) -> None: ...

    @property
    def stereo(self) -> StereoSensorOptions:
        """for the key "stereo" of the noise"""

    @stereo.setter
    def stereo(self, value: StereoSensorOptions | Mapping[str, Any], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def fit_stereo_sensor(frames: Sequence[partpose.core.DepthImage], intrinsics: partpose.core.Intrinsics, baseline_mm: float, region_px: Sequence[int] = [0, 0, 0, 0], depth_unit_mm: float = 0.0, plane_percent: float = 2.0) -> StereoSensorFit:
    """Estimates the noise figures from depth images of one flat wall."""

# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import os
from typing import Annotated, Any, Self

import numpy
from numpy.typing import NDArray

import partpose.camera
import partpose.core
import partpose.io


class RestingPoseOptions:
    """
    How resting poses are found.

    contact_tolerance = 0.0001: points this near the table touch it, as a share of the part's diagonal, 1e-6 to 0.1
    least_stability_deg = 3.0: a pose that a smaller tilt topples into a lower one is not kept [deg], 0 to 45
    merge_deg = 4.0: poses whose down directions differ by less are one pose [deg], 0 to 45
    level_tolerance = 0.01: poses roll into one another, not topple, when their centres of mass differ in height by less than this share, 0 to 0.5
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, contact_tolerance: float = 0.0001, least_stability_deg: float = 3.0, merge_deg: float = 4.0, level_tolerance: float = 0.01) -> None: ...

    @property
    def contact_tolerance(self) -> float:
        """
        points this near the table touch it, as a share of the part's diagonal, 1e-6 to 0.1
        """

    @contact_tolerance.setter
    def contact_tolerance(self, value: float, /) -> None: ...

    @property
    def least_stability_deg(self) -> float:
        """
        a pose that a smaller tilt topples into a lower one is not kept [deg], 0 to 45
        """

    @least_stability_deg.setter
    def least_stability_deg(self, value: float, /) -> None: ...

    @property
    def merge_deg(self) -> float:
        """poses whose down directions differ by less are one pose [deg], 0 to 45"""

    @merge_deg.setter
    def merge_deg(self, value: float, /) -> None: ...

    @property
    def level_tolerance(self) -> float:
        """
        poses roll into one another, not topple, when their centres of mass differ in height by less than this share, 0 to 0.5
        """

    @level_tolerance.setter
    def level_tolerance(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class RestingPose:
    """A pose in which a part stays on a level table by itself."""

    @property
    def table_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Table frame: z up, its top at 0."""

    @property
    def probability(self) -> float:
        """To come to rest so, dropped at random."""

    @property
    def centre_height_mm(self) -> float:
        """Of the centre of mass, above the table."""

    @property
    def stability_deg(self) -> float:
        """The tilt that it takes to tip it over."""

    @property
    def group(self) -> int:
        """Poses of a group are equal by the part's symmetry."""

    @property
    def down(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
        """The direction that is down, model frame."""

    def __repr__(self) -> str: ...

class RestingPoses:
    """The resting poses of a part, most probable first."""

    @property
    def poses(self) -> list[RestingPose]:
        """Each of them."""

    @property
    def groups(self) -> int:
        """How many are different."""

    @property
    def centre_of_mass_mm(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
        """Model frame."""

    @property
    def centre_of_mass_from_mesh(self) -> bool:
        """False: the mesh is open, and the hull's was taken."""

    def __repr__(self) -> str: ...

def resting_poses(mesh: partpose.core.TriangleMesh, options: RestingPoseOptions = ...) -> RestingPoses:
    """The resting poses of a part of even density."""

class SceneCameraOptions:
    """
    The camera and where it stands.

    width = 640: image width [px]
    height = 480: image height [px]
    fx = 615.0: focal length in x [px]
    fy = 615.0: focal length in y [px]
    cx = 319.5: principal point in x [px], pixel centres at integers
    cy = 239.5: principal point in y [px], pixel centres at integers
    distance_mm = (500.0, 800.0): range of the distance to the point that the camera aims at [mm]
    elevation_deg = (30.0, 90.0): range of the camera's elevation above the table, 5 to 90 [deg]
    roll_deg = (-10.0, 10.0): range of the turn about the line of sight [deg]
    aim_radius_mm = 30.0: the camera aims at a point this near the table's centre [mm], >= 0
    farthest_mm = 6000.0: what is farther gives no depth [mm], up to 65000
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, width: int = 640, height: int = 480, fx: float = 615.0, fy: float = 615.0, cx: float = 319.5, cy: float = 239.5, distance_mm: Sequence[float] = (500.0, 800.0), elevation_deg: Sequence[float] = (30.0, 90.0), roll_deg: Sequence[float] = (-10.0, 10.0), aim_radius_mm: float = 30.0, farthest_mm: float = 6000.0) -> None: ...

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
    def distance_mm(self) -> tuple[float, ...]:
        """range of the distance to the point that the camera aims at [mm]"""

    @distance_mm.setter
    def distance_mm(self, value: Sequence[float], /) -> None: ...

    @property
    def elevation_deg(self) -> tuple[float, ...]:
        """range of the camera's elevation above the table, 5 to 90 [deg]"""

    @elevation_deg.setter
    def elevation_deg(self, value: Sequence[float], /) -> None: ...

    @property
    def roll_deg(self) -> tuple[float, ...]:
        """range of the turn about the line of sight [deg]"""

    @roll_deg.setter
    def roll_deg(self, value: Sequence[float], /) -> None: ...

    @property
    def aim_radius_mm(self) -> float:
        """the camera aims at a point this near the table's centre [mm], >= 0"""

    @aim_radius_mm.setter
    def aim_radius_mm(self, value: float, /) -> None: ...

    @property
    def farthest_mm(self) -> float:
        """what is farther gives no depth [mm], up to 65000"""

    @farthest_mm.setter
    def farthest_mm(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    @property
    def intrinsics(self) -> partpose.core.Intrinsics:
        """The camera itself."""

class SceneOptions:
    """
    What is on the table.

    camera: the camera and where it stands
    parts = (1, 1): range of the number of catalogue parts in a frame
    unknown_parts = (0, 0): range of the number of parts that are not in the catalogue
    clutter = (0, 0): range of the number of boxes and cylinders
    clutter_size_mm = (20.0, 100.0): range of their edge lengths, diameters and heights [mm]
    poses = 'natural': "natural": as often as the part comes to rest so; "uniform": each group of resting poses equally often
    least_visible_fraction = 0.3: at least this share of each part, catalogue or not, is seen, 0 to 1
    hidden_fraction = (0.0, 0.0): range of the share of the first part that is hidden by intention, 0 to 1; [0, 0]: nothing is put before it
    place_radius_mm = 120.0: things lie this near the table's centre [mm], > 0; farther only where they find no room
    gap_mm = 3.0: least distance between things that lie apart, seen from above [mm], >= 0
    contact = 'apart': "apart", or "touching": each thing but the first is slid along the table until it touches another
    table_size_mm = (1000.0, 700.0): length and width of the table [mm], > 0
    floor_below_mm = 720.0: the floor is this far below the table's top [mm]; 0: there is none
    resting_poses: how resting poses are found
    seed = 1: the same seed gives the same frames
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, camera: SceneCameraOptions | Mapping[str, Any] = ..., parts: Sequence[int] = (1, 1), unknown_parts: Sequence[int] = (0, 0), clutter: Sequence[int] = (0, 0), clutter_size_mm: Sequence[float] = (20.0, 100.0), poses: str = 'natural', least_visible_fraction: float = 0.3, hidden_fraction: Sequence[float] = (0.0, 0.0), place_radius_mm: float = 120.0, gap_mm: float = 3.0, contact: str = 'apart', table_size_mm: Sequence[float] = (1000.0, 700.0), floor_below_mm: float = 720.0, resting_poses: RestingPoseOptions | Mapping[str, Any] = ..., seed: int = 1) -> None: ...

    @property
    def camera(self) -> SceneCameraOptions:
        """the camera and where it stands"""

    @camera.setter
    def camera(self, value: SceneCameraOptions | Mapping[str, Any], /) -> None: ...

    @property
    def parts(self) -> tuple[int, ...]:
        """range of the number of catalogue parts in a frame"""

    @parts.setter
    def parts(self, value: Sequence[int], /) -> None: ...

    @property
    def unknown_parts(self) -> tuple[int, ...]:
        """range of the number of parts that are not in the catalogue"""

    @unknown_parts.setter
    def unknown_parts(self, value: Sequence[int], /) -> None: ...

    @property
    def clutter(self) -> tuple[int, ...]:
        """range of the number of boxes and cylinders"""

    @clutter.setter
    def clutter(self, value: Sequence[int], /) -> None: ...

    @property
    def clutter_size_mm(self) -> tuple[float, ...]:
        """range of their edge lengths, diameters and heights [mm]"""

    @clutter_size_mm.setter
    def clutter_size_mm(self, value: Sequence[float], /) -> None: ...

    @property
    def poses(self) -> str:
        """
        "natural": as often as the part comes to rest so; "uniform": each group of resting poses equally often
        """

    @poses.setter
    def poses(self, value: str, /) -> None: ...

    @property
    def least_visible_fraction(self) -> float:
        """at least this share of each part, catalogue or not, is seen, 0 to 1"""

    @least_visible_fraction.setter
    def least_visible_fraction(self, value: float, /) -> None: ...

    @property
    def hidden_fraction(self) -> tuple[float, ...]:
        """
        range of the share of the first part that is hidden by intention, 0 to 1; [0, 0]: nothing is put before it
        """

    @hidden_fraction.setter
    def hidden_fraction(self, value: Sequence[float], /) -> None: ...

    @property
    def place_radius_mm(self) -> float:
        """
        things lie this near the table's centre [mm], > 0; farther only where they find no room
        """

    @place_radius_mm.setter
    def place_radius_mm(self, value: float, /) -> None: ...

    @property
    def gap_mm(self) -> float:
        """
        least distance between things that lie apart, seen from above [mm], >= 0
        """

    @gap_mm.setter
    def gap_mm(self, value: float, /) -> None: ...

    @property
    def contact(self) -> str:
        """
        "apart", or "touching": each thing but the first is slid along the table until it touches another
        """

    @contact.setter
    def contact(self, value: str, /) -> None: ...

    @property
    def table_size_mm(self) -> tuple[float, ...]:
        """length and width of the table [mm], > 0"""

    @table_size_mm.setter
    def table_size_mm(self, value: Sequence[float], /) -> None: ...

    @property
    def floor_below_mm(self) -> float:
        """the floor is this far below the table's top [mm]; 0: there is none"""

    @floor_below_mm.setter
    def floor_below_mm(self, value: float, /) -> None: ...

    @property
    def resting_poses(self) -> RestingPoseOptions:
        """how resting poses are found"""

    @resting_poses.setter
    def resting_poses(self, value: RestingPoseOptions | Mapping[str, Any], /) -> None: ...

    @property
    def seed(self) -> int:
        """the same seed gives the same frames"""

    @seed.setter
    def seed(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class SceneSensorOptions:
    """
    What the sensor does to the depth.

    model = 'stereo': "none", "gaussianray" (independent noise along the line of sight) or "stereo" (like a D415)
    standard_deviation_mm = 1.0: of "gaussianray" [mm], >= 0
    stereo: the disturbances of "stereo\"
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, model: str = 'stereo', standard_deviation_mm: float = 1.0, stereo: partpose.camera.StereoSensorOptions | Mapping[str, Any] = ...) -> None: ...

    @property
    def model(self) -> str:
        """
        "none", "gaussianray" (independent noise along the line of sight) or "stereo" (like a D415)
        """

    @model.setter
    def model(self, value: str, /) -> None: ...

    @property
    def standard_deviation_mm(self) -> float:
        """of "gaussianray" [mm], >= 0"""

    @standard_deviation_mm.setter
    def standard_deviation_mm(self, value: float, /) -> None: ...

    @property
    def stereo(self) -> partpose.camera.StereoSensorOptions:
        """the disturbances of "stereo\""""

    @stereo.setter
    def stereo(self, value: partpose.camera.StereoSensorOptions | Mapping[str, Any], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class SceneDatasetOptions:
    """
    All that a dataset's frames depend on.

    scene: what is on the table, and where the camera stands
    sensor: what the sensor does to the depth
    depth_scale_mm = 0.1: length of one unit of the depth images [mm], > 0
    frames_per_scene = 1000: so many frames go into one scene folder, 1 to 1000000
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, scene: SceneOptions | Mapping[str, Any] = ..., sensor: SceneSensorOptions | Mapping[str, Any] = ..., depth_scale_mm: float = 0.1, frames_per_scene: int = 1000) -> None: ...

    @property
    def scene(self) -> SceneOptions:
        """what is on the table, and where the camera stands"""

    @scene.setter
    def scene(self, value: SceneOptions | Mapping[str, Any], /) -> None: ...

    @property
    def sensor(self) -> SceneSensorOptions:
        """what the sensor does to the depth"""

    @sensor.setter
    def sensor(self, value: SceneSensorOptions | Mapping[str, Any], /) -> None: ...

    @property
    def depth_scale_mm(self) -> float:
        """length of one unit of the depth images [mm], > 0"""

    @depth_scale_mm.setter
    def depth_scale_mm(self, value: float, /) -> None: ...

    @property
    def frames_per_scene(self) -> int:
        """so many frames go into one scene folder, 1 to 1000000"""

    @frames_per_scene.setter
    def frames_per_scene(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class ScenePiece:
    """Anything in a scene."""

    @property
    def name(self) -> str:
        """The part's, or the kind of clutter."""

    @property
    def index(self) -> int:
        """Of the part; -1 for anything else."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Its pose."""

    @property
    def visible_px(self) -> int:
        """Pixels in which it is seen."""

    @property
    def silhouette_px(self) -> int:
        """Pixels that it would have if nothing hid it."""

    def visible_fraction(self) -> float:
        """visible_px / silhouette_px."""

    def in_catalogue(self) -> bool:
        """Whether it is one of the catalogue's parts."""

    def __repr__(self) -> str: ...

class SyntheticScene:
    """A frame and the truth about it."""

    @property
    def frame(self) -> int:
        """The number that it was drawn by."""

    @property
    def intrinsics(self) -> partpose.core.Intrinsics:
        """Of the camera."""

    @property
    def camera_from_table(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Table frame: z up, its top at 0."""

    @property
    def pieces(self) -> list[ScenePiece]:
        """Catalogue parts first."""

    @property
    def depth(self) -> partpose.core.DepthImage:
        """Without noise."""

    def measured(self, sensor: SceneSensorOptions = ..., seed: int = 0) -> partpose.core.DepthImage:
        """What a sensor measures of it."""

    def picture(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None, 3))]:
        """Height x width x 3, RGB."""

    def __repr__(self) -> str: ...

class SceneGenerator:
    """Draws frames of parts that rest on a table."""

    def __init__(self, catalogue: Sequence[tuple[str, partpose.core.TriangleMesh]], unknown: Sequence[tuple[str, partpose.core.TriangleMesh]] = [], options: SceneOptions = ...) -> None:
        """`catalogue` and `unknown`: pairs of name and mesh."""

    def generate(self, frame: int) -> SyntheticScene:
        """Depends on the options, the parts and frame alone."""

    @property
    def names(self) -> list[str]:
        """Of all parts, the catalogue's first."""

    @property
    def options(self) -> SceneOptions:
        """What it was made with."""

def write_scene_dataset(catalogue: Sequence[tuple[str, partpose.core.TriangleMesh]], unknown: Sequence[tuple[str, partpose.core.TriangleMesh]], options: SceneDatasetOptions, frames: int, folder: str | os.PathLike[str], progress: Callable[[str, int, int], object] | None = None) -> None:
    """Draws frames and writes them as a BOP dataset."""

class SceneDataset:
    """A dataset that write_scene_dataset wrote."""

    @property
    def bop(self) -> partpose.io.BopDataset:
        """Models, images and truth."""

    @property
    def options(self) -> SceneDatasetOptions:
        """As it was made."""

    @property
    def part_names(self) -> dict[int, str]:
        """By obj_id."""

    @property
    def unknown_names(self) -> dict[int, str]:
        """Parts that are not in the catalogue, by their obj_id."""

    @property
    def unknown(self) -> dict[int, partpose.io.BopScene]:
        """By scene_id: where these are."""

    def __repr__(self) -> str: ...

def read_scene_dataset(folder: str | os.PathLike[str]) -> SceneDataset:
    """Error when the folder is no such dataset, or is damaged."""

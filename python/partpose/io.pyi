# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import enum
import os
import pathlib
from typing import Annotated, Any, Self, overload

import numpy
from numpy.typing import NDArray

import partpose.core
import partpose.geometry


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

def read_off(path: str | os.PathLike[str]) -> partpose.core.TriangleMesh:
    """The mesh of an OFF file in mm."""

def content_hash(mesh: partpose.core.TriangleMesh) -> str:
    """Tells whether a mesh changed."""

class MeshReadOptions:
    """
    How CAD files are made triangles, and what a part is.

    chord_tolerance_mm = 0.1: STEP: largest distance of a triangle from the curved surface that it stands for [mm], > 0
    angle_tolerance_deg = 20.0: STEP: largest angle between neighbouring facets of a curved surface [deg], 1 to 90
    split = 'product': what is a part of its own: each "product" of an assembly, each "solid" of each product, or the "whole" file
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, chord_tolerance_mm: float = 0.1, angle_tolerance_deg: float = 20.0, split: str = 'product') -> None: ...

    @property
    def chord_tolerance_mm(self) -> float:
        """
        STEP: largest distance of a triangle from the curved surface that it stands for [mm], > 0
        """

    @chord_tolerance_mm.setter
    def chord_tolerance_mm(self, value: float, /) -> None: ...

    @property
    def angle_tolerance_deg(self) -> float:
        """
        STEP: largest angle between neighbouring facets of a curved surface [deg], 1 to 90
        """

    @angle_tolerance_deg.setter
    def angle_tolerance_deg(self, value: float, /) -> None: ...

    @property
    def split(self) -> str:
        """
        what is a part of its own: each "product" of an assembly, each "solid" of each product, or the "whole" file
        """

    @split.setter
    def split(self, value: str, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class NamedMesh:
    """A part: its mesh in mm, in the file's own frame."""

    def __init__(self, name: str, mesh: partpose.core.TriangleMesh, file: str | os.PathLike[str] = ..., unit: str = '') -> None: ...

    @property
    def name(self) -> str:
        """
        The file's without its ending; of several parts in a file, the part's own.
        """

    @property
    def mesh(self) -> partpose.core.TriangleMesh:
        """In mm."""

    @property
    def file(self) -> pathlib.Path:
        """Where it was read."""

    @property
    def unit(self) -> str:
        """As the file states it; empty when it does not."""

    def __repr__(self) -> str: ...

def read_meshes(paths: Sequence[str | os.PathLike[str]], options: MeshReadOptions = ..., broken: Callable[[pathlib.Path, str], object] | None = None) -> list[NamedMesh]:
    """
    The parts of files or folders. With `broken`, files that cannot be read are told there and left out.
    """

def read_mesh_file(file: str | os.PathLike[str], options: MeshReadOptions = ...) -> list[NamedMesh]:
    """The parts of one file, of any of mesh_file_endings()."""

def mesh_file_endings() -> list[str]:
    """The endings of the files that read_meshes knows."""

def reads_step() -> bool:
    """Whether this build reads STEP (by OpenCASCADE)."""

def reads_assimp_formats() -> bool:
    """Whether this build reads OBJ, 3MF and glTF (by Assimp)."""

def model_files(file_or_folder: str | os.PathLike[str]) -> list[pathlib.Path]:
    """The file itself, or a folder's model files by name."""

def read_depth_png(path: str | os.PathLike[str], depth_scale_mm: float) -> partpose.core.DepthImage:
    """A 16-bit greyscale PNG."""

def is_picture_png(path: str | os.PathLike[str]) -> bool:
    """
    Whether a file is a PNG of another kind than depth images: 8-bit or in colours. By its header alone.
    """

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
    def intrinsics(self) -> partpose.core.Intrinsics:
        """Without the scale."""

def read_camera(path: str | os.PathLike[str]) -> CameraFile:
    """A camera JSON."""

def write_camera(path: str | os.PathLike[str], camera: CameraFile) -> None:
    """A camera JSON."""

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
    def path(self) -> pathlib.Path:
        """The file it was read from; empty for data in memory."""

    @property
    def cloud(self) -> partpose.core.PointCloud:
        """The points; of a depth image, those of its pixels."""

    @property
    def depth(self) -> partpose.core.DepthImage | None:
        """None for a cloud."""

    @property
    def intrinsics(self) -> partpose.core.Intrinsics | None:
        """Of a depth image; None otherwise."""

    def __repr__(self) -> str: ...

def read_scene(path: str | os.PathLike[str], unit_mm: float = 1.0, camera_file: str | os.PathLike[str] | None = None) -> Scene:
    """A 16-bit depth PNG with its camera JSON, or a PCD or PLY cloud."""

class BopModelInfo:
    """An object's entry of models_info.json."""

    @property
    def diameter_mm(self) -> float:
        """The largest distance of two vertices."""

    @property
    def box_mm(self) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]]:
        """Lower and upper corner."""

    @property
    def symmetries(self) -> partpose.geometry.Symmetries:
        """As the file states them."""

    def __repr__(self) -> str: ...

def bop_model_info(mesh: partpose.core.TriangleMesh, symmetries: partpose.geometry.Symmetries = ...) -> BopModelInfo:
    """Diameter and box of a mesh."""

class BopCamera:
    """An image's entry of scene_camera.json."""

    def __init__(self, intrinsics: partpose.core.Intrinsics, depth_scale_mm: float = 1.0, camera_from_world: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')] | None = None) -> None: ...

    @property
    def K(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C')]:
        """Camera matrix, px; pixel centres at integers."""

    @property
    def depth_scale_mm(self) -> float:
        """mm for each unit of the depth image."""

    @property
    def camera_from_world(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')] | None:
        """Where it is stated."""

    def intrinsics(self, width: int, height: int) -> partpose.core.Intrinsics:
        """Error when K has skew."""

    def __repr__(self) -> str: ...

class BopVisibility:
    """
    A ground truth's entry of scene_gt_info.json. Boxes: x, y, width, height, px.
    """

    def __init__(self, *, bbox_obj: Sequence[int], bbox_visib: Sequence[int], px_count_all: int, px_count_valid: int, px_count_visib: int, visib_fract: float) -> None: ...

    @property
    def bbox_obj(self) -> list[int]:
        """Of the silhouette, which may reach beyond the image."""

    @property
    def bbox_visib(self) -> list[int]:
        """Of its visible part."""

    @property
    def px_count_all(self) -> int:
        """Of the silhouette."""

    @property
    def px_count_valid(self) -> int:
        """Where the depth image has a value."""

    @property
    def px_count_visib(self) -> int:
        """Of the visible part."""

    @property
    def visib_fract(self) -> float:
        """px_count_visib / px_count_all"""

    def __repr__(self) -> str: ...

class BopGroundTruth:
    """An instance in an image."""

    def __init__(self, obj_id: int, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], visibility: BopVisibility | None = None) -> None: ...

    @property
    def obj_id(self) -> int:
        """Which object."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """Its pose."""

    @property
    def visibility(self) -> BopVisibility | None:
        """None: not known."""

    def __repr__(self) -> str: ...

class BopImage:
    """An image of a scene: its camera and what it shows."""

    def __init__(self, id: int, camera: BopCamera, ground_truths: Sequence[BopGroundTruth] = []) -> None: ...

    @property
    def id(self) -> int:
        """The image's number."""

    @property
    def camera(self) -> BopCamera:
        """The camera that took it."""

    @property
    def ground_truths(self) -> list[BopGroundTruth]:
        """The position is the ground truth's id."""

    def __repr__(self) -> str: ...

class BopScene:
    """A scene's folder; depth images are read on demand."""

    def __init__(self, id: int, folder: str | os.PathLike[str], images: Sequence[BopImage], has_ground_truth: bool = True) -> None: ...

    @property
    def id(self) -> int:
        """The scene's number."""

    @property
    def folder(self) -> pathlib.Path:
        """Where its files are."""

    @property
    def has_ground_truth(self) -> bool:
        """False: there is no scene_gt.json."""

    @property
    def images(self) -> list[BopImage]:
        """By rising id."""

    def image(self, im_id: int) -> BopImage:
        """Error when there is no such image."""

    def depth_path(self, image: BopImage) -> pathlib.Path:
        """Where an image's depth is."""

    def read_depth(self, image: BopImage) -> partpose.core.DepthImage:
        """An image's depth, in mm."""

    def __repr__(self) -> str: ...

class BopTarget:
    """Find `inst_count` instances of an object in an image."""

    def __init__(self, scene_id: int, im_id: int, obj_id: int, inst_count: int = 1) -> None: ...

    @property
    def scene_id(self) -> int:
        """In which scene."""

    @property
    def im_id(self) -> int:
        """In which image."""

    @property
    def obj_id(self) -> int:
        """Which object."""

    @property
    def inst_count(self) -> int:
        """How many of it."""

    def __repr__(self) -> str: ...

class BopDatasetCamera:
    """camera.json: the camera that a dataset is meant for."""

    def __init__(self, intrinsics: partpose.core.Intrinsics, depth_scale_mm: float = 1.0) -> None: ...

    @property
    def intrinsics(self) -> partpose.core.Intrinsics:
        """Of the depth images."""

    @property
    def depth_scale_mm(self) -> float:
        """mm for each unit of the depth images."""

    def __repr__(self) -> str: ...

class BopDataset:
    """A dataset in the format of the BOP benchmark."""

    @property
    def folder(self) -> pathlib.Path:
        """Where it is."""

    @property
    def split(self) -> str:
        """The folder of its scenes."""

    @property
    def camera(self) -> BopDatasetCamera | None:
        """camera.json; None: there is none."""

    @property
    def models_folder(self) -> pathlib.Path:
        """models_eval/ if there, or else models/."""

    @property
    def models(self) -> dict[int, BopModelInfo]:
        """By obj_id."""

    @property
    def scenes(self) -> dict[int, BopScene]:
        """By scene_id."""

    @property
    def targets(self) -> list[BopTarget]:
        """As in their file; without one: all ground truths."""

    def read_model(self, obj_id: int) -> partpose.core.TriangleMesh:
        """An object's mesh."""

    def scene(self, scene_id: int) -> BopScene:
        """Error when there is no such scene."""

    def __repr__(self) -> str: ...

def read_bop_dataset(folder: str | os.PathLike[str], split: str = 'test') -> BopDataset:
    """
    Models, scenes and targets; what is missing or damaged is an Error naming file and key.
    """

def bop_scene_folder(dataset: str | os.PathLike[str], split: str, scene_id: int) -> pathlib.Path:
    """DATASET/SPLIT/000001."""

def bop_model_name(obj_id: int) -> str:
    """obj_000001.ply."""

def read_bop_models_info(file: str | os.PathLike[str]) -> dict[int, BopModelInfo]:
    """By obj_id."""

def read_bop_scene(scene_folder: str | os.PathLike[str], scene_id: int) -> BopScene:
    """Cameras and, if there, ground truths."""

def read_bop_targets(file: str | os.PathLike[str]) -> list[BopTarget]:
    """test_targets_bop19.json."""

def write_bop_model(models_folder: str | os.PathLike[str], obj_id: int, mesh: partpose.core.TriangleMesh) -> None:
    """models_folder/obj_000001.ply."""

def write_bop_models_info(models_folder: str | os.PathLike[str], models: Mapping[int, BopModelInfo]) -> None:
    """models_info.json."""

def write_bop_camera(dataset: str | os.PathLike[str], camera: BopDatasetCamera) -> None:
    """DATASET/camera.json."""

def write_bop_depth(scene_folder: str | os.PathLike[str], im_id: int, depth: partpose.core.DepthImage, depth_scale_mm: float) -> None:
    """scene_folder/depth/000000.png."""

def write_bop_scene(scene: BopScene) -> None:
    """
    scene_camera.json, and the ground truth's files where it is known. No depth images.
    """

def write_bop_targets(dataset: str | os.PathLike[str], targets: Sequence[BopTarget]) -> None:
    """DATASET/test_targets_bop19.json."""

def bop_targets_of(scenes: Sequence[BopScene], min_visib_fract: float = 0.1) -> list[BopTarget]:
    """A target for each object in each image that is visible enough."""

class BopEstimate:
    """A row of a results file."""

    def __init__(self, scene_id: int, im_id: int, obj_id: int, score: float, camera_from_model: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')], time_s: float = -1.0) -> None: ...

    @property
    def scene_id(self) -> int:
        """In which scene."""

    @property
    def im_id(self) -> int:
        """In which image."""

    @property
    def obj_id(self) -> int:
        """Which object."""

    @property
    def score(self) -> float:
        """Higher: more certain."""

    @property
    def camera_from_model(self) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The estimated pose."""

    @property
    def time_s(self) -> float:
        """For the whole image, equal in all its rows; -1: not known."""

    def __repr__(self) -> str: ...

def read_bop_results(file: str | os.PathLike[str]) -> list[BopEstimate]:
    """A results file; an Error names the damaged line."""

def write_bop_results(file: str | os.PathLike[str], estimates: Sequence[BopEstimate]) -> None:
    """scene_id,im_id,obj_id,score,R,t,time."""

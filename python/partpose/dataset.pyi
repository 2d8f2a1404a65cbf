# Written by script/make_stubs.
from collections.abc import Callable, Mapping, Sequence
import os
import pathlib
from typing import Annotated, Any, Self

import numpy
import numpy.typing
from numpy.typing import NDArray

import partpose.camera
import partpose.core
import partpose.geometry


class IcosahedronOptions:
    """
    Where the virtual camera stands.

    capture_distance_mm = 650.0: distance of the cameras from the part's centre [mm], > 0
    subdivide = 1: how often the icosahedron's faces are split in four, 0 to 4
    use_vertices = True: cameras at the vertices (12, 42, 162 views) or at the face centres (20, 80, 320 views)
    xyz_rotation_deg = 5.0: the icosahedron is turned by this about x, then y, then z [deg]
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, capture_distance_mm: float = 650.0, subdivide: int = 1, use_vertices: bool = True, xyz_rotation_deg: float = 5.0) -> None: ...

    @property
    def capture_distance_mm(self) -> float:
        """distance of the cameras from the part's centre [mm], > 0"""

    @capture_distance_mm.setter
    def capture_distance_mm(self, value: float, /) -> None: ...

    @property
    def subdivide(self) -> int:
        """how often the icosahedron's faces are split in four, 0 to 4"""

    @subdivide.setter
    def subdivide(self, value: int, /) -> None: ...

    @property
    def use_vertices(self) -> bool:
        """
        cameras at the vertices (12, 42, 162 views) or at the face centres (20, 80, 320 views)
        """

    @use_vertices.setter
    def use_vertices(self, value: bool, /) -> None: ...

    @property
    def xyz_rotation_deg(self) -> float:
        """the icosahedron is turned by this about x, then y, then z [deg]"""

    @xyz_rotation_deg.setter
    def xyz_rotation_deg(self, value: float, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DatasetPreparationConfig:
    """
    Appendix C.1.1 of the reference.

    tag = '': a note of yours
    virtual_depth_camera: the camera that takes the views
    organized_output = False: views keep the image's rows and columns (larger files)
    virtual_views_icosahedron: where the camera stands
    symmetries = None: a JSON like BOP's models_info.json, by the parts' names or ids: what it says of a part is not searched for
    symmetry_tolerance_mm = None: largest distance between a surface and its turned copy [mm], > 0; absent: by the part's size
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, tag: str = '', virtual_depth_camera: partpose.camera.VirtualDepthCameraOptions | Mapping[str, Any] = ..., organized_output: bool = False, virtual_views_icosahedron: IcosahedronOptions | Mapping[str, Any] = ..., symmetries: str | None = None, symmetry_tolerance_mm: float | None = None) -> None: ...

    @property
    def tag(self) -> str:
        """a note of yours"""

    @tag.setter
    def tag(self, value: str, /) -> None: ...

    @property
    def virtual_depth_camera(self) -> partpose.camera.VirtualDepthCameraOptions:
        """the camera that takes the views"""

    @virtual_depth_camera.setter
    def virtual_depth_camera(self, value: partpose.camera.VirtualDepthCameraOptions | Mapping[str, Any], /) -> None: ...

    @property
    def organized_output(self) -> bool:
        """views keep the image's rows and columns (larger files)"""

    @organized_output.setter
    def organized_output(self, value: bool, /) -> None: ...

    @property
    def virtual_views_icosahedron(self) -> IcosahedronOptions:
        """where the camera stands"""

    @virtual_views_icosahedron.setter
    def virtual_views_icosahedron(self, value: IcosahedronOptions | Mapping[str, Any], /) -> None: ...

    @property
    def symmetries(self) -> str | None:
        """
        a JSON like BOP's models_info.json, by the parts' names or ids: what it says of a part is not searched for
        """

    @symmetries.setter
    def symmetries(self, value: str | None, /) -> None: ...

    @property
    def symmetry_tolerance_mm(self) -> float | None:
        """
        largest distance between a surface and its turned copy [mm], > 0; absent: by the part's size
        """

    @symmetry_tolerance_mm.setter
    def symmetry_tolerance_mm(self, value: float | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class ModelList:
    """
    Appendix C.1.2: the parts' STL files.

    model_paths: paths to the parts' model files
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, model_paths: Sequence[str] = ...) -> None: ...

    @property
    def model_paths(self) -> tuple[str, ...]:
        """paths to the parts' model files"""

    @model_paths.setter
    def model_paths(self, value: Sequence[str], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class ContinuousSymmetry:
    """
    An axis about which a part may be turned.

    axis: direction of the axis, model frame
    offset: a point on it [mm]
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, axis: Sequence[float] = ..., offset: Sequence[float] = ...) -> None: ...

    @property
    def axis(self) -> tuple[float, ...]:
        """direction of the axis, model frame"""

    @axis.setter
    def axis(self, value: Sequence[float], /) -> None: ...

    @property
    def offset(self) -> tuple[float, ...]:
        """a point on it [mm]"""

    @offset.setter
    def offset(self, value: Sequence[float], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class ModelSymmetries:
    """
    A part's symmetries with the keys of BOP's models_info.json.

    symmetries_discrete = None: motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
    symmetries_continuous = None: axes about which it may be turned by any angle
    symmetry_tolerance_mm = None: found in the mesh with this tolerance; absent: given
    symmetry_deviation_mm = None: largest distance of the surface to its moved copy
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, symmetries_discrete: Sequence[Sequence[float]] | None = None, symmetries_continuous: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None = None, symmetry_tolerance_mm: float | None = None, symmetry_deviation_mm: float | None = None) -> None: ...

    @property
    def symmetries_discrete(self) -> tuple[tuple[float, ...], ...] | None:
        """
        motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
        """

    @symmetries_discrete.setter
    def symmetries_discrete(self, value: Sequence[Sequence[float]] | None, /) -> None: ...

    @property
    def symmetries_continuous(self) -> tuple[ContinuousSymmetry, ...] | None:
        """axes about which it may be turned by any angle"""

    @symmetries_continuous.setter
    def symmetries_continuous(self, value: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None, /) -> None: ...

    @property
    def symmetry_tolerance_mm(self) -> float | None:
        """found in the mesh with this tolerance; absent: given"""

    @symmetry_tolerance_mm.setter
    def symmetry_tolerance_mm(self, value: float | None, /) -> None: ...

    @property
    def symmetry_deviation_mm(self) -> float | None:
        """largest distance of the surface to its moved copy"""

    @symmetry_deviation_mm.setter
    def symmetry_deviation_mm(self, value: float | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    def symmetries(self) -> partpose.geometry.Symmetries:
        """The same as Symmetries."""

class ModelInfo:
    """
    A model's entry of models_info.json.

    name = None: the part's name
    diameter = None: largest distance of two vertices [mm]
    min_x = None: lower end of the bounding box [mm]
    min_y = None
    min_z = None
    size_x = None: its size [mm]
    size_y = None
    size_z = None
    symmetries_discrete = None: motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
    symmetries_continuous = None: axes about which it may be turned by any angle
    symmetry_tolerance_mm = None: found in the mesh with this tolerance; absent: given
    symmetry_deviation_mm = None: largest distance of the surface to its moved copy
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, name: str | None = None, diameter: float | None = None, min_x: float | None = None, min_y: float | None = None, min_z: float | None = None, size_x: float | None = None, size_y: float | None = None, size_z: float | None = None, symmetries_discrete: Sequence[Sequence[float]] | None = None, symmetries_continuous: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None = None, symmetry_tolerance_mm: float | None = None, symmetry_deviation_mm: float | None = None) -> None: ...

    @property
    def name(self) -> str | None:
        """the part's name"""

    @name.setter
    def name(self, value: str | None, /) -> None: ...

    @property
    def diameter(self) -> float | None:
        """largest distance of two vertices [mm]"""

    @diameter.setter
    def diameter(self, value: float | None, /) -> None: ...

    @property
    def min_x(self) -> float | None:
        """lower end of the bounding box [mm]"""

    @min_x.setter
    def min_x(self, value: float | None, /) -> None: ...

    @property
    def min_y(self) -> float | None: ...

    @min_y.setter
    def min_y(self, value: float | None, /) -> None: ...

    @property
    def min_z(self) -> float | None: ...

    @min_z.setter
    def min_z(self, value: float | None, /) -> None: ...

    @property
    def size_x(self) -> float | None:
        """its size [mm]"""

    @size_x.setter
    def size_x(self, value: float | None, /) -> None: ...

    @property
    def size_y(self) -> float | None: ...

    @size_y.setter
    def size_y(self, value: float | None, /) -> None: ...

    @property
    def size_z(self) -> float | None: ...

    @size_z.setter
    def size_z(self, value: float | None, /) -> None: ...

    @property
    def symmetries_discrete(self) -> tuple[tuple[float, ...], ...] | None:
        """
        motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
        """

    @symmetries_discrete.setter
    def symmetries_discrete(self, value: Sequence[Sequence[float]] | None, /) -> None: ...

    @property
    def symmetries_continuous(self) -> tuple[ContinuousSymmetry, ...] | None:
        """axes about which it may be turned by any angle"""

    @symmetries_continuous.setter
    def symmetries_continuous(self, value: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None, /) -> None: ...

    @property
    def symmetry_tolerance_mm(self) -> float | None:
        """found in the mesh with this tolerance; absent: given"""

    @symmetry_tolerance_mm.setter
    def symmetry_tolerance_mm(self, value: float | None, /) -> None: ...

    @property
    def symmetry_deviation_mm(self) -> float | None:
        """largest distance of the surface to its moved copy"""

    @symmetry_deviation_mm.setter
    def symmetry_deviation_mm(self, value: float | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

def read_models_info(path: str | os.PathLike[str]) -> dict[str, ModelInfo]:
    """By the model's number or name."""

class DatasetModel:
    """
    A part of a dataset.

    T1: moves the bounding box's centre to the origin, 4x4 [mm]
    id: names the folder under models/
    name: the model file's name without its ending, or the part's own
    mesh_hash: tells whether mesh.stl changed since its views were rendered
    symmetries_discrete: motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
    symmetries_continuous: axes about which it may be turned by any angle
    symmetry_tolerance_mm: found in the mesh with this tolerance; absent: given
    symmetry_deviation_mm: largest distance of the surface to its moved copy
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, T1: numpy.typing.ArrayLike = ..., id: int = ..., name: str = ..., mesh_hash: str | None = ..., symmetries_discrete: Sequence[Sequence[float]] | None = ..., symmetries_continuous: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None = ..., symmetry_tolerance_mm: float | None = ..., symmetry_deviation_mm: float | None = ...) -> None: ...

    @property
    def T1(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """moves the bounding box's centre to the origin, 4x4 [mm]"""

    @T1.setter
    def T1(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def id(self) -> int:
        """names the folder under models/"""

    @id.setter
    def id(self, value: int, /) -> None: ...

    @property
    def name(self) -> str:
        """the model file's name without its ending, or the part's own"""

    @name.setter
    def name(self, value: str, /) -> None: ...

    @property
    def mesh_hash(self) -> str | None:
        """tells whether mesh.stl changed since its views were rendered"""

    @mesh_hash.setter
    def mesh_hash(self, value: str | None, /) -> None: ...

    @property
    def symmetries_discrete(self) -> tuple[tuple[float, ...], ...] | None:
        """
        motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity
        """

    @symmetries_discrete.setter
    def symmetries_discrete(self, value: Sequence[Sequence[float]] | None, /) -> None: ...

    @property
    def symmetries_continuous(self) -> tuple[ContinuousSymmetry, ...] | None:
        """axes about which it may be turned by any angle"""

    @symmetries_continuous.setter
    def symmetries_continuous(self, value: Sequence[ContinuousSymmetry | Mapping[str, Any]] | None, /) -> None: ...

    @property
    def symmetry_tolerance_mm(self) -> float | None:
        """found in the mesh with this tolerance; absent: given"""

    @symmetry_tolerance_mm.setter
    def symmetry_tolerance_mm(self, value: float | None, /) -> None: ...

    @property
    def symmetry_deviation_mm(self) -> float | None:
        """largest distance of the surface to its moved copy"""

    @symmetry_deviation_mm.setter
    def symmetry_deviation_mm(self, value: float | None, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    @property
    def symmetries(self) -> partpose.geometry.Symmetries:
        """As the dataset states them."""

class DatasetView:
    """
    A camera of a dataset.

    T2: inverse of the camera's pose, 4x4 [mm]
    id: names the file under views/
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, T2: numpy.typing.ArrayLike = ..., id: int = ...) -> None: ...

    @property
    def T2(self) -> Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]:
        """inverse of the camera's pose, 4x4 [mm]"""

    @T2.setter
    def T2(self, value: numpy.typing.ArrayLike, /) -> None: ...

    @property
    def id(self) -> int:
        """names the file under views/"""

    @id.setter
    def id(self, value: int, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class DatasetOut:
    """
    Appendix C.1.3: the dataset's dataset.json.

    dataset_preparation_config: as it was given
    models: the parts
    views: the cameras
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, dataset_preparation_config: DatasetPreparationConfig | Mapping[str, Any] = ..., models: Sequence[DatasetModel | Mapping[str, Any]] = ..., views: Sequence[DatasetView | Mapping[str, Any]] = ...) -> None: ...

    @property
    def dataset_preparation_config(self) -> DatasetPreparationConfig:
        """as it was given"""

    @dataset_preparation_config.setter
    def dataset_preparation_config(self, value: DatasetPreparationConfig | Mapping[str, Any], /) -> None: ...

    @property
    def models(self) -> tuple[DatasetModel, ...]:
        """the parts"""

    @models.setter
    def models(self, value: Sequence[DatasetModel | Mapping[str, Any]], /) -> None: ...

    @property
    def views(self) -> tuple[DatasetView, ...]:
        """the cameras"""

    @views.setter
    def views(self, value: Sequence[DatasetView | Mapping[str, Any]], /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

class Dataset:
    """The folder of appendix C.1.4."""

    @property
    def folder(self) -> pathlib.Path:
        """Where it is."""

    @property
    def out(self) -> DatasetOut:
        """What dataset.json says."""

    def model_folder(self, model_id: int) -> pathlib.Path:
        """The folder of a model."""

    def mesh_path(self, model_id: int) -> pathlib.Path:
        """The mesh of a model."""

    def view_path(self, model_id: int, view_id: int) -> pathlib.Path:
        """The cloud of a model's view."""

    def camera_from_model(self, model_index: int, view_index: int) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
        """The pose of a model in a view."""

    def __repr__(self) -> str: ...

def icosahedron_views(options: IcosahedronOptions = ...) -> list[DatasetView]:
    """The cameras of an icosahedron."""

def centred_from_model(mesh: partpose.core.TriangleMesh) -> Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]:
    """T1: moves the bounding box's centre to the origin."""

def open_dataset(folder: str | os.PathLike[str]) -> Dataset:
    """Reads and checks dataset.json."""

def create_dataset(config: DatasetPreparationConfig, model_paths: Sequence[str | os.PathLike[str]], folder: str | os.PathLike[str], progress: Callable[[str, int, int], object] | None = None) -> Dataset:
    """Renders the views of all models and writes the folder."""

def read_model_list(path: str | os.PathLike[str]) -> list[pathlib.Path]:
    """The paths of a model list."""

def read_dataset_config(path: str | os.PathLike[str]) -> DatasetPreparationConfig:
    """Absent keys keep their defaults."""

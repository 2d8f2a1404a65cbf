# Written by script/make_stubs.
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

import numpy
import numpy.typing
from numpy.typing import NDArray

import partpose.core


def voxel_grid(cloud: partpose.core.PointCloud, voxel_mm: float) -> partpose.core.PointCloud:
    """One point per occupied cell: their centroid."""

def estimate_normals(cloud: partpose.core.PointCloud, radius_mm: float, viewpoint_mm: Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')] = ...) -> partpose.core.PointCloud:
    """A new cloud with normals and curvatures. Points must be finite."""

def icosphere_directions(subdivide: int, use_vertices: bool) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]:
    """
    Unit directions: vertices (12, 42, 162, ...) or face centres (20, 80, ...).
    """

class Plane:
    """{ p : normal . p + offset_mm = 0 }, turned towards the camera."""

    @property
    def normal(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
        """Unit normal."""

    @property
    def offset_mm(self) -> float:
        """Of the equation above."""

    def signed_distance_mm(self, point_mm: Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')]) -> float:
        """Positive on the camera's side."""

    def __repr__(self) -> str: ...

class PlaneFit:
    """A plane and the points on it."""

    @property
    def plane(self) -> Plane:
        """The plane found."""

    @property
    def rms_mm(self) -> float:
        """Of the inliers' distances."""

    @property
    def inliers(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,))]:
        """Indices of points."""

    def __repr__(self) -> str: ...

def fit_plane(cloud: partpose.core.PointCloud, distance_threshold_mm: float = 10.0, max_hypotheses: int = 500, seed: int = 1) -> PlaneFit | None:
    """The dominant plane by RANSAC; None when there is none."""

class KdTree:
    """Nearest neighbours among points that do not change."""

    def __init__(self, points_mm: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))]) -> None: ...

    def nearest(self, queries_mm: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))]) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.float32], dict(shape=(None,))]]:
        """Indices (-1: none) and squared distances (mm^2) of the nearest points."""

    def nearest_k(self, query_mm: Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')], k: int) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.float32], dict(shape=(None,))]]:
        """The k nearest, nearest first; fewer when there are fewer."""

class SurfaceDistance:
    """The nearest place on a mesh's triangles, exact."""

    def __init__(self, mesh: partpose.core.TriangleMesh) -> None: ...

    def nearest(self, query_mm: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]) -> tuple[float, Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], int]:
        """Distance (mm), place on the surface, triangle."""

def even_surface_samples(mesh: partpose.core.TriangleMesh, count: int) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]:
    """Points spread evenly over a mesh's surface."""

class ConvexHull:
    """A convex hull as triangles, counter-clockwise seen from outside."""

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]:
        """N x 3, mm."""

    @property
    def original(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,))]:
        """Which of the given points each vertex is."""

    @property
    def triangles(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None, 3))]:
        """M x 3 indices of vertices."""

    @property
    def flat(self) -> bool:
        """All points lie on a plane, a line or a point: there are no triangles."""

    def volume_mm3(self) -> float:
        """The enclosed volume."""

    def centroid(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]:
        """Of the enclosed volume."""

    def __repr__(self) -> str: ...

def convex_hull(points_mm: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))]) -> ConvexHull:
    """Quickhull (Barber, Dobkin and Huhdanpaa 1996) with exact predicates."""

class Symmetries:
    """
    The rigid motions of a part, model frame (mm), that map its shape onto itself.
    """

    def __init__(self, discrete: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]] = [], continuous: Sequence[tuple[Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]]] = []) -> None: ...

    @property
    def discrete(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]:
        """model_from_model, without the identity."""

    @property
    def continuous(self) -> list[tuple[Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')], Annotated[NDArray[numpy.float64], dict(shape=(3), order='C')]]]:
        """
        Axes (direction, a point on it in mm) about which it may be turned by any angle.
        """

    def empty(self) -> bool:
        """Whether there are none."""

    def __repr__(self) -> str: ...

def symmetry_transformations(symmetries: Symmetries, max_step: float = 0.01) -> list[Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C')]]:
    """
    A finite list of model_from_model, the identity first, as the BOP toolkit enumerates them.
    """

class MeasuredSymmetries:
    """Symmetries and how exact each is."""

    @property
    def symmetries(self) -> Symmetries:
        """The symmetries themselves."""

    @property
    def discrete_deviation_mm(self) -> list[float]:
        """Of each of symmetries.discrete."""

    @property
    def continuous_deviation_mm(self) -> list[float]:
        """Of each of symmetries.continuous."""

    def largest_deviation_mm(self) -> float:
        """The largest of all."""

    def __repr__(self) -> str: ...

class SymmetrySearch:
    """What search_symmetries found."""

    @property
    def found(self) -> MeasuredSymmetries:
        """Within the tolerance."""

    @property
    def near(self) -> MeasuredSymmetries:
        """But for a detail."""

    @property
    def tolerance_mm(self) -> float:
        """Within which a symmetry counts as found."""

    @property
    def diameter_mm(self) -> float:
        """The largest distance of two vertices."""

    def __repr__(self) -> str: ...

def search_symmetries(mesh: partpose.core.TriangleMesh, tolerance_mm: float | None = None) -> SymmetrySearch:
    """
    The rotations that put a part's surface back onto itself within a tolerance (None: by its size).
    """

def find_symmetries(mesh: partpose.core.TriangleMesh, tolerance_mm: float) -> Symmetries:
    """Those within the tolerance."""

def default_symmetry_tolerance_mm(diameter_mm: float) -> float:
    """What search_symmetries takes by a part's size."""

class DistanceGrid:
    """Distance to the nearest of some points, tabulated."""

    def __init__(self, points_mm: Annotated[numpy.typing.NDArray[numpy.floating[Any]], dict(shape=(None, 3))], margin_mm: float, cells_along_longest: int = 48) -> None: ...

    def at(self, p: Annotated[NDArray[numpy.float32], dict(shape=(3), order='C')]) -> float:
        """In mm, right to about half a cell."""

    def cell_mm(self) -> float:
        """Edge of a cell."""

class MeshInspection:
    """
    What a person should know before trusting a mesh.

    triangles = 0: of the file, all kinds
    vertices = 0: different ones that triangles use
    size_mm = (0.0, 0.0, 0.0): of the bounding box along x, y, z [mm]
    diagonal_mm = 0.0: of the bounding box [mm]
    area_mm2 = 0.0: of all triangles [mm^2]
    volume_mm3 = None: enclosed [mm^3]; of watertight meshes without flipped triangles only
    watertight = False: every edge belongs to an even number of triangles, at least two
    open_edges = 0: edges of one triangle, or of an odd number: the surface has a gap there
    non_manifold_edges = 0: edges of more than two triangles: sheets that meet
    shells = 0: pieces of surface that no edge connects
    degenerate_triangles = 0: triangles without area
    duplicate_triangles = 0: triangles that are there already, wound either way
    flipped_triangles = 0: triangles that face inwards: repair turns so many
    unit_guess = '': "metre" or "inch" when the size is that of a common part in this unit, "micrometre" when it is huge; else empty
    """

    def __init__(self, values: Mapping[str, Any] | None = None, /, *, triangles: int = 0, vertices: int = 0, size_mm: Sequence[float] = (0.0, 0.0, 0.0), diagonal_mm: float = 0.0, area_mm2: float = 0.0, volume_mm3: float | None = None, watertight: bool = False, open_edges: int = 0, non_manifold_edges: int = 0, shells: int = 0, degenerate_triangles: int = 0, duplicate_triangles: int = 0, flipped_triangles: int = 0, unit_guess: str = '') -> None: ...

    @property
    def triangles(self) -> int:
        """of the file, all kinds"""

    @triangles.setter
    def triangles(self, value: int, /) -> None: ...

    @property
    def vertices(self) -> int:
        """different ones that triangles use"""

    @vertices.setter
    def vertices(self, value: int, /) -> None: ...

    @property
    def size_mm(self) -> tuple[float, ...]:
        """of the bounding box along x, y, z [mm]"""

    @size_mm.setter
    def size_mm(self, value: Sequence[float], /) -> None: ...

    @property
    def diagonal_mm(self) -> float:
        """of the bounding box [mm]"""

    @diagonal_mm.setter
    def diagonal_mm(self, value: float, /) -> None: ...

    @property
    def area_mm2(self) -> float:
        """of all triangles [mm^2]"""

    @area_mm2.setter
    def area_mm2(self, value: float, /) -> None: ...

    @property
    def volume_mm3(self) -> float | None:
        """enclosed [mm^3]; of watertight meshes without flipped triangles only"""

    @volume_mm3.setter
    def volume_mm3(self, value: float | None, /) -> None: ...

    @property
    def watertight(self) -> bool:
        """every edge belongs to an even number of triangles, at least two"""

    @watertight.setter
    def watertight(self, value: bool, /) -> None: ...

    @property
    def open_edges(self) -> int:
        """
        edges of one triangle, or of an odd number: the surface has a gap there
        """

    @open_edges.setter
    def open_edges(self, value: int, /) -> None: ...

    @property
    def non_manifold_edges(self) -> int:
        """edges of more than two triangles: sheets that meet"""

    @non_manifold_edges.setter
    def non_manifold_edges(self, value: int, /) -> None: ...

    @property
    def shells(self) -> int:
        """pieces of surface that no edge connects"""

    @shells.setter
    def shells(self, value: int, /) -> None: ...

    @property
    def degenerate_triangles(self) -> int:
        """triangles without area"""

    @degenerate_triangles.setter
    def degenerate_triangles(self, value: int, /) -> None: ...

    @property
    def duplicate_triangles(self) -> int:
        """triangles that are there already, wound either way"""

    @duplicate_triangles.setter
    def duplicate_triangles(self, value: int, /) -> None: ...

    @property
    def flipped_triangles(self) -> int:
        """triangles that face inwards: repair turns so many"""

    @flipped_triangles.setter
    def flipped_triangles(self, value: int, /) -> None: ...

    @property
    def unit_guess(self) -> str:
        """
        "metre" or "inch" when the size is that of a common part in this unit, "micrometre" when it is huge; else empty
        """

    @unit_guess.setter
    def unit_guess(self, value: str, /) -> None: ...

    def to_dict(self) -> dict[str, Any]:
        """What its JSON file would say."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    __hash__: None = None  # type: ignore[assignment]

    def __copy__(self) -> Self: ...

    def __deepcopy__(self, memo: Any, /) -> Self: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    def sound(self) -> bool:
        """Nothing that repair or a person should look at; size aside."""

def inspect_mesh(mesh: partpose.core.TriangleMesh) -> MeshInspection:
    """Size, gaps, shells, degenerate and flipped triangles."""

def guess_unit(diagonal_mm: float) -> str:
    """
    In which unit a part of this diagonal (its number taken as mm) more likely is: "metre", "inch", "micrometre", else empty.
    """

def mm_per_unit(unit: str) -> float:
    """One of guess_unit's in mm; 1 for any other text."""

class MeshRepair:
    """A repaired mesh, and what was done."""

    @property
    def mesh(self) -> partpose.core.TriangleMesh:
        """Repaired."""

    @property
    def weld_distance_mm(self) -> float:
        """Vertices nearer than this were made one."""

    @property
    def welded_vertices(self) -> int:
        """That lay so near another one."""

    @property
    def removed_degenerate(self) -> int:
        """Triangles without area."""

    @property
    def removed_duplicates(self) -> int:
        """Triangles that were there twice."""

    @property
    def turned_triangles(self) -> int:
        """Triangles that faced inwards."""

    def changed_anything(self) -> bool:
        """Whether anything was done."""

    def __repr__(self) -> str: ...

def repair_mesh(mesh: partpose.core.TriangleMesh, weld_distance_mm: float | None = None) -> MeshRepair:
    """
    Welds vertices, removes triangles that say nothing, turns the surface outwards. The shape stays.
    """

# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import gc
import pickle
from typing import Any

import numpy as np
import pytest
from conftest import pose

import partpose
from partpose import core, geometry
from partpose.core import DepthImage, Error, Intrinsics, PointCloud, ThreadLimit, TriangleMesh

CAMERA = Intrinsics(width=64, height=48, fx=60, fy=60, cx=31.5, cy=23.5)


def test_arrays_are_views_that_keep_their_owner_alive() -> None:
    given = np.arange(3000, dtype=np.float32).reshape(-1, 3)
    cloud = PointCloud(given, normals=given, curvatures=given[:, 0])
    points = cloud.points
    assert points.dtype == np.float32 and not points.flags.owndata and not points.flags.writeable
    assert np.shares_memory(points, cloud.points)
    given[:] = -1  # the cloud has its own copy
    del cloud
    gc.collect()
    junk = [np.zeros(3000, np.float32) for _ in range(50)]
    assert points[999].tolist() == [2997, 2998, 2999] and len(junk) == 50


@pytest.mark.parametrize(
    "bad",
    [np.zeros((3, 4), np.float32), np.zeros(3, np.float32), np.zeros((3, 3), np.uint8), np.zeros((2, 3), complex),
     np.zeros((2, 3, 3), np.float32), np.zeros((2, 3), bool)],
)  # fmt: skip
def test_wrong_arrays_say_what_is_expected(bad: Any) -> None:
    with pytest.raises(Error, match="points: .*expected, got"):
        PointCloud(bad)


@pytest.mark.parametrize("bad", ["text", None, 5])
def test_what_is_no_array_is_a_type_error(bad: Any) -> None:
    with pytest.raises(TypeError):
        PointCloud(bad)


def test_any_layout_of_floats_is_read() -> None:
    base = np.random.default_rng(1).normal(size=(10, 6))
    for array in (base[:, ::2], base[::-1, :3], np.asfortranarray(base[:, :3]), base[:, :3].astype(np.float32)[::3]):
        assert np.array_equal(PointCloud(array).points, array.astype(np.float32))
    assert len(PointCloud(np.zeros((0, 3), np.float32))) == 0


def test_clouds() -> None:
    points = np.array([[0, 0, 500], [10, 0, 500], [np.nan] * 3, [0, 0, -5]], np.float32)
    cloud = PointCloud(points, width=2, height=2)
    assert cloud.is_organized() and not cloud.has_normals() and not cloud.has_curvatures()
    assert (cloud.width, cloud.height, cloud.normals.shape, cloud.curvatures.shape) == (2, 2, (0, 3), (0,))
    assert len(core.without_missing(cloud)) == 3
    assert len(core.before_camera(cloud)) == 2
    assert core.select(cloud, [1]).points.tolist() == [[10, 0, 500]]
    assert len(core.every_nth(cloud, 2)) == 2
    assert len(core.append(cloud, cloud)) == 8
    assert core.centroid(core.before_camera(cloud)).tolist() == [5, 0, 500]
    assert core.transformed(cloud, pose(1, 2, 3)).points[0].tolist() == [1, 2, 503]
    assert "float32 (4, 3)" in repr(cloud)
    for wrong in (lambda: core.select(cloud, [4]), lambda: core.every_nth(cloud, 0),
                  lambda: PointCloud(points, width=3, height=2), lambda: PointCloud(points, normals=points[:2]),
                  lambda: PointCloud(points, curvatures=points[:2, 0]), lambda: core.transformed(cloud, np.zeros((4, 4)))):  # fmt: skip
        with pytest.raises(Error):
            wrong()


def test_depth_images() -> None:
    pixels = np.zeros((48, 64), np.uint16)
    pixels[20, 30] = 5000
    depth = DepthImage(pixels, depth_scale_mm=0.1)
    assert depth.z_mm[20, 30] == 500 and (depth.width, depth.height) == (64, 48)
    floats = pixels.astype(np.float32)
    floats[0, 0], floats[0, 1] = np.nan, np.inf
    assert DepthImage(floats).z_mm[0, :2].tolist() == [0, 0]
    cloud = core.to_point_cloud(depth, CAMERA)
    assert np.allclose(cloud.points, CAMERA.unproject(30, 20, 500))
    assert core.to_point_cloud(depth, CAMERA, organized=True).is_organized()
    assert np.array_equal(core.to_depth_image(cloud, CAMERA).z_mm, depth.z_mm)
    assert core.intrinsics_covering(cloud, 0.01).width >= 1
    floats[5, 6] = -1
    for bad in (floats, pixels[0], pixels.astype(np.int64), np.zeros((2, 2, 2), np.float32)):
        with pytest.raises(Error, match="depth"):
            DepthImage(bad)
    with pytest.raises(Error, match="depth_scale_mm"):
        DepthImage(pixels, depth_scale_mm=0)
    with pytest.raises(Error, match="64 x 48"):
        core.to_point_cloud(depth, Intrinsics(32, 48, 60, 60, 16, 24))
    z = depth.z_mm
    del depth
    gc.collect()
    assert z[20, 30] == 500


def test_intrinsics() -> None:
    camera = Intrinsics.from_field_of_view(640, 480, 50, 40)
    assert np.isclose(camera.fx, 320 / np.tan(np.radians(25))) and camera.cx == 319.5 and camera.cy == 239.5
    assert np.isclose(camera.fy, 240 / np.tan(np.radians(20)))
    assert np.allclose(camera.project(camera.unproject(12, 34, 700)), [12, 34], atol=1e-4)
    assert pickle.loads(pickle.dumps(camera)) == camera != CAMERA and camera != 3
    assert "width=640" in repr(camera) and camera.height == 480
    for bad in ((0, 480, 600, 600, 1, 1), (640, 480, float("nan"), 600, 1, 1), (640, 480, 600, -1, 1, 1)):
        with pytest.raises(Error):
            Intrinsics(*bad)


def test_meshes(box: TriangleMesh) -> None:
    lower, upper = core.bounding_box(box)
    assert lower.tolist() == [-5, -10, -20] and upper.tolist() == [5, 10, 20]
    diagonal = np.sqrt(10**2 + 20**2 + 40**2)
    assert np.isclose(core.bounding_box_diagonal(box), diagonal) and np.isclose(core.diameter(box), diagonal)
    assert box.face_normal(0).tolist() == [-1, 0, 0]
    soup = TriangleMesh(box.vertices[box.triangles.reshape(-1)], np.arange(36).reshape(-1, 3))
    assert len(core.with_merged_vertices(soup).vertices) == 8
    for bad in (np.array([[0, 1, 8]]), np.array([[0, 1, -1]]), np.array([[0, 1]]), np.array([[0.0, 1, 2]])):
        with pytest.raises(Error, match="triangles"):
            TriangleMesh(box.vertices, bad)
    with pytest.raises(Error, match="no triangle 12"):
        box.face_normal(12)


def test_poses() -> None:
    turned = pose(3, 4, 0)
    turned[:3, :3] = core.rotation_from_vector(np.array([0, 0, np.pi / 2]))
    assert np.isclose(core.rotation_error_deg(turned, np.eye(4)), 90)
    assert np.isclose(core.translation_error_mm(turned, np.eye(4)), 5)
    assert core.is_rigid(turned) and not core.is_rigid(2 * turned)
    assert np.allclose(core.nearest_rigid(turned + 1e-6), turned, atol=1e-5)
    for bad in (2 * turned, np.full((4, 4), np.nan)):
        with pytest.raises(Error, match="rigid"):
            core.rotation_error_deg(bad, turned)
    with pytest.raises(TypeError):
        core.rotation_error_deg(np.eye(3), turned)
    with pytest.raises(Error):
        core.nearest_rigid(np.full((4, 4), np.nan))


def test_threads_do_not_change_a_bit() -> None:
    cloud = PointCloud(np.random.default_rng(2).uniform(0, 50, (3000, 3)))
    with ThreadLimit(1):
        one = geometry.estimate_normals(cloud, 8)
    assert np.array_equal(one.normals, geometry.estimate_normals(cloud, 8).normals)
    with pytest.raises(Error):
        ThreadLimit(-1)


def test_errors_are_value_errors_with_the_librarys_message() -> None:
    assert issubclass(Error, ValueError) and partpose.Error is Error


def test_geometry_of_points() -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform(-50, 50, (500, 3)).astype(np.float32)
    tree = geometry.KdTree(points)
    queries = rng.uniform(-50, 50, (40, 3)).astype(np.float32)
    squared = ((points[None] - queries[:, None]) ** 2).sum(2)
    index, distance = tree.nearest(queries)
    assert np.array_equal(index, squared.argmin(1)) and np.allclose(distance, squared.min(1), rtol=1e-4)
    index, distance = tree.nearest_k(queries[0], 5)
    assert np.array_equal(index, squared[0].argsort()[:5])
    grid = geometry.DistanceGrid(points, 10)
    assert abs(grid.at(points[0])) <= 2 * grid.cell_mm()
    assert len(geometry.voxel_grid(PointCloud(points), 1000)) == 8
    assert geometry.icosphere_directions(1, True).shape == (42, 3)
    flat = np.column_stack([points[:, :2], np.full(500, 700)])
    found = geometry.fit_plane(PointCloud(flat), distance_threshold_mm=1)
    assert found is not None and len(found.inliers) == 500 and found.rms_mm < 1e-2
    assert np.allclose(found.plane.normal, [0, 0, -1], atol=1e-5) and np.isclose(found.plane.offset_mm, 700)
    assert np.isclose(found.plane.signed_distance_mm(np.array([0, 0, 690], np.float32)), 10, atol=1e-3)
    assert geometry.fit_plane(PointCloud(flat[:2])) is None
    points[7, 1] = np.nan
    for wrong in (lambda: geometry.KdTree(points), lambda: tree.nearest_k(queries[0], 0),
                  lambda: geometry.DistanceGrid(queries[:0], 1), lambda: geometry.voxel_grid(PointCloud(flat), 0),
                  lambda: geometry.icosphere_directions(9, True)):  # fmt: skip
        with pytest.raises(Error):
            wrong()


def test_geometry_of_meshes(box: TriangleMesh) -> None:
    hull = geometry.convex_hull(box.vertices)
    assert np.isclose(hull.volume_mm3(), 8000) and not hull.flat and np.allclose(hull.centroid(), 0)
    assert len(hull.vertices) == len(hull.original) == 8 and hull.triangles.shape == (12, 3)
    surface = geometry.SurfaceDistance(box)
    distance, place, triangle = surface.nearest(np.array([9.0, 1, 2]))
    assert np.isclose(distance, 4) and np.allclose(place, [5, 1, 2]) and 0 <= triangle < 12
    assert np.allclose([surface.nearest(p)[0] for p in geometry.even_surface_samples(box, 20)], 0, atol=1e-5)
    tolerance = geometry.default_symmetry_tolerance_mm(core.diameter(box))
    found = geometry.search_symmetries(box)
    assert found.tolerance_mm == tolerance and np.isclose(found.diameter_mm, core.diameter(box))
    assert len(found.found.symmetries.discrete) == 3 and found.found.symmetries.continuous == []
    assert found.found.largest_deviation_mm() <= tolerance and len(found.found.discrete_deviation_mm) == 3
    assert found.found.continuous_deviation_mm == [] and found.near.symmetries.empty()
    assert len(geometry.find_symmetries(box, tolerance).discrete) == 3
    around = geometry.Symmetries(continuous=[(np.array([0.0, 0, 1]), np.zeros(3))])
    assert len(geometry.symmetry_transformations(around, 0.1)) == 32
    with pytest.raises(Error):
        geometry.symmetry_transformations(around, 0)
    with pytest.raises(Error):
        geometry.convex_hull(box.vertices[:1])
    assert isinstance(found.found, geometry.MeasuredSymmetries) and isinstance(found, geometry.SymmetrySearch)
    assert {geometry.Plane, geometry.PlaneFit, geometry.ConvexHull} and "discrete" in repr(around)

# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from conftest import pose

from partpose import camera, core, descriptor, geometry, io, matching, preprocess, registration, verification
from partpose.core import DepthImage, Error, Intrinsics, PointCloud, TriangleMesh

CAMERA = Intrinsics(width=160, height=120, fx=150, fy=150, cx=79.5, cy=59.5)


def view(mesh: TriangleMesh, at: np.ndarray) -> PointCloud:
    options = camera.VirtualDepthCameraOptions(resolution_px=(320, 240))
    return camera.capture(mesh, at, options)


def test_rendering(box: TriangleMesh) -> None:
    depth, triangle = camera.render(box, pose(z=220), CAMERA)
    assert np.isclose(depth.z_mm[60, 80], 200) and triangle.shape == (120, 160) and triangle[0, 0] == -1
    seen = camera.look_at(np.array([0.0, 0, 500]), np.zeros(3))
    assert np.allclose(seen[:3, 3], [0, 0, 500]) and np.allclose(seen[:3, 2], [0, 0, -1])
    with pytest.raises(Error):
        camera.render(box, 2 * np.eye(4), CAMERA)


def test_capture_is_repeatable(box: TriangleMesh) -> None:
    noise = camera.NoiseOptions(model="gaussianray", standard_deviation_mm=1)
    options = camera.VirtualDepthCameraOptions(noise=noise)
    a, b = (camera.capture(box, pose(z=300), options, frame=frame) for frame in (1, 1))
    assert np.array_equal(a.points, b.points) and a.has_normals()
    assert not np.array_equal(a.points, camera.capture(box, pose(z=300), options, frame=2).points)


def test_stereo() -> None:
    wall = DepthImage(np.full((120, 160), 600, np.float32))
    options = camera.StereoSensorOptions(static_pattern_percent=0)
    taken, pixel = camera.stereo_capture(wall, wall, CAMERA, options, seed=3)
    measured = taken.z_mm[taken.z_mm > 0]
    predicted = camera.predicted_depth_noise_mm(options, CAMERA, 600)
    assert 0.3 * predicted < measured.std() < 3 * predicted and pixel.shape == (120, 160)
    assert camera.right_from_left(options)[0, 3] == -55
    fit = camera.fit_stereo_sensor([taken], CAMERA, baseline_mm=55)
    assert isinstance(fit, camera.StereoSensorFit) and abs(fit.distance_mm - 600) < 10
    with pytest.raises(Error, match="baseline"):
        camera.fit_stereo_sensor([taken], CAMERA, baseline_mm=0)


def test_preprocessing(box: TriangleMesh) -> None:
    cloud = view(box, pose(z=300))
    options = preprocess.PreprocessOptions(voxel_size=5)
    scene = preprocess.preprocess(cloud, options)
    assert isinstance(scene, preprocess.PreprocessedScene) and 0 < len(scene.cloud) < len(cloud) and scene.plane is None
    assert np.allclose(preprocess.scaled(cloud, 2).points, 2 * cloud.points)
    assert preprocess.cropped(cloud, [0, 100, -100, 100, 0, 1000]).points[:, 0].min() >= 0
    far = core.append(cloud, PointCloud(np.array([[0, 0, 900]], np.float32)))
    assert len(preprocess.without_radius_outliers(far, 5, 3)) <= len(cloud)
    assert len(preprocess.without_statistical_outliers(far, 10, 3)) < len(far)
    normals = preprocess.with_normals(cloud, preprocess.NormalEstimationOptions(search_radius=4))
    assert np.allclose(np.linalg.norm(normals.normals, axis=1), 1, atol=1e-4)
    empty = PointCloud(np.zeros((0, 3)))
    assert len(preprocess.preprocess(empty, options).cloud) == 0
    depth, _ = camera.render(box, pose(z=220), CAMERA)
    segments = preprocess.segment(depth, CAMERA)
    assert len(segments) == 1 and np.array_equal(segments[0], np.flatnonzero(depth.z_mm.reshape(-1)))
    with pytest.raises(Error):
        preprocess.segment(depth, Intrinsics(10, 10, 5, 5, 5, 5))


@pytest.mark.parametrize("name", descriptor.descriptor_names())
def test_descriptors(name: str, box: TriangleMesh) -> None:
    assert {descriptor.VfhOptions, descriptor.CvfhOptions, descriptor.OurCvfhOptions, descriptor.EsfOptions,
            descriptor.GoodOptions}  # fmt: skip
    made = descriptor.make_global_descriptor(name, descriptor.DescriptorOptions())
    assert isinstance(made, descriptor.GlobalDescriptor) and descriptor.neighbours_of(name) == 6
    cloud = geometry.estimate_normals(view(box, pose(z=300)), 5)
    found = made.describe(cloud)
    assert found and isinstance(found[0], descriptor.Description)
    assert found[0].histogram.shape == (made.bins(),) and found[0].histogram.dtype == np.float32
    assert found[0].support > 0 and found[0].valid in (True, False) and abs(found[0].centroid_mm[2] - 290) < 30
    assert (found[0].camera_from_reference is not None) == (name in ("ourcvfh", "good") and found[0].valid)
    with pytest.raises(Error, match="normals"):
        made.describe(PointCloud(cloud.points))
    histogram = descriptor.camera_roll_histogram(cloud)
    assert histogram.shape == (90,)
    with pytest.raises(Error, match="normals"):
        descriptor.camera_roll_histogram(PointCloud(cloud.points))
    with pytest.raises(Error):
        descriptor.make_global_descriptor("vhf")


def test_matching() -> None:
    rows = np.random.default_rng(1).uniform(size=(30, 12)).astype(np.float32)
    index = matching.DescriptorIndex(12)
    for row in rows:
        index.add(row)
    query = rows[4] + np.float32(0.01)
    found, distances = index.nearest(query, 3)
    expected = np.abs(rows - query).sum(1)
    assert np.array_equal(found, expected.argsort()[:3]) and np.allclose(distances, np.sort(expected)[:3], rtol=1e-4)
    assert (len(index), index.bins()) == (30, 12) and np.array_equal(index.row(4), rows[4])
    for wrong in (lambda: index.add(rows[0, :5]), lambda: index.nearest(rows[0, :5], 1), lambda: index.row(30),
                  lambda: index.nearest(query, 0), lambda: matching.DescriptorIndex(0), lambda: index.add(rows)):  # fmt: skip
        with pytest.raises(Error):
            wrong()


def test_registration(root: object, box: TriangleMesh) -> None:
    cloud = view(io.read_stl(f"{root}/parts/bracket.stl"), pose(z=500))
    moved = core.transformed(cloud, pose(2, -1, 3))
    result = registration.icp(cloud, moved, registration.PoseRefinementOptions(transformation_epsilon=0.001))
    assert isinstance(result, registration.IcpResult) and result.converged and result.iterations > 0 < result.pairs
    assert core.translation_error_mm(result.target_from_source, pose(2, -1, 3)) < 0.5
    guesses = registration.coarse_alignments(cloud, moved, registration.CoarseAlignmentOptions())
    centre = np.append(core.centroid(cloud), 1)
    assert np.allclose((guesses[0] @ centre)[:3], core.centroid(moved), atol=0.5)  # centroids are brought together
    with pytest.raises(Error, match="normals"):
        registration.icp(PointCloud(cloud.points), moved)
    depth, _ = camera.render(box, pose(z=220), CAMERA)
    refined = registration.refine_projectively(box, pose(z=223), depth, CAMERA)
    assert isinstance(refined, registration.ProjectiveRefinement) and refined.pixels > 20 and refined.rms_mm < 0.1
    assert abs(refined.camera_from_model[2, 3] - 220) < 0.1
    with pytest.raises(Error):
        registration.refine_projectively(box, pose(z=223), depth, CAMERA, gate_mm=0)


def test_verification(box: TriangleMesh) -> None:
    depth, _ = camera.render(box, pose(z=220), CAMERA)
    good = verification.render_and_compare(box, pose(z=220), depth, CAMERA)
    assert isinstance(good, verification.RenderComparison) and good.score > 0.99 and good.model == good.object
    assert good.free_space == good.hidden == good.nothing == good.unexplained == 0 and good.cost < 1
    assert verification.render_and_compare(box, pose(z=260), depth, CAMERA).score < 0.2
    pixels = np.flatnonzero(depth.z_mm.reshape(-1))
    assert verification.render_and_compare(box, pose(z=220), depth, CAMERA, object_pixels=pixels).score > 0.99
    with pytest.raises(Error):
        verification.render_and_compare(box, pose(z=220), depth, CAMERA, object_pixels=[10**6])

    scene = core.to_point_cloud(depth, CAMERA)
    surface = PointCloud(geometry.even_surface_samples(box, 5000))
    options = verification.HypothesisVerificationOptions(inlier_threshold=6)
    right = verification.verify_greedy(box, surface, pose(z=220), scene, options)
    wrong = verification.verify_greedy(box, surface, pose(x=40, z=220), scene, options)
    assert isinstance(right, verification.Verification) and right.accepted and right.reason == ""
    assert not wrong.accepted and wrong.reason
    assert right.visible_model_points > 0 and right.unexplained_model_points == 0
    assert right.explained_scene_points == right.scene_points > 0

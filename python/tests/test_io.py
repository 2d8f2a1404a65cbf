# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from partpose import io
from partpose.core import DepthImage, Error, Intrinsics, PointCloud, TriangleMesh


def test_meshes(box: TriangleMesh, tmp_path: Path) -> None:
    io.write_stl(tmp_path / "box.stl", box)
    assert len(io.read_stl(tmp_path / "box.stl").triangles) == 12
    assert len(io.parse_stl((tmp_path / "box.stl").read_bytes(), "box").vertices) == 8
    assert io.model_files(tmp_path) == [tmp_path / "box.stl"]
    io.write_ply_mesh(tmp_path / "box.ply", box)
    assert np.array_equal(io.read_ply_mesh(tmp_path / "box.ply").triangles, box.triangles)
    (tmp_path / "short.stl").write_bytes((tmp_path / "box.stl").read_bytes()[:100])
    with pytest.raises(Error, match="short.stl"):
        io.read_stl(tmp_path / "short.stl")
    with pytest.raises(Error, match="nowhere.stl"):
        io.read_stl(str(tmp_path / "nowhere.stl"))


@pytest.mark.parametrize("encoding", [io.PcdEncoding.ascii, io.PcdEncoding.binary, io.PcdEncoding.binary_compressed])
def test_clouds(tmp_path: Path, encoding: io.PcdEncoding) -> None:
    points = np.random.default_rng(1).normal(size=(20, 3)).astype(np.float32)
    cloud = PointCloud(points, normals=points)
    io.write_pcd(tmp_path / "c.pcd", cloud, encoding)
    io.write_ply(tmp_path / "c.ply", cloud)
    for back in (io.read_pcd(tmp_path / "c.pcd"), io.read_ply(tmp_path / "c.ply"), io.read_cloud(tmp_path / "c.pcd")):
        assert np.array_equal(back.points, points) and np.array_equal(back.normals, points)
    scene = io.read_scene(tmp_path / "c.ply", unit_mm=1000)
    assert np.allclose(scene.cloud.points, 1000 * points) and scene.depth is None and scene.intrinsics is None
    with pytest.raises(Error):
        io.read_cloud(tmp_path / "c.xyz")


def test_depth_and_cameras(tmp_path: Path) -> None:
    pixels = np.arange(48 * 64, dtype=np.uint16).reshape(48, 64)
    io.write_depth_png(tmp_path / "d.png", DepthImage(pixels), 1)
    assert np.array_equal(io.read_depth_png(tmp_path / "d.png", 1).z_mm, pixels)
    camera = io.CameraFile(width=64, height=48, fx=60, fy=60, cx=31.5, cy=23.5, depth_scale_mm=1)
    assert camera.intrinsics == Intrinsics(64, 48, 60, 60, 31.5, 23.5)
    with pytest.raises(Error, match="d.camera.json"):
        io.camera_file_of(tmp_path / "d.png")
    io.write_camera(tmp_path / "d.camera.json", camera)
    assert io.read_camera(io.camera_file_of(tmp_path / "d.png")) == camera
    scene = io.read_scene(tmp_path / "d.png")
    assert scene.path == tmp_path / "d.png" and scene.intrinsics == camera.intrinsics
    assert scene.depth is not None and len(scene.cloud) == 48 * 64 - 1
    same = io.Scene(scene.depth, camera.intrinsics)
    assert len(same.cloud) == len(scene.cloud) and "cloud" in repr(same)
    assert io.Scene(PointCloud(np.zeros((1, 3)))).depth is None
    with pytest.raises(Error):
        io.Scene(scene.depth, Intrinsics(10, 10, 5, 5, 5, 5))


def test_pictures(tmp_path: Path) -> None:
    pixels = np.random.default_rng(1).integers(0, 255, (4, 6, 3), dtype=np.uint8)
    io.write_png(tmp_path / "p.png", pixels)
    assert np.array_equal(io.read_png(tmp_path / "p.png"), pixels)
    with pytest.raises(TypeError):
        io.write_png(tmp_path / "p.png", pixels[0])

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes the input clouds of the golden vectors: inputs/*.pcd and inputs/pairs.txt. Needs numpy.

    python3 tests/golden/make_inputs.py parts tests/golden/inputs

Camera frame: x right, y down, z forward; mm, except files named *_metres. The committed clouds are given as bits:
nothing hangs on this script giving the same ones again.
"""
import argparse
import struct
import sys
import zlib
from pathlib import Path

import numpy as np

NEIGHBOURS = 20  # of a point, itself included, in the estimate of its normal


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(data, record, count, 84)["corners"].astype(np.float64)


def generator(name):
    """A random generator of its own for each cloud, so that adding one changes no other."""
    return np.random.default_rng(zlib.crc32(name.encode()))


def rotation_about(axis, degrees):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k


def looking_at(direction, roll_deg):
    """camera_from_part rotation of a camera that sees the part from `direction` (part frame)."""
    forward = -np.asarray(direction, float) / np.linalg.norm(direction)
    up = [0, 0, 1] if abs(forward[2]) < 0.95 else [0, 1, 0]
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    return rotation_about([0, 0, 1], roll_deg) @ np.array([right, np.cross(forward, right), forward])


def visible_points(triangles, pitch):
    """Where the rays of a pinhole camera (pixels of size `pitch` at z = 1) first meet the mesh: points and normals."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normals, axis=1)
    facing = (area > 1e-9) & (np.sum(normals * triangles[:, 0], axis=1) < 0)
    triangles, normals = triangles[facing], normals[facing] / area[facing, None]
    flat = triangles[..., :2] / triangles[..., 2:]
    low = np.floor(flat.min(axis=(0, 1)) / pitch).astype(int)
    size = np.ceil(flat.max(axis=(0, 1)) / pitch).astype(int) - low + 1
    depth, owner = np.full(size, np.inf), np.full(size, -1)
    for i, (corners, normal) in enumerate(zip(flat, normals)):
        first = np.ceil(corners.min(axis=0) / pitch).astype(int) - low
        last = np.floor(corners.max(axis=0) / pitch).astype(int) - low
        if np.any(last < first):
            continue
        u, v = np.meshgrid(np.arange(first[0], last[0] + 1), np.arange(first[1], last[1] + 1), indexing="ij")
        x, y = (u + low[0]) * pitch, (v + low[1]) * pitch
        inside = np.ones(u.shape, bool)
        turn = np.sign(np.cross(np.append(corners[1] - corners[0], 0), np.append(corners[2] - corners[0], 0))[2])
        for a, b in ((0, 1), (1, 2), (2, 0)):
            edge = corners[b] - corners[a]
            inside &= turn * (edge[0] * (y - corners[a, 1]) - edge[1] * (x - corners[a, 0])) >= 0
        with np.errstate(divide="ignore", invalid="ignore"):
            z = normal @ triangles[i, 0] / (normal[0] * x + normal[1] * y + normal[2])
        nearer = inside & (z > 0) & (z < depth[u, v])
        depth[u[nearer], v[nearer]], owner[u[nearer], v[nearer]] = z[nearer], i
    u, v = np.nonzero(owner >= 0)
    z = depth[u, v]
    return np.column_stack([(u + low[0]) * pitch * z, (v + low[1]) * pitch * z, z]), normals[owner[u, v]]


def estimated_normals(points):
    """Normals and curvatures by principal components of the nearest neighbours, turned to the camera."""
    points = points.astype(np.float64)
    distances = np.sum((points[:, None] - points[None]) ** 2, axis=2)
    patches = points[np.argsort(distances, axis=1, kind="stable")[:, :NEIGHBOURS]]
    patches = patches - patches.mean(axis=1, keepdims=True)
    values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", patches, patches) / NEIGHBOURS)
    normals = vectors[:, :, 0]
    normals = np.where(np.sum(normals * points, axis=1, keepdims=True) > 0, -normals, normals)
    return normals, np.maximum(values[:, 0], 0) / values.sum(axis=1)


def view_of(triangles, name, count, direction, distance, offset, roll, noise, estimate):
    """Cloud (n, 7) of about `count` points: x y z, normal, curvature."""
    rotation = looking_at(direction, roll)
    middle = (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))) / 2
    camera = (triangles - middle) @ rotation.T + np.array([offset[0], offset[1], distance])
    pitch = 4.0 / distance
    for _ in range(3):
        points, normals = visible_points(camera, pitch)
        pitch *= np.sqrt(len(points) / count)
    points, normals = visible_points(camera, pitch)
    return finish(points, normals, name, noise, estimate)


def finish(points, normals, name, noise, estimate):
    if noise:
        length = np.linalg.norm(points, axis=1, keepdims=True)
        points = points * (1 + generator(name).normal(0, noise, (len(points), 1)) / length)
    points = points.astype(np.float32)
    curvatures = np.zeros(len(points))
    if estimate:
        normals, curvatures = estimated_normals(points)
    return np.column_stack([points, normals, curvatures]).astype("<f4")


def sphere_cap(name, count=900, radius=60, centre=(40, -25, 560), noise=0.0, estimate=False):
    """The half of a sphere that faces the camera, evenly covered."""
    centre = np.array(centre, float)
    i = np.arange(4 * count) + 0.5
    height, turn = 1 - 2 * i / (4 * count), np.pi * (1 + 5 ** 0.5) * i
    flat = np.sqrt(1 - height ** 2)
    normals = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    points = centre + radius * normals
    seen = np.sum(normals * points, axis=1) < 0
    return finish(points[seen][::2], normals[seen][::2], name, noise, estimate)


def plane(name, noise=0.0, estimate=False):
    """A rectangle of 110 x 70 mm whose normal leans 37 degrees from the line of sight."""
    normal = np.array([0.55, -0.31, -0.9])
    normal /= np.linalg.norm(normal)
    across = np.cross(normal, [0, 1, 0])
    across /= np.linalg.norm(across)
    u, v = np.meshgrid(np.linspace(-55, 55, 34), np.linspace(-35, 35, 22))
    points = np.array([-60, 35, 640]) + u.reshape(-1, 1) * across + v.reshape(-1, 1) * np.cross(normal, across)
    return finish(points, np.tile(normal, (len(points), 1)), name, noise, estimate)


def cylinder(name, noise=0.0, estimate=False):
    """A cylinder, radius 25 and length 120 mm, its axis oblique to the image."""
    axis = np.array([0.8, 0.45, 0.3])
    axis /= np.linalg.norm(axis)
    side = np.cross(axis, [0, 0, 1])
    side /= np.linalg.norm(side)
    turn, along = np.meshgrid(np.radians(np.arange(1.3, 360, 5)), np.linspace(-60, 60, 31))
    turn, along = turn.reshape(-1, 1), along.reshape(-1, 1)
    normals = np.cos(turn) * side + np.sin(turn) * np.cross(axis, side)
    points = np.array([15, 30, 700]) + along * axis + 25 * normals
    seen = np.sum(normals * points, axis=1) < 0
    return finish(points[seen], normals[seen], name, noise, estimate)


def rolled(cloud, degrees):
    """The cloud turned about the ray from the camera through its centroid: what a rolled camera sees."""
    turn = rotation_about(cloud[:, :3].astype(np.float64).mean(axis=0), degrees)
    return np.column_stack([cloud[:, :3] @ turn.T, cloud[:, 3:6] @ turn.T, cloud[:, 6]]).astype("<f4")


def metres(cloud):
    return np.column_stack([cloud[:, :3].astype(np.float64) / 1000, cloud[:, 3:]]).astype("<f4")


def make_clouds(parts):
    views = {  # points (about), from where (part frame), distance, offset of the part in x and y, roll in degrees
        "housing_mesh": (1200, (0.5, -0.4, 1), 620, (35, 20), 0),
        "bracket_mesh": (700, (1, 0.6, 0.8), 500, (-40, 10), 0),
        "keyed_shaft_mesh": (500, (0.3, -0.5, 1), 700, (80, -60), 0),
        "flange_mesh": (800, (0.2, 0.1, 1), 550, (20, -30), 0),
        "pump_body_mesh": (1300, (0.5, 1, 0.5), 800, (-100, 50), 0),
        "t_plate_mesh": (600, (-0.4, -0.7, 1), 650, (0, 90), 0),
        "mount_left_mesh": (600, (-1, 0.5, 0.6), 450, (10, 5), 0),
        "bracket_pca": (700, (1, 0.6, 0.8), 500, (-40, 10), 0),
        "plain_shaft_pca": (450, (1, 0.2, 0.3), 600, (30, 30), 0),
        "elbow_100_pca": (800, (-0.6, 0.9, 0.8), 680, (-20, -60), 70),
        "elbow_130_pca": (800, (-0.6, 0.9, 0.8), 680, (-20, -60), 70),
        "mount_right_pca": (650, (1, 0.5, 0.6), 450, (10, 5), 0),
        "flange_axis_pca": (900, (0, 0, 1), 550, (0, 0), 0),
        "housing_noise1": (1000, (-0.8, 0.5, 0.9), 700, (60, 0), 0),
        "bracket_noise2": (700, (1, 0.6, 0.8), 500, (-40, 10), 0),
        "keyed_shaft_noise1": (400, (-0.4, 0.9, 0.5), 640, (0, -70), 20),
        "link_noise05": (500, (0.3, -0.6, 1), 520, (-70, -20), 0),
        "pocket_plate_noise05": (900, (0.4, 0.3, 1), 600, (10, 80), 0),
        "t_plate_noise3": (700, (0.5, -0.2, -1), 750, (-50, 20), 0),
        "flange_noise2": (850, (0.9, -0.3, 0.7), 580, (45, -45), 0),
        "pump_body_noise3": (1400, (-1, -0.7, 0.2), 880, (120, 90), 0),
        "mount_left_noise1": (350, (-0.5, -1, 0.7), 420, (-30, 25), 0),
        # dense enough for clusters of a hundred points and more
        "housing_dense_noise03": (2400, (0.6, -0.5, 0.9), 600, (-30, 40), 15),
        "bracket_dense_noise03": (2000, (1, 0.6, 0.8), 500, (-40, 10), 0),
        "flange_dense_noise03": (2200, (0.6, 0.3, 1), 550, (20, -30), 0),
        "pump_body_dense_noise05": (2500, (0.5, 1, 0.5), 700, (-80, 50), 40),
        "t_plate_dense_noise03": (2000, (-0.6, -0.7, 0.8), 650, (0, 90), 0),
        "mount_left_dense_noise03": (2000, (-1, 0.5, 0.6), 450, (10, 5), 0),
        "mount_right_dense_noise05": (2000, (1, 0.5, 0.6), 450, (10, 5), 100),
        "elbow_100_dense_noise05": (2200, (-0.6, 0.9, 0.8), 680, (-20, -60), 70),
        "keyed_shaft_dense_noise03": (1800, (0.5, -0.5, 0.8), 640, (50, -60), 0),
        "pocket_plate_dense_noise05": (2400, (0.7, 0.5, 0.9), 600, (10, 80), 0),
        "link_dense_noise03": (2000, (0.5, -0.7, 0.8), 520, (-70, -20), 0),
        "housing_dense_noise1": (2400, (-0.8, 0.5, 0.9), 700, (60, 0), 0),
    }
    noises = {"mesh": 0.0, "pca": 0.0, "noise03": 0.3, "noise05": 0.5, "noise1": 1.0, "noise2": 2.0, "noise3": 3.0}
    clouds = {}
    for name, view in views.items():
        part, kind = name.replace("flange_axis", "flange").replace("_dense", "").rsplit("_", 1)
        triangles = read_stl(parts / f"{part}.stl")
        clouds[name] = view_of(triangles, name, *view, noise=noises[kind], estimate=kind != "mesh")
    clouds["sphere_cap_exact"] = sphere_cap("sphere_cap_exact")
    clouds["sphere_cap_noise1"] = sphere_cap("sphere_cap_noise1", count=500, noise=1.0, estimate=True)
    clouds["plane_exact"] = plane("plane_exact")
    clouds["plane_noise1"] = plane("plane_noise1", noise=1.0, estimate=True)
    clouds["cylinder_exact"] = cylinder("cylinder_exact")
    clouds["cylinder_noise05"] = cylinder("cylinder_noise05", noise=0.5, estimate=True)
    for name in ("bracket_mesh", "elbow_130_pca"):
        clouds[f"{name}_metres"] = metres(clouds[name])

    pairs = []
    for name, degrees in (("bracket_mesh", 40), ("bracket_noise2", 137), ("t_plate_mesh", 250),
                          ("mount_left_noise1", 318), ("elbow_100_pca", 91), ("link_noise05", 180),
                          ("flange_noise2", 60)):
        clouds[f"{name}_roll{degrees:03d}"] = rolled(clouds[name], degrees)
        pairs += [(name, f"{name}_roll{degrees:03d}", degrees), (f"{name}_roll{degrees:03d}", name, 360 - degrees)]
    pairs += [(name, name, 0) for name in (
        "housing_mesh", "flange_mesh", "flange_axis_pca", "plane_exact", "sphere_cap_exact", "cylinder_noise05")]
    pairs += [(a, b, "-") for a, b in (
        ("bracket_mesh", "bracket_pca"), ("bracket_pca", "bracket_noise2"), ("bracket_mesh", "bracket_mesh_metres"),
        ("elbow_100_pca", "elbow_130_pca"), ("t_plate_mesh", "t_plate_noise3"), ("mount_left_mesh", "mount_right_pca"),
        ("flange_mesh", "flange_noise2"), ("housing_mesh", "housing_noise1"), ("pump_body_mesh", "pump_body_noise3"),
        ("plain_shaft_pca", "keyed_shaft_noise1"), ("pocket_plate_noise05", "link_noise05"))]
    return clouds, pairs


def write_pcd(path, cloud):
    header = ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
              "FIELDS x y z normal_x normal_y normal_z curvature\nSIZE 4 4 4 4 4 4 4\nTYPE F F F F F F F\n"
              f"COUNT 1 1 1 1 1 1 1\nWIDTH {len(cloud)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(cloud)}\n"
              "DATA binary\n")
    path.write_bytes(header.encode() + cloud.tobytes())


def main():
    parser = argparse.ArgumentParser(description="Make the input clouds of the golden vectors.")
    parser.add_argument("parts", type=Path, help="folder of the parts' STL files")
    parser.add_argument("output", type=Path, help="folder for the clouds and pairs.txt")
    options = parser.parse_args()
    clouds, pairs = make_clouds(options.parts)
    options.output.mkdir(parents=True, exist_ok=True)
    for name, cloud in clouds.items():
        assert 300 <= len(cloud) <= 2700 and np.isfinite(cloud).all(), (name, len(cloud))
        write_pcd(options.output / f"{name}.pcd", cloud)
    (options.output / "pairs.txt").write_text("".join(f"{a}.pcd {b}.pcd {known}\n" for a, b, known in pairs))
    print(f"{len(clouds)} clouds, {sum(map(len, clouds.values()))} points, {len(pairs)} pairs")
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes the project's own depth frames: parts of parts/ resting on a table, with exact poses.

Needs three packages from PyPI (written with numpy 2.4.6, pillow 13.0.0, scipy 1.17.1) and Python 3.10:

    python3 -m pip install numpy pillow scipy

    python3 tools/make_frames.py scenes             # write everything (under a minute), then verify what was written
    python3 tools/make_frames.py scenes --check     # make it again beside and compare with the files in scenes/
    python3 tools/make_frames.py scenes --verify    # only read the files back and hold them against the meshes
    python3 tools/make_frames.py scenes --preview p.png

The rasteriser and the sensor are written here a second time, on purpose: frames drawn by the code that is tested with
them would hide that code's mistakes. Camera frame: x right, y down, z forward, pixel centres at integers, millimetres.
World frame: the table is z = 0, z up. `b_from_a` maps coordinates of a to b. The same versions give the same bytes each
time; `--check` compares bytes first and, where they differ (another libm or zlib), pixels, points and numbers.
"""
import argparse
import dataclasses
import json
import math
import re
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import binary_dilation, gaussian_filter, maximum_filter, minimum_filter
from scipy.spatial import ConvexHull, cKDTree

REPOSITORY = Path(__file__).resolve().parent.parent
TABLE, FLOOR, PART = 1, 2, 3          # labels of the picture; clutter follows PART
SYMMETRY_TOLERANCE_MM = 0.05          # a turned surface this near itself is the same surface
MEDIAN_LIMIT_MM = 1.5                 # of the distance measured point -> mesh at the true pose
MASK_MM = 15                          # a pixel belongs to the part when its depth is this near the rendered one (BOP)


# --- What is drawn ---------------------------------------------------------------------------------------------------

@dataclasses.dataclass(frozen=True)
class Camera:
    width: int = 640
    height: int = 480
    fx: float = 615.2
    fy: float = 615.2
    cx: float = 319.5
    cy: float = 239.5
    depth_scale_mm: float = 1


@dataclasses.dataclass(frozen=True)
class Sensor:
    """Stereo like a D415's; one number is drawn from each range, per frame."""
    baseline_mm: float = 55
    noise_px: tuple = (0.05, 0.08)    # disparity, standard deviation
    blur_px: tuple = (2.0, 3.0)       # of the noise: neighbours share a matching window
    white_share: float = 0.2          # of noise_px that is not blurred
    step_px: float = 1 / 32           # of the disparity
    jump_px: float = 0.75             # a larger difference between neighbours is an edge
    mixed_share: float = 0.2          # pixels at an edge that get a value between both sides ...
    lost_share: float = 0.15          # ... or none
    grazing_cos: tuple = (0.05, 0.24)  # angle to the surface normal: certainly lost, certainly kept
    range_mm: float = 6000


@dataclasses.dataclass(frozen=True)
class Frame:
    name: str
    part: str | None                  # of parts/, or `star_knob`, or nothing
    seed: int
    distance_mm: float                # from the camera to where it looks
    elevation_deg: float              # of the camera above the table
    camera: Camera
    table_mm: tuple | None = None     # size of the table's top; None: larger than the picture
    overhang: float = 0               # share of the part's width that is beyond the table's edge
    clutter: bool = False
    instance: bool = False            # also write the cloud of the part alone
    with_table: bool = False          # also write the cloud cropped around the part


MM = Camera()
MM_B = Camera(fx=613.7, fy=614.1, cx=321.3, cy=237.8)
TENTH = Camera(fx=616.4, fy=616.4, cx=318.9, cy=241.2, depth_scale_mm=0.1)

FRAMES = [
    Frame("housing", "housing", 1, 610, 52, MM, (900, 620)),
    Frame("bracket", "bracket", 602, 560, 41, MM, instance=True),
    Frame("keyed_shaft", "keyed_shaft", 403, 640, 58, MM, instance=True),
    Frame("link", "link", 504, 700, 66, MM_B, with_table=True),
    Frame("t_plate", "t_plate", 605, 590, 62, MM, (760, 520), overhang=0.22),
    Frame("flange", "flange", 406, 660, 37, TENTH, (1000, 700)),
    Frame("mount_left", "mount_left", 207, 480, 47, MM_B, (800, 600)),
    Frame("mount_right", "mount_right", 708, 780, 35, MM, instance=True),
    Frame("elbow_130", "elbow_130", 409, 740, 55, MM_B, (900, 640), with_table=True),
    Frame("pump_body", "pump_body", 310, 690, 44, TENTH),
    Frame("clutter_elbow_100", "elbow_100", 211, 680, 48, MM, (1000, 700), clutter=True),
    Frame("unknown_star_knob", "star_knob", 112, 520, 50, MM, (900, 620)),
    Frame("empty_table", None, 13, 650, 45, MM_B, (900, 640)),
]


def loft(rings):
    """Triangles (n, 3, 3) of a solid between rings (k, m, 3) of points, closed by a fan at each end."""
    rings = np.asarray(rings, float)
    low, high = rings[:-1], rings[1:]
    low_next, high_next = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    sides = [np.stack([low, low_next, high_next], axis=2), np.stack([low, high_next, high], axis=2)]
    ends = []
    for ring, turn in ((rings[0], 1), (rings[-1], -1)):
        centre = np.broadcast_to(ring.mean(axis=0), ring.shape)
        ends.append(np.stack([centre, np.roll(ring, -1, axis=0), ring], axis=1)[:, ::turn])
    triangles = np.concatenate([s.reshape(-1, 3, 3) for s in sides] + ends)
    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    return triangles[area > 1e-9]


def lobed(profile, lobes=0, count=72):
    """Solid around z from (radius, z, depth of the lobes); flat steps are steps."""
    a = 2 * math.pi * np.arange(count) / count
    return loft([np.column_stack([(r + d * np.cos(lobes * a)) * np.cos(a), (r + d * np.cos(lobes * a)) * np.sin(a),
                                  np.full(count, z)]) for r, z, d in profile])


def star_knob():
    """A part that is in no catalogue: hand knob with five lobes on a stepped hub."""
    head = [(37, 24, 5), (40, 26, 6.5), (42, 29, 7), (42, 43, 7), (40, 46, 6.5), (37, 48, 5), (20, 48, 0), (18, 52, 0)]
    return lobed([(11, 0, 0), (13, 2, 0), (13, 10, 0), (20, 10, 0), (20, 24, 0)] + head, lobes=5, count=100)


def mug():
    """Cup of 86 mm with a handle, standing on z = 0."""
    cup = lobed([(38, 0, 0), (41, 2, 0), (41, 92, 0), (40, 94, 0), (38, 94, 0), (37, 92, 0), (37, 6, 0)])
    a, b = np.radians(np.linspace(-100, 100, 15)), 2 * math.pi * np.arange(12) / 12
    handle = [np.column_stack([40 + (28 + 5 * np.cos(b)) * math.cos(t) * 0.9, 7 * np.sin(b),
                               48 + (28 + 5 * np.cos(b)) * math.sin(t)]) for t in a]
    return np.concatenate([cup, loft(handle)[:, ::-1]])


def small_box():
    corners = np.array([(-34, -22), (34, -22), (34, 22), (-34, 22)], float)
    return loft([np.column_stack([corners, np.full(4, z)]) for z in (0, 38)])


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    dtype = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(data, dtype, count, 84)["corners"].astype(np.float64)


def model(name):
    return star_knob() if name == "star_knob" else read_stl(REPOSITORY / "parts" / f"{name}.stl")


# --- Where it stands -------------------------------------------------------------------------------------------------

def moved(b_from_a, points):
    return points @ b_from_a[:3, :3].T + b_from_a[:3, 3]


def pose(rotation=np.eye(3), translation=(0, 0, 0)):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = rotation, translation
    return result


def about(axis, angle):
    """Rotation matrix (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


def upright(down):
    """Rotation that turns the direction `down` to -z."""
    axis = np.cross(down, [0, 0, -1])
    angle = math.atan2(np.linalg.norm(axis), -down[2])
    return about(axis if np.linalg.norm(axis) > 1e-9 else [1, 0, 0], angle)


def centre_of_mass(triangles):
    volumes = np.sum(triangles[:, 0] * np.cross(triangles[:, 1], triangles[:, 2]), axis=1)
    return (triangles.sum(axis=1) * volumes[:, None]).sum(axis=0) / (4 * volumes.sum())


def inside_by(corners, point):
    """How far `point` is inside the convex hull of 2D `corners`, mm; negative outside."""
    equations = ConvexHull(corners).equations
    return -np.max(equations[:, :2] @ point + equations[:, 2])


def resting_poses(triangles):
    """[(probability, rotation world_from_model)], the faces of the convex hull that carry the centre of mass.

    The probability is the solid angle of the face seen from the centre of mass; a face that the part would leave when
    tilted by one degree does not count.
    """
    points = np.unique(triangles.reshape(-1, 3), axis=0)
    hull, centre = ConvexHull(points), centre_of_mass(triangles)
    corners = points[hull.simplices] - centre
    lengths = np.linalg.norm(corners, axis=2)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]                 # van Oosterom and Strackee 1983
    volume = np.abs(np.sum(a * np.cross(b, c), axis=1))
    angle = 2 * np.arctan2(volume, lengths.prod(axis=1) + np.sum(a * b, axis=1) * lengths[:, 2]
                           + np.sum(b * c, axis=1) * lengths[:, 0] + np.sum(a * c, axis=1) * lengths[:, 1])
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    poses, free = [], np.ones(len(area), bool)
    for i in np.lexsort((np.arange(len(area)), -np.round(area, 3))):
        if not free[i]:
            continue
        down = hull.equations[i, :3]
        face = free & (hull.equations[:, :3] @ down > math.cos(math.radians(0.3)))
        free &= ~face
        rotation = upright(down)
        stood = (points[hull.vertices] - centre) @ rotation.T
        contact = stood[stood[:, 2] < stood[:, 2].min() + 0.02]
        if len(contact) >= 3 and inside_by(contact[:, :2], np.zeros(2)) > math.tan(math.radians(1)) * -contact[0, 2]:
            poses.append((float(angle[face].sum()), rotation))
    total = sum(p for p, _ in poses)
    return [(p / total, rotation) for p, rotation in poses]


def stand(triangles, random):
    """world_from_model of the part, resting near the world's origin."""
    poses = resting_poses(triangles)
    likely = [p for p in poses if p[0] > 0.3 * max(q for q, _ in poses)]
    share = np.array([p for p, _ in likely])
    _, rotation = likely[random.choice(len(likely), p=share / share.sum())]
    rotation = about([0, 0, 1], random.uniform(0, 2 * math.pi)) @ rotation
    points = triangles.reshape(-1, 3) @ rotation.T
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    place = random.uniform(-90, 90, 2)
    return pose(rotation, (place[0] - middle[0], place[1] - middle[1], -points[:, 2].min()))


def look(frame, random):
    """camera_from_world: looks at the table near the origin."""
    elevation, turn = math.radians(frame.elevation_deg), random.uniform(0, 2 * math.pi)
    target = np.array([*random.uniform(-20, 20, 2), 25.0])
    away = np.array([math.cos(elevation) * math.cos(turn), math.cos(elevation) * math.sin(turn), math.sin(elevation)])
    right = np.cross(-away, [0, 0, 1])
    right /= np.linalg.norm(right)
    rotation = about([0, 0, 1], math.radians(random.uniform(-6, 6))) @ np.array([right, np.cross(-away, right), -away])
    return pose(rotation, -rotation @ (target + frame.distance_mm * away))


def rectangle(centre, half_a, half_b):
    return np.asarray(centre, float), np.asarray(half_a, float), np.asarray(half_b, float)


def table_of(frame, camera_from_world, stood, com, random):
    """Rectangles of the world with labels: the table's top and sides, and the floor."""
    if frame.table_mm is None:
        return [(rectangle((0, 0, 0), (20000, 0, 0), (0, 20000, 0)), TABLE)]
    towards = -camera_from_world[2, :2] / np.linalg.norm(camera_from_world[2, :2])
    turn = math.atan2(towards[1], towards[0]) + math.pi / 2 + math.radians(random.uniform(-25, 25))
    a, b = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    half = np.array(frame.table_mm) / 2
    centre = random.uniform(-0.25, 0.25) * half[0] * a + random.uniform(-0.1, 0.1) * half[1] * b
    if frame.overhang:                                       # the edge at +a cuts the part
        along = stood[:, :2] @ a
        edge = along.max() - frame.overhang * np.ptp(along)
        centre += (edge - half[0] - centre @ a) * a
        contact = stood[stood[:, 2] < 0.02]
        contact = contact[contact[:, :2] @ a < edge]
        if inside_by(contact[:, :2], com[:2]) < 5:
            raise SystemExit(f"{frame.name}: would fall off the table")
    a, b, c = np.array([*a, 0]) * half[0], np.array([*b, 0]) * half[1], np.array([0, 0, 14.0])
    top = np.array([*centre, 0])
    boards = [rectangle(top, a, b)]
    boards += [rectangle(top - c + side, other, c) for s in (-1, 1) for side, other in ((s * a, b), (s * b, a))]
    floor = rectangle((0, 0, -730), (20000, 0, 0), (0, 20000, 0))
    return [(board, TABLE) for board in boards] + [(floor, FLOOR)]


# --- The rasteriser --------------------------------------------------------------------------------------------------

class Picture:
    """z depth, label and cosine between ray and normal, at the pixel centres."""

    def __init__(self, camera):
        self.camera = camera
        v, u = np.mgrid[0:camera.height, 0:camera.width]
        self.rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(u.shape)], axis=2)
        self.depth = np.full(u.shape, np.inf)
        self.label = np.zeros(u.shape, np.uint8)
        self.normal = np.zeros(u.shape + (3,))

    def cosine(self):
        return np.abs(np.sum(self.rays * self.normal, axis=2)) / np.linalg.norm(self.rays, axis=2)

    def draw_rectangle(self, centre, half_a, half_b, label):
        """A parallelogram, by the intersection of each ray: it may reach behind the camera."""
        normal = np.cross(half_a, half_b)
        with np.errstate(divide="ignore", invalid="ignore"):
            z = (normal @ centre) / (self.rays @ normal)
            points = z[..., None] * self.rays - centre
            inside = (np.abs(points @ half_a) <= half_a @ half_a) & (np.abs(points @ half_b) <= half_b @ half_b)
            nearer = inside & (z > 1) & (z < self.depth)
        self.depth[nearer], self.label[nearer] = z[nearer], label
        self.normal[nearer] = normal / np.linalg.norm(normal)

    def draw(self, triangles, label):
        """Triangles (n, 3, 3) in front of the camera, outward winding; faces turned away are hidden anyway."""
        camera = self.camera
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        offsets = np.sum(normals * triangles[:, 0], axis=1)
        if triangles[..., 2].min() < 10:
            raise SystemExit("a mesh reaches behind the camera")
        u = triangles[..., 0] / triangles[..., 2] * camera.fx + camera.cx
        v = triangles[..., 1] / triangles[..., 2] * camera.fy + camera.cy
        u0, u1 = np.maximum(np.ceil(u.min(axis=1)), 0), np.minimum(np.floor(u.max(axis=1)), camera.width - 1)
        v0, v1 = np.maximum(np.ceil(v.min(axis=1)), 0), np.minimum(np.floor(v.max(axis=1)), camera.height - 1)
        for i in np.flatnonzero((offsets < 0) & (u0 <= u1) & (v0 <= v1)):
            part = slice(int(v0[i]), int(v1[i]) + 1), slice(int(u0[i]), int(u1[i]) + 1)
            x, y = np.arange(u0[i], u1[i] + 1)[None, :], np.arange(v0[i], v1[i] + 1)[:, None]
            edges = [(u[i, k - 2] - u[i, k]) * (y - v[i, k]) - (v[i, k - 2] - v[i, k]) * (x - u[i, k])
                     for k in range(3)]                      # edge k -> k + 1; all negative inside (y is down)
            inside = np.maximum.reduce(edges) <= 1e-9
            if not inside.any():
                continue
            z = offsets[i] / (self.rays[part] @ normals[i])
            z = np.clip(z, triangles[i, :, 2].min(), triangles[i, :, 2].max())
            nearer = inside & (z < self.depth[part])
            self.depth[part][nearer], self.label[part][nearer] = z[nearer], label
            self.normal[part][nearer] = normals[i] / np.linalg.norm(normals[i])


def picture_of(camera, camera_from_world, boards, solids):
    picture = Picture(camera)
    rotation = camera_from_world[:3, :3]
    for (centre, half_a, half_b), label in boards:
        picture.draw_rectangle(moved(camera_from_world, centre), rotation @ half_a, rotation @ half_b, label)
    for triangles, label in solids:
        picture.draw(moved(camera_from_world, triangles), label)
    return picture


def rendered(camera, camera_from_model, triangles):
    """Depth of the part alone, infinite beside it."""
    picture = Picture(camera)
    picture.draw(moved(camera_from_model, triangles), PART)
    return picture.depth


def visible_fraction(camera, picture, camera_from_model, triangles):
    """As BOP's visib_fract: of the silhouette on a canvas three times as large."""
    canvas = dataclasses.replace(camera, width=3 * camera.width, height=3 * camera.height,
                                 cx=camera.cx + camera.width, cy=camera.cy + camera.height)
    whole = np.isfinite(rendered(canvas, camera_from_model, triangles))
    return np.count_nonzero(picture.label == PART) / np.count_nonzero(whole)


# --- The sensor ------------------------------------------------------------------------------------------------------

def smooth_noise(random, shape, blur):
    """Gaussian noise with standard deviation 1 that neighbours share."""
    pad = math.ceil(4 * blur)
    noise = gaussian_filter(random.standard_normal((shape[0] + 2 * pad, shape[1] + 2 * pad)), blur)
    return noise[pad:-pad, pad:-pad] * (2 * math.sqrt(math.pi) * blur)


def measure(left, right, sensor, random):
    """Units of the depth image (uint16) that the stereo camera gives for two exact pictures. The left is the reference.

    The range of every step follows from the disparity d = f * baseline / z, in pixels.
    """
    camera, shape = left.camera, left.depth.shape
    scale = camera.fx * sensor.baseline_mm
    exact, other = (np.where(np.isfinite(p.depth) & (p.depth < sensor.range_mm), scale / p.depth, 0)
                    for p in (left, right))
    u = np.broadcast_to(np.arange(shape[1]), shape)

    # 1. What the right imager does not see: beyond its left border, or behind something nearer.
    in_right = np.rint(u - exact).astype(int)
    behind = np.take_along_axis(other, np.clip(in_right, 0, None), axis=1) > exact + 1
    valid = (exact > 0) & (in_right >= 0) & ~behind

    # 2. Matching windows that touch the foreground take its disparity: edges grow by nothing to two pixels.
    seen = np.where(valid, exact, 0)
    disc = np.add.outer(np.arange(-2, 3) ** 2, np.arange(-2, 3) ** 2) <= 5
    wish = smooth_noise(random, shape, 3)
    grown = np.where(wish > 0.8, maximum_filter(seen, footprint=disc), maximum_filter(seen, 3))
    grow = (wish > -0.4) & (grown - exact > sensor.jump_px) & (u - grown >= 0)
    d, valid = np.where(grow, grown, exact), valid | grow

    # 3. Mixed and lost pixels at the jumps that are left.
    high, low = (f(np.where(valid, d, fill), 3) for f, fill in ((maximum_filter, 0), (minimum_filter, np.inf)))
    edge = valid & (high - low > sensor.jump_px)
    draw, between = random.random(shape), random.random(shape)
    mixed = edge & (draw < sensor.mixed_share)
    d = np.where(mixed, np.where(edge, low, 0) + between * np.where(edge, high - low, 0), d)
    valid &= ~(edge & (draw > 1 - sensor.lost_share))

    # 4. Holes where the surface is seen at a grazing angle.
    lost, kept = sensor.grazing_cos
    risk = np.clip((kept - left.cosine()) / (kept - lost), 0, 1)
    valid &= smooth_noise(random, shape, 1.5) > -3.6 + 5 * risk

    # 5. Noise, most of it shared by neighbours, then both quantisations.
    sigma, blur = random.uniform(*sensor.noise_px), random.uniform(*sensor.blur_px)
    d = d + sigma * (math.sqrt(1 - sensor.white_share ** 2) * smooth_noise(random, shape, blur)
                     + sensor.white_share * random.standard_normal(shape))
    d = np.rint(d / sensor.step_px) * sensor.step_px
    valid &= d > sensor.step_px
    units = np.rint(scale / np.where(valid, d, 1) / camera.depth_scale_mm)
    return np.where(valid & (units <= 65535), units, 0).astype(np.uint16)


# --- Files -----------------------------------------------------------------------------------------------------------

def json_text(value):
    """One level of indentation a space, lists without lists on one line."""
    text = json.dumps(value, indent=1)
    return re.sub(r"\[\s+([^\[\]{}]*?)\s+\]", lambda m: "[" + " ".join(m[1].split()) + "]", text) + "\n"


def rows(matrix):
    return [[round(float(x), 9) + 0.0 for x in row[:3]] + [round(float(row[3]), 5) + 0.0] for row in matrix]


def cloud_of(camera, units, mask):
    v, u = np.nonzero(mask & (units > 0))
    z = units[v, u] * camera.depth_scale_mm
    return np.column_stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z]).astype("<f4")


def ply_bytes(points):
    header = "\n".join(["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}", "property float x",
                        "property float y", "property float z", "end_header", ""])
    return header.encode() + points.tobytes()


def read_ply(path):
    header, _, body = path.read_bytes().partition(b"end_header\n")
    count = int(re.search(rb"element vertex (\d+)", header)[1])
    return np.frombuffer(body, "<f4", 3 * count).reshape(-1, 3).astype(np.float64)


def read_png(path):
    return np.array(Image.open(path)).astype(np.uint16)


def read_camera(path):
    return Camera(**json.loads(path.read_text()))


def make(frame, folder):
    """Writes the files of one frame; gives its entries of gt.json and its line of the README."""
    random = np.random.default_rng(frame.seed)
    camera, sensor = frame.camera, Sensor()
    solids, stood, com = [], None, None
    if frame.part:
        triangles = model(frame.part)
        world_from_model = stand(triangles, random)
        stood, com = moved(world_from_model, triangles), moved(world_from_model, centre_of_mass(triangles))
        solids.append((stood, PART))
        stood = stood.reshape(-1, 3)
    camera_from_world = look(frame, random)
    right = camera_from_world[0, :3]
    if frame.clutter:                                        # one on either side of the part, as the camera sees it
        middle = (stood.min(axis=0) + stood.max(axis=0)) / 2
        behind = np.cross([0, 0, 1], right)
        beside = (mug(), 175 * right + 40 * behind), (small_box(), -150 * right - 35 * behind)
        for k, (solid, at) in enumerate(beside):
            place = pose(about([0, 0, 1], random.uniform(0, 2 * math.pi)), (middle[0] + at[0], middle[1] + at[1], 0))
            solids.append((moved(place, solid), PART + 1 + k))
    boards = table_of(frame, camera_from_world, stood, com, random)

    left = picture_of(camera, camera_from_world, boards, solids)
    right_from_world = pose(translation=(-sensor.baseline_mm, 0, 0)) @ camera_from_world
    units = measure(left, picture_of(camera, right_from_world, boards, solids), sensor, random)
    Image.fromarray(units).save(folder / f"{frame.name}.png", optimize=True)
    (folder / f"{frame.name}.camera.json").write_text(json_text(dataclasses.asdict(camera)))

    table = "{} x {}".format(*frame.table_mm) if frame.table_mm else "fills the picture"
    extras = [f"{frame.overhang:.0%} beyond the table's edge"] * bool(frame.overhang)
    extras += ["a mug and a box beside it"] * frame.clutter
    line = [f"`{frame.name}`", "-", "-", f"{frame.distance_mm}", f"{frame.elevation_deg}", f"{camera.depth_scale_mm}",
            table, "-", "; ".join(extras) or "-"]
    if frame.part is None or frame.part == "star_knob":
        line[1], line[8] = "none", "-" if frame.part is None else "a hand knob that is not in `parts/`"
        return [{"scene": f"{frame.name}.png", "kind": "full_frame", "model": None, "T": [], "gt_quality": "none",
                 "tolerance_mm": None, "tolerance_deg": None, "verified_median_mm": None}], line
    camera_from_model = np.array(rows(camera_from_world @ world_from_model))
    entry = {"scene": f"{frame.name}.png", "kind": "full_frame", "model": frame.part, "T": [rows(camera_from_model)],
             "gt_quality": "exact", "tolerance_mm": 0.5, "tolerance_deg": 0.5,
             "visible_fraction": round(visible_fraction(camera, left, camera_from_model, triangles), 4)}
    entries = [entry]
    if frame.instance:
        near = np.abs(units * camera.depth_scale_mm - rendered(camera, camera_from_model, triangles)) < MASK_MM
        path = f"{frame.name}__{frame.part}.ply"
        (folder / path).write_bytes(ply_bytes(cloud_of(camera, units, near)))
        entries.append({**entry, "scene": path, "kind": "instance", "mask": "rendered"})
    if frame.with_table:
        corners = moved(camera_from_model, triangles.reshape(-1, 3))
        low, high = corners.min(axis=0), corners.max(axis=0)
        cloud = cloud_of(camera, units, units > 0)
        cloud = cloud[np.all(np.abs(cloud - (low + high) / 2) <= 1.8 * (high - low) / 2, axis=1)]
        path = f"{frame.name}_table.ply"
        (folder / path).write_bytes(ply_bytes(cloud))
        entries.append({**entry, "scene": path, "kind": "with_table"})
    down = -world_from_model[2, :3]
    line[1], line[2] = f"`{frame.part}`", "({:g}, {:g}, {:g})".format(*(np.round(down, 2) + 0.0))
    line[7] = f"{entry['visible_fraction']:.0%}"
    return entries, line


# --- Symmetries ------------------------------------------------------------------------------------------------------

def half_turn(axis):
    return pose(about(axis, math.pi))


DISCRETE = {"link": [half_turn([1, 0, 0])],
            "flange": [pose(about([0, 0, 1], i * math.pi / 3)) for i in range(1, 6)],
            "elbow_100": [half_turn([1, 1, 0])],
            "elbow_130": [half_turn([1, 1, 0])]}
CONTINUOUS = {"plain_shaft": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}


def to_triangles(points, triangles):
    """Distance of points (n, 3) to triangles (n, 3, 3), one each."""
    ahead, away = np.roll(triangles, -1, axis=1) - triangles, points[:, None] - triangles
    share = np.sum(away * ahead, axis=2) / np.maximum(np.sum(ahead * ahead, axis=2), 1e-20)
    to_edge = np.linalg.norm(away - np.clip(share, 0, 1)[..., None] * ahead, axis=2).min(axis=1)
    normal = np.cross(ahead[:, 0], ahead[:, 1])
    length = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(length, 1e-20)[:, None]
    above = np.all(np.sum(np.cross(ahead, away) * normal[:, None], axis=2) >= 0, axis=1) & (length > 1e-9)
    return np.where(above, np.abs(np.sum(away[:, 0] * normal, axis=1)), to_edge)


class Surface:
    """Distance of points to a mesh."""

    def __init__(self, triangles, spacing_mm=0.7):
        random = np.random.default_rng(0)
        self.triangles, each = triangles, np.arange(len(triangles))
        area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
        drawn = random.choice(len(area), int(area.sum() / 2 / spacing_mm ** 2), p=area / area.sum())
        self.owner = np.concatenate([each, drawn])
        weights = np.concatenate([np.full((len(each), 3), 1 / 3), random.dirichlet((1, 1, 1), len(drawn))])
        self.samples = np.einsum("nk,nkd->nd", weights, triangles[self.owner])
        self.tree = cKDTree(self.samples)

    def distance(self, points, candidates=12):
        """To the triangles of the nearest samples: never too small, too large by less than the samples' spacing."""
        owner = self.owner[self.tree.query(points, candidates)[1]].reshape(-1)
        each = to_triangles(np.repeat(points, candidates, axis=0), self.triangles[owner])
        return each.reshape(-1, candidates).min(axis=1)

    def exact_distance(self, points, good_enough_mm=0.0):
        """As `distance`, and then to every triangle whose box is nearer; only where it is above `good_enough_mm`."""
        result = self.distance(points)
        low, high = self.triangles.min(axis=1), self.triangles.max(axis=1)
        for some in np.array_split(np.flatnonzero(result > good_enough_mm), 1 + len(points) // 500):
            p = points[some][:, None]
            gap = np.linalg.norm(np.maximum(np.maximum(low - p, p - high), 0), axis=2)
            i, j = np.nonzero(gap < result[some][:, None])
            np.minimum.at(result, some[i], to_triangles(points[some[i]], self.triangles[j]))
        return result


def symmetries():
    """models_info of all parts, with the distance of each turned surface from itself measured on the mesh."""
    info = {}
    for path in sorted((REPOSITORY / "parts").glob("*.stl")):
        name, triangles = path.stem, read_stl(path)
        points = np.unique(triangles.reshape(-1, 3), axis=0)
        hull = points[ConvexHull(points).vertices]
        low, size = points.min(axis=0), np.ptp(points, axis=0)
        diameter = max(np.linalg.norm(hull - p, axis=1).max() for p in hull)
        item = {"diameter": round(float(diameter), 4)}
        item.update({f"min_{a}": round(float(x), 4) for a, x in zip("xyz", low)})
        item.update({f"size_{a}": round(float(x), 4) for a, x in zip("xyz", size)})
        turns = list(DISCRETE.get(name, []))
        if turns:
            item["symmetries_discrete"] = [[round(float(x), 9) + 0.0 for x in t.reshape(-1)] for t in turns]
        if name in CONTINUOUS:
            item["symmetries_continuous"] = CONTINUOUS[name]
            turns += [pose(about(c["axis"], a)) for c in CONTINUOUS[name] for a in (0.05, 0.7, 1.9, 3.0, 4.4)]
        deviation = 0.0
        surface = Surface(triangles, 1.5) if turns else None
        for turn in turns:
            turned = moved(turn, np.concatenate([surface.samples, points]))
            deviation = max(deviation, float(surface.exact_distance(turned, 0.0005).max()))
        if deviation > SYMMETRY_TOLERANCE_MM:
            raise SystemExit(f"{name}: not symmetric, {deviation:.3f} mm")
        item.update(symmetry_tolerance_mm=SYMMETRY_TOLERANCE_MM, symmetry_deviation_mm=round(deviation, 3))
        info[name] = item
    return info


# --- All of it -------------------------------------------------------------------------------------------------------

README = """# Frames

Depth frames of the project's own parts ([`parts/`](../parts)), rendered with a stereo camera's faults and exact poses:
the demo runs on them and so do the tests. Made by [`tools/make_frames.py`](../tools/make_frames.py), fixed seeds
(`python3 tools/make_frames.py scenes --check` compares). Licence: Apache-2.0, like the project.

| frame | part | rests on, model axes | distance, mm | elevation, deg | mm per unit | table, mm | visible | besides |
|---|---|---|---|---|---|---|---|---|
{table}

## How they are made

The part rests in a pose drawn from the faces of its convex hull that carry its centre of mass, at a random turn and
place; "rests on" is the direction that points down. The keyway of `keyed_shaft`, the cable collar of `housing` and the
counterbores of `t_plate` are in view, so that each pose is decided by its frame.

The rasteriser is the script's own, not the library's. The camera is like a D415 at 640 x 480: baseline 55 mm, disparity
noise of 0.05 to 0.08 pixels shared by neighbours within 2 to 3 pixels and a little white noise, edges that grow by up
to 2 pixels, mixed pixels between foreground and background, a shadow left of things and an empty band at the left
border where the right imager sees nothing, holes at grazing angles, disparity in steps of 1/32 pixel, then depth in
whole units. Not modelled: fixed ripples and bends of a real unit, texture, shine, motion.

## Files

- `NAME.png`, `NAME.camera.json`: 16-bit depth (0 = no value) and its pinhole camera, pixel centres at integers.
- `NAME__PART.ply` (kind `instance`): the part alone, the pixels within {mask} mm of the depth rendered at the true
  pose. `NAME_table.ply` (kind `with_table`): the points within 1.8 times the part's box, both along the camera's axes.
  Binary little-endian float32 x y z, mm, camera frame.
- `gt.json`: `T` = camera_from_model, 4x4 row by row, mm; x right, y down, z forward. `scene` is relative to this
  folder. `gt_quality` `exact`: the pose that was rendered. `tolerance_mm`, `tolerance_deg`: a smaller difference is no
  error, it is within the noise. `visible_fraction` as BOP's `visib_fract`. `verified_median_mm`: median distance of the
  part's points to the mesh at `T`, computed from these files. `model` null: nothing of the catalogue is there.
- `symmetries.json`: keys of BOP's models_info for every part of `parts/`; `symmetries_discrete` without the identity.
  A pose is right when it is near any `T * S`. `symmetry_deviation_mm`: largest distance between surface and turned
  surface, measured on the mesh.
"""


def verify(folder, quiet=False):
    """Reads the files back: True when every pose fits its points. Gives the median of each scene."""
    good, medians, truth = True, {}, json.loads((folder / "gt.json").read_text())
    surfaces = {}
    for entry in truth["scenes"]:
        if entry["model"] is None:
            continue
        path = folder / entry["scene"]
        frame = re.sub(r"(__\w+|_table)?\.ply$|\.png$", "", path.name)
        camera = read_camera(folder / f"{frame}.camera.json")
        camera_from_model = np.array(entry["T"][0])
        surface = surfaces.setdefault(entry["model"], Surface(model(entry["model"])))
        expected = rendered(camera, camera_from_model, surface.triangles)
        if path.suffix == ".png":
            points = cloud_of(camera, read_png(path), np.isfinite(expected)).astype(np.float64)
        else:
            points = read_ply(path)
        u, v = (np.rint(points[:, i] / points[:, 2] * f + c).astype(int)
                for i, f, c in ((0, camera.fx, camera.cx), (1, camera.fy, camera.cy)))
        off = points[:, 2] - expected[v, u]
        points, off = points[np.abs(off) < MASK_MM], off[np.abs(off) < MASK_MM]
        distance = surface.distance(moved(np.linalg.inv(camera_from_model), points))
        medians[entry["scene"]] = round(float(np.median(distance)), 2)
        filled = len(points) / np.count_nonzero(np.isfinite(expected))
        good &= medians[entry["scene"]] < MEDIAN_LIMIT_MM and filled > 0.5
        if not quiet:
            print(f"{entry['scene']:30s} {len(points):6d} points, {filled:4.0%} of the silhouette, distance: median "
                  f"{np.median(distance):.2f}, p95 {np.percentile(distance, 95):.2f}, along z {np.median(off):+.2f} mm")
    return good, medians


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    entries, lines = [], []
    for frame in FRAMES:
        of_frame, line = make(frame, folder)
        entries += of_frame
        lines.append("| " + " | ".join(line) + " |")
    truth = {"frame": "opencv camera, mm", "scenes": entries}
    (folder / "gt.json").write_text(json_text(truth))
    _, medians = verify(folder, quiet=True)
    for entry in entries:
        if entry["model"]:
            entry["verified_median_mm"] = medians[entry["scene"]]
    (folder / "gt.json").write_text(json_text(truth))
    (folder / "symmetries.json").write_text(json_text(symmetries()))
    (folder / "README.md").write_text(README.format(table="\n".join(lines), mask=MASK_MM))


def numbers(text):
    return np.array([float(x) for x in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)])


def check(folder, made):
    """True when both folders hold the same frames: bytes first, else (another libm, another zlib) what they mean."""
    good = True
    names = {p.name for f in (folder, made) for p in f.iterdir() if p.is_file()}
    for name in sorted(names):
        old, new = folder / name, made / name
        if not old.exists() or not new.exists():
            good, verdict = False, "only in " + str(folder if old.exists() else made)
        elif old.read_bytes() == new.read_bytes():
            verdict = "same bytes"
        elif old.suffix == ".png":
            a, b = read_png(old), read_png(new)
            share = np.mean(a != b) if a.shape == b.shape else 1
            good, verdict = good and share < 1e-3, f"{share:.3%} of the pixels differ"
        elif old.suffix == ".ply":
            a, b = len(read_ply(old)), len(read_ply(new))
            good, verdict = good and abs(a - b) <= 1e-3 * a, f"{a} and {b} points"
        elif old.suffix == ".json":
            a, b = (numbers(p.read_text()) for p in (old, new))
            off = np.abs(a - b).max() if len(a) == len(b) else math.inf
            good, verdict = good and off < 0.02, f"numbers differ by up to {off:.2g}"
        else:
            good, verdict = False, "DIFFERENT"
        print(f"{name}: {verdict}")
    return good


def preview(folder, target):
    """All frames in one picture: depth as colour, shaded, with the part's outline at the true pose."""
    truth = {e["scene"]: e for e in json.loads((folder / "gt.json").read_text())["scenes"]}
    tiles = []
    for frame in FRAMES:
        camera, entry = read_camera(folder / f"{frame.name}.camera.json"), truth[f"{frame.name}.png"]
        z = read_png(folder / f"{frame.name}.png") * camera.depth_scale_mm
        alone = z[160:320, 220:420]
        if entry["model"]:
            alone = rendered(camera, np.array(entry["T"][0]), model(entry["model"]))
        mask = np.isfinite(alone) & (alone > 0)
        low, high = alone[mask].min() - 30, alone[mask].max() + 120
        t = np.clip((z - low) / (high - low), 0, 1)[..., None]
        colour = 255 * np.clip(1.5 - np.abs(4 * (1 - t) - np.array([3, 2, 1])), 0.1, 1)
        shade = np.clip(0.8 + 0.12 * np.gradient(gaussian_filter(z, 1))[1], 0.35, 1)[..., None]
        colour = np.where(z[..., None] > 0, colour * shade, 0)
        if entry["model"]:
            colour[binary_dilation(mask) & ~mask] = 255
        tile = Image.fromarray(colour.astype(np.uint8))
        ImageDraw.Draw(tile).text((8, 6), frame.name, fill=(255, 255, 255))
        tiles.append(tile)
    columns = 4
    sheet = Image.new("RGB", (640 * columns, 480 * -(-len(tiles) // columns)))
    for i, tile in enumerate(tiles):
        sheet.paste(tile, (640 * (i % columns), 480 * (i // columns)))
    sheet.save(target)


def main():
    parser = argparse.ArgumentParser(description="Make the project's depth frames with exact poses.")
    parser.add_argument("folder", type=Path, help="output folder (with --check: the folder to compare with)")
    parser.add_argument("--check", action="store_true", help="make them beside and compare; exit 1 on a difference")
    parser.add_argument("--verify", action="store_true", help="only hold the files against the meshes")
    parser.add_argument("--preview", type=Path, metavar="PNG", help="only draw all frames into one picture")
    options = parser.parse_args()
    if options.preview:
        preview(options.folder, options.preview)
        return 0
    if options.check:
        with tempfile.TemporaryDirectory() as beside:
            write(Path(beside))
            return 0 if check(options.folder, Path(beside)) else 1
    if not options.verify:
        write(options.folder)
    return 0 if verify(options.folder)[0] else 1


if __name__ == "__main__":
    sys.exit(main())

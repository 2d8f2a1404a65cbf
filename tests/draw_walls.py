#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""draw_walls.py CAMERA.json WALL.png...: what a stereo camera with a baseline of 55 mm would take of a tilted wall, and that
camera. Needs the Python package."""

import sys

import numpy as np
from partpose import DepthImage, Intrinsics, camera, io

if len(sys.argv) < 3:
    sys.exit(__doc__)
told = io.CameraFile(width=640, height=480, fx=615, fy=615, cx=319.5, cy=239.5, depth_scale_mm=0.1)
intrinsics = Intrinsics(told.width, told.height, told.fx, told.fy, told.cx, told.cy)
options = camera.StereoSensorOptions(baseline_mm=55)
# A plane's inverse depth is linear in x and y; the right imager sees at x what the left one sees at x + baseline / depth.
x, y = np.meshgrid((np.arange(640) - 319.5) / 615, (np.arange(480) - 239.5) / 615)
slope = 0.3 * 55 / 700
left = 700 / (1 - 0.3 * x - 0.1 * y)
right = left * (1 + slope)
io.write_camera(sys.argv[1], told)
for seed, file in enumerate(sys.argv[2:]):
    walls = (DepthImage(z.astype(np.float32)) for z in (left, right))
    measured = camera.stereo_capture(*walls, intrinsics, options, seed=seed)[0]
    io.write_depth_png(file, measured, told.depth_scale_mm)

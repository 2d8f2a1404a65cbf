#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/img/ambiguity.png: a part as it lies (left), and another pose that the camera cannot tell from it (right);
above as the camera sees them, below from the other side.

    partpose ambiguity parts/keyed_shaft.stl --camera scenes/link.camera.json --jsonl poses.jsonl
    tools/make_ambiguity_picture.py parts/keyed_shaft.stl poses.jsonl docs/img/ambiguity.png
"""
import json
import math
import struct
import sys
import zlib

WIDTH, HEIGHT = 360, 190


def read_stl(path):
    data = open(path, 'rb').read()
    count, = struct.unpack_from('<I', data, 80)
    return [[struct.unpack_from('<3f', data, 84 + 50 * t + 12 + 12 * k) for k in range(3)] for t in range(count)]


def shade(triangles, matrix, behind):
    """Rows of grey values: orthographic, along z of the camera frame, or against it."""
    def place(p):
        return [sum(matrix[i][j] * p[j] for j in range(3)) + matrix[i][3] for i in range(3)]
    placed = [[place(p) for p in triangle] for triangle in triangles]
    low = [min(p[i] for t in placed for p in t) for i in range(3)]
    high = [max(p[i] for t in placed for p in t) for i in range(3)]
    scale = 0.86 * min(WIDTH / (high[0] - low[0]), HEIGHT / (high[1] - low[1]))
    nearest = [[math.inf] * WIDTH for _ in range(HEIGHT)]
    image = [[255] * WIDTH for _ in range(HEIGHT)]
    side = -1 if behind else 1
    for triangle in placed:
        a, b, c = [(WIDTH / 2 + side * scale * (p[0] - (low[0] + high[0]) / 2),
                    HEIGHT / 2 + scale * (p[1] - (low[1] + high[1]) / 2), side * p[2]) for p in triangle]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-9:
            continue
        u = [b[i] - a[i] for i in range(3)]
        v = [c[i] - a[i] for i in range(3)]
        u[2] *= scale
        v[2] *= scale
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        length = math.sqrt(sum(x * x for x in normal)) or 1
        light = abs(0.35 * normal[0] + 0.5 * normal[1] + 0.79 * normal[2]) / length
        grey = int(40 + 190 * light)
        for y in range(max(0, math.ceil(min(a[1], b[1], c[1]))), min(HEIGHT - 1, int(max(a[1], b[1], c[1]))) + 1):
            for x in range(max(0, math.ceil(min(a[0], b[0], c[0]))), min(WIDTH - 1, int(max(a[0], b[0], c[0]))) + 1):
                p = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
                q = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
                if p < 0 or q < 0 or p + q > 1:
                    continue
                z = p * a[2] + q * b[2] + (1 - p - q) * c[2]
                if z < nearest[y][x]:
                    nearest[y][x] = z
                    image[y][x] = grey
    return image


def write_png(path, rows):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    raw = b''.join(b'\0' + bytes(row) for row in rows)
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', len(rows[0]), len(rows), 8, 0, 0, 0, 0))
                   + chunk(b'IDAT', zlib.compress(raw, 9)) + chunk(b'IEND', b''))


def main():
    triangles = read_stl(sys.argv[1])
    poses = [json.loads(line) for line in open(sys.argv[2])]
    poses = [p for p in poses if p['model_name'] == p['other_model_name']]
    largest = max(p['displacement_mm'] for p in poses)
    pose = min(poses, key=lambda p: (p['differing_share'] > 0, abs(p['displacement_mm'] / largest - 0.8)))
    print({key: pose[key] for key in ('model_name', 'view_id', 'displacement_mm', 'differing_share', 'rms_sigmas')})
    rows = []
    for behind in (False, True):
        left, right = shade(triangles, pose['T'], behind), shade(triangles, pose['other_T'], behind)
        rows += [a + [200, 200] + b for a, b in zip(left, right)]
    write_png(sys.argv[3], rows)


if __name__ == '__main__':
    main()

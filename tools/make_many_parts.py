#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes catalogues of parametric CAD-like parts, for experiments with many parts: watertight binary STL files in mm.

    python3 -m pip install manifold3d==3.5.4 numpy

    python3 tools/make_many_parts.py FOLDER --count 1000 --seed 2    # brackets, flanges, shafts, plates, housings, ...
    python3 tools/make_many_parts.py FOLDER --hard --seed 2          # six: a mirror pair, one shape in two sizes, two symmetric
    python3 tools/make_many_parts.py FOLDER --sets                   # all that experiments/engine_*.json want

The largest edge of a part's box is 40 to 150 mm. The same seed gives the same parts, and more of them begin with the
same ones. No two parts are alike: one whose box, volume and area (as lengths) are all within 1.5 mm of those of an
earlier part is drawn anew. Neighbours in the list are of different families.
"""
import argparse
import math
import sys
from pathlib import Path

import numpy as np
from manifold3d import CrossSection, Manifold

from make_parts import (blind_hole, boss, circle, counterbored, hole, measures, prism, rectangle, rounded, shaft_profile,
                        slot, stand_on_x, stl_bytes, triangles_of, turned, union, web)

LEAST_MM, MOST_MM = 40.0, 150.0   # of the box's longest edge
DIFFERENCE_MM = 1.5


class Draw:
    """Dimensions in steps as a drawing has them."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)

    def mm(self, low, high, step=0.5):
        return round(float(self.random.uniform(low, high)) / step) * step

    def count(self, low, high):
        return int(self.random.integers(low, high + 1))

    def chance(self, share):
        return bool(self.random.random() < share)


def bracket(draw):
    """L-bracket with holes, perhaps a gusset."""
    x, y, z, t = draw.mm(45, 140), draw.mm(30, 80), draw.mm(35, 110), draw.mm(5, 12)
    r = min(draw.mm(4, 14), y / 3, x / 3, z / 3)
    body = prism(rounded((0, 0, 1), (x, 0, r), (x, y, r), (0, y, 1)), 0, t)
    body += stand_on_x(prism(rounded((0, 0, 1), (y, 0, 1), (y, z, r), (0, z, r)), 0, t))
    if draw.chance(0.7):
        at, long, high = draw.mm(0.2 * y, 0.8 * y), draw.mm(0.3, 0.8, 0.05) * x, draw.mm(0.3, 0.8, 0.05) * z
        body += web(np.array([(t / 2, t / 2), (long, t / 2), (long, t + 2), (t + 2, high), (t / 2, high)]),
                    draw.mm(4, 8)).translate([0, at, 0])
    d = draw.mm(12, 0.5 * min(y, z - t))
    body -= hole(d, -1, t + 1).rotate([0, 90, 0]).translate(
        [0, draw.mm(d / 2 + 3, max(d / 2 + 3.5, y - d / 2 - 3)), draw.mm(t + d / 2 + 2, max(t + d / 2 + 2.5, z - d / 2 - 3))])
    for _ in range(draw.count(1, 4)):
        head = draw.mm(7, 14)
        body -= counterbored(0.6 * head, 0, t, head, 0.45 * t).translate(
            [draw.mm(t + head, max(t + head + 0.5, x - head)), draw.mm(head, max(head + 0.5, y - head)), 0])
    return body


def flange(draw):
    """Disc with a hub, a bore and bolt holes; perhaps with a flat at one side."""
    r, t, height, bolts = draw.mm(25, 70), draw.mm(6, 16), draw.mm(4, 60), draw.count(3, 8)
    hub = draw.mm(0.4, 0.65, 0.05) * r
    bore, circle_radius, bolt = 2 * hub * draw.mm(0.4, 0.8, 0.05), (hub + r) / 2, draw.mm(0.5, 0.8, 0.1) * (r - hub) / 2
    body = turned(rounded((0, 0, 0), (r, 0, 1.5), (r, t, 1.5), (hub, t, 2), (0.95 * hub, t + height, 0), (0, t + height, 0)))
    body -= hole(bore, 0, t + height)
    for i in range(bolts):
        a = 2 * math.pi * i / bolts
        body -= hole(2 * bolt, 0, t, 0.5).translate([circle_radius * math.cos(a), circle_radius * math.sin(a), 0])
    if draw.chance(0.5):
        body = body.trim_by_plane([-1, 0, 0], -draw.mm(0.75, 0.95, 0.05) * r)
    return body


def shaft(draw):
    """Stepped shaft with a keyway, a flat or a cross hole; one in six has neither."""
    steps, z = [], 0.0
    for _ in range(draw.count(3, 6)):
        z += draw.mm(8, 34)
        steps.append((draw.mm(14, 56), z))
    steps = [s for i, s in enumerate(steps) if i == 0 or abs(s[0] - steps[i - 1][0]) >= 3]
    scale = min(1.0, 148 / steps[-1][1])
    steps = [(d, e * scale) for d, e in steps]
    body = turned(shaft_profile(steps, 0.8, 0.5), 48)
    kind = draw.count(0, 5)
    wide, end = max(steps, key=lambda s: s[0])
    start = max([e for _, e in steps if e < end], default=0.0)
    if kind in (1, 2, 3):
        w = draw.mm(0.2, 0.35, 0.05) * wide
        cutter = prism(slot(start + w, 0, max(end - w, start + 1.2 * w), 0, w / 2), 0.3 * wide, wide)
        body -= cutter.rotate([0, -90, 0])
    if kind == 4:
        body -= Manifold.cube([wide, 2 * wide, end - start + 1]).translate([0.3 * wide, -wide, start - 0.5])
    if kind >= 3:
        at = draw.mm(0.1, 0.9, 0.05) * steps[-1][1]
        body -= hole(draw.mm(6, 12), -60, 60).rotate([90, 0, 0]).translate([0, 0, at])
    return body


def plate(draw):
    """Plate with a corner cut off, pockets, holes and a long hole."""
    x, y, t = draw.mm(60, 150), draw.mm(35, 110), draw.mm(6, 20)
    cut = draw.mm(0.1, 0.35, 0.05) * min(x, y)
    r = draw.mm(2, 8)
    body = prism(rounded((0, 0, r), (x, 0, r), (x, y - cut, 2), (x - cut, y, 2), (0, y, r)), 0, t, top=("chamfer", 1))
    for _ in range(draw.count(1, 3)):
        a, b = draw.mm(0.15, 0.4, 0.05) * x, draw.mm(0.15, 0.5, 0.05) * y
        x0, y0 = draw.mm(4, max(4.5, x - a - 8)), draw.mm(4, max(4.5, y - b - 8))
        through = draw.chance(0.4)
        body -= prism(rectangle(x0, y0, x0 + a, y0 + b, 3), -1 if through else 0.5 * t, t + 1)
    for _ in range(draw.count(1, 4)):
        d = draw.mm(6, 22)
        body -= hole(d, 0, t).translate([draw.mm(d, x - d), draw.mm(d, max(d + 0.5, y - d)), 0])
    if draw.chance(0.5):
        d = draw.mm(12, 30)
        body += boss(d, t, t + draw.mm(5, 30)).translate([draw.mm(d / 2 + 1, x - d), draw.mm(d / 2 + 1, max(d / 2 + 1.5, y - d)), 0])
    return body


def housing(draw):
    """Open box with walls, screw columns, stand-offs, a rib and a window in a wall."""
    x, y, z, wall = draw.mm(50, 145), draw.mm(40, 100), draw.mm(18, 70), draw.mm(2.5, 5)
    r = draw.mm(5, 10)
    outer = prism(rectangle(-x / 2, -y / 2, x / 2, y / 2, r), 0, z)
    body = outer - prism(rectangle(-x / 2 + wall, -y / 2 + wall, x / 2 - wall, y / 2 - wall, r - wall / 2), wall, z + 1)
    for sx, sy in ((-1, -1), (-1, 1), (1, -1), (1, 1))[:draw.count(2, 4)]:
        body += boss(11, wall, z - 1).translate([sx * (x / 2 - wall - 4), sy * (y / 2 - wall - 4), 0]) ^ outer
    for _ in range(draw.count(1, 4)):
        body += boss(draw.mm(7, 14), wall, wall + draw.mm(4, 0.6 * z)).translate(
            [draw.mm(-0.3 * x, 0.3 * x), draw.mm(-0.3 * y, 0.3 * y), 0])
    at = draw.mm(-0.3 * x, 0.3 * x)
    body += prism(rectangle(at - 1.5, -y / 2 + 1, at + 1.5, y / 2 - 1), 1, draw.mm(0.3, 0.8, 0.05) * z)
    d = draw.mm(0.3, 0.6, 0.05) * z
    body -= hole(d, x / 2 - wall - 2, x / 2 + 2).rotate([0, 90, 0]).translate([0, draw.mm(-0.25 * y, 0.25 * y), 0.5 * z])
    if draw.chance(0.6):
        a = draw.mm(0.15, 0.5, 0.05) * x
        body -= Manifold.cube([a, 3 * wall, 0.6 * z]).translate([draw.mm(-0.4 * x, 0.4 * x - a), y / 2 - 2 * wall, 0.6 * z])
    return body


def clevis(draw):
    """Fork: base, two cheeks with a bore, a shank."""
    w, gap, t, depth, high = draw.mm(25, 60), draw.mm(12, 40), draw.mm(6, 16), draw.mm(8, 18), draw.mm(30, 70)
    cheek = np.vstack([[(-w / 2, 0), (w / 2, 0)], circle(w / 2, 0, high)[:len(circle(w / 2, 0, high)) // 2 + 1]])
    one = prism(cheek, 0, t).rotate([90, 0, 0])
    thick = t if draw.chance(0.5) else draw.mm(6, 16)
    other = prism(cheek, 0, thick).rotate([90, 0, 0])
    body = one.translate([0, -gap / 2, 0]) + other.translate([0, gap / 2 + thick, 0])
    body += Manifold.cube([w, gap + t + thick, depth]).translate([-w / 2, -gap / 2 - t, -depth + 0.01])
    body -= hole(draw.mm(0.3, 0.7, 0.05) * w, -200, 200).rotate([90, 0, 0]).translate([0, 0, high])
    return body + turned(shaft_profile([(draw.mm(14, min(w, 40)), draw.mm(15, 45))], 1, 0.5)).rotate([180, 0, 0]).translate(
        [draw.mm(-0.15 * w, 0.15 * w), 0, -depth + 0.5])


def bearing_block(draw):
    """Foot with slots, an arch with a bore, a lubricating stub."""
    x, y, foot, r = draw.mm(70, 148), draw.mm(25, 60), draw.mm(8, 16), draw.mm(18, 34)
    r = min(r, 0.36 * x)
    centre = foot + r * draw.mm(0.5, 1.1, 0.05)
    off = draw.mm(-0.12 * x, 0.12 * x)
    body = prism(rectangle(-x / 2, -y / 2, x / 2, y / 2, 6), 0, foot)
    body += turned([(0, -y / 2), (r, -y / 2), (r, y / 2), (0, y / 2)]).rotate([90, 0, 0]).translate([off, 0, centre])
    body += Manifold.cube([2 * r, y, centre - 1]).translate([off - r, -y / 2, 1])
    body -= hole(2 * r * draw.mm(0.45, 0.75, 0.05), -y, y).rotate([90, 0, 0]).translate([off, 0, centre])
    for side in (-1, 1):
        w = draw.mm(7, 12)
        at = off + side * r + side * (x / 2 - side * off - r) / 2
        body -= prism(slot(at, -0.15 * y, at, 0.15 * y, w / 2), -1, foot + 1)
    if draw.chance(0.6):
        body += boss(draw.mm(8, 14), 0, 10).translate([off, draw.mm(-0.3 * y, 0.3 * y), centre + r - 2])
    return body


def lever(draw):
    """Two eyes of different size, the arm offset and perhaps cranked, a pin."""
    length, big, small, t = draw.mm(45, 105), draw.mm(14, 24), draw.mm(9, 16), draw.mm(8, 20)
    bend = draw.mm(-25, 25)
    arm = CrossSection.hull_points(np.vstack([circle(0.65 * big, 0, 0), circle(0.7 * small, length, bend)]))
    body = arm.extrude(0.6 * t).translate([0, 0, draw.mm(0, 0.4 * t)])
    body += turned([(0, 0), (big, 0), (big, t), (0, t)])
    lift = draw.mm(-10, 10)
    body += turned([(0, min(0, lift)), (small, min(0, lift)), (small, max(t, t + lift)), (0, max(t, t + lift))]).translate(
        [length, bend, 0])
    body -= hole(2 * big * draw.mm(0.45, 0.75, 0.05), -20, 60)
    body -= hole(2 * small * draw.mm(0.4, 0.7, 0.05), -30, 60).translate([length, bend, 0])
    if draw.chance(0.6):
        body += boss(draw.mm(6, 10), 0.6 * t, t + draw.mm(6, 25)).translate([0.5 * length, 0.5 * bend, 0])
    return body


def profile(draw):
    """A length of an extruded profile (angle, tee, channel or Z), its ends mitred, with holes."""
    a, b, t, length = draw.mm(25, 70), draw.mm(25, 70), draw.mm(3, 9), draw.mm(40, 148)
    kind = draw.count(0, 3)
    flat = lambda *c: CrossSection([np.array(c, float)])
    bar = lambda x0, y0, x1, y1: flat((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    at = draw.mm(0.25, 0.6, 0.05) * a
    section = bar(0, 0, a, t)
    section += (bar(0, 0, t, b), bar(at, 0, at + t, b), bar(0, 0, t, b) + bar(a - t, 0, a, draw.mm(0.5, 1, 0.1) * b),
                bar(0, 0, t, b) + bar(a - t, -draw.mm(0.4, 0.8, 0.1) * b, a, t))[kind]
    body = section.extrude(length)
    if draw.chance(0.6):
        angle = math.radians(draw.mm(20, 45, 5))
        body = body.trim_by_plane([0, -math.sin(angle), -math.cos(angle)], -length * math.cos(angle) - 0.15 * b)
    for _ in range(draw.count(1, 3)):
        body -= hole(draw.mm(5, 0.4 * a), -t, 2 * t).rotate([-90, 0, 0]).translate(
            [draw.mm(0.3 * a, 0.7 * a), 0, draw.mm(0.1, 0.8, 0.05) * length])
    return body


def pulley(draw):
    """Wheel with a groove, pockets on one side, a hub and a key."""
    r, w, hub = draw.mm(24, 74), draw.mm(12, 32), draw.mm(9, 16)
    groove = draw.mm(0.1, 0.2, 0.05) * r
    body = turned(rounded((0, 0, 0), (r, 0, 0.5), (r, 0.2 * w, 0), (r - groove, 0.5 * w, 0.5), (r, 0.8 * w, 0), (r, w, 0.5),
                          (0, w, 0)))
    spokes = draw.count(3, 6)
    ring_out, ring_in = r - groove - 4, hub + 3
    if ring_out - ring_in > 6:
        d, at = ring_out - ring_in - 1, (ring_out + ring_in) / 2
        floor = draw.mm(-0.1, 0.6, 0.1) * w
        for i in range(spokes):
            angle = 2 * math.pi * i / spokes
            pocket = hole(min(d, 1.6 * math.pi * at / spokes - 2), floor, w)
            body -= pocket.translate([at * math.cos(angle), at * math.sin(angle), 1.1])
    end = w + draw.mm(3, 20)
    body += turned([(0, w - 0.5), (hub, w - 0.5), (hub, end), (0, end)])
    bore = hub * draw.mm(0.4, 0.65, 0.05)
    body -= hole(2 * bore, 0, end)
    return body - Manifold.cube([bore + 3, 0.5 * bore, end + 10]).translate([0, -0.25 * bore, -5])


def pipe_tee(draw):
    """Run with flanges, a branch off the middle, perhaps a second one."""
    r, half = draw.mm(9, 20), draw.mm(28, 72)
    rim, t = r + draw.mm(5, 14), draw.mm(5, 10)
    pipe = lambda length: turned([(0, 0), (r, 0), (r, length - t), (rim, length - t), (rim, length), (0, length)])
    bore = lambda length: turned([(0, 0), (0.7 * r, 0), (0.7 * r, length + 1), (0, length + 1)])
    directions = [[0, 90, 0], [0, -90, 0], [draw.mm(-40, 40, 5), 0, 0]]
    lengths = [half, half if draw.chance(0.5) else draw.mm(28, 72), draw.mm(26, 60)]
    if draw.chance(0.4):
        directions.append([90, 0, 0])
        lengths.append(draw.mm(24, 50))
    body = union(*[pipe(length).rotate(turn) for turn, length in zip(directions, lengths)])
    return body - union(*[bore(length).rotate(turn) for turn, length in zip(directions, lengths)])


def manifold_block(draw):
    """Block with steps, bores and stubs on its faces."""
    x, y, z = draw.mm(40, 130), draw.mm(30, 90), draw.mm(25, 75)
    body = prism(rectangle(0, 0, x, y, 1.5), 0, z, top=("chamfer", 1))
    body -= Manifold.cube([draw.mm(0.2, 0.5, 0.05) * x, y + 2, draw.mm(0.2, 0.6, 0.05) * z]).translate([-1, -1, 0]).translate(
        [0, 0, z - draw.mm(0.2, 0.6, 0.05) * z])
    for _ in range(draw.count(1, 3)):
        d = draw.mm(8, 0.5 * min(x, y))
        body -= blind_hole(d, 0.4 * z, z).translate([draw.mm(0.2, 0.8, 0.05) * x, draw.mm(0.3, 0.7, 0.05) * y, 0])
    for _ in range(draw.count(1, 3)):
        d = draw.mm(10, 0.6 * min(x, z))
        body += boss(d, 0, draw.mm(5, 28)).rotate([90, 0, 0]).translate([draw.mm(0.2, 0.8, 0.05) * x, 0, draw.mm(0.25, 0.5, 0.05) * z])
    d = draw.mm(8, 0.6 * min(y, z))
    body -= hole(d, 0.5 * x, x + 1).rotate([0, 90, 0]).translate([0, draw.mm(0.3, 0.7, 0.05) * y, 0.5 * z])
    return body


def sheet(draw):
    """Sheet metal: a base with one to three flanges bent up at its edges, or one in its middle, and holes."""
    x, y, t = draw.mm(45, 120), draw.mm(30, 70), draw.mm(1.5, 4)
    body = prism([rectangle(0, 0, x, y, 2)] + [circle(draw.mm(3, 9) / 2 + 1, draw.mm(0.3, 0.7, 0.05) * x, draw.mm(0.3, 0.7, 0.05) * y)[::-1]],
                 0, t)
    edges = draw.random.permutation(4)[:draw.count(1, 3)]
    for edge in edges:
        length = y if edge < 2 else x
        width, height = draw.mm(0.35, 1, 0.05) * length, draw.mm(15, 55)
        start = draw.mm(0, 1, 0.5) * (length - width)
        flange = Manifold.cube([t, width, height]) - hole(min(draw.mm(4, 14), 0.6 * width, 0.5 * height), -1, t + 1).rotate(
            [0, 90, 0]).translate([0, width / 2, 0.6 * height])
        flange = flange.translate([0, start, 0])
        if edge == 1:
            flange = flange.translate([x - t, 0, 0])
        elif edge >= 2:
            flange = flange.rotate([0, 0, -90]).translate([0, t if edge == 2 else y, 0])
        body += flange
    if len(edges) == 1 and draw.chance(0.5):
        body += Manifold.cube([t, draw.mm(0.5, 1, 0.1) * y, draw.mm(12, 40)]).translate([draw.mm(0.35, 0.65, 0.05) * x, 0, 0])
    return body


FAMILIES = [bracket, flange, shaft, plate, housing, clevis, bearing_block, lever, profile, pulley, pipe_tee, manifold_block]


def size_of(solid):
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    return high - low


def fitted(solid):
    """One piece, not larger or smaller than the parts may be; None when a draw fell apart."""
    pieces = solid.decompose()
    if not pieces:
        return None
    whole = max(pieces, key=lambda piece: piece.volume())
    longest = max(size_of(whole))
    if whole.volume() < 0.9 * solid.volume() or whole.status().name != "NoError":
        return None
    return whole if LEAST_MM <= longest <= MOST_MM else whole.scale([min(max(longest, LEAST_MM), MOST_MM) / longest] * 3)


def signature(triangles):
    """What tells parts apart: lengths that do not change when the part is turned by 90 degrees."""
    size = np.sort(np.ptp(triangles.reshape(-1, 3), axis=0))
    return np.concatenate([size, measures(triangles)[:2]])


def closed_triangles_of(solid):
    """None when rounding the coordinates makes two edges one."""
    try:
        return triangles_of(solid)
    except SystemExit:
        return None


def many(count, seed, families=FAMILIES):
    """(name, triangles) of each part."""
    signatures = []
    for index in range(count):
        family = families[index % len(families)]
        for attempt in range(100):
            draw = Draw([seed, index, attempt])
            solid = fitted(family(draw))
            if solid is None:
                continue
            solid = solid.translate([draw.mm(-60, 60) for _ in range(3)])
            triangles = closed_triangles_of(solid)
            if triangles is None:
                continue
            this = signature(triangles)
            if all(np.abs(this - other).max() > DIFFERENCE_MM for other in signatures):
                signatures.append(this)
                yield f"p{index + 1:04d}_{family.__name__}", triangles
                break
        else:
            raise SystemExit(f"part {index + 1}: 100 draws of {family.__name__} are all like earlier parts")


def hard(seed):
    """(name, triangles): what is easily confused."""
    def first(family):
        for attempt in range(100):
            solid = fitted(family(Draw([seed, attempt])))
            if solid is not None and 60 <= max(size_of(solid)) <= 120:
                return solid
        raise SystemExit(f"no draw of {family.__name__} is 60 to 120 mm large")

    handed, sized = first(bracket), first(manifold_block)
    wheel = turned(rounded((0, 0, 0), (46, 0, 1.5), (46, 11, 1.5), (24, 11, 2), (22, 40, 0), (0, 40, 0))) - hole(26, 0, 40)
    for x, y in ((35, 0), (0, 35), (-35, 0), (0, -35)):
        wheel -= hole(12, 0, 11, 0.5).translate([x, y, 0])
    steps = [(18, 20), (36, 34), (28, 70), (22, 96), (16, 120)]
    spindle = turned(shaft_profile(steps, 1.0, 1.0, grooves=[(84, 3, 18)]), 56)
    sized = sized.simplify(0.004)
    for name, solid in (("handed_left", handed.mirror([1, 0, 0])), ("handed_right", handed), ("block_small", sized),
                        ("block_large", sized.scale([1.2] * 3)), ("wheel_4_fold", wheel), ("spindle", spindle)):
        yield name, triangles_of(solid)


SETS = {   # folder: how its parts are made
    "thirty_tuning": lambda: many(30, 3),
    **{f"six_tuning_{i}": lambda seed=20 + i: many(6, seed) for i in (1, 2, 3)},
    "thousand_tuning": lambda: many(1000, 1),
    "thousand": lambda: many(1000, 2),
    "hard": lambda: hard(2),
    **{f"hard_tuning_{i}": lambda seed=3 + 2 * i: hard(seed) for i in (1, 2, 3)},
    "sheet_tuning": lambda: many(6, 1, [sheet]),
    **{f"sheet_tuning_{i}": lambda seed=1 + i: many(6, seed, [sheet]) for i in (2, 3)},
    "sheet": lambda: many(6, 2, [sheet]),
}


def write(folder, parts):
    folder.mkdir(parents=True, exist_ok=True)
    number = 0
    for name, triangles in parts:
        (folder / f"{name}.stl").write_bytes(stl_bytes(name, triangles))
        number += 1
    print(f"{folder}: {number} parts")


def main():
    parser = argparse.ArgumentParser(description="Make many parametric CAD-like parts as binary STL files (mm).")
    parser.add_argument("folder", type=Path, help="output folder; files of the same names there are replaced")
    parser.add_argument("--count", type=int, default=1000, help="number of parts (1000)")
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other parts (1)")
    parser.add_argument("--hard", action="store_true", help="six parts that are easily confused instead")
    parser.add_argument("--sets", action="store_true", help="the sets of experiments/engine_*.json, each in its own folder")
    options = parser.parse_args()
    if options.count < 1 or options.seed < 0:
        parser.error("--count must be 1 or more, --seed 0 or more")
    if options.sets:
        for name, made in SETS.items():
            write(options.folder / name, made())
    else:
        write(options.folder, hard(options.seed) if options.hard else many(options.count, options.seed))
    return 0


if __name__ == "__main__":
    sys.exit(main())

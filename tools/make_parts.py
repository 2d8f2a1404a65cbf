#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes the project's own CAD-like parts: watertight binary STL files in millimetres.

Needs two packages from PyPI and nothing else:

    python3 -m pip install manifold3d==3.5.4 numpy

    python3 tools/make_parts.py parts            # write every part
    python3 tools/make_parts.py parts --only elbow_100 pump_body
    python3 tools/make_parts.py parts --check    # make them again beside and compare with the files in parts/

The same version of manifold3d gives the same bytes each time: coordinates are snapped to 0.1 micrometre, vertices and
triangles are sorted. `--check` compares bytes first; where they differ (another version, another libm) it compares
volume, area, box and centroid instead and says so.
"""
import argparse
import itertools
import math
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np
from manifold3d import CrossSection, Manifold, Mesh64, triangulate

SAGITTA_MM = 0.06     # an arc is drawn with chords at most this far inside it
SNAP_MM = 1e-4        # grid of the written coordinates
SIMPLIFY_MM = 0.004   # vertices that matter less than this are dropped


# --- Flat outlines: arrays of (x, y), counter-clockwise around material, clockwise around holes ----------------------

def segments(radius):
    """Chords of a full circle; a multiple of four, so that circles keep the symmetry of the axes."""
    n = math.pi / math.acos(1 - min(SAGITTA_MM / radius, 0.5))
    return 4 * math.ceil(min(max(n, 16), 64) / 4)


def circle(radius, x=0.0, y=0.0, n=None):
    angles = 2 * math.pi * np.arange(n or segments(radius)) / (n or segments(radius))
    return np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])


def arc(x, y, radius, from_deg, to_deg):
    steps = max(1, math.ceil(abs(to_deg - from_deg) / 360 * segments(radius) - 1e-9))
    angles = np.radians(np.linspace(from_deg, to_deg, steps + 1))
    return np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])


def rounded(*corners):
    """Polygon of corners (x, y, fillet radius); convex and concave corners alike."""
    points = np.array([c[:2] for c in corners], float)
    outline = []
    for i, (_, _, radius) in enumerate(corners):
        here, before, after = points[i], points[i - 1], points[(i + 1) % len(points)]
        if radius == 0:
            outline.append(here)
            continue
        to_before, to_after = (p / np.linalg.norm(p) for p in (before - here, after - here))
        half = math.acos(np.clip(to_before @ to_after, -1, 1)) / 2
        bisector = (to_before + to_after) / np.linalg.norm(to_before + to_after)
        centre = here + bisector * radius / math.sin(half)
        start, end = (here + t * radius / math.tan(half) - centre for t in (to_before, to_after))
        first = math.atan2(start[1], start[0])
        turn = (math.atan2(end[1], end[0]) - first + math.pi) % (2 * math.pi) - math.pi
        steps = max(1, math.ceil(abs(turn) / (2 * math.pi) * segments(radius) - 1e-9))
        for a in first + turn * np.arange(steps + 1) / steps:
            outline.append(centre + radius * np.array([math.cos(a), math.sin(a)]))
    return np.array(outline)


def rectangle(x0, y0, x1, y1, radius=0.0):
    return rounded((x0, y0, radius), (x1, y0, radius), (x1, y1, radius), (x0, y1, radius))


def slot(x0, y0, x1, y1, radius):
    """Long hole between two centres."""
    a = math.degrees(math.atan2(y1 - y0, x1 - x0))
    return np.vstack([arc(x1, y1, radius, a - 90, a + 90), arc(x0, y0, radius, a + 90, a + 270)])


# --- Solids ----------------------------------------------------------------------------------------------------------

def inset(contour, distance):
    """Contour moved into its material by mitred corners: as many points as before."""
    ahead = np.roll(contour, -1, axis=0) - contour
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    before = np.roll(normal, 1, axis=0)
    return contour + distance * (normal + before) / (1 + np.sum(normal * before, axis=1, keepdims=True))


def edge_steps(edge):
    """Edge ('round' or 'chamfer', size) as (inset, depth below the face), from the face outwards."""
    if edge is None:
        return [(0.0, 0.0)]
    kind, size = edge
    if kind == "chamfer":
        return [(size, 0.0), (0.0, size)]
    angles = np.linspace(0, math.pi / 2, (3 if size < 1.6 else 4) + 1)
    return [(size * (1 - math.sin(a)), size * (1 - math.cos(a))) for a in angles]


def prism(contours, z0, z1, bottom=None, top=None):
    """Extrusion along z whose edges at the bottom and top face are rounded or chamfered, holes included."""
    contours = [np.asarray(c, float) for c in (contours if isinstance(contours, list) else [contours])]
    layers = [(i, z0 + d) for i, d in edge_steps(bottom)] + [(i, z1 - d) for i, d in reversed(edge_steps(top))]
    rings = [[inset(c, i) for c in contours] for i, _ in layers]
    vertices = np.vstack([np.column_stack([np.vstack(ring), np.full(sum(map(len, ring)), z)])
                          for ring, (_, z) in zip(rings, layers)])
    count = sum(map(len, contours))
    triangles = [triangulate(rings[0])[:, ::-1], triangulate(rings[-1]) + count * (len(layers) - 1)]
    first = 0
    for c in contours:
        here = first + np.arange(len(c))
        there = first + (np.arange(len(c)) + 1) % len(c)
        for layer in range(len(layers) - 1):
            low, high = layer * count, (layer + 1) * count
            triangles += [np.column_stack([here + low, there + low, there + high]),
                          np.column_stack([here + low, there + high, here + high])]
        first += len(c)
    solid = Manifold(Mesh64(vertices, np.vstack(triangles).astype(np.uint64)))
    assert solid.status().name == "NoError" and solid.volume() > 0, solid.status()
    return solid


def turned(profile, n=None):
    """Solid of revolution about z of a profile (radius, z), counter-clockwise."""
    profile = np.asarray(profile, float)
    return CrossSection([profile]).revolve(n or segments(profile[:, 0].max()))


def hole(diameter, z0, z1, chamfer=0.0, n=None):
    """Cutter along z from z0 to z1 (it reaches past both faces), chamfered at both."""
    r, c, past = diameter / 2, chamfer, 1.0
    if c == 0:
        return turned([(0, z0 - past), (r, z0 - past), (r, z1 + past), (0, z1 + past)], n)
    return turned([(0, z0 - past), (r + c + past, z0 - past), (r, z0 + c), (r, z1 - c),
                   (r + c + past, z1 + past), (0, z1 + past)], n or segments(r))


def blind_hole(diameter, z_floor, z_face, chamfer=0.0):
    """Cutter of a drilled hole with a 118 degree tip, opening upwards."""
    r, past = diameter / 2, 1.0
    tip = r / math.tan(math.radians(59))
    return turned([(0, z_floor - tip), (r, z_floor), (r, z_face - chamfer),
                   (r + chamfer + past, z_face + past), (0, z_face + past)], segments(r))


def counterbored(diameter, z0, z1, head_diameter, head_depth):
    return hole(diameter, z0, z1) + hole(head_diameter, z1 - head_depth, z1)


def boss(diameter, z0, z1, fillet=0.0, edge=1.0, sink=0.5):
    """Round boss standing on z0: fillet at the foot, chamfer at the top, sunk a little into what it stands on."""
    r = diameter / 2
    foot = arc(r + fillet, z0 + fillet, fillet, 270, 180) if fillet else np.array([[r, z0]])
    start, end = [(0, z0 - sink), (r + fillet, z0 - sink)], [(r, z1 - edge), (r - edge, z1), (0, z1)]
    return turned(np.vstack([start, foot, end]), segments(r))


def web(outline, thickness, edge=None):
    """Rib: outline in x, z; centred on y = 0."""
    return prism(outline, -thickness / 2, thickness / 2, edge, edge).rotate([90, 0, 0])


def union(*solids):
    total = solids[0]
    for s in solids[1:]:
        total = total + s
    return total


def stand_on_x(plate, shift=0.0):
    """Stands up a plate drawn in (y - shift, z) as (x, y): its thickness runs along x."""
    return plate.transform(np.array([[0, 0, 1, 0], [1, 0, 0, shift], [0, 1, 0, 0]], float))


# --- The parts -------------------------------------------------------------------------------------------------------

def housing():
    """Open cast shell with 3 mm walls. Origin: middle of the underside."""
    outer = prism(rectangle(-60, -40, 60, 40, 10), 0, 35, bottom=("round", 4))
    cavity = prism(rectangle(-57, -37, 57, 37, 7), 3, 36, bottom=("round", 2.5))
    body = outer - cavity
    for x, y in itertools.product((-50.5, 50.5), (-30.5, 30.5)):        # screw columns grown into the corners
        sx, sy = math.copysign(1, x), math.copysign(1, y)
        column = CrossSection.hull_points(np.vstack([circle(5, x, y), circle(4, x + 4 * sx, y - 1 * sy),
                                                     circle(4, x - 1 * sx, y + 4 * sy)]))
        body += column.extrude(29).translate([0, 0, 3]) ^ outer
        body -= blind_hole(3.4, 14, 32, 0.6).translate([x, y, 0])
    for x, y in ((-36, -19), (-36, 17), (24, -19), (24, 17)):           # stand-offs of the circuit board
        body += boss(8, 3, 12, fillet=2, edge=0.6).translate([x, y, 0])
        body -= blind_hole(2.8, 5, 12, 0.4).translate([x, y, 0])
    for y0, y1, x in ((-38, 38, 38), (-38, -10, -6)):                   # stiffening ribs on the floor
        body += prism(rectangle(x - 1.25, y0, x + 1.25, y1), 2, 11, top=("round", 0.8))
    body += boss(28, 60, 62.5, edge=0.8).rotate([0, 90, 0]).translate([0, 11, 19])   # collar of the cable gland
    body -= hole(18, 50, 63).rotate([0, 90, 0]).translate([0, 11, 19])
    connector = prism(rectangle(-41, 12, -7, 27, 3), 30, 45)
    body -= connector.rotate([90, 0, 0])
    for x in range(-24, 7, 6):                                          # vents
        body -= prism(slot(x, -6, x, 24, 1.5), -1, 4)
    lid_seat = prism(rectangle(-58.5, -38.5, 58.5, 38.5, 8.5), 33.5, 36)
    return body - lid_seat


def bracket():
    """L-bracket. Origin: heel corner, base along x, upright along z."""
    edge = ("round", 1.2)
    base = prism(rounded((0, 0, 1.5), (92, 0, 12), (92, 60, 12), (0, 60, 1.5)), 0, 9, edge, edge)
    upright = prism(rounded((-60, 0, 1.5), (0, 0, 1.5), (0, 78, 16), (-60, 78, 16)), 0, 9, edge, edge)
    body = base + stand_on_x(upright, 60)
    corner = np.vstack([[(4, 4), (15, 4)], arc(15, 15, 6, 270, 180), [(4, 15)]])
    body += web(corner, 60, edge).translate([0, 30, 0])
    gusset = rounded((5, 5, 0), (56, 5, 0), (56, 9.5, 0), (46, 13, 8), (17, 36, 8), (9.5, 40, 0), (5, 40, 0))
    body += web(gusset, 8, ("round", 1)).translate([0, 40, 0])
    seat = boss(40, 9, 14, fillet=2.5, edge=1).rotate([0, 90, 0]).translate([0, 28, 57])
    bore = hole(25, 0, 14, 1).rotate([0, 90, 0]).translate([0, 28, 57])
    side_hole = hole(9, 0, 9, 0.6).rotate([0, 90, 0]).translate([0, 12, 24])
    body = body + (seat ^ stand_on_x(prism(rounded((-60, 0, 0), (0, 0, 0), (0, 78, 16), (-60, 78, 16)), 0, 30), 60))
    body = body - bore - side_hole
    for x, y in ((36, 14), (76, 14), (76, 46)):
        body -= counterbored(9, 0, 9, 15, 4).translate([x, y, 0])
    return body


def shaft_profile(steps, chamfer, fillet, grooves=()):
    """Profile (radius, z) of a stepped shaft: steps are (diameter, end z); grooves are (z, width, diameter)."""
    corners, z = [(0, 0, 0)], 0.0
    radii = [d / 2 for d, _ in steps]
    for i, (diameter, end) in enumerate(steps):
        r = diameter / 2
        before, after = (radii[i - 1] if i else 0), (radii[i + 1] if i + 1 < len(steps) else 0)
        if r > before:
            corners += [(r - chamfer, z, 0), (r, z + chamfer, 0)]
        else:
            corners.append((r, z, fillet))
        for at, width, bottom in grooves:
            if z < at < end:
                corners += [(r, at, 0), (bottom / 2, at, 0), (bottom / 2, at + width, 0), (r, at + width, 0)]
        if r > after:
            corners += [(r, end - chamfer, 0), (r - chamfer, end, 0)]
        else:
            corners.append((r, end, fillet))
        z = end
    corners.append((0, z, 0))
    return rounded(*corners)


def keyed_shaft():
    """Stepped shaft with one keyway. Axis: x, origin at the thin end."""
    steps = [(20, 24), (26, 48), (40, 57), (32, 112), (25, 136), (18, 160)]
    body = turned(shaft_profile(steps, 1.2, 1.2, grooves=[(128, 2, 22.5)]), 52)
    body -= turned([(0, 152), (2, 153), (2, 157), (5.5, 160.5), (0, 161)], 24)        # centre holes
    body -= turned([(0, -1), (5.5, -0.5), (2, 3), (2, 7), (0, 8)], 24)
    keyway = prism(slot(69, 0, 101, 0, 5), 10.5, 20)
    return body.rotate([0, 90, 0]) - keyway


def plain_shaft():
    """Turned shaft, fully rotational. Axis: z, origin at the lower end."""
    steps = [(22, 30), (30, 52), (52, 62), (38, 84), (28, 122), (20, 140)]
    return turned(shaft_profile(steps, 1.5, 1.5, grooves=[(24, 2, 19), (110, 3, 25)]), 56)


def link():
    """Lever of two eyes, hollowed on both sides alike. Origin: middle of the big eye, mid-plane."""
    start, end, fillet = np.array([0, 19.0]), np.array([108, 12.0]), 14      # the bar's upper edge
    ahead = (end - start) / np.linalg.norm(end - start)
    normal = np.array([-ahead[1], ahead[0]])

    def fillet_arc(x, radius, side):
        """Concave arc between the eye at x and the bar; side +1: the eye lies at the beginning of the bar."""
        base = start + fillet * normal - (x, 0)
        along = -base @ ahead + side * math.sqrt((base @ ahead) ** 2 - base @ base + (radius + fillet) ** 2)
        centre = base + along * ahead
        eye, bar = (math.degrees(math.atan2(v[1], v[0])) for v in (-centre, -normal))
        turn = (bar - eye + 180) % 360 - 180
        return arc(centre[0] + x, centre[1], fillet, eye, eye + turn), math.degrees(math.atan2(centre[1], centre[0]))

    (big, from_big), (small, to_small) = fillet_arc(0, 27, 1), fillet_arc(108, 19, -1)
    upper = np.vstack([arc(0, 0, 27, 180, from_big), big[1:], small[::-1], arc(108, 0, 19, to_small, 0)[1:]])[::-1]
    outline = np.vstack([upper, upper[-2:0:-1] * (1, -1)])
    body = prism(outline, -9, 9, ("round", 1.8), ("round", 1.8))
    pocket = prism(rounded((36, -10, 5), (80, -6.5, 4), (80, 6.5, 4), (36, 10, 5)), 4, 10)
    body = body - pocket - pocket.rotate([180, 0, 0])
    return body - hole(32, -9, 9, 1.2) - hole(20, -9, 9, 1.2).translate([108, 0, 0])


def t_plate():
    """T-shaped plate. Origin far from the part, as in an assembly file."""
    outline = rounded((-22, -92, 14), (22, -92, 14), (22, -18, 12), (62, -18, 9), (62, 20, 9), (-62, 20, 9),
                      (-62, -18, 9), (-22, -18, 12))
    window = slot(0, -48, 0, -22, 7)[::-1]
    body = prism([outline, window], 0, 18, ("chamfer", 1), ("chamfer", 1.5))
    for x in (-45, 45):
        body -= counterbored(11, 0, 18, 18, 8).translate([x, 1, 0])
    body -= hole(20, 0, 18, 1).translate([0, -73, 0])
    body -= hole(8, 0, 18, 0.8).translate([0, 5, 0])
    return body.translate([210, -35, 12])


def pocket_plate():
    """Milled plate with pockets of different sizes. Origin: a corner of the underside."""
    outline = rounded((0, 0, 8), (130, 0, 8), (130, 66, 4), (106, 90, 4), (0, 90, 8))
    body = prism(outline, 0, 18, ("chamfer", 1), ("chamfer", 1))
    pockets = [rounded((20, 7, 6), (60, 7, 6), (60, 38, 6), (20, 38, 6)),
               rounded((66, 7, 6), (111, 7, 6), (111, 38, 6), (66, 38, 6)),
               rounded((20, 44, 6), (48, 44, 6), (48, 83, 6), (20, 83, 6))]
    for outline_, floor in zip(pockets, (6, 11, 6)):
        body -= prism(outline_, floor, 19, bottom=("round", 1.5))
    body -= hole(30, 0, 18, 1.2).translate([78, 64, 0])
    body -= hole(40, 13, 18).translate([78, 64, 0])
    for x, y in ((10, 10), (120, 10), (10, 80), (120, 52)):
        body -= counterbored(7, 0, 18, 12, 7).translate([x, y, 0])
    return body


def flange():
    """Six-fold flange with hub and ribs. Axis: z, origin in the seating face."""
    disc = turned(rounded((0, 0, 0), (38, 0, 0), (38, 2, 0), (62, 2, 1.5), (62, 15, 1.5), (34, 15.5, 4), (28, 50, 0),
                          (26.5, 51.5, 0), (0, 51.5, 0)), 60)
    rib = web(rounded((20, 10, 0), (57, 10, 0), (57, 15.6, 0), (52, 18, 6), (29, 44, 0), (20, 44, 0)), 7, ("round", 1))
    cutter = hole(11, 2, 15, 0.8, 24).translate([49, 0, 0]) + hole(19, 14, 40, 0, 36).translate([49, 0, 0])
    body = disc
    for i in range(6):
        body += rib.rotate([0, 0, 60.0 * i])
    for i in range(6):
        body -= cutter.rotate([0, 0, 60.0 * i + 30])
    body -= hole(36, 0, 51.5, 1.5, 48)
    return body - hole(44, 40, 51.5, 0, 48)


def mount_right():
    """Handed bearing bracket. Origin on the mirror plane x = 0 of the pair."""
    edge = ("round", 1.2)
    base = prism(rounded((0, 0, 3), (84, 0, 10), (84, 26, 10), (40, 58, 10), (0, 58, 3)), 0, 9, edge, edge)
    wall = stand_on_x(prism(rounded((0, 0, 3), (58, 0, 3), (58, 28, 8), (36, 70, 16), (0, 70, 16)), 0, 9, edge, edge))
    body = base + wall
    corner = np.vstack([[(4, 4), (15, 4)], arc(15, 15, 6, 270, 180), [(4, 15)]])
    body += web(corner, 58, edge).translate([0, 29, 0])
    body += web(rounded((5, 5, 0), (48, 5, 0), (48, 9.5, 0), (40, 12, 6), (9.5, 38, 0), (5, 38, 0)), 7,
                ("round", 1)).translate([0, 47, 0])
    barrel = boss(30, 9, 30, fillet=3, edge=1.2) + boss(30, 0, 9, fillet=2.5, edge=1).rotate([180, 0, 0])
    body += barrel.rotate([0, 90, 0]).translate([0, 19, 48]) ^ \
        Manifold.cube([60, 80, 66], True).translate([20, 30, 37])
    body -= hole(17, -9, 30, 1).rotate([0, 90, 0]).translate([0, 19, 48])
    body += boss(22, 9, 14, fillet=2, edge=0.8).translate([69, 14, 0])
    body -= hole(10, 0, 14, 0.8).translate([69, 14, 0])
    body -= prism(slot(28, 40, 36, 40, 4.5), -1, 10) + prism(slot(34, 14, 44, 14, 4.5), -1, 10)
    return body.translate([28, -20, 0])


def mount_left():
    """Mirror image of mount_right in the plane x = 0."""
    return mount_right().mirror([1, 0, 0])


def elbow_100():
    """Pipe elbow of 90 degrees. Origin: where the two pipe axes meet; axes along +x and +y."""
    def leg(profile):
        along_y = turned(profile, 36).rotate([-90, 0, 0])
        return along_y + along_y.transform(np.array([[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, -1, 0]], float))

    def bend(radius):
        ring = CrossSection([circle(radius, 42, 0, 36)]).revolve(18, 90).rotate([0, 0, 180])
        return ring.translate([42, 42, 0])

    flange_ = np.vstack([[(0, 41.9), (19, 41.9)], arc(23, 49, 4, 180, 90),
                         [(35.2, 53), (36, 53.8), (36, 63.2), (35.2, 64), (0, 64)]])
    body = bend(19) + leg(flange_)
    body += boss(18, 10, 26, edge=1).rotate([0, 90, 0]).rotate([0, 0, 225]).translate([12.3, 12.3, 0])
    body -= bend(13.5) + leg([(0, 41.9), (13.5, 41.9), (13.5, 65), (0, 65)])
    body -= leg([(0, 62.5), (18, 62.5), (18, 65), (0, 65)])                              # seat of the seal
    body -= blind_hole(7, 16, 26, 0.8).rotate([0, 90, 0]).rotate([0, 0, 225]).translate([12.3, 12.3, 0])
    bolts = union(*[hole(8.5, 53, 64, 0.6, 16).translate([a * 28 * math.sqrt(.5), b * 28 * math.sqrt(.5), 0])
                    for a in (1, -1) for b in (1, -1)])
    along_y = bolts.rotate([-90, 0, 0])
    return body - along_y - along_y.transform(np.array([[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, -1, 0]], float))


def elbow_130():
    """The same elbow, 1.3 times as large in every direction."""
    return elbow_100().simplify(SIMPLIFY_MM).scale([1.3, 1.3, 1.3])


def pump_body():
    """Cast volute with two pipe stubs and a foot. Origin on the rotor axis, which runs along y."""
    def cylinder(a, b, radius):
        """Distance to a capped cylinder along one axis: (u, v) from its axis, w between two planes."""
        q = max(a - radius, b)
        return q if q < 0 else math.sqrt(max(a - radius, 0) ** 2 + max(b, 0) ** 2)

    def box(x, y, z, hx, hy, hz, r):
        qx, qy, qz = abs(x) - hx + r, abs(y) - hy + r, abs(z) - hz + r
        return math.sqrt(max(qx, 0) ** 2 + max(qy, 0) ** 2 + max(qz, 0) ** 2) + min(max(qx, qy, qz), 0) - r

    def blend(a, b, k):
        h = max(k - abs(a - b), 0.0) / k
        return min(a, b) - h * h * k / 4

    def cast(x, y, z):
        rho = math.sqrt(x * x + z * z)
        turn = (math.atan2(z, x) % (2 * math.pi)) / (2 * math.pi)
        d = math.sqrt((rho - 36 - 4 * turn) ** 2 + y * y) - (10 + 8 * turn)              # spiral casing
        out = cylinder(math.sqrt((x - 40) ** 2 + y * y), abs(z - 36) - 36, 18)           # discharge stub, up
        d = blend(d, out, min(max(z / 2, 0.01), 6))                                      # tangent where the spiral ends
        d = blend(d, cylinder(rho, abs(y) - 11, 34) - 3, 6)                              # side walls
        d = blend(d, cylinder(rho, abs(y - 30) - 30, 21), 9)                             # suction stub, +y
        d = blend(d, cylinder(rho, abs(y + 26) - 24, 24), 8)                             # bearing housing, -y
        d = blend(d, box(x - 4, y + 2, z + 38, 34, 7, 22, 6), 7)                         # webs down to the foot
        d = blend(d, box(x - 4, y + 18, z + 38, 7, 20, 22, 6), 7)
        return -d

    body = Manifold.level_set(cast, [-64.0, -54.0, -66.0, 68.0, 64.0, 76.0], 3.6, 0.0, 0.01)
    body = max(body.decompose(), key=lambda solid: solid.volume()).simplify(0.16)
    body += turned([(0, -10), (24.2, -10), (24.2, 48), (0, 48)], 56).rotate([90, 0, 0]) ^ \
        Manifold.cube([80, 30, 80], True).translate([0, -38, 0])
    rib = web(rounded((20, 2, 0), (46, 2, 0), (47, 13, 3), (36, 22, 12), (26, 40, 0), (20, 40, 0)), 6, ("round", 1.5))
    for i in (1, 3, 5, 7):                                                               # ribs behind the casing
        body += rib.rotate([0, 0, 45.0 * i]).rotate([90, 0, 0])
    body += prism(rounded((-54, -40, 10), (62, -40, 10), (62, 26, 10), (-54, 26, 10)), -64, -53, top=("chamfer", 2))
    body = body.trim_by_plane([0, 1, 0], -48)                                            # machined faces
    def stub(z_neck, neck, z0, z1, radius):
        rim = [(radius - 1, z0), (radius, z0 + 1), (radius, z1 - 1), (radius - 1, z1), (0, z1)]
        return turned(np.vstack([[(0, z_neck), (neck, z_neck)], arc(neck + 4, z0 - 4, 4, 180, 90), rim]), 56)

    body += stub(20, 21.2, 52, 62, 36).rotate([-90, 0, 0])
    body += stub(10, 18.2, 66, 76, 32).translate([40, 0, 0])
    body += boss(19, 30, 56, edge=1).rotate([0, -45, 0]).translate([0, 2, 0])            # drain boss
    body += boss(18, 10, 36, edge=1).translate([0, -34, 0])                              # oil boss
    body -= hole(28, -20, 62).rotate([-90, 0, 0])                                        # suction bore
    body -= turned([(0, -11), (30, -11), (30, 11), (0, 11)], 64).rotate([-90, 0, 0])     # impeller chamber
    body -= hole(23, 0, 76, 0).translate([40, 0, 0]).trim_by_plane([0, 0, 1], -4)
    body -= hole(18, -50, 0).rotate([-90, 0, 0])
    body -= hole(34, -49, -38).rotate([-90, 0, 0])                                       # bearing seat
    for i in range(4):
        turn = math.radians(45 + 90 * i)
        body -= hole(8, 52, 62, 0, 16).translate([28 * math.cos(turn), 28 * math.sin(turn), 0]).rotate([-90, 0, 0])
        body -= hole(7, 66, 76, 0, 16).translate([40 + 25 * math.cos(turn), 25 * math.sin(turn), 0])
    for x, y in ((-43, -29), (51, -29), (-43, 15), (51, 15)):
        body -= hole(10, -64, -53, 0, 20).translate([x, y, 0]) + hole(17, -54, -40, 0, 28).translate([x, y, 0])
    body -= blind_hole(8, 22, 36, 0.8).translate([0, -34, 0])
    body -= blind_hole(8, 44, 56, 0.8).rotate([0, -45, 0]).translate([0, 2, 0])
    return body.simplify(0.02)


PARTS = [housing, bracket, keyed_shaft, plain_shaft, link, t_plate, pocket_plate, flange, mount_left, mount_right,
         elbow_100, elbow_130, pump_body]


# --- STL -------------------------------------------------------------------------------------------------------------

def triangles_of(solid):
    """(n, 3, 3) float32 corners in a fixed order: of the part, not of how the solid was put together."""
    mesh = solid.simplify(SIMPLIFY_MM).to_mesh64()
    points = np.round(mesh.vert_properties[:, :3] / SNAP_MM) * SNAP_MM + 0.0
    points, index = np.unique(points.astype(np.float32), axis=0, return_inverse=True)
    faces = index.reshape(-1)[np.asarray(mesh.tri_verts, np.int64)]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    first = np.argmin(faces, axis=1)
    faces = faces[np.arange(len(faces))[:, None], (first[:, None] + np.arange(3)) % 3]
    faces = faces[np.lexsort((faces[:, 2], faces[:, 1], faces[:, 0]))]
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward, backward = ({tuple(e) for e in edges} for edges in (directed, directed[:, ::-1]))
    if len(forward) != len(directed) or forward != backward:
        raise SystemExit("an edge does not have exactly two triangles")
    return points[faces]


def normals_of(triangles):
    t = triangles.astype(np.float64)
    normals = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0).astype(np.float32)


def stl_bytes(name, triangles):
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["normal"], record["corners"] = normals_of(triangles), triangles
    header = f"partpose part {name}, unit mm".encode().ljust(80)
    return header + struct.pack("<I", len(triangles)) + record.tobytes()


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    dtype = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(data, dtype, count, 84)["corners"]


def measures(triangles):
    """Volume, area, box and centroid: what two meshings of one part have in common."""
    t = triangles.astype(np.float64)
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    six_volumes = np.sum(t[:, 0] * np.cross(t[:, 1], t[:, 2]), axis=1)
    area = np.linalg.norm(cross, axis=1)
    volume = six_volumes.sum() / 6
    centroid = (t.sum(axis=1) * six_volumes[:, None]).sum(axis=0) / (24 * volume)
    sizes = [volume ** (1 / 3), math.sqrt(area.sum() / 2)]
    return np.concatenate([sizes, t.min(axis=(0, 1)), t.max(axis=(0, 1)), centroid])


def check(folder, made):
    """True when the files in `made` and `folder` are the same parts."""
    good = True
    for path in sorted(made.glob("*.stl")):
        old = folder / path.name
        if not old.exists():
            print(f"{path.name}: missing in {folder}")
            good = False
        elif old.read_bytes() == path.read_bytes():
            print(f"{path.name}: same bytes")
        else:
            off = np.abs(measures(read_stl(old)) - measures(read_stl(path))).max()
            same = off < 0.02
            good &= same
            verdict = "same part, other triangles" if same else "DIFFERENT"
            print(f"{path.name}: {verdict} (largest difference {off:.4f} mm)")
    return good


def write(folder, only):
    folder.mkdir(parents=True, exist_ok=True)
    for make in PARTS:
        name = make.__name__
        if only and name not in only:
            continue
        triangles = triangles_of(make())
        (folder / f"{name}.stl").write_bytes(stl_bytes(name, triangles))
        size = np.ptp(triangles.reshape(-1, 3), axis=0)
        print(f"{name:14s} {size[0]:6.1f} x {size[1]:6.1f} x {size[2]:6.1f} mm {len(triangles):6d} triangles "
              f"{measures(triangles)[0] ** 3 / 1000:8.1f} cm3")


def main():
    parser = argparse.ArgumentParser(description="Make the CAD-like parts of the project as binary STL files (mm).")
    parser.add_argument("folder", type=Path, help="output folder (with --check: the folder to compare with)")
    parser.add_argument("--only", nargs="*", metavar="NAME", help="only these parts")
    parser.add_argument("--check", action="store_true", help="make them beside and compare; exit 1 on a difference")
    options = parser.parse_args()
    unknown = set(options.only or ()) - {make.__name__ for make in PARTS}
    if unknown:
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    if not options.check:
        write(options.folder, options.only)
        return 0
    with tempfile.TemporaryDirectory() as beside:
        write(Path(beside), options.only)
        return 0 if check(options.folder, Path(beside)) else 1


if __name__ == "__main__":
    sys.exit(main())

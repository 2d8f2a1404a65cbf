#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""make_broken_cad.py FOLDER: 45 model files that cannot be used, of all formats, and 7 good ones among them.

The good ones, a block of 20 x 30 x 40 mm each, are named good_*. Prints how many are broken and how many good.
"""
import json
import struct
import sys
import zipfile
from pathlib import Path

CUBE = [(x, y, z) for z in (0, 40) for y in (0, 30) for x in (0, 20)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]


def binary_stl(vertices=CUBE, triangles=TRIANGLES, header=b"cube", count=None):
    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(c for v in t for c in vertices[v]), 0) for t in triangles)
    return header.ljust(80) + struct.pack("<I", len(triangles) if count is None else count) + body


def ascii_stl(first="0 0 0"):
    lines = ["solid cube"]
    for t in TRIANGLES:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + (first if v == 0 else "%g %g %g" % CUBE[v]) for v in t]
        lines += ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid cube", ""])


def obj(faces=QUADS, vertices=CUBE):
    return "".join("v %s %s %s\n" % tuple(v) for v in vertices) + "".join(
        "f " + " ".join(str(v + 1) for v in f) + "\n" for f in faces)


def off(faces=QUADS, vertices=CUBE, counts=None):
    counts = counts or f"{len(vertices)} {len(faces)} 0"
    return f"OFF\n{counts}\n" + "".join("%s %s %s\n" % tuple(v) for v in vertices) + "".join(
        f"{len(f)} " + " ".join(map(str, f)) + "\n" for f in faces)


def ply(vertices=CUBE, faces=TRIANGLES, vertex_count=None):
    return (f"ply\nformat ascii 1.0\nelement vertex {vertex_count or len(vertices)}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n" +
            "".join("%s %s %s\n" % tuple(v) for v in vertices) + "".join("3 %d %d %d\n" % f for f in faces))


def model_3mf(unit="inch", triangles=TRIANGLES, scale=1 / 25.4):
    vertices = "".join('<vertex x="%.9g" y="%.9g" z="%.9g"/>' % tuple(scale * c for c in v) for v in CUBE)
    faces = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in triangles)
    return (f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xml:lang="en-US" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
            f'<object id="1" name="block" type="model"><mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles>'
            '</mesh></object></resources><build><item objectid="1"/></build></model>')


def write_3mf(path, model, name="3D/3dmodel.model"):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/'
                         'package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.'
                         'openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application'
                         '/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        archive.writestr("_rels/.rels", '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/'
                         f'package/2006/relationships"><Relationship Target="/{name}" Id="rel0" Type="http://schemas.'
                         'microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        archive.writestr(name, model)


def say_size(path, size):
    """Both places of the archive where the sizes of its files stand say that each will be so large."""
    archive = bytearray(path.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        at = archive.find(signature)
        while at >= 0:
            archive[at + offset:at + offset + 4] = struct.pack("<I", size)
            at = archive.find(signature, at + 4)
    path.write_bytes(archive)


def glb(scale=1e-3, buffer_bytes=None, indices=None):
    flat = [i for t in TRIANGLES for i in t] if indices is None else indices
    points = b"".join(struct.pack("<3f", *(scale * c for c in v)) for v in CUBE)
    data = points + b"".join(struct.pack("<H", i) for i in flat)
    data += b"\0" * (-len(data) % 4)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "block"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": buffer_bytes or len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": 2 * len(flat)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(CUBE), "type": "VEC3",
                       "min": [0, 0, 0], "max": [20 * scale, 30 * scale, 40 * scale]},
                      {"bufferView": 1, "componentType": 5123, "count": len(flat), "type": "SCALAR"}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


STEP = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('empty','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
%s
ENDSEC;
END-ISO-10303-21;
"""


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    nan = [(float("nan"), 0, 0)] + CUBE[1:]
    whole = binary_stl()
    files = {
        "good_binary.stl": whole,
        "good_solid_header.stl": binary_stl(header=b"solid exported by a program that cannot know better"),
        "good_obj.obj": obj(), "good_off.off": off(), "good_ply.ply": ply(), "good_gltf.glb": glb(),
        "01_empty.stl": b"",
        "02_truncated.stl": whole[:-60],
        "03_longer_than_it_says.stl": whole + b"\0" * 25,
        "04_huge_count.stl": binary_stl(count=4_000_000_000),
        "05_no_triangles.stl": binary_stl(triangles=[]),
        "06_nan.stl": binary_stl(vertices=nan),
        "07_no_area.stl": binary_stl(triangles=[(0, 0, 1), (2, 2, 2)]),
        "08_far_away.stl": binary_stl(vertices=[(3e9, 0, 0)] + CUBE[1:]),
        "09_text.stl": "This is no model but a note about one.\n" * 9,
        "10_word_for_number.stl": ascii_stl(first="0 zero 0"),
        "11_cut_text.stl": ascii_stl()[:400],
        "12_web_page.stl": "<!DOCTYPE html><html><body>404 Not Found</body></html>\n" * 4,
        "13_empty.step": b"",
        "14_stl_in_disguise.step": whole,
        "15_truncated.step": STEP[:180],
        "16_no_solids.stp": STEP % "#1=CARTESIAN_POINT('',(0.,0.,0.));",
        "17_garbage_entities.step": STEP % "#1=MANIFOLD_SOLID_BREP('',#77);\n#2=(((;\n#3=PRODUCT(",
        "18_face_without_vertex.obj": obj(faces=[(0, 1, 999)]),
        "19_points_only.obj": obj(faces=[]),
        "20_negative_index.obj": obj() + "f -1 -2 -99\n",
        "21_nan.obj": obj(vertices=[("nan", 0, 0)] + CUBE[1:]),
        "22_wrong_magic.off": off().replace("OFF", "FOO", 1),
        "23_face_without_vertex.off": off(faces=[(0, 1, 999)]),
        "24_huge_counts.off": off(counts="4000000000 4000000000 0"),
        "25_huge_count.ply": ply(vertex_count=4_000_000_000),
        "26_cloud.ply": ply(faces=[]),
        "27_truncated.glb": glb()[:-100],
        "28_index_beyond.glb": glb(indices=[0, 1, 60000]),
        "29_no_archive.3mf": "PK, it says, but it is no archive",
        "32_header_lies.ply": ply().replace("format ascii", "format binary_little_endian"),
        "33_fewer_faces_than_it_says.ply": ply().replace(f"element face {len(TRIANGLES)}", "element face 4000"),
        "34_no_header_end.ply": ply().split("end_header")[0],
        "35_index_beyond.ply": ply(faces=[(0, 1, 99)]),
        "36_stl_in_disguise.ply": whole,
        "37_ply_in_disguise.stl": ply(),
        "38_absurd_size.obj": obj(vertices=[(1e30, 0, 0)] + CUBE[1:]),
        "39_infinite.off": off(vertices=[("inf", 0, 0)] + CUBE[1:]),
        "40_all_in_one_point.stl": binary_stl(vertices=[(5, 5, 5)] * 8),
        "41_zeros.step": b"\0" * 4096,
        "42_binary_noise.3mf": bytes((37 * i * i + 11 * i) % 251 for i in range(4096)),
        "43_not_even_json.gltf": "{ \"asset\": { \"version\": ",
    }
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    write_3mf(folder / "30_unknown_unit.3mf", model_3mf(unit="cubit"))
    write_3mf(folder / "44_bomb.3mf", model_3mf())
    say_size(folder / "44_bomb.3mf", 4_000_000_000)
    (folder / "45_cut_in_a_number.stl").write_text(ascii_stl()[:-len("endloop\nendfacet\nendsolid cube\n") - 3])
    write_3mf(folder / "good_3mf.3mf", model_3mf())
    link = folder / "31_link_to_nowhere.stl"
    link.unlink(missing_ok=True)
    link.symlink_to("nowhere.stl")
    names = [path.name for path in folder.iterdir()]
    print(sum(not name.startswith("good") for name in names), sum(name.startswith("good") for name in names))


if __name__ == "__main__":
    main()

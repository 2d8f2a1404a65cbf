#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""make_step.py FILE...: STEP files (AP214, mm) of an angle with two legs, one product of one solid, named as the file."""
import sys
from pathlib import Path

OUTLINE = [(0, 0), (80, 0), (80, 10), (12, 10), (12, 50), (0, 50)]  # mm, counterclockwise
WIDTH_MM = 30

FRAME = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('{name}','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('{name}','{name}','',(#3));
#5=PRODUCT_DEFINITION_FORMATION('','',#4);
#6=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#7=PRODUCT_DEFINITION('','',#5,#6);
#8=PRODUCT_DEFINITION_SHAPE('','',#7);
#9=SHAPE_DEFINITION_REPRESENTATION(#8,#10);
#10=FACETED_BREP_SHAPE_REPRESENTATION('',(#20,#30),#11);
#11=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#15))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#12,#13,#14)) REPRESENTATION_CONTEXT('',''));
#12=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));
#13=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
#14=(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT());
#15=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#12,'distance_accuracy_value','');
#20=AXIS2_PLACEMENT_3D('',#21,#22,#23);
#21=CARTESIAN_POINT('',(0.,0.,0.));
#22=DIRECTION('',(0.,0.,1.));
#23=DIRECTION('',(1.,0.,0.));
#30=FACETED_BREP('{name}',#31);
{solid}
ENDSEC;
END-ISO-10303-21;
"""


def solid():
    """#31, a closed shell of the faces of the outline pushed along z."""
    count = len(OUTLINE)
    points = [(x, y, z) for z in (0, WIDTH_MM) for x, y in OUTLINE]
    sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    faces = [tuple(reversed(range(count))), tuple(range(count, 2 * count)), *sides]
    lines = ["#%d=CARTESIAN_POINT('',(%.1f,%.1f,%.1f));" % (100 + i, *p) for i, p in enumerate(points)]
    for i, face in enumerate(faces):
        loop, bound, plane = 200 + 10 * i, 201 + 10 * i, 202 + 10 * i
        a, b, c = (points[face[k]] for k in (0, 1, 2))
        u = [q - p for p, q in zip(a, b)]
        v = [q - p for p, q in zip(b, c)]
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        length, along = sum(x * x for x in normal) ** 0.5, sum(x * x for x in u) ** 0.5
        lines += [
            "#%d=POLY_LOOP('',(%s));" % (loop, ",".join(f"#{100 + k}" for k in face)),
            "#%d=FACE_OUTER_BOUND('',#%d,.T.);" % (bound, loop),
            "#%d=PLANE('',#%d);" % (plane, plane + 1),
            "#%d=AXIS2_PLACEMENT_3D('',#%d,#%d,#%d);" % (plane + 1, 100 + face[0], plane + 2, plane + 3),
            "#%d=DIRECTION('',(%.6f,%.6f,%.6f));" % (plane + 2, *(x / length for x in normal)),
            "#%d=DIRECTION('',(%.6f,%.6f,%.6f));" % (plane + 3, *(x / along for x in u)),
            "#%d=FACE_SURFACE('',(#%d),#%d,.T.);" % (plane + 4, bound, plane),
        ]
    shell = ",".join(f"#{206 + 10 * i}" for i in range(len(faces)))
    return "\n".join([f"#31=CLOSED_SHELL('',({shell}));", *lines])


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for file in map(Path, sys.argv[1:]):
        file.write_text(FRAME.format(name=file.stem, solid=solid()))


if __name__ == "__main__":
    main()

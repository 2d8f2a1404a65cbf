# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import partpose

recognizer = partpose.Engine.from_files(["parts/"])
scene = partpose.read_scene("scenes/bracket.png")  # or your own: a depth array and its partpose.Intrinsics
assert scene.depth is not None and scene.intrinsics is not None
found = recognizer.recognize(scene.depth.z_mm, scene.intrinsics)
if found:
    print(f"{found.part}, score {found.score:.2f}, {len(found.equivalent_poses())} equivalent pose(s)")
    print(found.camera_from_model)
else:
    print("nothing recognized:", found.reason)

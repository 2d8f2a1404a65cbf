// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What several peers share, so that no one is judged or slowed down by another's version of it: plain C, for Python
// too. Lengths in mm, camera frame x right, y down, z forward; poses are camera_from_model, 16 numbers row by row.
#pragma once

#define PEERS_API __attribute__((visibility("default")))

extern "C" {

typedef struct {
  int width, height;
  double fx, fy, cx, cy;
} PeersCamera;

/// A part's mesh. Null, with a message on standard error, when the file cannot be read.
PEERS_API void* peers_load_part(const char* stl);
/// Evenly over the surface: x, y, z and the triangle's normal of each point.
PEERS_API void peers_sample_surface(const void* part, int count, float* points_and_normals);

/// The frame as the verification sees it: half its resolution, the neighbourhood of the object. `object_xyz` are the
/// points that the peer took for the object; none (null): all that is measured. Depths `tolerance_mm` apart disagree.
PEERS_API void* peers_open_frame(const PeersCamera* camera, const float* depth_mm, const float* object_xyz, int count,
                                 double tolerance_mm);
PEERS_API void peers_close_frame(void* frame);
/// How well the part at this pose explains the object and the object the part, 0 to 1: rendered with a z-buffer.
PEERS_API double peers_two_sided(const void* part, const void* frame, const double* camera_from_model);

/// GOOD (PCL has none): 108 bins and a reference frame (camera_from_reference) for each description, at most `most`.
/// `ambiguous`: one description for each plausible frame, where signs are in doubt. Returns how many there are.
PEERS_API int peers_good(const float* xyz, int count, int bins, double threshold_mm, int ambiguous, int most,
                         float* histograms, double* frames);

/// For libraries without these steps: the object's points with normals (6 numbers each): voxel grid, the plane taken
/// away (`plane_mm` > 0), lone points and clusters that do not stand on it dropped, normals within `radius_mm` turned
/// to the camera. Returns how many, at most `most`.
PEERS_API int peers_object_cloud(const PeersCamera* camera, const float* depth_mm, double plane_mm, double voxel_mm,
                                 double radius_mm, int most, float* points_and_normals);

}  // extern "C"

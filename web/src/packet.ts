// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Undoes src/partpose/report/packet.cpp.
import type { CloudSection, DepthSection, MeshSection } from './data';

export interface Cloud {
  points: Float32Array; // x y z, camera frame, mm
  normals: Float32Array | null;
  of: number; // points that were saved; more than are here when they were thinned
}

export interface Mesh {
  points: Float32Array; // x y z, model frame, mm
  triangles: Uint32Array;
}

export interface Depth {
  width: number;
  height: number;
  z: Float32Array; // mm, 0: nothing measured
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

/** High bytes, then low bytes, of `count` values. */
function planes(bytes: Uint8Array, offset: number, count: number): Uint16Array {
  const out = new Uint16Array(count);
  for (let i = 0; i < count; ++i) out[i] = (bytes[offset + i] << 8) | bytes[offset + count + i];
  return out;
}

function coordinates(bytes: Uint8Array, offset: number, count: number, lo: number[], size: number[]): Float32Array {
  const out = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; ++axis) {
    const differences = planes(bytes, offset + axis * 2 * count, count);
    let level = 0;
    for (let i = 0; i < count; ++i) {
      level = (level + differences[i]) & 0xffff;
      out[3 * i + axis] = lo[axis] + (size[axis] * level) / 65535;
    }
  }
  return out;
}

export function decodeCloud(bytes: Uint8Array, section: CloudSection): Cloud {
  const { offset, count } = section;
  const points = coordinates(bytes, offset, count, section.lo, section.size);
  if (!section.normals) return { points, normals: null, of: section.of };
  const normals = new Float32Array(3 * count);
  const at = offset + 6 * count;
  for (let i = 0; i < count; ++i) {
    let x = bytes[at + i] / 127.5 - 1;
    let y = bytes[at + count + i] / 127.5 - 1;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) {
      const fold = 1 - Math.abs(y);
      y = (1 - Math.abs(x)) * (y < 0 ? -1 : 1);
      x = fold * (x < 0 ? -1 : 1);
    }
    const length = Math.hypot(x, y, z) || 1;
    normals.set([x / length, y / length, z / length], 3 * i);
  }
  return { points, normals, of: section.of };
}

export function decodeDepth(bytes: Uint8Array, section: DepthSection): Depth {
  const { width, height } = section;
  const units = planes(bytes, section.offset, width * height);
  for (let v = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u) {
      const i = v * width + u;
      const left = u > 0 ? units[i - 1] : 0;
      const above = v > 0 ? units[i - width] : 0;
      const corner = u > 0 && v > 0 ? units[i - width - 1] : 0;
      const lower = Math.min(left, above);
      const upper = Math.max(left, above);
      units[i] += corner >= upper ? lower : corner <= lower ? upper : left + above - corner;
    }
  }
  const [fx, fy, cx, cy] = section.camera;
  return { width, height, z: Float32Array.from(units, (unit) => unit * section.unit_mm), fx, fy, cx, cy };
}

export function decodeMesh(bytes: Uint8Array, section: MeshSection): Mesh {
  const points = coordinates(bytes, section.offset, section.vertices, section.lo, section.size);
  const corners = 3 * section.triangles;
  const at = section.offset + 6 * section.vertices;
  const high = planes(bytes, at, corners);
  const low = planes(bytes, at + 2 * corners, corners);
  const triangles = new Uint32Array(corners);
  let last = 0;
  for (let i = 0; i < corners; ++i) triangles[i] = last = (last + ((high[i] << 16) | low[i])) >>> 0;
  return { points, triangles };
}

/** At most about `most` points of a depth image. */
export function unproject(depth: Depth, most: number): Cloud {
  let measured = 0;
  for (const z of depth.z) if (z > 0) ++measured;
  const step = Math.max(1, Math.ceil(Math.sqrt(measured / most)));
  const points: number[] = [];
  for (let v = 0; v < depth.height; v += step)
    for (let u = 0; u < depth.width; u += step) {
      const z = depth.z[v * depth.width + u];
      if (z > 0) points.push(((u - depth.cx) / depth.fx) * z, ((v - depth.cy) / depth.fy) * z, z);
    }
  return { points: new Float32Array(points), normals: null, of: measured };
}

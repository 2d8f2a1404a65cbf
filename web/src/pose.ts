// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import type { Rows } from './data';

/** Angle between two rotations in degrees (equation 2.2 of the reference). */
export function rotationError(a: Rows, b: Rows): number {
  let trace = 0;
  for (let r = 0; r < 3; ++r) for (let c = 0; c < 3; ++c) trace += a[4 * r + c] * b[4 * r + c];
  return (Math.acos(Math.max(-1, Math.min(1, (trace - 1) / 2))) * 180) / Math.PI;
}

/** Distance between two origins in mm (equation 2.3 of the reference). */
export function translationError(a: Rows, b: Rows): number {
  return Math.hypot(a[3] - b[3], a[7] - b[7], a[11] - b[11]);
}

export function transform(rows: Rows, points: Float32Array): Float32Array {
  const out = new Float32Array(points.length);
  for (let i = 0; i < points.length; i += 3)
    for (let r = 0; r < 3; ++r)
      out[i + r] =
        rows[4 * r] * points[i] + rows[4 * r + 1] * points[i + 1] + rows[4 * r + 2] * points[i + 2] + rows[4 * r + 3];
  return out;
}

export function inverse(a: Rows): Rows {
  const out = [a[0], a[4], a[8], 0, a[1], a[5], a[9], 0, a[2], a[6], a[10], 0];
  for (let r = 0; r < 3; ++r) out[4 * r + 3] = -(out[4 * r] * a[3] + out[4 * r + 1] * a[7] + out[4 * r + 2] * a[11]);
  return out;
}

export function product(a: Rows, b: Rows): Rows {
  const out: Rows = [];
  for (let r = 0; r < 3; ++r)
    for (let c = 0; c < 4; ++c)
      out.push(a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c] + a[4 * r + 2] * b[8 + c] + (c === 3 ? a[4 * r + 3] : 0));
  return out;
}

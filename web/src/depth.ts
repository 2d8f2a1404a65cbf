// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import type { Depth, Mesh } from './packet';
import type { Rows } from './data';
import { transform } from './pose';

export interface Rendered {
  z: Float32Array; // mm, 0: no part
  shade: Float32Array; // 0 to 1: how much the face looks at the camera
}

/** The mesh's depth at a pose, in the camera of a depth image; exact at pixel centres. */
export function rasterize(mesh: Mesh, pose: Rows, camera: Depth): Rendered {
  const { width, height, fx, fy, cx, cy } = camera;
  const z = new Float32Array(width * height);
  const shade = new Float32Array(width * height);
  const p = transform(pose, mesh.points);
  for (let t = 0; t < mesh.triangles.length; t += 3) {
    const [a, b, c] = [3 * mesh.triangles[t], 3 * mesh.triangles[t + 1], 3 * mesh.triangles[t + 2]];
    if (p[a + 2] <= 1 || p[b + 2] <= 1 || p[c + 2] <= 1) continue;
    const [ua, va] = [(fx * p[a]) / p[a + 2] + cx, (fy * p[a + 1]) / p[a + 2] + cy];
    const [ub, vb] = [(fx * p[b]) / p[b + 2] + cx, (fy * p[b + 1]) / p[b + 2] + cy];
    const [uc, vc] = [(fx * p[c]) / p[c + 2] + cx, (fy * p[c + 1]) / p[c + 2] + cy];
    const area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va);
    if (area === 0) continue;
    const nx = (p[b + 1] - p[a + 1]) * (p[c + 2] - p[a + 2]) - (p[b + 2] - p[a + 2]) * (p[c + 1] - p[a + 1]);
    const ny = (p[b + 2] - p[a + 2]) * (p[c] - p[a]) - (p[b] - p[a]) * (p[c + 2] - p[a + 2]);
    const nz = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
    const facing = Math.abs(nz) / (Math.hypot(nx, ny, nz) || 1);
    const uMin = Math.max(0, Math.ceil(Math.min(ua, ub, uc)));
    const uMax = Math.min(width - 1, Math.floor(Math.max(ua, ub, uc)));
    const vMin = Math.max(0, Math.ceil(Math.min(va, vb, vc)));
    const vMax = Math.min(height - 1, Math.floor(Math.max(va, vb, vc)));
    for (let v = vMin; v <= vMax; ++v) {
      for (let u = uMin; u <= uMax; ++u) {
        const wa = ((ub - u) * (vc - v) - (uc - u) * (vb - v)) / area;
        const wb = ((uc - u) * (va - v) - (ua - u) * (vc - v)) / area;
        const wc = 1 - wa - wb;
        if (wa < 0 || wb < 0 || wc < 0) continue;
        // 1/z is linear in the image.
        const depth = 1 / (wa / p[a + 2] + wb / p[b + 2] + wc / p[c + 2]);
        const i = v * width + u;
        if (z[i] === 0 || depth < z[i]) {
          z[i] = depth;
          shade[i] = facing;
        }
      }
    }
  }
  return { z, shade };
}

/** What is nearest at each pixel. */
export function nearest(all: Rendered[]): Rendered {
  const [out, ...others] = all;
  for (const { z, shade } of others)
    for (let i = 0; i < z.length; ++i)
      if (z[i] > 0 && (out.z[i] === 0 || z[i] < out.z[i])) [out.z[i], out.shade[i]] = [z[i], shade[i]];
  return out;
}

/** Each pixel the mean of those around it that are no further than 10 mm off: noise would hide the relief. */
function smoothed(depth: Depth): Depth {
  const { width, height, z } = depth;
  const out = new Float32Array(z.length);
  for (let v = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u) {
      const i = v * width + u;
      if (z[i] === 0) continue;
      let [sum, count] = [0, 0];
      for (let dv = v > 0 ? -1 : 0; dv <= (v < height - 1 ? 1 : 0); ++dv)
        for (let du = u > 0 ? -1 : 0; du <= (u < width - 1 ? 1 : 0); ++du) {
          const near = z[i + dv * width + du];
          if (near > 0 && Math.abs(near - z[i]) < 10) [sum, count] = [sum + near, count + 1];
        }
      out[i] = sum / count;
    }
  }
  return { ...depth, z: out };
}

/** How much the measured surface looks at the camera, 0 to 1, from differences of neighbours no further than 20 mm apart. */
function relief(depth: Depth, i: number, u: number): number {
  const { z, width, height } = depth;
  const here = z[i];
  const slope = (before: number, after: number, insideBefore: boolean, insideAfter: boolean): number => {
    const near = (j: number) => z[j] > 0 && Math.abs(z[j] - here) < 20;
    if (insideBefore && insideAfter && near(before) && near(after)) return (z[after] - z[before]) / 2;
    if (insideAfter && near(after)) return z[after] - here;
    if (insideBefore && near(before)) return here - z[before];
    return 0;
  };
  const pixel = here / depth.fx; // mm
  const dx = slope(i - 1, i + 1, u > 0, u < width - 1) / pixel;
  const dy = slope(i - width, i + width, i >= width, i < width * (height - 1)) / pixel;
  // Light from above left.
  return Math.max(0, Math.min(1, (0.85 + 0.35 * dx + 0.35 * dy) / Math.hypot(dx, dy, 1)));
}

const gap = 5; // mm

/**
 * The measured depth as a grey relief, nothing measured: black (dark) or white-grey; over it the part: orange where it
 * agrees, red where it lies more than 5 mm before what was measured, blue where more than 5 mm behind.
 */
export function paint(canvas: HTMLCanvasElement, depth: Depth, part: Rendered | null, truth: Rendered | null): void {
  const { width, height, z } = depth;
  const smooth = smoothed(smoothed(depth));
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  if (!context) return;
  const image = context.createImageData(width, height);
  const put = (i: number, r: number, g: number, b: number) => {
    image.data[4 * i] = r;
    image.data[4 * i + 1] = g;
    image.data[4 * i + 2] = b;
    image.data[4 * i + 3] = 255;
  };
  const edge = (of: Rendered, i: number, u: number): boolean =>
    of.z[i] > 0 &&
    (u === 0 || u === width - 1 || i < width || i >= width * (height - 1) ||
      of.z[i - 1] === 0 || of.z[i + 1] === 0 || of.z[i - width] === 0 || of.z[i + width] === 0);
  for (let v = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u) {
      const i = v * width + u;
      const grey = z[i] > 0 ? 40 + 190 * relief(smooth, i, u) : 0;
      if (truth && edge(truth, i, u)) put(i, 60, 210, 110);
      else if (part && edge(part, i, u)) put(i, 255, 214, 120);
      else if (part && part.z[i] > 0) {
        const light = 0.35 + 0.65 * part.shade[i];
        if (z[i] === 0) put(i, 170 * light, 120 * light, 60 * light);
        else if (part.z[i] < z[i] - gap) put(i, 230 * light, 60 * light, 50 * light);
        else if (part.z[i] > z[i] + gap) put(i, 70 * light, 110 * light, 235 * light);
        else put(i, 250 * light, 150 * light, 40 * light);
      } else put(i, grey, grey, grey);
    }
  }
  context.putImageData(image, 0, 0);
}

// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The ways to judge a pose, by what the evaluation holds.
import type { FrameRow, Index } from './data';

/** Below all of those that a measure looks at a pose is right. */
export interface Limits {
  percent: number; // of the diameter
  deg: number;
  mm: number;
}

/** A figure that a measure looks at. */
export interface PoseFigure {
  key: string; // names it in the glossary
  label: string;
  unit: string; // as in words: "1.5 mm", "20°"
  limit: keyof Limits;
  value: (row: FrameRow) => number | undefined;
}

export interface Measure {
  name: string;
  figures: PoseFigure[];
  upToSight: boolean; // right as well: part and pose that the camera cannot tell from the true ones
}

/** Those that this report's frames have; first the one that the command line counts by: experiments by MSSD, `captured` up to
 * symmetry, `evaluate` by the plain errors. */
export function measuresOf(index: Index): Measure[] {
  const keys = new Set(index.frames.flatMap((row) => Object.keys(row.figures ?? {})));
  const measures: Measure[] = [];
  for (const deg of keys) {
    if (!/rotation_error.*_deg$/.test(deg)) continue;
    const mm = deg.replace('rotation_error', 'translation_error').replace(/_deg$/, '_mm');
    if (!keys.has(mm)) continue;
    const kind = deg.replace('rotation_error', '').replace(/_deg$/, '').replaceAll('_', ' ').trim();
    const of = (key: string) => (row: FrameRow) => row.figures?.[key];
    measures.push({
      name: kind === '' ? 'symmetry ignored' : kind === 'symmetric' ? 'up to symmetry' : kind,
      upToSight: false,
      figures: [
        { key: deg, label: `rotation \u00b0${kind && ` ${kind}`}`, unit: '\u00b0', limit: 'deg', value: of(deg) },
        { key: mm, label: `translation mm${kind && ` ${kind}`}`, unit: ' mm', limit: 'mm', value: of(mm) },
      ],
    });
  }
  const plain = (measure: Measure) => measure.figures[0].key === 'rotation_error_deg';
  measures.sort((a, b) => Number(plain(a)) - Number(plain(b)));
  if (keys.has('mssd_mm') && keys.has('diameter_mm'))
    measures.splice(index.experiment ? 0 : measures.length, 0, {
      name: 'up to symmetry and sight',
      upToSight: true,
      figures: [{
        key: 'mssd_percent', label: 'MSSD %', unit: ' % of the diameter', limit: 'percent',
        value: ({ figures }) => (figures?.mssd_mm === undefined || !figures.diameter_mm ? undefined : (100 * figures.mssd_mm) / figures.diameter_mm),
      }],
    });
  return measures;
}

/** What a right pose is, in words that follow "A pose is right ...". */
export function definition(measure: Measure, limits: Limits): string {
  const below = measure.figures.map((f) => `${limits[f.limit]}${f.unit}`).join(' and ');
  return measure.upToSight
    ? `with an MSSD below ${below}, which knows the part\u2019s symmetry, or where the camera cannot tell part and pose from the true ones`
    : `below ${below} (${measure.name})`;
}

/** How poses are judged. */
export interface Judgement {
  measure: Measure | undefined;
  limits: Limits;
}

export type PoseVerdict = 'right' | 'off' | undefined;

/** By the figures alone. */
export function isBelow(row: FrameRow, measure: Measure, limits: Limits): PoseVerdict {
  const values = measure.figures.map((f) => f.value(row));
  if (values.includes(undefined)) return undefined;
  return measure.figures.every((f, i) => values[i]! < limits[f.limit]) ? 'right' : 'off';
}

/**
 * Whether the pose is right; undefined: there is none to judge. Where none of the parts is shown, to recognize none is
 * right; of a part that was left out of the catalogue there is nothing to judge.
 */
export function poseVerdict(row: FrameRow, { measure, limits }: Judgement): PoseVerdict {
  if (!measure || row.truth === undefined || row.left_out) return undefined;
  if (measure.upToSight && row.flags?.indistinguishable) return 'right';
  if (row.verdict !== 'correct') return undefined;
  if (row.truth === '') return 'right';
  return isBelow(row, measure, limits);
}

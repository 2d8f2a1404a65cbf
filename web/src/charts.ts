// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import { h, svg } from './dom';
import { number } from './words';

export interface Distribution {
  low: number; // whisker: the least value within 1.5 interquartile ranges of the box
  q1: number;
  median: number;
  q3: number;
  high: number;
  outliers: number[];
  count: number;
}

/** Linear interpolation between the order statistics (Hyndman and Fan 1996, type 7). `sorted` is not empty. */
export function quantile(sorted: number[], share: number): number {
  const at = share * (sorted.length - 1);
  const below = Math.floor(at);
  return sorted[below] + (at - below) * ((sorted[below + 1] ?? sorted[below]) - sorted[below]);
}

/** Box and whiskers (Tukey 1977). */
export function distribution(values: number[]): Distribution | null {
  if (values.length === 0) return null;
  const sorted = [...values].sort((a, b) => a - b);
  const [q1, median, q3] = [0.25, 0.5, 0.75].map((share) => quantile(sorted, share));
  const reach = 1.5 * (q3 - q1);
  const inside = sorted.filter((x) => x >= q1 - reach && x <= q3 + reach);
  return {
    low: inside[0], q1, median, q3, high: inside[inside.length - 1],
    outliers: sorted.filter((x) => x < q1 - reach || x > q3 + reach),
    count: sorted.length,
  };
}

/** About `count` round numbers from 0 (or a power of ten) to `max`. */
function linearTicks(max: number, count: number): number[] {
  const raw = max / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw) ?? raw;
  const ticks: number[] = [];
  for (let i = 0; i * step <= max * 1.0001; ++i) ticks.push(i * step);
  return ticks;
}

export interface Box {
  label: string;
  values: number[];
  onclick?: () => void;
}

/** Horizontal boxes, one a row. `limit` is drawn as a dashed line. */
export function boxPlot(boxes: Box[], unit: string, options: { log?: boolean; limit?: number } = {}): Element {
  const rows = boxes.map((box) => ({ ...box, d: distribution(box.values) })).filter((row) => row.d);
  if (rows.length === 0) return h('p', { class: 'quiet' }, 'no values were saved');
  const all = rows.flatMap((row) => row.values);
  const positive = all.filter((x) => x > 0);
  const log = options.log === true && positive.length > 0;
  const max = Math.max(...all.map((x) => x), options.limit ?? 0, 1e-9) * 1.03;
  const min = log ? Math.max(Math.min(...positive), max * 1e-6) / 1.2 : 0;
  const labelWidth = Math.min(290, 14 + 6.6 * Math.max(...rows.map((row) => row.label.length)));
  const [width, rowHeight, top] = [640, 26, 8];
  const right = width - 56;
  const x = (value: number) => {
    const share = log ? Math.log(Math.max(value, min) / min) / Math.log(max / min) : value / max;
    return labelWidth + share * (right - labelWidth);
  };
  const ticks = log
    ? Array.from({ length: 12 }, (_, i) => 10 ** (Math.ceil(Math.log10(min)) + i)).filter((t) => t <= max)
    : linearTicks(max, 6);
  const height = top + rows.length * rowHeight + 34;
  const bottom = top + rows.length * rowHeight;
  const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'chart', role: 'img' });
  for (const tick of ticks) {
    picture.append(
      svg('line', { x1: x(tick), x2: x(tick), y1: top, y2: bottom, class: 'grid' }),
      svg('text', { x: x(tick), y: bottom + 15, class: 'tick', 'text-anchor': 'middle' }, number(tick)),
    );
  }
  picture.append(svg('text', { x: (labelWidth + right) / 2, y: bottom + 30, class: 'tick', 'text-anchor': 'middle' }, unit));
  if (options.limit !== undefined)
    picture.append(svg('line', { x1: x(options.limit), x2: x(options.limit), y1: top, y2: bottom, class: 'limit' }));
  rows.forEach((row, i) => {
    const d = row.d!;
    const y = top + i * rowHeight + rowHeight / 2;
    const label = row.label.length > 42 ? `${row.label.slice(0, 20)}\u2026${row.label.slice(-20)}` : row.label; // both ends tell
    const group = svg(
      'g',
      {
        class: row.onclick ? 'box clickable' : 'box',
        tip: `${row.label}: median ${number(d.median)}, half of all between ${number(d.q1)} and ${number(d.q3)}, ` +
          `whiskers ${number(d.low)} to ${number(d.high)}, ${d.outliers.length} outliers; ${d.count} values (${unit})`,
        onclick: row.onclick,
      },
      svg('rect', { x: 0, y: y - rowHeight / 2, width, height: rowHeight, class: 'hit' }),
      svg('text', { x: labelWidth - 8, y: y + 4, 'text-anchor': 'end' }, label),
      svg('line', { x1: x(d.low), x2: x(d.high), y1: y, y2: y, class: 'whisker' }),
      svg('line', { x1: x(d.low), x2: x(d.low), y1: y - 4, y2: y + 4, class: 'whisker' }),
      svg('line', { x1: x(d.high), x2: x(d.high), y1: y - 4, y2: y + 4, class: 'whisker' }),
      svg('rect', { x: x(d.q1), y: y - 7, width: Math.max(1, x(d.q3) - x(d.q1)), height: 14, class: 'quartiles' }),
      svg('line', { x1: x(d.median), x2: x(d.median), y1: y - 7, y2: y + 7, class: 'median' }),
      svg('text', { x: right + 8, y: y + 4, class: 'tick' }, `n ${d.count}`),
    );
    // Of very many outliers those that can be told apart on the picture.
    for (const at of new Set(d.outliers.map((value) => Math.round(x(value)))))
      group.append(svg('circle', { cx: at, cy: y, r: 2.2, class: 'outlier' }));
    picture.append(group);
  });
  return picture;
}

/** One bar a row, as wide as its value. */
export function bars(rows: { label: string; value: number; note: string; tip?: string }[], unit: string): Element {
  if (rows.length === 0) return h('p', { class: 'quiet' }, 'not saved');
  const max = Math.max(...rows.map((row) => row.value), 1e-9);
  const [width, rowHeight, left, right] = [420, 20, 150, 330];
  const picture = svg('svg', { viewBox: `0 0 ${width} ${rows.length * rowHeight + 4}`, class: 'chart', role: 'img' });
  rows.forEach((row, i) => {
    const y = i * rowHeight + rowHeight / 2;
    picture.append(
      svg(
        'g', { tip: row.tip ?? `${row.label}: ${number(row.value)} ${unit}` },
        svg('rect', { x: 0, y: y - rowHeight / 2, width, height: rowHeight, class: 'hit' }),
        svg('text', { x: left - 8, y: y + 4, 'text-anchor': 'end' }, row.label),
        svg('rect', { x: left, y: y - 6, width: Math.max(1, (row.value / max) * (right - left)), height: 12, class: 'quartiles' }),
        svg('text', { x: right + 6, y: y + 4, class: 'tick' }, row.note),
      ),
    );
  });
  return picture;
}

/** Shares of right and false accepts for every threshold on a score. */
export interface AcceptCurve {
  threshold: number;
  right: number;
  wrong: number;
}

/** `parts`: score of the best candidate and whether it names the part shown; `others`: of scenes that show none. */
export function acceptCurve(parts: { score: number; right: boolean }[], others: number[]): AcceptCurve[] {
  const thresholds = [...new Set([...parts.map((p) => p.score), ...others, 0])].sort((a, b) => b - a);
  return thresholds.map((threshold) => ({
    threshold,
    right: parts.filter((p) => p.right && p.score >= threshold).length / parts.length,
    wrong: others.filter((score) => score >= threshold).length / others.length,
  }));
}

/** Right accepts over false accepts, a step for each score. */
export function acceptPlot(curve: AcceptCurve[]): Element {
  const [left, top, size] = [50, 10, 260];
  const x = (share: number) => left + share * size;
  const y = (share: number) => top + (1 - share) * size;
  const picture = svg('svg', { viewBox: `0 0 ${left + size + 30} ${top + size + 40}`, class: 'chart accepts', role: 'img' });
  for (const tick of [0, 0.25, 0.5, 0.75, 1])
    picture.append(
      svg('line', { x1: x(tick), x2: x(tick), y1: y(0), y2: y(1), class: 'grid' }),
      svg('line', { x1: x(0), x2: x(1), y1: y(tick), y2: y(tick), class: 'grid' }),
      svg('text', { x: x(tick), y: y(0) + 15, class: 'tick', 'text-anchor': 'middle' }, `${100 * tick}`),
      svg('text', { x: x(0) - 6, y: y(tick) + 4, class: 'tick', 'text-anchor': 'end' }, `${100 * tick}`));
  picture.append(
    svg('text', { x: x(0.5), y: y(0) + 32, class: 'tick', 'text-anchor': 'middle' }, 'scenes without a part, accepted [%]'),
    svg('text', { transform: `translate(12 ${y(0.5)}) rotate(-90)`, class: 'tick', 'text-anchor': 'middle' }, 'parts, accepted rightly [%]'));
  let path = `M${x(0)} ${y(0)}`;
  for (const point of curve) path += `H${x(point.wrong)}V${y(point.right)}`;
  picture.append(svg('path', { d: path, class: 'curve' }));
  const shown = curve.filter((_, i) => i % Math.max(1, Math.ceil(curve.length / 40)) === 0);
  for (const point of shown)
    picture.append(svg('circle', { cx: x(point.wrong), cy: y(point.right), r: 3, class: 'point',
      tip: `A score of ${number(point.threshold)} or more is accepted: ${number(100 * point.right)} % of the parts rightly, ${number(100 * point.wrong)} % of the scenes without one falsely.` }));
  return picture;
}

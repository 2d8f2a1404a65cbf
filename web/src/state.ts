// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What the address says: #summary, #frames?verdict=wrong, #frame/12?verdict=wrong
import type { FrameRow, Index } from './data';
import { poseVerdict, type Judgement, type Measure } from './measure';

export interface Filter {
  group?: string;
  verdict?: string; // correct, wrong, none, found, nothing, pose_right, pose_off
  truth?: string;
  result?: string;
  text?: string;
}

export interface Place {
  page: 'summary' | 'frames' | 'frame';
  frame: number;
  filter: Filter;
}

const keys = ['group', 'verdict', 'truth', 'result', 'text'] as const;

/** Without an address a report of one frame opens on it: its summary says no more. */
export function readPlace(frames: number): Place {
  const [path, query = ''] = (location.hash || (frames === 1 ? addressOf('frame') : '')).slice(1).split('?');
  const values = new URLSearchParams(query);
  const filter: Filter = {};
  for (const key of keys) if (values.has(key)) filter[key] = values.get(key)!;
  const [page, number] = path.split('/');
  if (page === 'frame') return { page, frame: Number(number) || 0, filter };
  return { page: page === 'frames' ? 'frames' : 'summary', frame: 0, filter };
}

export function addressOf(page: Place['page'], filter: Filter = {}, frame = 0): string {
  const values = new URLSearchParams();
  for (const key of keys) if (filter[key] !== undefined) values.set(key, filter[key]!);
  const query = values.toString();
  return `#${page}${page === 'frame' ? `/${frame}` : ''}${query ? `?${query}` : ''}`;
}

/** What all pages share. */
export interface Report extends Judgement {
  index: Index;
  measures: Measure[];
  groups: string[];
}

export function filtered(report: Report, filter: Filter): FrameRow[] {
  const text = filter.text?.toLowerCase();
  return report.index.frames.filter((row) => {
    if (filter.group !== undefined && row.group !== filter.group) return false;
    if (filter.truth !== undefined && row.truth !== filter.truth) return false;
    if (filter.result !== undefined && row.result !== filter.result) return false;
    if (filter.verdict === 'pose_right' || filter.verdict === 'pose_off') {
      if (`pose_${poseVerdict(row, report)}` !== filter.verdict) return false;
    } else if (filter.verdict !== undefined && row.verdict !== filter.verdict) return false;
    return !text || `${row.name} ${row.group} ${row.truth ?? ''} ${row.result}`.toLowerCase().includes(text);
  });
}

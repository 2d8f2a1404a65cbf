// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import type { FrameRow } from './data';
import { h } from './dom';
import { definition, poseVerdict } from './measure';
import { addressOf, filtered, type Filter, type Report } from './state';
import { noneOfThem, nothing, number, tipOf, verdictTip, verdictWord } from './words';

type Column = { key: string; label: string; tip: string; value: (row: FrameRow) => string | number | undefined; numeric?: boolean };

let sortedBy = '';
let descending = false;

function columns(report: Report): Column[] {
  const out: Column[] = [{ key: 'name', label: 'frame', tip: 'The scene. Click a row to look at it.', value: (row) => row.name }];
  if (report.groups.length > 1) out.push({ key: 'group', label: 'run', tip: 'Run, protocol, descriptor.', value: (row) => row.group });
  out.push(
    { key: 'truth', label: 'shown', tip: 'The part that the scene really shows.', value: (row) => (row.truth === '' ? noneOfThem : row.truth) },
    { key: 'result', label: 'recognized', tip: 'The part that was recognized.', value: (row) => row.result || nothing },
    { key: 'verdict', label: 'verdict', tip: 'How the frame came out; the words have explanations of their own.', value: (row) => row.verdict });
  const { measure, limits } = report;
  if (measure) {
    out.push({ key: 'pose', label: 'pose', tip: `right: ${definition(measure, limits)}.`, value: (row) => (row.result ? poseVerdict(row, report) : undefined) });
    out.push(...measure.figures.map(({ key, label, value }) => ({ key, label, tip: tipOf(key), value, numeric: true })));
  }
  if (report.index.frames.some((row) => row.best_score !== undefined))
    out.push({ key: 'score', label: 'score', tip: `${tipOf('score')} Of the best candidate, accepted or not.`, value: (row) => row.best_score, numeric: true });
  out.push({ key: 'time', label: 'ms', tip: tipOf('time_ms'), value: (row) => row.time_ms, numeric: true });
  return out;
}

export function sorted(rows: FrameRow[], report: Report): FrameRow[] {
  const column = columns(report).find((c) => c.key === sortedBy);
  if (!column) return rows;
  const out = [...rows].sort((a, b) => {
    const [x, y] = [column.value(a), column.value(b)];
    if (x === undefined || y === undefined) return Number(x === undefined) - Number(y === undefined) || a.index - b.index;
    const order = typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en', { numeric: true });
    return (descending ? -order : order) || a.index - b.index;
  });
  return out;
}

export function listPage(report: Report, filter: Filter, again: () => void): Element {
  const rows = sorted(filtered(report, filter), report);
  const all = columns(report);
  const set = (change: Filter) => (location.hash = addressOf('frames', { ...filter, ...change }));
  const choice = (key: 'group' | 'verdict' | 'truth' | 'result', label: string, values: [string, string][]) =>
    h('label', {}, `${label} `,
      h('select', { 'data-filter': key, onchange: (e: Event) => {
        const value = (e.target as HTMLSelectElement).value;
        set({ [key]: value === '*' ? undefined : value });
      } },
        h('option', { value: '*' }, 'any'),
        values.map(([value, words]) => h('option', { value, selected: filter[key] === value }, words))));
  const names = (of: (row: FrameRow) => string | undefined, empty: string): [string, string][] =>
    [...new Set(report.index.frames.map(of).filter((n): n is string => n !== undefined))].sort().map((n) => [n, n || empty]);
  const verdicts: [string, string][] = [...new Set(report.index.frames.map((row) => row.verdict))].map((v) => [v, verdictWord[v]]);
  if (report.measure) verdicts.push(['pose_right', 'pose right'], ['pose_off', 'pose off']);
  const anything = Object.values(filter).some((value) => value !== undefined);

  return h('main', { class: 'list' },
    h('div', { class: 'controls' },
      report.groups.length > 1 && choice('group', 'Run', names((row) => row.group, '(without a name)')),
      choice('verdict', 'Verdict', verdicts),
      choice('truth', 'Shown', names((row) => row.truth, noneOfThem)),
      choice('result', 'Recognized', names((row) => row.result, nothing)),
      h('label', {}, 'Search ', h('input', { type: 'search', value: filter.text ?? '', onchange: (e: Event) =>
        set({ text: (e.target as HTMLInputElement).value || undefined }) })),
      anything && h('a', { class: 'button', href: addressOf('frames') }, 'show all'),
      h('span', { class: 'quiet', id: 'count' }, `${rows.length} of ${report.index.frames.length} frames`)),
    h('div', { class: 'scroll' },
      h('table', { class: 'frames' },
        h('thead', {}, h('tr', {}, all.map((column) =>
          h('th', { tip: `${column.tip} Click: sort.`, class: column.numeric ? 'number' : '', tabindex: 0, 'aria-sort': sortedBy === column.key ? (descending ? 'descending' : 'ascending') : 'none',
            onclick: () => {
              descending = sortedBy === column.key ? !descending : column.numeric === true;
              sortedBy = column.key;
              again();
            } }, column.label, sortedBy === column.key ? (descending ? ' \u2193' : ' \u2191') : '')))),
        h('tbody', {}, rows.map((row) =>
          h('tr', { class: 'clickable', tabindex: 0, 'data-frame': row.index,
            onclick: () => (location.hash = addressOf('frame', filter, row.index)),
            onkeydown: (e: KeyboardEvent) => {
              const next = e.key === 'ArrowDown' ? 'nextElementSibling' : e.key === 'ArrowUp' ? 'previousElementSibling' : null;
              if (e.key === 'Enter') location.hash = addressOf('frame', filter, row.index);
              if (!next) return;
              ((e.currentTarget as Element)[next] as HTMLElement | null)?.focus();
              e.preventDefault();
            } },
            all.map((column) => {
              const value = column.value(row);
              if (column.key === 'verdict') return h('td', {}, h('span', { class: `badge ${row.verdict}`, tip: verdictTip[row.verdict] }, verdictWord[row.verdict]));
              if (column.key === 'pose') return h('td', { class: value === 'off' ? 'bad' : '' }, value ?? '');
              return h('td', { class: column.numeric ? 'number' : '' }, typeof value === 'number' ? number(value) : value ?? (column.numeric ? '' : '?'));
            })))))),
    rows.length === 0 && h('p', { class: 'quiet' }, 'No frame is like that.'));
}

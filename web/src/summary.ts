// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import { acceptCurve, acceptPlot, boxPlot, quantile } from './charts';
import type { FrameRow } from './data';
import { h } from './dom';
import { definition, poseVerdict, type PoseFigure } from './measure';
import { addressOf, filtered, type Filter, type Report } from './state';
import { noneOfThem, nothing, number, percent, stepTip, tipOf, verdictTip } from './words';

const go = (filter: Filter) => () => (location.hash = addressOf('frames', filter));
const unique = (values: string[]) => [...new Set(values)].sort((a, b) => a.localeCompare(b, 'en', { numeric: true }));

interface Count {
  frames: number;
  known: number; // frames whose truth is known
  correct: number;
  wrong: number;
  none: number;
  found: number;
  judged: number; // those that are not shown to a catalogue without their part: the others have no pose to be right
  poseRight: number;
  times: number[];
}

function count(rows: FrameRow[], report: Report): Count {
  const of = (verdict: string) => rows.filter((row) => row.verdict === verdict).length;
  return {
    frames: rows.length,
    known: rows.filter((row) => row.truth !== undefined).length,
    correct: of('correct'),
    wrong: of('wrong'),
    none: of('none'),
    found: of('found'),
    judged: rows.filter((row) => row.truth !== undefined && !row.left_out).length,
    poseRight: rows.filter((row) => poseVerdict(row, report) === 'right').length,
    times: rows.map((row) => row.time_ms).filter((t): t is number => t !== undefined).sort((a, b) => a - b),
  };
}

function card(label: string, value: string, note: string, tip: string, onclick?: () => void, colour = ''): Element {
  return h(
    onclick ? 'button' : 'div',
    { class: `card ${colour}`, tip, onclick },
    h('span', { class: 'label' }, label),
    h('span', { class: 'value' }, value),
    h('span', { class: 'note' }, note),
  );
}

function cards(c: Count, report: Report, filter: Filter): Element {
  const all = h('div', { class: 'cards' });
  all.append(card('Frames', String(c.frames), c.known === c.frames ? 'truth known for all' : `truth known for ${c.known}`,
    'Scenes that were given to the recognition. Click: list them.', go(filter)));
  if (c.known > 0) {
    all.append(
      card('Correct', percent(c.correct, c.known), `${c.correct} of ${c.known}`, verdictTip.correct, go({ ...filter, verdict: 'correct' }), 'correct'),
      card('Wrong part', percent(c.wrong, c.known), `${c.wrong} of ${c.known}`, verdictTip.wrong, go({ ...filter, verdict: 'wrong' }), 'wrong'),
      card('Not recognized', percent(c.none, c.known), `${c.none} of ${c.known}`, verdictTip.none, go({ ...filter, verdict: 'none' }), 'none'),
    );
    if (report.measure)
      all.append(card('Pose right', percent(c.poseRight, c.judged), `${c.poseRight} of ${c.judged}`,
        `A pose is right ${definition(report.measure, report.limits)}. ${poseRightOf} Click: list them.`,
        go({ ...filter, verdict: 'pose_right' }), 'correct'));
  } else {
    all.append(card('Recognized', percent(c.found, c.frames), `${c.found} of ${c.frames}`, verdictTip.found, go({ ...filter, verdict: 'found' }), 'found'));
  }
  if (c.times.length)
    all.append(card('Time, median', `${number(quantile(c.times, 0.5))} ms`, `95 of 100 below ${number(quantile(c.times, 0.95))} ms`, tipOf('time_ms')));
  return all;
}

const poseRightOf = 'Of all frames but those whose part was left out of the catalogue; where none of the parts is shown, to recognize none is right.';

/** One line for each group of frames. */
function table(title: string, tip: string, lines: { name: string; rows: FrameRow[]; filter: Filter }[], report: Report, known: boolean): Element {
  const head = known
    ? [['frames', 'Scenes of this line.'], ['correct', verdictTip.correct], ['wrong', verdictTip.wrong], ['none', verdictTip.none],
       ...(report.measure ? [['pose right', `A pose is right ${definition(report.measure, report.limits)}. ${poseRightOf}`]] : [])]
    : [['frames', 'Scenes of this line.']];
  const cell = (value: number, of: number, filter: Filter, colour: string) =>
    h('td', { class: `number clickable ${value ? colour : ''}`, tip: `${value} of ${of}. Click: list them.`, onclick: go(filter) },
      percent(value, of), h('small', {}, ` ${value}`));
  const body = lines.map(({ name, rows, filter }) => {
    const c = count(rows, report);
    return h('tr', {},
      h('th', { scope: 'row' }, h('a', { href: addressOf('frames', filter) }, name || '(one run)')),
      h('td', { class: 'number' }, c.frames),
      known
        ? [cell(c.correct, c.known, { ...filter, verdict: 'correct' }, 'good'),
           cell(c.wrong, c.known, { ...filter, verdict: 'wrong' }, 'bad'),
           cell(c.none, c.known, { ...filter, verdict: 'none' }, 'poor'),
           report.measure && cell(c.poseRight, c.judged, { ...filter, verdict: 'pose_right' }, 'good')]
        : '',
      h('td', { class: 'number' }, c.times.length ? number(quantile(c.times, 0.5)) : '\u2013'),
      h('td', { class: 'number' }, c.times.length ? number(quantile(c.times, 0.95)) : '\u2013'));
  });
  return h('table', { class: 'figures' },
    h('thead', {}, h('tr', {}, h('th', { tip }, title), head.map(([label, words]) => h('th', { tip: words, class: 'number' }, label)),
      h('th', { tip: `${tipOf('time_ms')} Median: ${tipOf('median')}`, class: 'number' }, 'median ms'),
      h('th', { tip: tipOf('p95'), class: 'number' }, 'p95 ms'))),
    h('tbody', {}, body));
}

function confusion(rows: FrameRow[], filter: Filter): Element {
  const known = rows.filter((row) => row.truth !== undefined);
  const shown = unique(known.map((row) => row.truth!));
  const present = known.filter((row) => !row.left_out).map((row) => row.truth!);
  const columns = unique([...known.map((row) => row.result), ...present]).filter((name) => name !== '');
  columns.push('');
  const label = (name: string) => name || nothing;
  const headHeight = 30 + Math.round(5.2 * Math.max(...columns.map((name) => label(name).length)));
  const lines = shown.map((truth) => {
    const of = known.filter((row) => row.truth === truth);
    return h('tr', {},
      h('th', { scope: 'row' }, truth || noneOfThem),
      columns.map((result) => {
        const here = of.filter((row) => row.result === result);
        const value = here.length;
        const kind = here[0]?.verdict;
        return h('td', { tip: `${truth || noneOfThem} shown, ${label(result)} recognized: ${value} of ${of.length} frames.${value ? ' Click: list them.' : ''}` },
          value
            ? h('button', {
                class: `cell ${kind}`, style: `--share:${Math.round(15 + (85 * value) / of.length)}%`,
                'data-truth': truth, 'data-result': result, onclick: go({ ...filter, truth, result }),
                'aria-label': `${truth || noneOfThem} as ${label(result)}: ${value} frames`,
              }, value)
            : h('span', { class: 'cell empty' }, '\u00b7'));
      }));
  });
  return h('div', { class: 'scroll' },
    h('table', { class: 'confusion', style: `margin-right:${headHeight}px` },
      h('thead', {}, h('tr', {},
        h('th', { tip: 'Rows: what was shown. Columns: what was recognized.' }, 'shown \u2193 recognized \u2192'),
        columns.map((name) => h('th', { class: 'turned', style: `height:${headHeight}px` }, h('span', {}, label(name)))))),
      h('tbody', {}, lines)));
}

function errorPlots(rows: FrameRow[], report: Report, filter: Filter, by: string): Element[] {
  const { measure, measures, limits } = report;
  if (!measure) return [h('p', { class: 'quiet' }, 'Pose errors: not saved.')];
  const groupOf = (row: FrameRow) => (by === 'run' ? row.group : row.truth!);
  const plot = (figure: PoseFigure, limit?: number) => {
    const judged = rows.filter((row) => row.verdict === 'correct' && row.truth && !row.left_out && figure.value(row) !== undefined);
    return h('figure', {},
      h('figcaption', { tip: tipOf(figure.key) }, figure.key.replaceAll('_', ' ')),
      boxPlot(unique(judged.map(groupOf)).map((name) => ({
        label: name || '(one run)',
        values: judged.filter((row) => groupOf(row) === name).map((row) => figure.value(row)!),
        onclick: go(by === 'run' ? { ...filter, group: name, verdict: 'correct' } : { ...filter, truth: name, verdict: 'correct' }),
      })), `${figure.unit.trim().replace('\u00b0', 'degrees')}, logarithmic`, { limit, log: true }));
  };
  const others = measures.filter((other) => other !== measure);
  return [...measure.figures.map((f) => plot(f, limits[f.limit])), ...others.flatMap((other) => other.figures.map((f) => plot(f)))];
}

function otherFigures(rows: FrameRow[], report: Report): string[] {
  const used = new Set(['mssd_mm', 'diameter_mm', ...report.measures.flatMap((measure) => measure.figures.map((figure) => figure.key))]);
  const keys = unique(rows.flatMap((row) => Object.keys(row.figures ?? {})));
  return keys.filter((key) => !used.has(key));
}

/** What a run is compared as: its name without the protocol, as scenes with and without a part are different protocols. */
const pipelineOf = (row: FrameRow) =>
  row.group.split(/ \/ | \u00b7 /).filter((name) => name !== row.protocol).join(' / ');

/** The curve over all thresholds of each pipeline that saw scenes with and without a part of its catalogue. */
function accepts(rows: FrameRow[]): Element | null {
  const without = (row: FrameRow) => row.truth === '' || row.left_out === true;
  const known = rows.filter((row) => row.truth !== undefined);
  const figures: Element[] = [];
  for (const pipeline of unique(known.map(pipelineOf))) {
    const own = known.filter((row) => pipelineOf(row) === pipeline);
    if (!own.some((row) => row.best_score !== undefined)) continue;
    // Frames without any candidate have no score, and are accepted at no threshold.
    const parts = own.filter((row) => !without(row)).map((row) => ({ score: row.best_score ?? -1, right: row.best_is_right === true }));
    const others = own.filter(without).map((row) => row.best_score ?? -1);
    if (!parts.length || !others.length) continue;
    figures.push(h('figure', {},
      h('figcaption', {}, pipeline || 'all frames', h('small', {}, ` ${parts.length} scenes with a part, ${others.length} without`)),
      acceptPlot(acceptCurve(parts, others))));
  }
  if (!figures.length) return null;
  return h('section', {},
    h('h2', { tip: 'For each threshold on the score of the best candidate: how many of the parts are accepted rightly, how many scenes without a part of the catalogue falsely. Up and left is better.' }, 'Accepts by score'),
    h('div', { class: 'plots small' }, figures));
}

export function summaryPage(report: Report, filter: Filter, again: () => void): Element {
  const { index } = report;
  const own: Filter = filter.group === undefined ? {} : { group: filter.group };
  const rows = filtered(report, own);
  const c = count(rows, report);
  const known = c.known > 0;
  const page = h('main', { class: 'summary' });

  const controls = h('div', { class: 'controls' });
  if (report.groups.length > 1)
    controls.append(h('label', {}, 'Run ',
      h('select', { id: 'group', onchange: (e: Event) => {
        const value = (e.target as HTMLSelectElement).value;
        location.hash = addressOf('summary', value === '*' ? {} : { group: value });
      } },
        h('option', { value: '*' }, `all ${report.groups.length} runs`),
        report.groups.map((name) => h('option', { value: name, selected: name === filter.group }, name || '(without a name)')))));
  const { measure, measures, limits } = report;
  if (measure) {
    controls.append(h('label', { tip: `A pose is right ${definition(measure, limits)}. Other errors and limits change all figures of this report.` }, 'A pose is right ',
      h('select', { id: 'measure', onchange: (e: Event) => {
        report.measure = measures[(e.target as HTMLSelectElement).selectedIndex];
        again();
      } }, measures.map((one) => h('option', { selected: one === measure }, one.name)))));
    controls.append(h('span', {}, measure.figures.map((figure, i) =>
      h('label', { tip: 'A pose counts as right below all limits.' }, i === 0 ? 'below ' : ' and ',
        h('input', { type: 'number', min: 0, step: 'any', value: limits[figure.limit], onchange: (e: Event) => {
          const value = Number((e.target as HTMLInputElement).value);
          if (value >= 0) limits[figure.limit] = value;
          again();
        } }), figure.unit))));
  }
  page.append(h('h1', {}, index.title), controls, cards(c, report, own));
  if (index.thinned)
    page.append(h('p', { class: 'quiet' },
      'Points or depth images are thinned to keep this file small; each frame says how far. All figures are of the full data.'));
  if (index.problems.length)
    page.append(h('details', { class: 'problems' },
      h('summary', {}, `${index.problems.length} file${index.problems.length > 1 ? 's' : ''} could not be read and ${index.problems.length > 1 ? 'are' : 'is'} left out`),
      h('ul', {}, index.problems.map((words) => h('li', {}, words)))));

  const byRun = report.groups.length > 1 && filter.group === undefined;
  if (byRun)
    page.append(h('section', {}, h('h2', {}, 'By run'),
      h('div', { class: 'scroll' }, table('run', 'What was run: name, protocol, descriptor.',
        report.groups.map((name) => ({ name, rows: rows.filter((row) => row.group === name), filter: { group: name } })), report, known))));
  const names = unique(rows.map((row) => (known ? row.truth : row.result)).filter((n): n is string => n !== undefined));
  page.append(h('section', {}, h('h2', {}, 'By part'),
    h('div', { class: 'scroll' }, table(known ? 'part shown' : 'part recognized', known ? 'What the scene really shows.' : 'What was recognized.',
      names.map((name) => ({
        name: name || (known ? noneOfThem : nothing),
        rows: rows.filter((row) => (known ? row.truth : row.result) === name),
        filter: known ? { ...own, truth: name } : { ...own, result: name },
      })), report, known))));
  if (known)
    page.append(h('section', {}, h('h2', { tip: 'Each cell: how many frames that show the part of the row were recognized as the part of the column.' }, 'Confusion'),
      confusion(rows, own)));
  if (known)
    page.append(h('section', {}, h('h2', { tip: 'Of the frames whose part was recognized. Box: the middle half of the values; line in it: the median; whiskers: the furthest values within 1.5 box lengths; dots: outliers (Tukey 1977). Dashed: the limit.' }, 'Pose errors'),
      h('div', { class: 'plots' }, errorPlots(rows, report, own, byRun ? 'run' : 'part'))));
  const curve = accepts(rows);
  if (curve) page.append(curve);
  const others = otherFigures(rows, report);
  if (others.length)
    page.append(h('section', {}, h('h2', {}, 'Other figures of the evaluation'),
      h('div', { class: 'plots' }, others.map((key) =>
        h('figure', {}, h('figcaption', { tip: tipOf(key) }, key.replaceAll('_', ' ')),
          boxPlot(names.map((name) => ({ label: name || noneOfThem,
            values: rows.filter((row) => row.truth === name).map((row) => row.figures?.[key]).filter((x): x is number => x !== undefined) })),
            key.split('_').pop() ?? ''))))));
  const order = Object.keys(stepTip);
  const place = (tag: string) => (order.includes(tag) ? order.indexOf(tag) : order.length);
  const steps = [...index.steps].sort((a, b) => place(a) - place(b));
  page.append(h('section', {}, h('h2', { tip: 'Wall-clock time of each step in all frames.' }, 'Time by step'),
    h('div', { class: 'plots' }, h('figure', {},
      index.steps.length
        ? boxPlot(steps.map((tag) => ({ label: tag, values: rows.map((row) => row.steps?.[index.steps.indexOf(tag)]).filter((x): x is number => typeof x === 'number') })), 'ms')
        : h('p', { class: 'quiet' }, 'not saved')),
      h('dl', { class: 'glossary' }, steps.map((tag) => [h('dt', {}, tag), h('dd', {}, stepTip[tag] ?? '')])))));
  return page;
}

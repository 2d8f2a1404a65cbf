// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import { loadIndex } from './data';
import { h, installTips } from './dom';
import { FramePage, view } from './frame';
import { listPage } from './list';
import { measuresOf } from './measure';
import { addressOf, readPlace, type Report } from './state';
import { summaryPage } from './summary';

const keys: [string, string][] = [
  ['1 \u2026 6, \u2190 \u2192', 'the stages above the 3-D view'],
  ['\u2191 \u2193', 'candidate'],
  ['n, p', 'next, previous frame of the list'],
  ['Shift + arrows, + \u2212', 'turn, zoom'],
  ['r', 'look as the camera did'],
  ['t, a, o, x', 'truth, all candidates, normals, see through'],
  ['z', 'depth image: object only, or all'],
  [', .', 'smaller, larger points'],
  ['s, f', 'summary, frames'],
  ['Esc', 'back'],
  ['?', 'this help'],
];

function help(): HTMLDialogElement {
  const dialog = h('dialog', { class: 'help' },
    h('h2', {}, 'Keys and mouse'),
    h('p', {}, 'Drag to turn the 3-D view, right-drag to move it, wheel to zoom. Hover over any word or symbol for its meaning.'),
    h('dl', { class: 'facts' }, keys.map(([key, words]) => [h('dt', {}, h('kbd', {}, key)), h('dd', {}, words)])),
    h('form', { method: 'dialog' }, h('button', { class: 'button' }, 'Close')));
  document.body.append(dialog);
  return dialog;
}

function setTheme(theme: string): void {
  document.documentElement.dataset.theme = theme;
}

async function start(): Promise<void> {
  const app = document.getElementById('app')!;
  const system = matchMedia('(prefers-color-scheme: dark)');
  setTheme(system.matches ? 'dark' : 'light');
  if (!('DecompressionStream' in window)) {
    app.replaceChildren(h('p', { class: 'loading' }, 'This page needs a browser of 2023 or later (Chromium 80, Firefox 113, Safari 16.4).'));
    return;
  }
  const index = await loadIndex();
  document.title = `${index.title} \u2013 partpose report`;
  const measures = measuresOf(index);
  const report: Report = {
    index, measures, measure: measures[0], limits: { percent: 10, deg: index.limit_deg, mm: index.limit_mm },
    groups: [...new Set(index.frames.map((frame) => frame.group))],
  };
  installTips();
  const dialog = help();
  const body = h('div', { class: 'body' });
  const links = h('nav', {});
  let frame: FramePage | null = null;
  let lastList = addressOf('frames');

  const draw = () => {
    const place = readPlace(index.frames.length);
    frame = null;
    if (place.page === 'frames') lastList = addressOf('frames', place.filter);
    links.replaceChildren(
      h('a', { href: addressOf('summary'), class: place.page === 'summary' ? 'here' : '', tip: 'All frames in numbers (s)' }, 'Summary'),
      h('a', { href: lastList, class: place.page === 'frames' ? 'here' : '', tip: 'The list of frames (f)' }, `Frames (${index.frames.length})`),
      place.page === 'frame' && index.frames[place.frame] ? h('a', { href: addressOf('frame', place.filter, place.frame), class: 'here' }, 'Frame') : '');
    if (place.page === 'frame' && index.frames[place.frame]) {
      const next = new FramePage(report, place.filter, place.frame);
      frame = next;
      void next.ready.then(() => {
        if (frame !== next) return; // the person has gone on
        body.replaceChildren(next.element);
        next.start();
      });
    } else if (place.page === 'frames') body.replaceChildren(listPage(report, place.filter, draw));
    else body.replaceChildren(summaryPage(report, place.filter, draw));
  };

  app.replaceChildren(
    h('header', {},
      h('span', { class: 'name', tip: index.title }, 'partpose ', h('b', {}, index.title)), links, h('span', { class: 'space' }),
      h('button', { class: 'button', tip: 'Light or dark', onclick: () => {
        setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
        frame?.themeChanged();
      } }, '\u25d0'),
      h('button', { class: 'button', tip: 'Keys and mouse (?)', onclick: () => dialog.showModal() }, '?')),
    body);
  system.addEventListener('change', () => {
    setTheme(system.matches ? 'dark' : 'light');
    frame?.themeChanged();
  });
  addEventListener('hashchange', () => {
    draw();
    scrollTo(0, 0);
  });
  addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || dialog.open) return;
    if (['INPUT', 'SELECT', 'TEXTAREA'].includes(target.tagName)) return;
    if (event.key === '?') dialog.showModal();
    else if (event.key === 's') location.hash = addressOf('summary');
    else if (event.key === 'f') location.hash = lastList;
    else if (!frame?.key(event)) {
      if (event.key === 'Escape' && readPlace(index.frames.length).page === 'frames') location.hash = addressOf('summary');
      return;
    }
    event.preventDefault();
  });
  draw();
  // For those who measure.
  (window as unknown as Record<string, unknown>).partposeReport = { view };
}

start().catch((error: unknown) => {
  document.getElementById('app')!.replaceChildren(h('p', { class: 'loading' }, `The report cannot be opened: ${String(error)}`));
});

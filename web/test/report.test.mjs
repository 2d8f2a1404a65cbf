// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Clicks through reports of real output in a real browser without network. What a page must say is computed here from the
// files of the output folder, by other code than the report's.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Browser } from './chromium.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
const partpose = process.env.PARTPOSE ?? join(root, 'build/release/partpose');
const work = mkdtempSync(join(tmpdir(), 'partpose_report_'));
const shots = process.env.SHOTS; // a folder: pictures of what was tested
if (shots) mkdirSync(shots, { recursive: true });
const run = (...args) => execFileSync(partpose, ['-q', ...args], { cwd: work, env: { ...process.env, XDG_CACHE_HOME: join(work, 'cache') }, encoding: 'utf8' });
const json = (path) => JSON.parse(readFileSync(path, 'utf8'));

/** What evaluate wrote, frame by frame, as the files say. */
function readFrames(folder) {
  return readdirSync(folder).filter((name) => /^\d{4}-/.test(name)).sort().map((name) => {
    const at = join(folder, name);
    return { folder: name, at, result: json(join(at, 'result.json')), extras: json(join(at, 'extras.json')), evaluation: json(join(at, 'evaluation.json')) };
  });
}

function verdictOf(frame) {
  if (frame.result.model_name === frame.evaluation.ground_truth_model_name) return 'correct';
  return frame.result.candidate_id < 0 ? 'none' : 'wrong';
}

/** x y z of all points of a binary PLY of 32-bit floats. */
function plyPoints(path) {
  const bytes = readFileSync(path);
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const header = bytes.subarray(0, end).toString();
  const count = Number(/element vertex (\d+)/.exec(header)[1]);
  const fields = header.match(/property float \w+/g).length;
  const points = [];
  for (let i = 0; i < count; ++i) points.push([0, 4, 8].map((o) => bytes.readFloatLE(end + i * fields * 4 + o)));
  return points;
}

/** Label, value and note of a card of the summary. */
const card = (label) => browser.value(`(() => {
  const card = [...document.querySelectorAll('.card')].find((c) => c.querySelector('.label').textContent === ${JSON.stringify(label)});
  return [card.querySelector('.value').textContent, card.querySelector('.note').textContent];
})()`);

const ready = "document.querySelector('main') && !document.querySelector('main .loading')";
let browser;
let frames;
const report = join(work, 'evaluated.html');
const path = (name) => join(work, name);

before(async () => {
  mkdirSync(path('parts'));
  for (const part of ['bracket', 'link', 'mount_left', 'mount_right', 'elbow_100']) cpSync(join(root, `parts/${part}.stl`), path(`parts/${part}.stl`));
  const views = (more) => ({ virtual_views_icosahedron: { subdivide: 0, ...more.views }, ...more.rest });
  writeFileSync(path('clean.json'), JSON.stringify(views({})));
  writeFileSync(path('noisy.json'), JSON.stringify(views({
    views: { xyz_rotation_deg: 15, capture_distance_mm: 700 },
    rest: { virtual_depth_camera: { noise: { model: 'gaussianray', standard_deviation_mm: 3 } } },
  })));
  const config = json(join(root, 'configs/pipeline_virtual.json'));
  config.debug = { ...config.debug, save_extras_json: true, save_point_clouds: true, save_used_pipeline_config_json: true, step_notion_to_cout: false };
  writeFileSync(path('pipeline.json'), JSON.stringify(config));
  run('dataset', '--models', 'parts', '--config', 'clean.json', '--output', 'dataset');
  run('dataset', '--models', 'parts', '--config', 'noisy.json', '--output', 'test');
  run('evaluate', '--dataset', 'dataset', '--test', 'test', '--config', 'pipeline.json', '--output', 'evaluated');
  run('report', 'evaluated', '--output', report, '--title', 'Noisy views <b>of 5 parts</b>');
  run('recognize', '--models', 'parts', '--output', 'recognized', join(root, 'scenes/bracket.png'), join(root, 'scenes/unknown_star_knob.png'));
  run('report', 'recognized');
  frames = readFrames(path('evaluated'));
  browser = await Browser.open();
}, { timeout: 300_000 });

after(async () => {
  await browser?.close();
  rmSync(work, { recursive: true, force: true });
});

const shot = async (name) => shots && browser.screenshot(join(shots, `${name}.png`));
const text = (selector) => browser.value(`document.querySelector(${JSON.stringify(selector)})?.textContent ?? null`);
const texts = (selector) => browser.value(`[...document.querySelectorAll(${JSON.stringify(selector)})].map((e) => e.textContent)`);
const quiet = () => assert.deepEqual(browser.complaints, []);

/** Pixels of the 3-D view that differ from its first, drawn now. */
const drawnPixels = () => browser.value(`(() => {
  const { view } = partposeReport;
  view.render();
  const copy = document.createElement('canvas');
  copy.width = view.canvas.width; copy.height = view.canvas.height;
  const context = copy.getContext('2d', { willReadFrequently: true });
  context.drawImage(view.canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let drawn = 0, sum = 0;
  for (let i = 0; i < data.length; i += 4)
    if (Math.abs(data[i] - data[0]) + Math.abs(data[i + 1] - data[1]) + Math.abs(data[i + 2] - data[2]) > 24) { ++drawn; sum = (sum * 31 + data[i] + 3 * data[i + 1] + 7 * data[i + 2]) % 1000003; }
  return { drawn, sum, all: copy.width * copy.height };
})()`);

test('the folder shows every verdict that the tests below rely on', () => {
  assert.equal(frames.length, 60);
  for (const verdict of ['correct', 'none']) assert.ok(frames.some((f) => verdictOf(f) === verdict), verdict);
});

test('opens from disk without network, with the figures of the folder', async () => {
  const ms = await browser.goto(report, ready);
  assert.ok(ms < 5000, `${ms} ms`);
  assert.equal(await text('h1'), 'Noisy views <b>of 5 parts</b>'); // text, never HTML
  const count = (verdict) => frames.filter((f) => verdictOf(f) === verdict).length;
  const share = (n) => `${((100 * n) / frames.length).toFixed(1)} %`;
  assert.equal((await card('Frames'))[0], String(frames.length));
  assert.equal((await card('Correct'))[0], share(count('correct')));
  assert.equal((await card('Wrong part'))[0], share(count('wrong')));
  assert.equal((await card('Not recognized'))[0], share(count('none')));
  const right = frames.filter((f) => verdictOf(f) === 'correct' && f.evaluation.rotation_error_deg < 15 && f.evaluation.translation_error_mm < 15);
  assert.equal((await card('Pose right'))[0], share(right.length));
  await shot('summary');
  assert.ok((await browser.value("document.querySelectorAll('svg.chart .quartiles').length")) > 10);
  quiet();
});

test('other limits give other figures', async () => {
  await browser.value("(() => { const input = document.querySelector('input[type=number]'); input.value = '0.5'; input.dispatchEvent(new Event('change')); })()");
  const right = frames.filter((f) => verdictOf(f) === 'correct' && f.evaluation.rotation_error_deg < 0.5 && f.evaluation.translation_error_mm < 15);
  assert.equal((await card('Pose right'))[1], `${right.length} of ${frames.length}`);
});

test('summary, cell of the confusion matrix, frame, every stage, every candidate', async () => {
  await browser.goto(report, ready);
  const truth = 'bracket';
  const cells = await browser.value(`[...document.querySelectorAll('button.cell[data-truth=${truth}]')].map((b) => [b.dataset.result, b.textContent])`);
  const expected = frames.filter((f) => f.evaluation.ground_truth_model_name === truth);
  assert.equal(cells.reduce((sum, [, n]) => sum + Number(n), 0), expected.length);
  for (const [result, n] of cells) assert.equal(Number(n), expected.filter((f) => f.result.model_name === result).length, `${truth} as ${result}`);

  await browser.click(`button.cell[data-truth=${truth}][data-result=${truth}]`);
  await browser.until("document.querySelector('table.frames')");
  const own = expected.filter((f) => f.result.model_name === truth);
  assert.equal(await browser.value("document.querySelectorAll('table.frames tbody tr').length"), own.length);
  assert.match(await text('#count'), new RegExp(`^${own.length} of ${frames.length} frames`));
  await shot('frames');

  const index = Number(await browser.value("document.querySelector('table.frames tbody tr').dataset.frame"));
  const frame = frames[index];
  await browser.click('table.frames tbody tr');
  await browser.until("document.querySelector('main[data-frame]')");
  assert.equal(await text('.head h1'), `${truth} view ${frame.evaluation.ground_truth_view_id}`);
  assert.match(await text('.why .first'), /^(Correct: this is bracket|The part is right, bracket)/);

  const sums = new Map();
  for (const stage of ['input', 'preprocessed', 'normals', 'coarse', 'fine', 'verdict']) {
    await browser.click(`.stages [data-stage=${stage}]`);
    const { drawn, sum, all } = await drawnPixels();
    assert.ok(drawn > 0.01 * all, `${stage}: ${drawn} of ${all} pixels`);
    assert.ok(await browser.value("document.querySelector('.missing').hidden"), stage);
    sums.set(stage, sum);
    await shot(`stage_${stage}`);
  }
  assert.equal(new Set([sums.get('input'), sums.get('normals'), sums.get('coarse')]).size, 3);

  const candidates = frame.extras.candidate_extras;
  const head = await texts('.candidates th');
  assert.equal(await browser.value("document.querySelectorAll('.candidates tbody tr').length"), candidates.length);
  for (let i = 0; i < candidates.length; ++i) {
    await browser.click(`[data-candidate='${i}']`);
    const c = candidates[i];
    assert.equal(await text('.details h2'), `Candidate ${c.id}: ${c.model_name}`);
    assert.equal(await text('.details .verdict'), c.verdict === 'accepted' ? 'Accepted.' : `Fell: ${c.verdict}.`);
    const cells = await texts(`[data-candidate='${i}'] td`);
    assert.equal(cells[head.indexOf('part')], c.model_name);
    assert.ok(Math.abs(Number(cells[head.indexOf('fit mm')]) - c.icp_fitness) <= 0.006 * Math.max(1, c.icp_fitness), `${cells} ${c.icp_fitness}`);
    const pose = await texts('table.matrix td');
    for (let k = 0; k < 12; ++k) assert.ok(Math.abs(Number(pose[k]) - c.T_final[Math.floor(k / 4)][k % 4]) < 0.006);
    assert.ok((await drawnPixels()).drawn > 500);
  }
  assert.equal(await browser.value("document.querySelectorAll('.steps svg g').length"), frame.extras.time_profiling.length);
  quiet();
});

test('the points on the page are those of the files', async () => {
  const index = frames.findIndex((f) => verdictOf(f) === 'correct');
  await browser.goto(report, ready, `#frame/${index}`);
  for (const [stage, file] of [['input', 'scene_original.ply'], ['preprocessed', 'scene_preprocessed.ply'], ['normals', 'scene_preprocessed.ply']]) {
    await browser.click(`.stages [data-stage=${stage}]`);
    const shown = await browser.value('[...partposeReport.view.points.geometry.attributes.position.array]');
    const points = plyPoints(join(frames[index].at, file));
    assert.equal(shown.length, 3 * points.length, stage);
    // Every tenth point has one of the file's within half a 65535th of the box, about.
    for (let i = 0; i < shown.length; i += 30) {
      const nearest = Math.min(...points.map((p) => Math.max(...p.map((x, a) => Math.abs(x - shown[i + a])))));
      assert.ok(nearest < 0.01, `${stage}: point ${i / 3} is ${nearest} mm off`);
    }
  }
});

test('in words why a frame fell', async () => {
  for (const verdict of ['wrong', 'none']) {
    const index = frames.findIndex((f) => verdictOf(f) === verdict);
    if (index < 0) continue;
    const { evaluation, result, extras } = frames[index];
    await browser.goto(report, ready, `#frame/${index}`);
    const truth = evaluation.ground_truth_model_name;
    assert.equal(await text('.why .first'), verdict === 'wrong'
      ? `Wrong: ${truth} was shown, ${result.model_name} was recognized.`
      : `Not recognized: ${truth} was shown, no candidate was accepted.`);
    const words = await text('.why');
    if (verdict === 'none') assert.ok(words.includes(extras.reason), words);
    assert.match(words, extras.candidate_extras.some((c) => c.model_name === truth) ? /Lost in the (pose|decision)/ : /Lost in matching/);
    await shot(`why_${verdict}`);
  }
  quiet();
});

test('the part is drawn over the depth image where it belongs', async () => {
  const index = frames.findIndex((f) => f.evaluation.recognized_correctly && f.evaluation.rotation_error_deg < 2);
  await browser.goto(report, ready, `#frame/${index}`);
  const colours = () => browser.value(`(() => {
    const shown = document.querySelector('.depthImage');
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [shown.width, shown.height];
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(shown, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const count = { orange: 0, red: 0, grey: 0 };
    for (let i = 0; i < data.length; i += 4) {
      const [r, g, b] = data.subarray(i, i + 3);
      if (r === g && g === b && r > 0) ++count.grey;
      else if (r > 1.4 * g && g > 1.8 * b) ++count.orange;
      else if (r > 2.5 * g) ++count.red;
    }
    return count;
  })()`);
  await browser.click('.stages [data-stage=fine]');
  const fine = await colours();
  assert.ok(fine.orange > 300 && fine.orange > 4 * fine.red && fine.orange > fine.grey, JSON.stringify(fine));
  await browser.click('.stages [data-stage=input]');
  const input = await colours();
  assert.ok(input.orange === 0 && input.grey > 300, JSON.stringify(input));
});

test('keyboard and mouse', async () => {
  await browser.goto(report, ready, '#frame/1?truth=bracket');
  const stage = () => browser.value("document.querySelector('.stages [aria-selected=true]').dataset.stage");
  await browser.key('1');
  assert.equal(await stage(), 'input');
  await browser.key('ArrowRight');
  assert.equal(await stage(), 'preprocessed');
  await browser.key('5');
  assert.equal(await stage(), 'fine');
  await browser.key('ArrowDown');
  assert.notEqual(await browser.value("document.querySelector('.candidates [aria-selected=true]').dataset.candidate"), '0');
  const before = await drawnPixels();
  const box = await browser.value("(() => { const b = partposeReport.view.canvas.getBoundingClientRect(); return { x: b.left + b.width / 2, y: b.top + b.height / 2 }; })()");
  await browser.mouse('mousePressed', box, { button: 'left', clickCount: 1 });
  for (let i = 1; i <= 5; ++i) await browser.mouse('mouseMoved', { x: box.x + 30 * i, y: box.y + 8 * i }, { button: 'left', buttons: 1 });
  await browser.mouse('mouseReleased', { x: box.x + 150, y: box.y + 40 }, { button: 'left' });
  const turned = await drawnPixels();
  assert.notEqual(turned.sum, before.sum);
  await browser.key('r');
  assert.equal((await drawnPixels()).sum, before.sum);
  await browser.key('a');
  assert.notEqual((await drawnPixels()).sum, before.sum);
  await browser.key('a');
  await browser.key('n');
  await browser.until("document.querySelector('main[data-frame=\"2\"]')");
  await browser.key('p');
  await browser.until("document.querySelector('main[data-frame=\"1\"]')");
  await browser.key('?');
  assert.ok(await browser.value("document.querySelector('dialog').open"));
  await shot('help');
  await browser.value("document.querySelector('dialog').close()");
  await browser.key('Escape');
  await browser.until("location.hash.startsWith('#frames')");
  quiet();
});

test('every symbol is explained on hover', async () => {
  for (const hash of ['#summary', '#frames', '#frame/0']) {
    await browser.goto(report, ready, hash);
    const bare = await browser.value(`[...document.querySelectorAll('th.number, .card, figcaption, .candidates th, dl.facts dt')]
      .filter((e) => !e.closest('dialog') && !(e.getAttribute('tip') ?? '').trim()).map((e) => e.textContent)`);
    assert.deepEqual(bare.filter((word) => !['shown', 'scene', 'folder', 'Depth image'].includes(word)), [], hash);
  }
  const at = await browser.value("(() => { const b = [...document.querySelectorAll('.candidates th')].at(-1).getBoundingClientRect(); return { x: b.left + b.width / 2, y: b.top + 8 }; })()");
  await browser.mouse('mouseMoved', at);
  await browser.until("!document.querySelector('.tip').hidden");
  assert.match(await text('.tip'), /eq\. 2\.3/);
});

test('light and dark, wide and narrow: nothing sticks out', async () => {
  for (const dark of [false, true]) {
    await browser.theme(dark);
    for (const [width, height] of [[1280, 800], [1366, 768], [1920, 1080], [820, 1100]]) {
      await browser.resize(width, height);
      for (const hash of ['#summary', '#frames', '#frame/3']) {
        await browser.goto(report, ready, hash);
        const wide = await browser.value('document.documentElement.scrollWidth - innerWidth');
        assert.ok(wide <= 0, `${hash} at ${width} x ${height}: ${wide} px too wide`);
      }
    }
    const ground = await browser.value("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)[0]");
    assert.ok(dark ? ground < 60 : ground > 200, `ground ${ground}`);
    await browser.resize(1280, 800);
    await browser.goto(report, ready, '#frame/0');
    await shot(dark ? 'frame_dark' : 'frame_light');
  }
  await browser.theme(false);
  quiet();
});

test('a recognized depth frame, its truth unknown', async () => {
  await browser.goto(path('recognized/report.html'), ready, '#frame/0');
  assert.match(await text('.why .first'), /^Recognized: bracket/);
  assert.ok((await texts('.candidates th')).includes('score'));
  await browser.click('.stages [data-stage=input]');
  assert.match(await text('.caption'), /points, thinned from 279,244/);
  assert.ok((await drawnPixels()).drawn > 10000);
  await shot('depth_frame');
  await browser.goto(path('recognized/report.html'), ready, '#frame/1');
  assert.match(await text('.why'), /Nothing was recognized.*below 0\.5\./);
  await browser.goto(path('recognized/report.html'), ready);
  const steps = await texts('dl.glossary dt'), meant = await texts('dl.glossary dd');
  assert.deepEqual([steps[0], steps.at(-1)], ['segmentation', 'decision']);
  assert.deepEqual(steps.filter((_, i) => !meant[i]), [], 'steps without an explanation');
  quiet();
});

test('all objects of a frame, drawn and listed; no stages that the engine does not have', async () => {
  run('scenes', '--models', join(root, 'parts'), '--frames', '3', '--parts', '5', '--seed', '3', '--output', 'several');
  const { width, height, fx, fy, cx, cy, depth_scale: depth_scale_mm } = json(path('several/camera.json'));
  writeFileSync(path('several/depth.camera.json'), JSON.stringify({ width, height, fx, fy, cx, cy, depth_scale_mm }));
  run('recognize', '--models', join(root, 'parts'), '--camera', 'several/depth.camera.json', '--output', 'objects', '--jsonl', 'objects.jsonl', 'several/test/000001/depth/000002.png');
  const { detections } = json(path('objects.jsonl'));
  assert.ok(detections.length > 1, 'a frame of several objects');
  run('report', 'objects');
  await browser.goto(path('objects/report.html'), "document.querySelector('main[data-frame=\"0\"]')");
  assert.deepEqual(await texts('.objects td:first-child'), detections.map((d) => d.model_name));
  assert.match(await text('.why'), new RegExp(`Also recognized: ${detections.slice(1).map((d) => d.model_name).join(', ')}\\.`));
  assert.deepEqual(await browser.value("[...document.querySelectorAll('.stages button')].map((b) => b.dataset.stage)"), ['input', 'verdict']);
  assert.deepEqual((await texts('.candidates th')).filter((label) => ['view', 'fit mm'].includes(label)), []);
  assert.doesNotMatch(await text('.right'), /points|icp|view 0|Configuration/);
  // In the depth image each is orange where its points are.
  const drawn = await browser.value(`(async () => {
    await new Promise(requestAnimationFrame);
    document.querySelector('.depth button').click();  // the whole image
    const canvas = document.querySelector('.depthImage');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const orange = new Set();
    for (let i = 0; i < data.length; i += 4) if (data[i] > 1.4 * data[i + 1] && data[i + 1] > 1.8 * data[i + 2]) orange.add(i / 4);
    return [canvas.width, [...orange]];
  })()`);
  const [imageWidth, orange] = [drawn[0], new Set(drawn[1])];
  for (const { model_name, T } of detections) {
    const [x, y, z] = T.slice(0, 3).map((row) => row[3]);
    let near = 0;
    for (let dv = -40; dv <= 40; ++dv)
      for (let du = -40; du <= 40; ++du)
        near += orange.has((Math.round(cy + (fy * y) / z) + dv) * imageWidth + Math.round(cx + (fx * x) / z) + du);
    assert.ok(near > 200, `${model_name}: ${near} px`);
  }
  await shot('objects');
  quiet();
});

test('experiments: frames.jsonl with runs, frames without a folder, a line cut off, a broken file', async () => {
  const folder = path('experiment');
  mkdirSync(folder);
  for (const f of frames.slice(0, 4)) cpSync(f.at, join(folder, 'iterations', f.folder), { recursive: true });
  cpSync(path('evaluated/meshes'), join(folder, 'meshes'), { recursive: true });
  const line = (runName, f, i, kept) => JSON.stringify({
    run: runName, protocol: 'noisy', descriptor: 'vfh', frame: `${runName} ${i}`,
    truth: { model_name: f.evaluation.ground_truth_model_name, T: f.evaluation.ground_truth_transformation_matrix },
    result: f.result, evaluation: f.evaluation, time_ms: 10 + i, folder: kept ? `iterations/${f.folder}` : '',
  });
  const lines = frames.slice(0, 4).map((f, i) => line('first', f, i, true)).concat(frames.slice(4, 10).map((f, i) => line('second', f, i, false)));
  writeFileSync(join(folder, 'frames.jsonl'), lines.join('\n') + '\n{"run": "first", "fra');
  writeFileSync(join(folder, 'iterations', frames[1].folder, 'extras.json'), '{"candidate_extras": [');
  run('report', 'experiment');
  await browser.goto(path('experiment/report.html'), ready);
  assert.deepEqual(await browser.value("[...document.querySelectorAll('#group option')].map((o) => o.textContent)"),
    ['all 2 runs', 'first \u00b7 noisy \u00b7 vfh', 'second \u00b7 noisy \u00b7 vfh']);
  assert.match(await text('.problems'), /2 files could not be read/);
  await shot('experiment');
  await browser.goto(path('experiment/report.html'), ready, '#frame/0');
  assert.ok((await drawnPixels()).drawn > 1000);
  await browser.goto(path('experiment/report.html'), ready, '#frame/5');
  assert.equal(await text('.head h1'), 'second 1');
  assert.match(await text('.candidates'), /Not saved/);
  await browser.click('.stages [data-stage=input]');
  assert.match(await text('.missing'), /not saved/);
  await shot('not_saved');
  await browser.goto(path('experiment/report.html'), ready, '#frame/1');
  assert.match(await text('.candidates'), /Not saved/);
  quiet();
});

test('poses are right as the command line counts them: up to symmetry, and to what the camera can tell', async () => {
  const share = (n, of) => [`${((100 * n) / of).toFixed(1)} %`, `${n} of ${of}`];
  const choose = (name) => browser.value(`(() => {
    const select = document.getElementById('measure');
    select.selectedIndex = [...select.options].findIndex((o) => o.textContent === ${JSON.stringify(name)});
    select.dispatchEvent(new Event('change'));
  })()`);
  const scenes = join(root, 'experiments/scenes_stereo.json');
  writeFileSync(path('my_parts.json'), JSON.stringify({
    name: 'parts with symmetries',
    groups: [{ name: 'round', parts: ['bracket', 'flange', 'plain_shaft', 'keyed_shaft'].map((part) => join(root, `parts/${part}.stl`)) }],
    protocols: [{ name: 'at rest', scenes, frames: 16 }, { name: 'not in the catalogue', scenes, frames: 4, left_out: true }],
    configurations: [{ name: 'engine' }],
  }));
  const [known] = JSON.parse(run('experiment', 'my_parts.json', '--output', 'my_results', '--json')).runs;
  run('report', 'my_results');
  await browser.goto(path('my_results/report.html'), ready);
  assert.deepEqual(await card('Pose right'), share(known.seen_right, known.frames));
  const byRun = await browser.value("[...document.querySelector('table.figures').querySelectorAll('tbody tr')].map((row) => [row.children[0].textContent, row.children[5].textContent])");
  assert.deepEqual(byRun, [
    ['round / at rest / engine', `${share(known.seen_right, known.frames)[0]} ${known.seen_right}`],
    ['round / not in the catalogue / engine', '\u2013 0']]);
  await choose('symmetry ignored');
  assert.deepEqual(await card('Pose right'), share(known.pose_right, known.frames));
  assert.ok(known.pose_right < known.seen_right, 'the two measures differ on these parts');

  assert.deepEqual(await browser.value("[...document.querySelectorAll('figcaption')].filter((c) => /indistinguishable|diameter/.test(c.textContent)).length"), 0);
  await browser.goto(path('my_results/report.html'), ready, '#frames?group=round+%2F+at+rest+%2F+engine');
  const head = await texts('table.frames th'), scores = await browser.value(`[...document.querySelectorAll('table.frames tbody tr')].map((row) => row.children[${head.indexOf('score')}].textContent)`);
  assert.equal(scores.length, known.frames);
  assert.ok(scores.every((score) => Number(score) > 0), `scores of frames that were not saved: ${scores}`);
  const unsaved = readFileSync(path('my_results/frames.jsonl'), 'utf8').trim().split('\n').findIndex((line) => JSON.parse(line).folder === '');
  await browser.goto(path('my_results/report.html'), ready, `#frame/${unsaved}`);
  assert.match(await text('.candidates'), /save_frames: "all"/);
  assert.doesNotMatch(await text('main'), /debug\./);

  const { kinds } = JSON.parse(run('captured', join(root, 'scenes'), '--models', join(root, 'parts'), '--output', 'captured', '--json'));
  const sum = (key) => Object.values(kinds).reduce((all, kind) => all + kind[key], 0);
  run('report', 'captured');
  await browser.goto(path('captured/report.html'), ready);
  assert.deepEqual(await card('Pose right'), share(sum('pose_right'), sum('frames')));
  await choose('symmetry ignored');
  assert.notDeepEqual(await card('Pose right'), share(sum('pose_right'), sum('frames')));
  quiet();
});

test('the flags of debug.visualize select the stages', async () => {
  const config = json(path('pipeline.json'));
  config.debug = { ...config.debug, save_point_clouds: false, save_extras_json: false, visualize_flag: true,
    visualize: { ...config.debug.visualize, normal_estimation: true, pose_refinement: true } };
  writeFileSync(path('visualize.json'), JSON.stringify(config));
  run('recognize', '--dataset', 'dataset', '--config', 'visualize.json', '--output', 'visualized', 'test/models/0001/views/0003.pcd');
  const [iteration] = readdirSync(path('visualized')).filter((name) => name !== 'meshes');
  await browser.goto(path(`visualized/${iteration}/report.html`), "document.querySelector('main[data-frame=\"0\"]')"); // the only frame
  assert.deepEqual(await browser.value("[...document.querySelectorAll('.stages button')].map((b) => b.dataset.stage)"), ['normals', 'fine']);
  for (const stage of ['normals', 'fine']) {
    await browser.click(`.stages [data-stage=${stage}]`);
    assert.ok((await drawnPixels()).drawn > 1000, stage);
  }
  quiet();
});

test('500 frames: small, quick to open, quick to draw', async () => {
  const folder = path('large');
  mkdirSync(folder);
  writeFileSync(join(folder, 'frames.jsonl'), Array.from({ length: 500 }, (_, i) => {
    const f = frames[i % frames.length];
    return JSON.stringify({ run: 'large', frame: `frame ${i}`, result: f.result, evaluation: f.evaluation, folder: join('..', 'evaluated', f.folder) });
  }).join('\n'));
  run('report', 'large');
  const bytes = statSync(path('large/report.html')).size;
  assert.ok(bytes < 30e6, `${bytes} bytes`);
  const ms = await browser.goto(path('large/report.html'), ready);
  assert.ok(ms < 5000, `opened in ${ms} ms`);
  assert.match(await text('main'), /thinned to keep this file small/);
  const frameMs = await browser.goto(path('large/report.html'), ready, '#frame/250');
  assert.ok((await drawnPixels()).drawn > 1000);
  console.log(`500 frames: ${(bytes / 1e6).toFixed(1)} MB, opened in ${ms.toFixed(0)} ms, a frame in ${frameMs.toFixed(0)} ms`);
  quiet();
});

test('10 000 points turn smoothly', async () => {
  await browser.goto(report, ready, '#frame/0');
  await browser.click('.stages [data-stage=input]');
  const { cpu, all, calls } = await browser.value(`(() => {
    const { view } = partposeReport;
    const points = new Float32Array(30000), colours = new Float32Array(30000).fill(0.3);
    for (let i = 0; i < 30000; i += 3) points.set([200 * Math.sin(i), 150 * Math.sin(1.7 * i), 700 + 100 * Math.sin(2.3 * i)], i);
    view.showPoints({ points, colours }, 2);
    view.render();
    const pictures = 200, gl = view.canvas.getContext('webgl2'), pixel = new Uint8Array(4);
    const timed = (finish) => {
      const start = performance.now();
      for (let i = 0; i < pictures; ++i) {
        view.turn(0.03, 0);
        view.render();
        if (finish) gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      }
      return (performance.now() - start) / pictures;
    };
    return { cpu: timed(false), all: timed(true), calls: view.drawCalls };
  })()`);
  console.log(`10 000 points: ${cpu.toFixed(2)} ms of the page's time for each picture, ${all.toFixed(1)} ms until it is drawn (in software here), ${calls} draw calls`);
  assert.ok(calls <= 3, `${calls} draw calls`);
  assert.ok(cpu < 8 && all < 100, `${cpu} and ${all} ms`);
  quiet();
});

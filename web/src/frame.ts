// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import { bars } from './charts';
import { loadFrame, loadMesh, type Candidate, type Detection, type FrameHeader, type FrameRow, type Packet, type Rows, type StageName } from './data';
import { nearest, paint, rasterize, type Rendered } from './depth';
import { h } from './dom';
import { decodeCloud, decodeDepth, decodeMesh, unproject, type Cloud, type Depth, type Mesh } from './packet';
import { inverse, product, rotationError, transform, translationError } from './pose';
import { sorted } from './list';
import { poseVerdict } from './measure';
import { addressOf, filtered, type Filter, type Report } from './state';
import { View3d, type Coloured, type Part } from './view3d';
import { isEngines, noneOfThem, number, savedBy, stepTip, tipOf, verdictTip, verdictWord, why } from './words';

export const stageNames: StageName[] = ['input', 'preprocessed', 'normals', 'coarse', 'fine', 'verdict'];
const stageLabel: Record<StageName, string> = {
  input: 'Input', preprocessed: 'Preprocessed', normals: 'Normals', coarse: 'Coarse', fine: 'Fine', verdict: 'Verdict',
};
const stageTip: Record<StageName, string> = {
  input: 'What the camera measured, before anything was done to it. Colour: distance from the camera.',
  preprocessed: 'What is left after segmentation, scaling, cropping, voxel grid, plane and outlier removal. Colour: distance from the camera.',
  normals: 'The direction of the surface at each point: red, green, blue are x, y, \u2212z. Grey points have no usable normal and were dropped.',
  coarse: 'The candidate after the coarse alignment (T3 T2 T1); of the Recognizer, after its ICP.',
  fine: 'The candidate after the refinement (T4 T3 T2 T1 = T_final).',
  verdict: 'The result, and the truth (green lines) where it is known.',
};

/** One view for all frames: browsers allow only a few WebGL contexts. */
export const view = new View3d();
const meshes = new Map<number, Promise<Mesh>>();

function meshOf(i: number | undefined): Promise<Mesh> | undefined {
  if (i === undefined) return undefined;
  let mesh = meshes.get(i);
  if (!mesh) {
    mesh = loadMesh(i).then((packet) => decodeMesh(packet.sections, packet.header.mesh));
    meshes.set(i, mesh);
  }
  return mesh;
}

interface Loaded {
  header: FrameHeader;
  depth: Depth | null;
  input: Cloud | null;
  preprocessedOnly: Cloud | null;
  withNormals: Cloud | null;
  result: Cloud | null;
  meshes: Map<number, Mesh>;
  sections: Uint8Array;
}

async function load(index: number): Promise<Loaded> {
  const packet: Packet<FrameHeader> = await loadFrame(index);
  const { header, sections } = packet;
  const cloud = (key: keyof FrameHeader['clouds']) => {
    const section = header.clouds[key];
    return section ? decodeCloud(sections, section) : null;
  };
  const depth = header.depth ? decodeDepth(sections, header.depth) : null;
  const needed = new Set([header.result_mesh, header.truth_mesh, ...[...header.candidates, ...header.detections].map((c) => c.mesh)]);
  const loaded = new Map<number, Mesh>();
  for (const i of needed) {
    const mesh = await meshOf(i);
    if (i !== undefined && mesh && mesh.triangles.length) loaded.set(i, mesh);
  }
  return {
    header, depth, sections, meshes: loaded,
    input: cloud('input') ?? (depth && header.depth && !header.depth.of_cloud ? unproject(depth, 60000) : null),
    preprocessedOnly: cloud('preprocessed_only'), withNormals: cloud('with_normals'), result: cloud('result'),
  };
}

// What the person chose stays for the next frame.
const choice = { stage: 'verdict' as StageName, truth: true, all: false, normals: false, zoomDepth: true, pointScale: 1 };

const ramp = [[68, 58, 131], [49, 104, 142], [33, 145, 140], [53, 183, 121], [160, 218, 57], [253, 231, 37]];
function byDistance(points: Float32Array, dark: boolean): Float32Array {
  const colours = new Float32Array(points.length);
  const z: number[] = [];
  for (let i = 2; i < points.length; i += 3 * Math.max(1, Math.floor(points.length / 6000))) z.push(points[i]);
  z.sort((a, b) => a - b);
  const [near, far] = [z[Math.floor(z.length * 0.02)], z[Math.floor(z.length * 0.98)]];
  for (let i = 0; i < points.length; i += 3) {
    // The light end does not show on a light ground.
    const share = Math.max(0, Math.min(1, (points[i + 2] - near) / (far - near || 1))) * (dark ? 1 : 0.66);
    const at = (dark ? 1 - share : share) * (ramp.length - 1);
    const below = Math.min(ramp.length - 2, Math.floor(at));
    for (let c = 0; c < 3; ++c)
      colours[i + c] = ((ramp[below][c] + (at - below) * (ramp[below + 1][c] - ramp[below][c])) / 255) ** 2.2;
  }
  return colours;
}

function merged(parts: Coloured[]): Coloured {
  return { points: joined(parts.map((part) => part.points)), colours: joined(parts.map((part) => part.colours)) };
}

function joined(parts: Float32Array[]): Float32Array {
  const out = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

/** The corners of a box about the points, with room around them. */
function surroundings(points: Float32Array): Float32Array {
  const lo = [Infinity, Infinity, Infinity];
  const hi = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    lo[i % 3] = Math.min(lo[i % 3], points[i]);
    hi[i % 3] = Math.max(hi[i % 3], points[i]);
  }
  const margin = 0.25 * Math.max(...hi.map((high, a) => high - lo[a]));
  return new Float32Array([0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) =>
    [0, 1, 2].map((a) => ((corner >> a) & 1 ? hi[a] + margin : lo[a] - margin))));
}

function plain(points: Float32Array, colour: [number, number, number]): Coloured {
  const colours = new Float32Array(points.length);
  for (let i = 0; i < points.length; ++i) colours[i] = colour[i % 3];
  return { points, colours };
}

/** Distance of neighbours, about, of an evenly sampled surface. */
function spacing(points: Float32Array): number {
  const count = points.length / 3;
  if (count < 2) return 1;
  const lo = [Infinity, Infinity, Infinity];
  const hi = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    lo[i % 3] = Math.min(lo[i % 3], points[i]);
    hi[i % 3] = Math.max(hi[i % 3], points[i]);
  }
  return Math.max(0.2, Math.min(8, Math.sqrt(((hi[0] - lo[0]) * (hi[1] - lo[1])) / count)));
}

export class FramePage {
  readonly element = h('main', { class: 'frame' });
  /** Resolves when the page can be shown; it is not built before it is, as the 3-D view is one for all pages. */
  readonly ready: Promise<void>;
  private loaded?: Loaded;
  private selected = -1; // index into candidates
  private readonly rows: FrameRow[];
  private readonly row: FrameRow;
  private readonly parts = {
    stages: h('nav', { class: 'stages', role: 'tablist' }),
    caption: h('div', { class: 'caption' }),
    missing: h('div', { class: 'missing', hidden: true }),
    tools: h('div', { class: 'tools' }),
    depth: h('figure', { class: 'depth' }),
    why: h('section', { class: 'why' }),
    objects: h('section', { class: 'objects' }),
    candidates: h('section', { class: 'candidates' }),
    details: h('section', { class: 'details' }),
  };
  private depthCanvas = h('canvas', { class: 'depthImage' });
  private depthNote = h('span', { class: 'quiet' });
  private region = { u: 0, v: 0, width: 1, height: 1 };
  private part: Rendered | null = null;
  private truth: Rendered | null = null;

  constructor(private readonly report: Report, private readonly filter: Filter, index: number) {
    this.row = report.index.frames[index];
    this.rows = sorted(filtered(report, filter), report);
    if (!this.rows.includes(this.row)) this.rows = report.index.frames;
    this.ready = load(index).then(
      (loaded) => void (this.loaded = loaded),
      (error: unknown) => this.element.replaceChildren(h('p', { class: 'loading' }, `This frame cannot be shown: ${String(error)}`)),
    );
  }

  /** To be called when `element` is in the document. */
  start(): void {
    if (!this.loaded) return;
    this.build();
    this.element.dataset.frame = String(this.row.index);
  }

  get header(): FrameHeader {
    return this.loaded!.header;
  }

  private stages(): StageName[] {
    return stageNames.filter((name) => this.report.index.stages[name] && (!isEngines(this.header) || name === 'input' || name === 'verdict'));
  }

  private step(by: number): string {
    const at = this.rows.indexOf(this.row) + by;
    return addressOf('frame', this.filter, this.rows[Math.max(0, Math.min(this.rows.length - 1, at))].index);
  }

  private build(): void {
    const { row, header } = this;
    const { parts } = this;
    const at = this.rows.indexOf(this.row);
    this.selected = header.accepted >= 0 ? header.accepted : header.candidates.length > 0 ? 0 : -1;
    if (!this.stages().includes(choice.stage)) choice.stage = this.stages().at(-1) ?? 'verdict';
    const link = (by: number, label: string, tip: string) => {
      const there = at + by >= 0 && at + by < this.rows.length;
      return h('a', { class: `button${there ? '' : ' off'}`, href: there ? this.step(by) : undefined, tip }, label);
    };
    const fact = (label: string, value: string, tip?: string) => [h('dt', { tip }, label), h('dd', {}, value)];
    const figures = Object.entries(row.figures ?? {});
    const config = header.config === undefined ? '' : this.report.index.configs[header.config];
    this.element.replaceChildren(
      h('div', { class: 'head' },
        link(-1, '\u2190', 'Previous frame of the list (p)'),
        h('h1', {}, row.name),
        h('span', { class: `badge ${row.verdict}`, tip: verdictTip[row.verdict] }, verdictWord[row.verdict]),
        poseVerdict(row, this.report) === 'off' &&
          h('span', { class: 'badge none', tip: 'Beyond the limits that the summary page sets.' }, 'pose off'),
        row.group && h('span', { class: 'quiet' }, row.group),
        h('span', { class: 'space' }),
        h('span', { class: 'quiet' }, `${at + 1} of ${this.rows.length}`),
        h('a', { class: 'button', href: addressOf('frames', this.filter), tip: 'Back to the list (Esc)' }, 'list'),
        link(1, '\u2192', 'Next frame of the list (n)')),
      h('div', { class: 'columns' },
        h('div', { class: 'left' },
          parts.stages,
          h('div', { class: 'stage' }, view.available ? view.canvas : h('p', { class: 'nogl' }, 'This browser shows no WebGL; the depth image and all figures are there all the same.'),
            parts.caption, parts.missing, parts.tools),
          h('div', { class: 'under' },
            parts.depth,
            h('figure', { class: 'steps' },
              h('figcaption', { tip: tipOf('time_ms') }, `Time by step${row.time_ms === undefined ? '' : `: ${number(row.time_ms)} ms in all`}`),
              bars(header.steps.map((s) => ({
                label: s.tag, value: s.ms,
                note: `${number(s.ms)} ms`,
                tip: `${s.tag}: ${number(s.ms)} ms${s.points_in !== undefined ? `, ${s.points_in} points in, ${s.points_out ?? '?'} out` : ''}. ${stepTip[s.tag] ?? ''}`,
              })), 'ms'),
              this.flow()))),
        h('div', { class: 'right' },
          parts.why, parts.objects, parts.candidates, parts.details,
          figures.length > 0 && h('details', { open: true }, h('summary', {}, 'Evaluation'),
            h('dl', { class: 'facts' }, fact('shown', row.truth === '' ? noneOfThem : row.truth ?? '?'),
              Object.entries(row.flags ?? {}).map(([key, value]) => fact(key.replaceAll('_', ' '), value ? 'yes' : 'no', tipOf(key))),
              figures.map(([key, value]) => fact(key.replaceAll('_', ' '), number(value), tipOf(key))))),
          h('details', {}, h('summary', {}, 'Where it comes from'),
            h('dl', { class: 'facts' }, fact('scene', header.scene || 'not saved'), fact('folder', header.folder || 'not kept'))),
          (config || !isEngines(header)) && h('details', {}, h('summary', {}, 'Configuration'),
            h('pre', {}, config || (this.report.index.experiment ? 'see experiment.json' : 'not saved (debug.save_used_pipeline_config_json)'))))));
    this.buildDepth();
    let width = 0;
    new ResizeObserver(() => {
      if (parts.depth.clientWidth !== width && width > 0) this.drawDepth();
      width = parts.depth.clientWidth;
    }).observe(parts.depth);
    this.aim();
    this.buildTools();
    this.refresh();
  }

  /** Points in and out of the steps, as one line. */
  private flow(): Element | false {
    const counts: (string | Element)[] = [];
    let last: number | undefined;
    for (const step of this.header.steps) {
      if (step.points_in !== undefined && counts.length === 0) counts.push(h('b', { tip: 'Points of the input.' }, step.points_in));
      if (step.points_out !== undefined && step.points_out !== (last ?? step.points_in))
        counts.push(' \u2192 ', h('b', { tip: `Points that ${step.tag} left.` }, step.points_out));
      last = step.points_out ?? last;
    }
    return counts.length > 0 && h('p', { class: 'quiet' }, 'points ', counts);
  }

  private aim(): void {
    const l = this.loaded!;
    const { header } = l;
    const best = header.candidates[this.selected];
    const placed: [number | undefined, Rows | undefined][] = [
      ...header.detections.map((d): [number | undefined, Rows] => [d.mesh, d.pose]),
      [header.result_mesh, header.result_pose], [header.truth_mesh, header.truth_pose], [best?.mesh, best?.fine]];
    // The segmented object, or where a whole frame has parts; or all that there is.
    const parts = placed.flatMap(([mesh, pose]) => {
      const loaded = l.meshes.get(mesh ?? -1);
      return loaded && pose ? [transform(pose, loaded.points)] : [];
    });
    const points = (l.withNormals ?? l.preprocessedOnly)?.points;
    const own = points ?? (parts.length ? joined(parts) : l.input?.points ?? new Float32Array());
    view.aim(points ?? (parts.length ? surroundings(own) : own));
    // The part of the depth image around it.
    const depth = l.depth;
    if (!depth) return;
    let [uLo, vLo, uHi, vHi] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < own.length; i += 3) {
      if (own[i + 2] <= 0) continue;
      const [u, v] = [(own[i] / own[i + 2]) * depth.fx + depth.cx, (own[i + 1] / own[i + 2]) * depth.fy + depth.cy];
      [uLo, vLo, uHi, vHi] = [Math.min(uLo, u), Math.min(vLo, v), Math.max(uHi, u), Math.max(vHi, v)];
    }
    const margin = 4 + 0.3 * Math.max(uHi - uLo, vHi - vLo);
    let width = Math.max(1, Math.min(depth.width, Math.ceil(uHi - uLo + 2 * margin)));
    let height = Math.max(1, Math.min(depth.height, Math.ceil(vHi - vLo + 2 * margin)));
    width = Math.min(depth.width, Math.max(width, Math.round((height * 4) / 3)));
    height = Math.min(depth.height, Math.max(height, Math.round((width * 3) / 4)));
    const middle = (lo: number, hi: number, size: number, whole: number) =>
      Math.max(0, Math.min(whole - size, Math.round((lo + hi) / 2 - size / 2)));
    this.region = Number.isFinite(uLo)
      ? { u: middle(uLo, uHi, width, depth.width), v: middle(vLo, vHi, height, depth.height), width, height }
      : { u: 0, v: 0, width: depth.width, height: depth.height };
  }

  private buildTools(): void {
    const toggle = (key: 'truth' | 'all' | 'normals', label: string, letter: string, tip: string) =>
      h('button', { class: choice[key] ? 'on' : '', tip: `${tip} (${letter})`, 'aria-pressed': String(choice[key]), onclick: () => this.toggle(key) }, label);
    this.parts.tools.replaceChildren(
      this.header.truth_pose ? toggle('truth', 'truth', 't', 'The part at its true pose, green lines') : '',
      this.header.candidates.length > 1 ? toggle('all', 'all candidates', 'a', 'The other candidates, grey lines') : '',
      this.loaded!.withNormals?.normals ? toggle('normals', 'normals', 'o', 'Lines along the normals') : '',
      h('button', { class: view.seeThrough ? 'on' : '', tip: 'See through the part (x)', 'aria-pressed': String(view.seeThrough), onclick: () => this.seeThrough() }, 'see through'),
      h('button', { tip: 'Smaller points (,)', onclick: () => this.scalePoints(0.8) }, '\u2022\u2212'),
      h('button', { tip: 'Larger points (.)', onclick: () => this.scalePoints(1.25) }, '\u2022+'),
      h('button', { tip: 'As the camera saw it (r)', onclick: () => view.lookAsCamera() }, 'reset'));
  }

  private toggle(key: 'truth' | 'all' | 'normals'): void {
    choice[key] = !choice[key];
    this.buildTools();
    this.refresh();
  }

  private seeThrough(): void {
    view.seeThrough = !view.seeThrough;
    this.buildTools();
    this.refresh();
  }

  private scalePoints(factor: number): void {
    choice.pointScale *= factor;
    this.refresh();
  }

  private buildDepth(): void {
    const l = this.loaded!;
    const figure = this.parts.depth;
    const section = l.header.depth;
    if (!l.depth || !section) {
      figure.replaceChildren(h('figcaption', {}, 'Depth image'), h('p', { class: 'quiet' }, `not saved (${savedBy(this.report, 'save_point_clouds')})`));
      return;
    }
    const changes = [
      section.of_cloud ? 'made of the cloud' : '',
      section.factor > 1 ? `each ${section.factor}\u00d7${section.factor} px as one` : '',
      section.crop[2] < section.of_width || section.crop[3] < section.of_height ? `cut out of ${section.of_width}\u00d7${section.of_height}` : '',
    ].filter(Boolean);
    const zoom = h('button', { class: choice.zoomDepth ? 'on small' : 'small', tip: 'Only the surroundings of the object (z)', onclick: () => this.toggleDepthZoom() }, 'zoom');
    figure.replaceChildren(
      h('figcaption', { tip: 'What the camera measured, as a relief lit from above left; black: nothing measured. The part at the selected candidate\u2019s pose is drawn over it. Hover: distances.' },
        'Depth image', h('small', {}, changes.length ? ` (${changes.join(', ')})` : ''), zoom),
      this.depthCanvas,
      h('p', { class: 'legend' },
        h('i', { style: 'background:#fa9628' }), h('span', { tip: 'Part and measurement within 5 mm.' }, 'agrees'),
        h('i', { style: 'background:#e63c32' }), h('span', { tip: 'The part lies more than 5 mm before what was measured: the camera saw through it, so it cannot be there.' }, 'part in front'),
        h('i', { style: 'background:#466eeb' }), h('span', { tip: 'The part lies more than 5 mm behind what was measured: something hides it, or it is not there.' }, 'behind'),
        l.header.truth_pose ? [h('i', { style: 'background:#3cd26e' }), h('span', { tip: 'Outline of the part at its true pose.' }, 'truth')] : ''),
      this.depthNote);
    this.depthCanvas.onpointermove = (event) => {
      const depth = this.loaded!.depth!;
      const box = this.depthCanvas.getBoundingClientRect();
      const shown = choice.zoomDepth ? this.region : { u: 0, v: 0, width: depth.width, height: depth.height };
      const u = Math.floor(shown.u + ((event.clientX - box.left) / box.width) * shown.width);
      const v = Math.floor(shown.v + ((event.clientY - box.top) / box.height) * shown.height);
      const i = v * depth.width + u;
      if (!(i >= 0 && i < depth.z.length)) return;
      const measured = depth.z[i] > 0 ? `${depth.z[i].toFixed(1)} mm measured` : 'nothing measured';
      const part = this.part && this.part.z[i] > 0 ? `, part at ${this.part.z[i].toFixed(1)} mm` : '';
      this.depthNote.textContent = `pixel ${u}, ${v}: ${measured}${part}`;
    };
    this.depthCanvas.onpointerleave = () => (this.depthNote.textContent = '\u00a0');
    this.depthNote.textContent = '\u00a0';
  }

  private toggleDepthZoom(): void {
    choice.zoomDepth = !choice.zoomDepth;
    this.buildDepth();
    this.drawDepth();
  }

  select(i: number): void {
    if (i < 0 || i >= this.header.candidates.length) return;
    this.selected = i;
    this.refresh();
    this.parts.candidates.querySelector('[aria-selected=true]')?.scrollIntoView({ block: 'nearest' });
  }

  show(stage: StageName | undefined): void {
    if (!stage || !this.stages().includes(stage)) return;
    choice.stage = stage;
    this.refresh();
  }

  private poseOf(candidate: Candidate): Rows {
    return choice.stage === 'coarse' && candidate.coarse ? candidate.coarse : candidate.fine;
  }

  /** The mesh and pose that the stage shows for the selected candidate, or for a result whose candidates were not saved. */
  private shownPart(): { mesh?: Mesh; pose: Rows; cloud?: Float32Array } | null {
    const l = this.loaded!;
    const candidate = l.header.candidates[this.selected];
    if (['input', 'preprocessed', 'normals'].includes(choice.stage)) return null;
    if (!candidate)
      return l.header.result_pose && choice.stage !== 'coarse'
        ? { mesh: l.meshes.get(l.header.result_mesh ?? -1), pose: l.header.result_pose, cloud: l.result?.points }
        : null;
    const pose = this.poseOf(candidate);
    let cloud: Float32Array | undefined;
    if (candidate.cloud) {
      cloud = decodeCloud(l.sections, candidate.cloud).points;
      if (pose !== candidate.fine) cloud = transform(product(pose, inverse(candidate.fine)), cloud);
    } else if (this.selected === l.header.accepted && choice.stage !== 'coarse') cloud = l.result?.points;
    return { mesh: l.meshes.get(candidate.mesh ?? -1), pose, cloud };
  }

  /** The other objects that were recognized, where the result is shown. */
  private others(): { mesh: Mesh; pose: Rows }[] {
    if (choice.stage !== 'verdict') return [];
    return this.header.detections.slice(1).flatMap(({ mesh, pose }) => {
      const loaded = this.loaded!.meshes.get(mesh ?? -1);
      return loaded ? [{ mesh: loaded, pose }] : [];
    });
  }

  private refresh(): void {
    const l = this.loaded!;
    const { parts } = this;
    parts.stages.replaceChildren(...this.stages().map((name, i) =>
      h('button', { role: 'tab', 'aria-selected': String(name === choice.stage), 'data-stage': name, tip: `${stageTip[name]} (key ${i + 1})`, onclick: () => this.show(name) },
        h('small', {}, i + 1), ` ${stageLabel[name]}`)));
    const shown = this.shownPart();
    const truthMesh = l.meshes.get(l.header.truth_mesh ?? -1);
    const solids = [...(shown?.mesh ? [{ mesh: shown.mesh, pose: shown.pose }] : []), ...this.others()];
    this.part = solids.length && l.depth ? nearest(solids.map(({ mesh, pose }) => rasterize(mesh, pose, l.depth!))) : null;
    const withTruth = choice.truth && shown !== null && truthMesh && l.header.truth_pose;
    this.truth = withTruth && l.depth ? rasterize(truthMesh, l.header.truth_pose!, l.depth) : null;
    if (!shown && choice.truth && choice.stage === 'verdict' && truthMesh && l.header.truth_pose && l.depth)
      this.truth = rasterize(truthMesh, l.header.truth_pose, l.depth);
    this.drawDepth();
    this.draw3d(shown, truthMesh);
    this.writeWhy();
    this.writeObjects();
    this.writeCandidates();
    this.writeDetails();
  }

  private drawDepth(): void {
    const depth = this.loaded!.depth;
    if (!depth) return;
    const whole = document.createElement('canvas');
    paint(whole, depth, this.part, this.truth);
    const shown = choice.zoomDepth ? this.region : { u: 0, v: 0, width: depth.width, height: depth.height };
    this.depthCanvas.width = shown.width;
    this.depthCanvas.height = shown.height;
    const scale = Math.min(this.parts.depth.clientWidth / shown.width, 270 / shown.height);
    this.depthCanvas.style.width = `${Math.round(scale * shown.width)}px`;
    this.depthCanvas.getContext('2d')?.drawImage(whole, -shown.u, -shown.v);
  }

  private draw3d(shown: ReturnType<FramePage['shownPart']>, truthMesh: Mesh | undefined): void {
    const l = this.loaded!;
    const dark = document.documentElement.dataset.theme === 'dark';
    const { stage } = choice;
    const clouds: Coloured[] = [];
    let words = '';
    let missing = '';
    let size = 1;
    const count = (n: number, of: number) => `${n.toLocaleString('en')} points${of > n ? `, thinned from ${of.toLocaleString('en')}` : ''}`;
    const kept = l.withNormals;
    const dropped = l.preprocessedOnly;
    if (stage === 'input') {
      if (l.input) {
        clouds.push({ points: l.input.points, colours: byDistance(l.input.points, dark) });
        words = count(l.input.points.length / 3, l.input.of);
        size = spacing(l.input.points);
      } else missing = `The input was not saved (${savedBy(this.report, 'save_point_clouds')}).`;
    } else if (stage === 'preprocessed') {
      const all = [kept, dropped].filter((c): c is Cloud => c !== null);
      for (const c of all) clouds.push({ points: c.points, colours: new Float32Array() });
      const points = merged(clouds.map((c) => ({ points: c.points, colours: new Float32Array(c.points.length) }))).points;
      clouds.splice(0, clouds.length, { points, colours: byDistance(points, dark) });
      words = count(points.length / 3, all.reduce((sum, c) => sum + c.of, 0));
      size = spacing(points);
      if (points.length === 0) missing = `${l.header.steps.length ? 'No point was left, or the' : 'The'} cloud was not saved (${savedBy(this.report, 'save_point_clouds')}).`;
    } else if (stage === 'normals') {
      if (kept?.normals) {
        const colours = new Float32Array(kept.points.length);
        for (let i = 0; i < colours.length; i += 3) {
          colours[i] = (0.5 + 0.5 * kept.normals[i]) ** 1.6;
          colours[i + 1] = (0.5 + 0.5 * kept.normals[i + 1]) ** 1.6;
          colours[i + 2] = (0.5 - 0.5 * kept.normals[i + 2]) ** 1.6;
        }
        clouds.push({ points: kept.points, colours });
        if (dropped) clouds.push(plain(dropped.points, [0.3, 0.3, 0.3]));
        words = `${count(kept.points.length / 3, kept.of)} with a normal${dropped ? `, ${dropped.of.toLocaleString('en')} dropped` : ''}`;
        size = spacing(kept.points);
      } else missing = `Normals were not saved (${savedBy(this.report, 'save_point_clouds')}), or there were none.`;
    } else {
      const scene = kept ?? l.input;
      if (scene) {
        clouds.push(this.byAgreement(scene.points, dark));
        size = spacing(scene.points);
      }
      const candidate = l.header.candidates[this.selected];
      if (candidate)
        words = `${stage === 'coarse' ? 'coarse alignment of' : stage === 'fine' ? 'refined' : this.selected === l.header.accepted ? 'accepted:' : 'not accepted:'} candidate ${candidate.id}, ${candidate.model_name}`;
      else if (stage === 'verdict') words = this.row.result ? `result: ${this.row.result}` : 'nothing recognized';
      if (shown && !shown.mesh && !shown.cloud) missing = 'The part\u2019s mesh was not saved.';
      if (!shown && stage !== 'verdict') missing = l.header.has_extras ? 'There were no candidates.' : `The candidates were not saved (${savedBy(this.report, 'save_extras_json')}).`;
      if (stage === 'coarse' && candidate && !candidate.coarse) missing = 'The coarse pose was not saved.';
    }
    const solid: Part[] = [];
    if (shown?.mesh) solid.push({ mesh: shown.mesh, pose: shown.pose, colour: this.selected === l.header.accepted || stage !== 'verdict' ? '#f0902a' : '#b9835a', style: 'solid' });
    else if (shown?.cloud) clouds.push(plain(shown.cloud, [0.9, 0.28, 0.03]));
    for (const { mesh, pose } of this.others()) solid.push({ mesh, pose, colour: '#f0902a', style: 'solid' });
    if (shown && choice.all)
      l.header.candidates.forEach((candidate, i) => {
        const mesh = l.meshes.get(candidate.mesh ?? -1);
        if (i !== this.selected && mesh) solid.push({ mesh, pose: this.poseOf(candidate), colour: dark ? '#5f6875' : '#a5adb8', style: 'edges' });
      });
    const stageHasTruth = stage === 'verdict' || stage === 'fine' || stage === 'coarse';
    if (choice.truth && stageHasTruth && truthMesh && l.header.truth_pose)
      solid.push({ mesh: truthMesh, pose: l.header.truth_pose, colour: dark ? '#3cd26e' : '#15803d', style: 'edges' });
    view.background(dark ? '#111418' : '#f1f3f5');
    view.showPoints(merged(clouds), size * 1.35 * choice.pointScale);
    const lines = choice.normals && kept?.normals && stage !== 'input' && stage !== 'preprocessed';
    view.showNormals(kept?.points ?? new Float32Array(), lines ? kept.normals : null, 4 * size);
    view.showParts(solid);
    this.parts.caption.textContent = words;
    this.parts.missing.textContent = missing;
    this.parts.missing.hidden = missing === '';
  }

  /** The scene's points, blue and red where the part lies behind or before them, as the part where they agree: it shows. */
  private byAgreement(points: Float32Array, dark: boolean): Coloured {
    const depth = this.loaded!.depth;
    const neutral: [number, number, number] = dark ? [0.2, 0.23, 0.27] : [0.33, 0.37, 0.43];
    const out = plain(points, neutral);
    if (!depth || !this.part) return out;
    for (let i = 0; i < points.length; i += 3) {
      const z = points[i + 2];
      if (z <= 0) continue;
      const u = Math.round((points[i] / z) * depth.fx + depth.cx);
      const v = Math.round((points[i + 1] / z) * depth.fy + depth.cy);
      if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) continue;
      const part = this.part.z[v * depth.width + u];
      if (part === 0) continue;
      if (part < z - 5) out.colours.set([0.78, 0.05, 0.03], i);
      else if (part > z + 5) out.colours.set([0.06, 0.15, 0.82], i);
      else out.colours.set([0.93, 0.38, 0.08], i);
    }
    return out;
  }

  private writeWhy(): void {
    const [first, ...rest] = why(this.row, this.header, this.report);
    this.parts.why.className = `why ${poseVerdict(this.row, this.report) === 'off' ? 'off' : this.row.verdict}`;
    this.parts.why.replaceChildren(h('p', { class: 'first' }, first), ...rest.map((words) => h('p', {}, words)));
  }

  private writeObjects(): void {
    const { detections } = this.header;
    const has = (key: 'score' | 'confidence') => detections.some((d) => d[key] !== undefined);
    const look = ({ mesh, pose }: Detection) => {
      const loaded = this.loaded!.meshes.get(mesh ?? -1);
      if (loaded) view.aim(surroundings(transform(pose, loaded.points)));
    };
    this.parts.objects.hidden = detections.length < 2;
    this.parts.objects.replaceChildren(
      h('h2', { tip: 'All objects of the frame that were recognized, the one that is explained best first; that one is judged and explained above. Click: look at it.' },
        `Objects (${detections.length})`),
      h('table', {},
        h('thead', {}, h('tr', {}, h('th', {}, 'part'), has('score') && h('th', { class: 'number', tip: tipOf('score') }, 'score'),
          has('confidence') && h('th', { class: 'number', tip: tipOf('confidence') }, 'confidence'),
          h('th', { class: 'number', tip: tipOf('position') }, 'position mm'))),
        h('tbody', {}, detections.map((d) =>
          h('tr', { class: 'clickable', onclick: () => look(d) }, h('td', {}, d.model_name),
            has('score') && h('td', { class: 'number' }, number(d.score)),
            has('confidence') && h('td', { class: 'number' }, number(d.confidence)),
            h('td', { class: 'number' }, [3, 7, 11].map((i) => d.pose[i].toFixed(1)).join(' ')))))));
  }

  private writeCandidates(): void {
    const { candidates, accepted, truth_pose: truth } = this.header;
    const engines = isEngines(this.header);
    const has = (key: keyof Candidate) => candidates.some((c) => c[key] !== undefined);
    const head: [string, string][] = [['', 'Place in the order of the decision. \u2713: accepted.'], ['part', 'The part of this hypothesis.']];
    if (!engines) head.push(['view', tipOf('view_id')]);
    if (has('score')) head.push(['score', tipOf('score')]);
    if (has('icp_fitness') && !engines) head.push(['fit mm', tipOf('icp_fitness')]);
    if (has('match_distance')) head.push(['match', tipOf('match_distance')]);
    if (truth) head.push(['\u0394\u00b0', tipOf('d_rotation')], ['\u0394 mm', tipOf('d_translation')]);
    const own = (c: Candidate) => truth && c.model_name === this.row.truth;
    this.parts.candidates.replaceChildren(
      h('h2', { tip: 'Hypotheses: a view of a part, and where it would lie. In the order of the decision. Arrow keys up and down select.' },
        `Candidates${candidates.length < this.header.candidates_of ? ` (${candidates.length} of ${this.header.candidates_of})` : candidates.length ? ` (${candidates.length})` : ''}`),
      candidates.length === 0
        ? h('p', { class: 'quiet' }, this.header.has_extras ? 'None.' : `Not saved (${savedBy(this.report, 'save_extras_json')}).`)
        : h('div', { class: 'scroll' }, h('table', {},
            h('thead', {}, h('tr', {}, head.map(([label, tip]) => h('th', { tip, class: label === 'part' || label === '' ? '' : 'number' }, label)))),
            h('tbody', {}, candidates.map((c, i) =>
              h('tr', { class: 'clickable', 'aria-selected': String(i === this.selected), 'data-candidate': i, onclick: () => this.select(i), tip: c.verdict || undefined },
                h('td', {}, i === accepted ? '\u2713' : String(c.place)),
                h('td', { class: own(c) ? 'own' : '' }, c.model_name),
                !engines && h('td', { class: 'number' }, c.view_id),
                has('score') && h('td', { class: 'number' }, number(c.score)),
                has('icp_fitness') && !engines && h('td', { class: 'number' }, number(c.icp_fitness)),
                has('match_distance') && h('td', { class: 'number' }, number(c.match_distance)),
                truth && [
                  h('td', { class: 'number' }, own(c) ? number(rotationError(this.poseOf(c), truth)) : '\u2013'),
                  h('td', { class: 'number' }, own(c) ? number(translationError(this.poseOf(c), truth)) : '\u2013'),
                ]))))));
  }

  private writeDetails(): void {
    const candidate = this.header.candidates[this.selected];
    if (!candidate) return this.parts.details.replaceChildren();
    const pose = this.poseOf(candidate);
    const keys = isEngines(this.header)
      ? (['id', 'score', 'match_distance'] as const)
      : (['id', 'score', 'icp_fitness', 'icp_converged', 'match_distance', 'points', 'points_refinement', 'scene_points', 'explained_scene_points', 'visible_model_points', 'unexplained_model_points'] as const);
    const triangles = candidate.mesh === undefined ? null : this.report.index.meshes[candidate.mesh];
    const value = (v: number | boolean) => (typeof v === 'boolean' ? (v ? 'yes' : 'no') : Number.isInteger(v) ? String(v) : number(v));
    this.parts.details.replaceChildren(
      h('h2', {}, `Candidate ${candidate.id}: ${candidate.model_name}`),
      h('p', { class: candidate.verdict === 'accepted' ? 'good verdict' : 'verdict' },
        candidate.verdict === 'accepted' ? 'Accepted.' : candidate.verdict ? `Fell: ${candidate.verdict}.` : 'Its verdict was not saved.'),
      h('dl', { class: 'facts' }, keys.map((key) => candidate[key] === undefined ? null :
        [h('dt', { tip: tipOf(key) }, key.replaceAll('_', ' ')), h('dd', {}, value(candidate[key]!))])),
      h('table', { class: 'matrix', tip: tipOf('T') },
        h('caption', {}, choice.stage === 'coarse' ? 'pose after the coarse alignment' : 'pose (camera_from_model, mm)'),
        h('tbody', {}, [0, 1, 2].map((r) => h('tr', {}, [0, 1, 2, 3].map((c) => h('td', {}, pose[4 * r + c].toFixed(c < 3 ? 4 : 2))))))),
      triangles && triangles.triangles < triangles.of
        ? h('p', { class: 'quiet' }, `Mesh drawn with ${triangles.triangles} of ${triangles.of} triangles.`)
        : '');
  }

  /** True when the key meant something. */
  key(event: KeyboardEvent): boolean {
    if (!this.loaded) return false;
    const { key } = event;
    const stages = this.stages();
    const at = stages.indexOf(choice.stage);
    if (event.shiftKey && key.startsWith('Arrow')) {
      const [x, y] = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] } as Record<string, number[]>)[key];
      view.turn(x * 0.1, y * 0.1);
    } else if (/^[1-6]$/.test(key)) this.show(stages[Number(key) - 1]);
    else if (key === 'ArrowRight') this.show(stages[Math.min(stages.length - 1, at + 1)]);
    else if (key === 'ArrowLeft') this.show(stages[Math.max(0, at - 1)]);
    else if (key === 'ArrowDown') this.select(this.selected + 1);
    else if (key === 'ArrowUp') this.select(this.selected - 1);
    else if (key === 'n' || key === 'PageDown') location.hash = this.step(1);
    else if (key === 'p' || key === 'PageUp') location.hash = this.step(-1);
    else if (key === 'Escape') location.hash = addressOf('frames', this.filter);
    else if (key === 't') this.toggle('truth');
    else if (key === 'a') this.toggle('all');
    else if (key === 'o') this.toggle('normals');
    else if (key === 'x') this.seeThrough();
    else if (key === 'z') this.toggleDepthZoom();
    else if (key === 'r') view.lookAsCamera();
    else if (key === ',') this.scalePoints(0.8);
    else if (key === '.') this.scalePoints(1.25);
    else if (key === '+' || key === '=') view.zoom(0.85);
    else if (key === '-') view.zoom(1.18);
    else return false;
    return true;
  }

  themeChanged(): void {
    if (this.loaded) this.refresh();
  }
}

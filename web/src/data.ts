// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What src/partpose/report/report.cpp writes into the page. A key that is not there was not saved.

export type Verdict = 'correct' | 'wrong' | 'none' | 'found' | 'nothing';

/** A frame in numbers: enough for all tables and plots. */
export interface FrameRow {
  name: string;
  verdict: Verdict;
  result: string; // '' : nothing recognized
  truth?: string; // '' : none of the parts; absent: not known
  run?: string;
  protocol?: string;
  descriptor?: string;
  reason?: string;
  left_out?: boolean; // the part shown was taken out of the catalogue: nothing should be recognized
  best_score?: number; // of the best candidate, accepted or not
  best_is_right?: boolean; // whether that candidate names the part shown
  time_ms?: number;
  figures?: Record<string, number>; // of the evaluation, by its keys
  flags?: Record<string, boolean>; // what it answers with yes or no
  steps?: (number | null)[]; // ms, in the order of Index.steps
  index: number; // set on loading
  group: string; // set on loading
}

export type StageName = 'input' | 'preprocessed' | 'normals' | 'coarse' | 'fine' | 'verdict';

export interface Index {
  title: string;
  limit_deg: number;
  limit_mm: number;
  thinned: boolean;
  experiment: boolean; // the frames are of `partpose experiment`
  stages: Record<StageName | 'candidates', boolean>;
  configs: string[];
  problems: string[];
  steps: string[];
  meshes: { file: string; triangles: number; of: number; diagonal_mm: number }[];
  frames: FrameRow[];
}

export type Rows = number[]; // 12: rotation and translation row by row, mm

export interface CloudSection {
  offset: number;
  count: number;
  of: number;
  lo: number[];
  size: number[];
  normals: boolean;
}

export interface DepthSection {
  offset: number;
  width: number;
  height: number;
  unit_mm: number;
  camera: [number, number, number, number]; // fx fy cx cy
  factor: number;
  crop: [number, number, number, number];
  of_width: number;
  of_height: number;
  of_cloud: boolean;
}

export interface MeshSection {
  offset: number;
  vertices: number;
  triangles: number;
  lo: number[];
  size: number[];
}

export interface Candidate {
  id: number;
  model_name: string;
  view_id: number;
  place: number; // in the order of the decision, from 1
  verdict: string;
  coarse?: Rows;
  fine: Rows;
  score?: number;
  icp_fitness?: number;
  icp_converged?: boolean;
  match_distance?: number;
  points?: number;
  points_refinement?: number;
  visible_model_points?: number;
  unexplained_model_points?: number;
  scene_points?: number;
  explained_scene_points?: number;
  mesh?: number;
  cloud?: CloudSection;
}

/** An object that was recognized. */
export interface Detection {
  model_name: string;
  pose: Rows;
  score?: number;
  confidence?: number;
  mesh?: number;
}

export interface Step {
  tag: string;
  ms: number;
  points_in?: number;
  points_out?: number;
}

export interface FrameHeader {
  clouds: Partial<Record<'input' | 'preprocessed_only' | 'with_normals' | 'result', CloudSection>>;
  depth?: DepthSection;
  candidates: Candidate[]; // in the order of the decision; only the accepted one where the others were not asked for
  candidates_of: number;
  accepted: number;
  detections: Detection[]; // all objects, the result first; of a recognizer that knows no detections none
  result_pose?: Rows;
  result_mesh?: number;
  truth_pose?: Rows;
  truth_mesh?: number;
  steps: Step[];
  config?: number;
  scene: string;
  folder: string;
  has_extras: boolean;
}

/** A header and the bytes that its sections are in. */
export interface Packet<Header> {
  header: Header;
  sections: Uint8Array;
}

async function inflate(id: string): Promise<Uint8Array> {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no block "${id}": it was cut off`);
  const text = atob(element.textContent ?? '');
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function loadPacket<Header>(id: string): Promise<Packet<Header>> {
  const bytes = await inflate(id);
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length))) as Header;
  return { header, sections: bytes.subarray(4 + length) };
}

export async function loadIndex(): Promise<Index> {
  const index = JSON.parse(new TextDecoder().decode(await inflate('index'))) as Index;
  index.frames.forEach((frame, i) => {
    frame.index = i;
    // An experiment's run has the other two in its name, and "-" where there is no descriptor.
    const more = [frame.protocol, frame.descriptor].filter((name) => name && name !== '-' && !frame.run?.includes(name));
    frame.group = [frame.run?.replace(/ \/ -$/, ''), ...more].filter(Boolean).join(' \u00b7 ');
  });
  return index;
}

export const loadFrame = (i: number) => loadPacket<FrameHeader>(`frame${i}`);
export const loadMesh = (i: number) => loadPacket<{ mesh: MeshSection }>(`mesh${i}`);

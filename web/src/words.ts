// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import type { Candidate, FrameHeader, FrameRow, Verdict } from './data';
import { definition, isBelow, poseVerdict } from './measure';
import { rotationError, translationError } from './pose';
import type { Report } from './state';

/** Three digits that count. */
export function number(value: number | undefined | null): string {
  if (value === undefined || value === null || Number.isNaN(value)) return '\u2013';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 100) return value.toFixed(0);
  if (size >= 10) return value.toFixed(1);
  if (size >= 0.01) return value.toFixed(2);
  return String(Number(value.toPrecision(2)));
}

export const percent = (count: number, of: number) => (of ? `${((100 * count) / of).toFixed(1)} %` : '\u2013');

export const verdictWord: Record<Verdict, string> = {
  correct: 'correct',
  wrong: 'wrong part',
  none: 'not recognized',
  found: 'recognized',
  nothing: 'nothing recognized',
};

export const verdictTip: Record<Verdict, string> = {
  correct: 'The part that was shown was recognized; or none was shown, and none recognized. Says nothing about the pose.',
  wrong: 'Another part than the one shown was recognized, or a part where none was shown.',
  none: 'A part of the catalogue was shown, and no candidate was accepted.',
  found: 'A part was recognized. What was shown is not known, so nobody can say whether it is right.',
  nothing: 'No candidate was accepted. What was shown is not known.',
};

export const noneOfThem = '(none of the parts)';
export const nothing = '(nothing)';

/** Every symbol, figure and column, in words. */
const glossary: Record<string, string> = {
  rotation_error_deg: 'Angle of the rotation that turns the result into the truth, in degrees (reference, eq. 2.2). Symmetry is ignored: a cylinder turned about its axis counts as off.',
  translation_error_mm: 'Distance between the origins of the part at the result and at the truth, in mm (reference, eq. 2.3).',
  recognized_correctly: 'Whether the result names the part that was shown; of a part that was left out of the catalogue, whether nothing was recognized.',
  indistinguishable: 'Whether this camera cannot tell the result, part and pose, from the truth.',
  diameter_mm: 'Largest distance of two vertices of the part shown, in mm.',
  mssd_percent: 'MSSD: the largest distance of a model point between result and truth, over the best of all symmetries, in % of the part\u2019s diameter.',
  add_mm: 'ADD: mean distance between each model point at the result and at the truth, in mm.',
  adi_mm: 'ADI (ADD-S): mean distance from each model point at the truth to the nearest one at the result, in mm; for symmetric parts.',
  mssd_mm: 'MSSD: the largest distance of a model point between result and truth, over the best of all symmetries, in mm.',
  mspd_px: 'MSPD: the largest distance in the image of a projected model point between result and truth, over the best of all symmetries, in pixels.',
  vsd: 'VSD: share of the visible pixels whose depth differs between result and truth by more than the tolerance; 0 is perfect.',
  score: 'How well part and measured depth explain each other when the part is rendered at this pose. Of the Engine (the default) the probability that the part is what is seen; of the Recognizer a share of pixels, 1 all, 0 nothing.',
  icp_fitness: 'How far scene and part lie apart after the refinement, in mm: mean nearest distance; of the Recognizer the root mean square of the depths\u2019 differences. Smaller is better.',
  confidence: 'Probability that part and pose are right, up to what this camera cannot tell apart.',
  position: 'Of the part\u2019s origin in the camera frame: x right, y down, z forward, in mm.',
  match_distance: 'How unlike scene and view are; smaller is more alike. Of descriptors the L1 distance: compare only within one descriptor. Of the Engine the mean difference of the template\u2019s cells.',
  icp_converged: 'Whether the refinement stopped because the pose no longer changed.',
  view_id: 'The view of the part, in the dataset, that matched.',
  id: 'Rank in the matching, from 0: the view nearest by the descriptor first.',
  points: 'Points of the view in the dataset.',
  points_refinement: 'Points of the view that the refinement used.',
  visible_model_points: 'Points of the part\u2019s surface that the camera could see at this pose.',
  unexplained_model_points: 'Of the visible points of the part: those without a measured point near. The part says something is there, the camera saw nothing.',
  scene_points: 'Points of the thinned scene.',
  explained_scene_points: 'Of the scene\u2019s points: those near the part\u2019s visible surface.',
  time_ms: 'Wall-clock time of the recognition in milliseconds, without reading the scene.',
  median: 'Half of the values are below, half above.',
  p95: '95 of 100 values are below.',
  d_rotation: 'Angle between this candidate and the truth, in degrees (eq. 2.2), symmetry ignored.',
  d_translation: 'Distance between this candidate\u2019s origin and the truth\u2019s, in mm (eq. 2.3).',
  T: 'camera_from_model: takes points of the model (mm) into the camera frame (mm; x right, y down, z forward). Left 3\u00d73: rotation; right column: translation.',
};

/** The explanation of a figure; of one that is not known here, what its name tells. */
export function tipOf(key: string): string {
  if (glossary[key]) return glossary[key];
  const unit = /_deg$/.test(key) ? ' [degrees]' : /_mm$/.test(key) ? ' [mm]' : /_px$/.test(key) ? ' [pixels]' : /_ms$/.test(key) ? ' [ms]' : '';
  const symmetric = /symm/.test(key) ? ' The best over all poses that are equivalent by symmetry.' : '';
  const base = key.replace(/_(deg|mm|px|ms)$/, '').replaceAll('_', ' ');
  return `${base}${unit}, as evaluation.json has it.${symmetric}`;
}

export const stepTip: Record<string, string> = {
  segmentation: 'Planes (the table) are taken away, what is left is split where the depth jumps.',
  preprocessing: 'Scaling, cropping, voxel grid, plane and outlier removal, as configured.',
  normal_estimation: 'The direction of each point\u2019s surface, from its neighbours. Points without a clear one are dropped.',
  matching: 'The views whose descriptors are nearest to the scene\u2019s become candidates.',
  refinement_cloud: 'The scene, thinned for the refinement.',
  coarse_alignment: 'Each candidate\u2019s view is turned about the line of sight and moved onto the scene.',
  pose_refinement: 'Iterative closest points (ICP) moves each candidate to the best fit nearby.',
  sorting: 'Candidates in the order of their fitness.',
  hypothesis_verification: 'Which candidate explains the scene, and is explained by it.',
  points: 'The object\u2019s points, averaged over blocks of pixels, and how much its depths err.',
  templates: 'What each part looks like from 162 sides is compared with the object: places to start from.',
  refine_1: 'Every start is moved onto the object by a few points; the worst are dropped.',
  refine_2: 'What is left, by more points.',
  at_rest: 'Parts as they lie on a table by themselves; only where nothing explains the object well.',
  anchored: 'A search that need not know how far the part reaches: for what is partly hidden or touches another part.',
  separation: 'What is still not explained: one part after the other is found in it and taken away.',
  verify: 'Each pose is rendered and compared with what was measured.',
  polish: 'The best few are moved onto the pixels themselves.',
  decision: 'The best few, rendered and compared again with more pixels: which is likeliest, and whether it is the part at all.',
};

/** Whether the Engine recognized the frame: it has none of the pipelines' stages, and matches no views of a dataset. */
export const isEngines = (header: FrameHeader) => header.steps.length > 0 && !header.steps.some((step) => step.tag === 'preprocessing');

/** What must be set for something to be saved; `key`: of a configuration's debug. */
export const savedBy = (report: Report, key: string) => (report.index.experiment ? 'the experiment\u2019s save_frames: "all"' : `debug.${key}`);

const partWord = (name: string) => (name === '' ? 'none of the parts' : name);

/** What happened to a candidate of a known truth. */
function errorsOf(candidate: Candidate, truth: number[]): { deg: number; mm: number } {
  return { deg: rotationError(candidate.fine, truth), mm: translationError(candidate.fine, truth) };
}

/** Why the verdict is what it is: sentences, the first one the verdict itself. */
export function why(row: FrameRow, header: FrameHeader, report: Report): string[] {
  const { measure, measures, limits } = report;
  const out: string[] = [];
  const { candidates } = header;
  const accepted = candidates[header.accepted];
  const verdict = poseVerdict(row, report);
  // Another measure, like one that knows of symmetry, may say that all is well.
  const otherwise = verdict === 'off' ? measures.find((other) => poseVerdict(row, { measure: other, limits }) === 'right') : undefined;
  const off = measure ? measure.figures.map((f) => `${number(f.value(row))}${f.unit}`).join(' and ') : '';
  switch (row.verdict) {
    case 'correct':
      if (row.left_out) out.push(`Correct: ${row.truth} was shown, which this catalogue does not have, and nothing was recognized.`);
      else if (row.truth === '') out.push('Correct: none of the parts was shown, and none was recognized.');
      else if (verdict === undefined) out.push(`Correct: this is ${row.result}.`);
      else if (verdict === 'right')
        out.push(`Correct: this is ${row.result}, and its pose is right: ${off} off the truth` +
          `${isBelow(row, measure!, limits) === 'off' ? ', which this camera cannot tell from here' : ''}.`);
      else out.push(`The part is right, ${row.result}, but its pose is ${off} off the truth.`, `It would be right ${definition(measure!, limits)}.`);
      if (otherwise) out.push(`\u201c${otherwise.name}\u201d the pose is right.`);
      break;
    case 'wrong':
      out.push(`Wrong: ${partWord(row.truth ?? '')} was shown, ${row.result} was recognized.`);
      if (verdict === 'right') out.push('The camera cannot tell the two apart here: the pose counts as right.');
      break;
    case 'none':
      out.push(`Not recognized: ${row.truth} was shown, no candidate was accepted.`);
      break;
    case 'found':
      out.push(`Recognized: ${row.result}. What was really shown is not known.`);
      break;
    case 'nothing':
      out.push('Nothing was recognized. What was really shown is not known.');
  }
  if (header.detections.length > 1) out.push(`Also recognized: ${header.detections.slice(1).map((d) => d.model_name).join(', ')}.`);
  if (row.reason && row.result === '') out.push(`The recognizer says: ${row.reason}.`);
  if (accepted) {
    const figures = [
      accepted.score !== undefined ? `score ${number(accepted.score)}` : '',
      accepted.icp_fitness !== undefined && !isEngines(header) ? `fitness ${number(accepted.icp_fitness)} mm` : '',
      accepted.explained_scene_points !== undefined && accepted.scene_points
        ? `${percent(accepted.explained_scene_points, accepted.scene_points)} of the scene explained`
        : '',
      accepted.unexplained_model_points !== undefined && accepted.visible_model_points
        ? `${accepted.unexplained_model_points} of ${accepted.visible_model_points} visible points of the part without a measured point near`
        : '',
    ].filter(Boolean);
    const seen = isEngines(header) ? '' : ` seen as in view ${accepted.view_id}`;
    const place = header.candidates_of === 1
      ? 'the only one'
      : `${accepted.place === 1 ? 'the first' : `number ${accepted.place}`} of ${header.candidates_of} in the order of the decision`;
    out.push(`Accepted: candidate ${accepted.id}, ${accepted.model_name}${seen}, ${place}${figures.length ? ` (${figures.join(', ')})` : ''}.`);
  }
  // Where the truth was lost.
  const failed = verdict === 'off' ? !otherwise : verdict !== 'right' && (row.verdict === 'wrong' || row.verdict === 'none');
  if (failed && row.truth && !row.left_out && candidates.length > 0 && candidates.length === header.candidates_of) {
    const own = candidates.filter((c) => c.model_name === row.truth);
    if (own.length === 0) {
      out.push(`Lost in matching: no view of ${row.truth} is among the ${candidates.length} candidates.`);
    } else if (header.truth_pose) {
      const truth = header.truth_pose;
      const best = own.reduce((a, b) => (errorsOf(a, truth).deg + errorsOf(a, truth).mm <= errorsOf(b, truth).deg + errorsOf(b, truth).mm ? a : b));
      const e = errorsOf(best, truth);
      const rank = candidates.indexOf(best) + 1;
      const which = own.length === 1 ? 'the only candidate' : `the nearest of ${own.length} candidates`;
      if (e.deg < limits.deg && e.mm < limits.mm)
        out.push(`Lost in the decision: candidate ${best.id} is ${row.truth} and only ${number(e.deg)}\u00b0 and ${number(e.mm)} mm off the truth, ` +
          `but stands at place ${rank}${best.verdict && best.verdict !== 'accepted' ? ` and fell: ${best.verdict}` : ''}.`);
      else if (best.coarse)
        out.push(`Lost in the pose: ${which} of ${row.truth} ends ${number(e.deg)}\u00b0 and ${number(e.mm)} mm off the truth; ` +
          `its coarse alignment was ${number(rotationError(best.coarse, truth))}\u00b0 and ${number(translationError(best.coarse, truth))} mm off.`);
      else out.push(`Lost in the pose: ${which} of ${row.truth} ends ${number(e.deg)}\u00b0 and ${number(e.mm)} mm off the truth.`);
    } else {
      out.push(`${row.truth} is among the candidates at place ${candidates.indexOf(own[0]) + 1}${own[0].verdict ? `: ${own[0].verdict}` : ''}.`);
    }
  }
  if (!header.has_extras) out.push(`The candidates were not saved (${savedBy(report, 'save_extras_json')}).`);
  return out;
}

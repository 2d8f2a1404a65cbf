# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path

import numpy as np
import pytest
from conftest import pose

import partpose
from partpose import camera, evaluation, io, synthesis
from partpose.core import DepthImage, Error, Intrinsics, TriangleMesh

CAMERA = Intrinsics(160, 120, 150, 150, 79.5, 59.5)


def small_dataset(folder: Path, box: TriangleMesh) -> io.BopDataset:
    """One scene, two images, one box in each."""
    poses = [pose(5, -3, 400), pose(-8, 2, 450)]
    visible = io.BopVisibility(bbox_obj=[1, 2, 3, 4], bbox_visib=[1, 2, 3, 4], px_count_all=50, px_count_valid=50,
                               px_count_visib=40, visib_fract=0.8)  # fmt: skip
    taken_by = io.BopCamera(CAMERA, depth_scale_mm=0.1)
    images = [io.BopImage(i, taken_by, [io.BopGroundTruth(1, p, visible)]) for i, p in enumerate(poses)]
    scene = io.BopScene(1, io.bop_scene_folder(folder, "test", 1), images)
    io.write_bop_scene(scene)
    for image, p in zip(images, poses):
        io.write_bop_depth(scene.folder, image.id, camera.render(box, p, CAMERA)[0], 0.1)
    io.write_bop_model(folder / "models", 1, box)
    io.write_bop_models_info(folder / "models", {1: io.bop_model_info(box)})
    io.write_bop_camera(folder, io.BopDatasetCamera(CAMERA, 0.1))
    io.write_bop_targets(folder, io.bop_targets_of([scene]))
    return io.read_bop_dataset(folder)


def test_datasets_are_written_and_read(tmp_path: Path, box: TriangleMesh) -> None:
    dataset = small_dataset(tmp_path, box)
    assert isinstance(dataset, io.BopDataset) and dataset.folder == tmp_path and dataset.split == "test"
    assert dataset.models_folder == tmp_path / "models" and "1 models, 1 scenes, 2 targets" in repr(dataset)
    assert dataset.camera is not None and dataset.camera.intrinsics == CAMERA and dataset.camera.depth_scale_mm == 0.1
    info = dataset.models[1]
    assert isinstance(info, io.BopModelInfo) and np.isclose(info.diameter_mm, np.sqrt(2100)) and info.symmetries.empty()
    assert np.allclose(info.box_mm, [[-5, -10, -20], [5, 10, 20]])
    assert len(dataset.read_model(1).triangles) == 12 and io.bop_model_name(1) == "obj_000001.ply"
    scene = dataset.scene(1)
    assert isinstance(scene, io.BopScene) and scene.id == 1 and scene.has_ground_truth and len(scene.images) == 2
    image = scene.image(1)
    assert isinstance(image, io.BopImage) and image.id == 1 and image.camera.depth_scale_mm == 0.1
    assert image.camera.K[0, 2] == 79.5 and image.camera.intrinsics(160, 120) == CAMERA
    assert image.camera.camera_from_world is None
    truth = image.ground_truths[0]
    assert truth.obj_id == 1 and np.allclose(truth.camera_from_model, pose(-8, 2, 450))
    seen = truth.visibility
    assert seen is not None and seen.bbox_obj == seen.bbox_visib == [1, 2, 3, 4] and seen.visib_fract == 0.8
    assert (seen.px_count_all, seen.px_count_valid, seen.px_count_visib) == (50, 50, 40)
    assert scene.depth_path(image).name == "000001.png"
    assert abs(float(scene.read_depth(image).z_mm.max()) - 430) < 1
    target = dataset.targets[0]
    assert (target.scene_id, target.im_id, target.obj_id, target.inst_count) == (1, 0, 1, 1)
    assert io.BopTarget(1, 2, 3).inst_count == 1
    assert io.read_bop_models_info(tmp_path / "models" / "models_info.json")[1].diameter_mm == info.diameter_mm
    assert len(io.read_bop_targets(tmp_path / "test_targets_bop19.json")) == 2
    assert io.read_bop_scene(scene.folder, 1).images[0].id == 0
    for wrong in (lambda: dataset.scene(2), lambda: scene.image(7), lambda: dataset.read_model(5),
                  lambda: io.read_bop_dataset(tmp_path / "nowhere")):  # fmt: skip
        with pytest.raises(Error):
            wrong()


def test_results_are_scored(tmp_path: Path, box: TriangleMesh) -> None:
    dataset = small_dataset(tmp_path, box)
    right = [io.BopEstimate(1, i, 1, 0.9, dataset.scene(1).image(i).ground_truths[0].camera_from_model, time_s=0.5)
             for i in (0, 1)]  # fmt: skip
    io.write_bop_results(tmp_path / "r.csv", right)
    back = io.read_bop_results(tmp_path / "r.csv")
    assert [(e.scene_id, e.im_id, e.obj_id, e.score, e.time_s) for e in back] == [(1, 0, 1, 0.9, 0.5), (1, 1, 1, 0.9, 0.5)]
    assert np.allclose(back[0].camera_from_model, right[0].camera_from_model)
    scores = evaluation.score_bop(dataset, back)
    assert isinstance(scores, evaluation.BopScores) and scores.targets_count == scores.estimates_kept == 2
    assert scores.average_recall == 1 and scores.average_time_per_image_s == 0.5
    assert scores.vsd is not None and scores.vsd.average_recall == 1 and scores.mspd.average_recall == 1
    assert isinstance(scores.mssd, evaluation.BopScore) and scores.mssd.obj_recall == {1: 1}
    recall = scores.mssd.recalls[0]
    assert isinstance(recall, evaluation.BopRecall) and np.isclose(recall.threshold, 0.05) and recall.recall == 1
    assert recall.mean_obj_recall == recall.mean_scene_recall == 1 and recall.tp_count == recall.targets_count == 2
    assert recall.obj_recall == recall.scene_recall == {1: 1}
    match = recall.matches[1]
    assert isinstance(match, evaluation.BopMatch)
    assert (match.scene_id, match.im_id, match.gt_id, match.est_id) == (1, 1, 0, 0)

    moved = [io.BopEstimate(1, 0, 1, 0.9, pose(5, -3, 400) @ pose(x=20))]
    options = evaluation.BopScoreOptions(vsd=False)
    assert not options.vsd and options.image_width == 0 and options.vsd_delta_mm == 15
    poor = evaluation.score_bop(dataset, moved, options)
    assert poor.vsd is None and poor.average_recall is None and poor.average_time_per_image_s == -1
    assert poor.mssd.average_recall < 0.2
    with pytest.raises(Error, match="vsd_delta"):
        evaluation.BopScoreOptions(vsd_delta_mm=-1)
    (tmp_path / "r.csv").write_text((tmp_path / "r.csv").read_text().replace(",0.9,", ",high,"))
    with pytest.raises(Error, match="line 2"):
        io.read_bop_results(tmp_path / "r.csv")


def test_the_toolkits_scores(root: Path) -> None:
    golden = root / "tests" / "bop_golden" / "mini_bop"
    expected = json.loads((golden / "expected.json").read_text())
    dataset = io.read_bop_dataset(golden)
    scores = evaluation.score_bop(
        dataset, io.read_bop_results(golden / "golden_minibop-test.csv"), evaluation.BopScoreOptions(image_width=640)
    )
    assert scores.targets_count == sum(t.inst_count for t in dataset.targets) and 0 < scores.mssd.average_recall < 1
    assert f"{scores.mssd.average_recall:.6f}" in json.dumps(_rounded(expected))
    assert f"{scores.mspd.average_recall:.6f}" in json.dumps(_rounded(expected))


def _rounded(value: object) -> object:
    if isinstance(value, dict):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_rounded(v) for v in value]
    return f"{value:.6f}" if isinstance(value, float) else value


def test_datasets_are_recognized(tmp_path: Path, root: Path) -> None:
    """Frames that write_scene_dataset draws, recognized and scored."""
    parts = [(name, io.read_stl(root / "parts" / f"{name}.stl")) for name in ("bracket", "flange")]
    options = synthesis.SceneDatasetOptions(scene={"parts": [1, 1], "clutter": [0, 0], "seed": 3})
    synthesis.write_scene_dataset(parts[:1], parts[1:], options, 2, tmp_path / "d")
    drawn = synthesis.read_scene_dataset(tmp_path / "d")
    assert isinstance(drawn, synthesis.SceneDataset) and drawn.part_names == {1: "bracket"}
    assert drawn.options == options and list(drawn.unknown_names.values()) == ["flange"]
    assert isinstance(drawn.unknown, dict)
    dataset = drawn.bop
    catalogue = evaluation.bop_catalogue(dataset, tmp_path / "cache")
    assert [p.name for p in catalogue.parts] == ["obj_000001"]
    recognizer = partpose.Recognizer(catalogue)
    told: list[str] = []
    estimates = evaluation.recognize_bop(dataset, recognizer, 0.72, lambda what, done, total: told.append(what))
    assert told and len(estimates) == 2 and {e.obj_id for e in estimates} == {1}
    assert evaluation.score_bop(dataset, estimates).mssd.average_recall > 0.7
    scene = dataset.scene(1)
    image = scene.images[0]
    depth = scene.read_depth(image)
    alone = evaluation.recognize_bop_image(
        recognizer, depth, image.camera.intrinsics(depth.width, depth.height), {1: 1}, 0.72
    )
    assert len(alone) == 1 and np.allclose(alone[0].camera_from_model, estimates[0].camera_from_model)
    with pytest.raises(Error):
        synthesis.read_scene_dataset(tmp_path)


def test_more_pose_errors(box: TriangleMesh) -> None:
    estimate, truth = pose(3, 4, 400), pose(0, 0, 400)
    assert np.isclose(evaluation.ad_mm(box.vertices, estimate, truth, symmetric=False), 5)
    assert evaluation.ad_mm(box.vertices, estimate, truth, symmetric=True) == evaluation.adi_mm(
        box.vertices, estimate, truth
    )
    off = evaluation.projection_error_px(box.vertices, estimate, truth, CAMERA)
    assert np.isclose(off, 150 * 5 / 400, rtol=0.02)
    depth, _ = camera.render(box, truth, CAMERA)
    diameter = partpose.core.diameter(box)
    assert np.allclose(evaluation.visible_surface_discrepancy(box, depth, truth, truth, CAMERA, diameter), 0)
    vsd = evaluation.visible_surface_discrepancy(box, depth, estimate, truth, CAMERA, diameter, delta_mm=15)
    assert vsd.shape == (10,) and (vsd > 0).all() and (np.diff(vsd) <= 0).all()
    assert np.allclose(evaluation.bop_fractions(), np.arange(0.05, 0.51, 0.05))
    assert evaluation.bop_pixels() == list(range(5, 51, 5))


def test_captured_sets_and_the_judge(
    root: Path, recognizer: partpose.Recognizer, bracket_scene: io.Scene, tmp_path: Path
) -> None:
    captured = evaluation.read_captured_set(root / "scenes")
    assert isinstance(captured, evaluation.CapturedSet) and captured.folder == root / "scenes"
    scene = next(s for s in captured.scenes if s.path.name == "bracket.png")
    assert isinstance(scene, evaluation.CapturedScene) and scene.model_name == "bracket" and scene.kind
    found = recognizer.recognize(bracket_scene)
    assert found.camera_from_model is not None and bracket_scene.intrinsics is not None
    mesh = recognizer.catalogue.parts[0].mesh
    symmetries = captured.symmetries.get("bracket", [np.eye(4)])
    error = evaluation.symmetric_pose_error(found.camera_from_model, scene.camera_from_model, symmetries, mesh)
    assert isinstance(error, evaluation.SymmetricPoseError) and error.rotation_deg < 3 and error.translation_mm < 3
    assert error.largest_displacement_mm < 5
    with pytest.raises(Error, match="one pose at least"):
        evaluation.symmetric_pose_error(found.camera_from_model, [], symmetries, mesh)
    with pytest.raises(Error, match="gt.json"):
        evaluation.read_captured_set(tmp_path)

    judge = evaluation.PoseJudge(recognizer.catalogue)
    shown = evaluation.GroundTruth("bracket", scene.camera_from_model[0])
    judged = judge.judge(found.result, shown, bracket_scene.intrinsics, bracket_scene.depth)
    assert judged.recognized_correctly and judge.diameter_mm("bracket") > 50
    assert evaluation.mssd_below(judged, 0.1) and not evaluation.mssd_below(judged, 1e-6)
    with pytest.raises(Error):
        judge.diameter_mm("brackte")


def test_meshes_of_all_kinds(tmp_path: Path, box: TriangleMesh) -> None:
    io.write_stl(tmp_path / "a.stl", box)
    io.write_ply_mesh(tmp_path / "b.ply", box)
    (tmp_path / "c.off").write_text("OFF\n4 4 6\n0 0 0\n30 0 0\n0 40 0\n0 0 50\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
    assert len(io.read_off(tmp_path / "c.off").triangles) == 4
    parts = io.read_meshes([tmp_path], io.MeshReadOptions(chord_tolerance_mm=0.5))
    assert [p.name for p in parts] == ["a", "b", "c"] and isinstance(parts[0], io.NamedMesh)
    assert parts[0].file == tmp_path / "a.stl" and parts[0].unit == "" and len(parts[0].mesh.triangles) == 12
    assert io.content_hash(parts[0].mesh) != io.content_hash(parts[2].mesh)
    assert io.read_mesh_file(tmp_path / "b.ply")[0].name == "b" and io.NamedMesh("x", box, unit="inch").unit == "inch"
    assert {".stl", ".step", ".glb"} <= set(io.mesh_file_endings())
    assert io.reads_step() in (True, False) and io.reads_assimp_formats() in (True, False)
    (tmp_path / "d.stl").write_bytes(b"no such thing")
    with pytest.raises(Error, match="d.stl"):
        io.read_meshes([tmp_path])
    told: list[tuple[Path, str]] = []
    assert len(io.read_meshes([tmp_path], broken=lambda file, message: told.append((file, message)))) == 3
    assert told[0][0] == tmp_path / "d.stl" and "d.stl" in told[0][1]


def test_inspection(box: TriangleMesh) -> None:
    from partpose import geometry

    said = geometry.inspect_mesh(box)
    assert isinstance(said, geometry.MeshInspection) and said.watertight and said.sound() and said.size_mm == (10, 20, 40)
    flipped = np.array(box.triangles)
    flipped[3] = flipped[3][::-1]
    broken = TriangleMesh(box.vertices, np.vstack([flipped, flipped[:1]]))
    assert not geometry.inspect_mesh(broken).sound()
    repair = geometry.repair_mesh(broken)
    assert isinstance(repair, geometry.MeshRepair) and repair.changed_anything() and repair.turned_triangles == 1
    assert repair.removed_duplicates == 1 and repair.removed_degenerate == 0 == repair.welded_vertices
    assert repair.weld_distance_mm >= 0 and geometry.inspect_mesh(repair.mesh).sound()
    assert geometry.guess_unit(0.2) == "metre" and geometry.mm_per_unit("inch") == 25.4
    assert DepthImage(np.zeros((2, 2), np.uint16)).width == 2

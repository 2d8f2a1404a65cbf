# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import gc
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import pose

import partpose
from partpose import dataset, evaluation, geometry, io, pipeline, synthesis
from partpose.core import Error, Intrinsics, PointCloud


def truth_of(root: Path, name: str) -> np.ndarray:
    for entry in json.loads((root / "scenes" / "gt.json").read_text())["scenes"]:
        if Path(entry["scene"]).stem == name:
            return np.array(entry["T"]).reshape(-1, 4, 4)[0]
    raise KeyError(name)


def test_ten_lines(root: Path, tmp_path: Path) -> None:
    out = subprocess.run([sys.executable, root / "python" / "examples" / "ten_lines.py"], cwd=root, check=True,
                         capture_output=True, text=True, env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)}).stdout  # fmt: skip
    assert out.startswith("bracket, score ") and 0.9 <= float(out.split("score ")[1].split(",")[0]) <= 1
    assert len((root / "python" / "examples" / "ten_lines.py").read_text().split("import partpose\n")[1].split("\n")) <= 12


def test_recognition(recognizer: partpose.Recognizer, bracket_scene: io.Scene, root: Path) -> None:
    assert bracket_scene.depth is not None and bracket_scene.intrinsics is not None
    depth, camera = bracket_scene.depth, bracket_scene.intrinsics
    found = recognizer.recognize(depth.z_mm, camera)
    assert found and found.part == "bracket" and found.score > 0.9 and found.reason == ""
    pose_found = found.camera_from_model
    assert pose_found is not None and pose_found.dtype == np.float64
    truth = truth_of(root, "bracket")
    assert partpose.core.rotation_error_deg(pose_found, truth) < 3
    assert partpose.core.translation_error_mm(pose_found, truth) < 3
    assert isinstance(found, pipeline.Recognition) and isinstance(found.stages[0], pipeline.MeasuredOperation)
    assert isinstance(found.extras, pipeline.Extras) and isinstance(found.extras.scene_extras, pipeline.SceneExtras)
    assert found.candidates[0].model_name in ("bracket", "flange") and found.candidates[0].verdict
    assert [s.tag for s in found.stages] and np.isclose(found.total_ms, sum(s.measure_ms for s in found.stages))
    assert found.result.model_name == "bracket" and len(found.extras.candidate_extras) == len(found.candidates)
    assert np.array_equal(found.equivalent_poses()[0], pose_found) and found.symmetries.empty()
    assert len(found.preprocessed) and found.with_normals.has_normals() and len(found.refinement_scene)
    assert found.num_of_points_input > 0 and "bracket at" in repr(found)
    # The same pixels in other clothes.
    for same in (recognizer.recognize(depth.z_mm.astype(np.uint16), camera), recognizer.recognize(depth, camera),
                 recognizer.recognize(bracket_scene),
                 recognizer.recognize((depth.z_mm * 10).astype(np.uint16), camera, depth_scale_mm=0.1)):  # fmt: skip
        assert np.allclose(same.camera_from_model, pose_found, atol=1e-3)
    points = found.preprocessed.points
    del found
    gc.collect()
    assert np.isfinite(points).all()


def test_clouds_are_recognized(recognizer: partpose.Recognizer, root: Path) -> None:
    cloud = io.read_ply(root / "scenes" / "bracket__bracket.ply")
    assert recognizer.recognize(cloud.points).part == recognizer.recognize(cloud).part == "bracket"


def test_nothing_is_no_error(recognizer: partpose.Recognizer, bracket_scene: io.Scene) -> None:
    camera = bracket_scene.intrinsics
    assert camera is not None
    empty = recognizer.recognize(np.zeros((480, 640), np.uint16), camera)
    assert not empty and empty.part is None and empty.camera_from_model is None and empty.score == -1
    assert empty.reason and empty.equivalent_poses() == [] and "nothing" in repr(empty)
    for cloud in (np.zeros((0, 3)), np.zeros((1, 3)), np.full((9, 3), np.nan), np.ones((5, 3))):
        assert not recognizer.recognize(cloud)


@pytest.mark.parametrize(
    "bad",
    [np.zeros((480, 640), np.int32), np.zeros((100, 640), np.uint16), np.zeros((480, 640, 3), np.uint16),
     np.full((480, 640), -1, np.float32)],
)  # fmt: skip
def test_bad_frames(recognizer: partpose.Recognizer, bracket_scene: io.Scene, bad: Any) -> None:
    with pytest.raises(Error, match="depth"):
        recognizer.recognize(bad, bracket_scene.intrinsics)
    with pytest.raises(Error):
        recognizer.recognize(np.zeros((480, 640), np.uint16))  # without intrinsics
    with pytest.raises(Error, match="frame.png: no such file"):
        recognizer.recognize("frame.png")


def test_two_threads_at_once(recognizer: partpose.Recognizer, bracket_scene: io.Scene) -> None:
    alone = recognizer.recognize(bracket_scene).camera_from_model
    found: list[Any] = []
    threads = [threading.Thread(target=lambda: found.append(recognizer.recognize(bracket_scene))) for _ in range(2)]
    for thread in threads:
        thread.start()
    turns = 0
    while any(thread.is_alive() for thread in threads):
        turns += 1  # would not be counted if the library held the lock
        time.sleep(0.001)
    assert turns > 10
    assert len(found) == 2 and all(np.array_equal(r.camera_from_model, alone) for r in found)


def test_catalogues(recognizer: partpose.Recognizer, tmp_path: Path, root: Path) -> None:
    catalogue = recognizer.catalogue
    assert isinstance(catalogue, pipeline.Catalogue) and isinstance(recognizer, pipeline.PartRecognizer)
    assert [part.name for part in catalogue.parts] == ["bracket", "flange"] and catalogue.view_count > 0
    part = catalogue.parts[0]
    assert isinstance(part, pipeline.CataloguePart) and part.id == 0 and len(part.mesh.triangles) and len(part.surface)
    assert part.T1.shape == (4, 4) and len(catalogue.index) >= catalogue.view_count and "2 parts" in repr(catalogue)
    smaller = pipeline.without_part(catalogue, "flange")
    assert [p.name for p in smaller.parts] == ["bracket"]
    with pytest.raises(Error):
        pipeline.without_part(catalogue, "flnage")
    options = pipeline.RecognizerOptions(min_score=0.9)
    assert (options.min_score, options.shortlist_views, options.rolls) == (pytest.approx(0.9), 400, 12)
    assert isinstance(pipeline.Recognizer(smaller, options), partpose.Recognizer)
    with pytest.raises(Error, match="min_score"):
        pipeline.RecognizerOptions(min_score=2)
    assert pipeline.default_cache_folder().name == "partpose"
    assert partpose.Recognizer.catalogue_config().global_descriptor == "vfh"
    with pytest.raises(Error):
        partpose.Recognizer.from_files([tmp_path], cache_folder=tmp_path)
    with pytest.raises(Error):
        partpose.Recognizer.from_files([], cache_folder=tmp_path)


SMALL = {"virtual_depth_camera": {"resolution_px": [320, 240]}, "virtual_views_icosahedron": {"subdivide": 0}}


def test_progress_and_its_errors(tmp_path: Path, root: Path) -> None:
    config = dataset.DatasetPreparationConfig(SMALL)
    models = [root / "parts" / "bracket.stl"]
    told: list[tuple[str, int, int]] = []
    made = dataset.create_dataset(config, models, tmp_path / "d", lambda *step: told.append(step))
    assert told and {total >= done > 0 for _, done, total in told} == {True}
    assert dataset.open_dataset(tmp_path / "d").out == made.out and len(made.out.views) == 12
    with pytest.raises(ZeroDivisionError):
        dataset.create_dataset(config, models, tmp_path / "e", lambda *_: 1 / 0)
    assert not (tmp_path / "e").exists()
    catalogue = pipeline.cached_catalogue(models, config, pipeline.GlobalPipelineConfig(), tmp_path / "cache")
    assert len(catalogue.parts) == 1


def test_ctrl_c_stops_long_work(tmp_path: Path, root: Path) -> None:
    config = dataset.DatasetPreparationConfig(virtual_views_icosahedron={"subdivide": 3})
    sent = []

    def interrupt(*_: object) -> None:
        if not sent:
            sent.append(os.kill(os.getpid(), signal.SIGINT))

    # Programs that a shell starts in the background ignore the signal, and so would this one.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            dataset.create_dataset(config, io.model_files(root / "parts"), tmp_path / "d", interrupt)
    finally:
        signal.signal(signal.SIGINT, before)
    assert not (tmp_path / "d").exists()


def test_datasets(tmp_path: Path, root: Path, box: partpose.TriangleMesh) -> None:
    io.write_stl(tmp_path / "box.stl", box)
    made = dataset.create_dataset(dataset.DatasetPreparationConfig(SMALL), [tmp_path / "box.stl"], tmp_path / "d")
    model = made.out.models[0]
    assert isinstance(made, dataset.Dataset) and isinstance(made.out, dataset.DatasetOut)
    assert isinstance(model, dataset.DatasetModel) and isinstance(made.out.views[0], dataset.DatasetView)
    assert made.folder == tmp_path / "d" and made.mesh_path(0).exists() and made.view_path(0, 3).exists()
    assert made.model_folder(0) == made.mesh_path(0).parent and "1 models, 12 views" in repr(made)
    assert len(model.symmetries.discrete) == 3
    assert np.allclose(made.camera_from_model(0, 2), made.out.views[2].T2 @ model.T1)
    with pytest.raises(Error):
        made.camera_from_model(0, 12)
    view = pipeline.comparable_view(io.read_pcd(made.view_path(0, 0)), pipeline.GlobalPipelineConfig())
    assert view.has_normals()
    assert len(dataset.icosahedron_views(dataset.IcosahedronOptions())) == 42
    assert np.allclose(dataset.centred_from_model(box), np.eye(4))
    (tmp_path / "list.json").write_text('{"model_paths": ["box.stl"]}')
    assert dataset.read_model_list(tmp_path / "list.json") == [tmp_path / "box.stl"]
    assert dataset.ModelList(model_paths=["a"]).model_paths == ("a",)
    info = dataset.read_models_info(root / "scenes" / "symmetries.json")
    assert isinstance(info["flange"], dataset.ModelInfo)
    symmetric = dataset.ModelSymmetries(symmetries_continuous=[{"axis": [0, 0, 1], "offset": [0, 0, 0]}])
    assert len(symmetric.symmetries().continuous) == 1 and dataset.ContinuousSymmetry(axis=[0, 0, 1], offset=[0, 0, 0])
    with pytest.raises(Error):
        dataset.open_dataset(tmp_path)
    (tmp_path / "config.json").write_text(json.dumps({"tga": 1}))
    with pytest.raises(Error, match='did you mean "tag"'):
        dataset.read_dataset_config(tmp_path / "config.json")


def test_solution(tmp_path: Path, root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "dataset.json").write_text(json.dumps(SMALL))
    parts = [str(root / "parts" / f"{name}.stl") for name in ("bracket", "flange")]
    (tmp_path / "models.json").write_text(json.dumps({"model_paths": parts}))
    (tmp_path / "pipeline.json").write_text(json.dumps({"debug": {"step_notion_to_cout": True, "save_extras_json": True,
                                                                  "result_to_cout": True}}))  # fmt: skip
    solution = partpose.Solution()
    with pytest.raises(Error, match="init_online"):
        solution.iterate(np.zeros((3, 3)))
    made = solution.prepare_dataset(tmp_path / "dataset.json", tmp_path / "models.json", tmp_path / "d")
    solution.offline(tmp_path / "d", tmp_path / "pipeline.json")
    solution.init_online(tmp_path / "d", tmp_path / "pipeline.json", tmp_path / "out")
    assert isinstance(solution.pipeline, pipeline.GlobalPipeline) and solution.pipeline.config.debug.save_extras_json
    found = solution.iterate(made.view_path(0, 4))
    assert found.part == "bracket" and found.camera_from_model is not None
    assert partpose.core.translation_error_mm(found.camera_from_model, made.camera_from_model(0, 4)) < 5
    view = io.read_pcd(made.view_path(0, 4))
    for same in (view, view.points, io.Scene(view)):
        assert solution.iterate(same).part == "bracket"
    said = capsys.readouterr()
    assert "bracket" in said.out and said.err
    assert len(list((tmp_path / "out").glob("*/result.json"))) == 4 == len(list((tmp_path / "out").glob("*/extras.json")))

    frames = solution.test_accuracy(tmp_path / "d")
    summary = evaluation.summarize(frames, limit_deg=15, limit_mm=15)
    assert isinstance(summary, evaluation.ProtocolSummary) and summary.frames == 24
    assert summary.correct + summary.wrong + summary.none == 24 and summary.correct_percent() > 80
    assert summary.wrong_percent() + summary.none_percent() < 20 and summary.pose_right <= summary.correct
    assert summary.pose_right_percent() <= 100 and summary.median_ms <= summary.p95_ms
    assert isinstance(frames[0], evaluation.ProtocolFrame) and frames[0].truth.view_id == 0 and frames[0].time_ms > 0
    assert frames[0].result.timestamp == frames[0].evaluation.timestamp
    assert len(list((tmp_path / "out").glob("*/evaluation.json"))) == 24
    assert evaluation.run_protocol and pipeline.load_catalogue and pipeline.read_pipeline_config
    folder = pipeline.write_iteration(tmp_path / "o2", found, io.Scene(view), solution.pipeline.catalogue, solution.pipeline.config)
    assert (folder / "result.json").exists()


def test_evaluation(box: partpose.TriangleMesh, recognizer: partpose.Recognizer, bracket_scene: io.Scene) -> None:
    estimate, truth = pose(3, 4, 500), pose(0, 0, 500)
    assert np.isclose(evaluation.add_mm(box.vertices, estimate, truth), 5)
    assert evaluation.adi_mm(box.vertices, estimate, truth) <= 5
    assert np.isclose(evaluation.mssd_mm(box.vertices, estimate, truth), 5)
    camera = bracket_scene.intrinsics
    assert camera is not None
    assert evaluation.mspd_px(box.vertices, estimate, truth, geometry.Symmetries(), camera) > 5
    with pytest.raises(Error):
        evaluation.add_mm(box.vertices[:0], estimate, truth)
    found = recognizer.recognize(bracket_scene)
    assert found.camera_from_model is not None
    shown = evaluation.GroundTruth("bracket", found.camera_from_model, model_id=0)
    assert (shown.model_name, shown.model_id, shown.view_id) == ("bracket", 0, -1)
    assert shown.camera_from_model.shape == (4, 4)
    judged = evaluation.evaluate(found.result, shown)
    assert judged.recognized_correctly and judged.rotation_error_deg < 1e-3

    mesh = recognizer.catalogue.parts[0].mesh
    same = evaluation.depth_difference(mesh, found.camera_from_model, mesh, found.camera_from_model, camera)
    assert isinstance(same, evaluation.DepthDifference) and same.differing_px == 0 < same.union_px and same.share() == 0
    assert same.indistinguishable(evaluation.AmbiguityOptions()) and same.rms_sigmas == 0
    search = evaluation.AmbiguitySearch(recognizer.catalogue, camera)
    assert search.names == ["bracket", "flange"]
    for other in search.at("bracket", found.camera_from_model):
        assert isinstance(other, evaluation.AmbiguousPose) and other.part in (0, 1) and other.displacement_mm > 0
        assert other.difference.union_px > 0 and other.camera_from_model.shape == (4, 4)
    with pytest.raises(Error, match='did you mean "bracket"'):
        search.at("brackte", found.camera_from_model)


def test_experiments(tmp_path: Path) -> None:
    with pytest.raises(Error, match="nowhere.json"):
        evaluation.run_experiment(tmp_path / "nowhere.json", tmp_path / "out")
    assert evaluation.read_frame_records(tmp_path) == []
    for record in (evaluation.BoundRecord, evaluation.FrameRecord, evaluation.FrameObjects, evaluation.ObjectRecord, evaluation.DetectionRecord):
        assert record.__doc__


def test_pictures(recognizer: partpose.Recognizer, bracket_scene: io.Scene) -> None:
    assert bracket_scene.depth is not None and bracket_scene.intrinsics is not None
    found = recognizer.recognize(bracket_scene)
    mesh = recognizer.catalogue.parts[0].mesh
    picture = pipeline.draw_overlay(bracket_scene.depth, bracket_scene.intrinsics, mesh, found.camera_from_model)
    plain = pipeline.draw_overlay(bracket_scene.depth, bracket_scene.intrinsics)
    assert picture.shape == plain.shape and picture.shape[2] == 3 and (picture != plain).any()


def test_synthesis(box: partpose.TriangleMesh, tmp_path: Path) -> None:
    poses = synthesis.resting_poses(box)
    assert isinstance(poses, synthesis.RestingPoses) and poses.groups == 6 and poses.centre_of_mass_from_mesh
    assert np.allclose(poses.centre_of_mass_mm, 0, atol=1e-5)
    best = poses.poses[0]
    assert isinstance(best, synthesis.RestingPose) and np.isclose(best.centre_height_mm, 5, atol=0.1)
    assert abs(best.down[0]) > 0.99 and best.stability_deg > 3 and best.group >= 0 and 0 < best.probability < 1
    assert best.table_from_model.shape == (4, 4)
    options = synthesis.SceneOptions(clutter=(1, 1), seed=4)
    generator = synthesis.SceneGenerator([("box", box)], options=options)
    assert generator.names == ["box"] and generator.options == options
    scene = generator.generate(0)
    assert isinstance(scene, synthesis.SyntheticScene) and isinstance(scene.pieces[0], synthesis.ScenePiece)
    piece = scene.pieces[0]
    assert piece.name == "box" and piece.index == 0 and piece.in_catalogue() and 0 < piece.visible_fraction() <= 1
    assert 0 < piece.visible_px <= piece.silhouette_px and piece.camera_from_model[2, 3] > 300
    assert scene.frame == 0 and scene.intrinsics.width == 640 and scene.camera_from_table.shape == (4, 4)
    noisy = scene.measured(synthesis.SceneSensorOptions(model="gaussianray"), seed=2)
    assert not np.array_equal(noisy.z_mm, scene.depth.z_mm) and scene.picture().shape == (480, 640, 3)
    assert np.array_equal(generator.generate(0).depth.z_mm, scene.depth.z_mm)
    made = synthesis.SceneDatasetOptions(scene=options)
    synthesis.write_scene_dataset([("box", box)], [], made, 1, tmp_path / "d")
    assert (tmp_path / "d" / "scenes.json").exists()
    assert synthesis.SceneCameraOptions().intrinsics.fx == 615
    with pytest.raises(Error):
        synthesis.SceneGenerator([], options=options)
    with pytest.raises(Error):
        synthesis.resting_poses(partpose.TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)))
    assert isinstance(scene.intrinsics, Intrinsics) and synthesis.RestingPoseOptions and PointCloud

# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import partpose
from partpose import engine, io, pipeline, report
from partpose.core import Error


@pytest.fixture(scope="module")
def small_engine() -> partpose.Engine:
    files = [ROOT / "parts" / f"{name}.stl" for name in ("bracket", "flange")]
    told: list[tuple[str, int, int]] = []
    made = partpose.Engine.from_files(files, progress=lambda *step: told.append(step))
    assert told == [("finding symmetries", 1, 2), ("finding symmetries", 2, 2)]
    return made


def test_the_engine_recognizes(
    small_engine: partpose.Engine, recognizer: partpose.Recognizer, bracket_scene: io.Scene
) -> None:
    assert isinstance(small_engine, pipeline.PartRecognizer) and small_engine.catalogue.parts[0].name == "bracket"
    assert bracket_scene.depth is not None and bracket_scene.intrinsics is not None
    found = small_engine.recognize(bracket_scene.depth.z_mm, bracket_scene.intrinsics)
    other = recognizer.recognize(bracket_scene)
    assert found and found.part == other.part == "bracket" and found.score > 0.8
    assert found.camera_from_model is not None and other.camera_from_model is not None
    assert partpose.core.translation_error_mm(found.camera_from_model, other.camera_from_model) < 5


def test_detections(
    small_engine: partpose.Engine, recognizer: partpose.Recognizer, bracket_scene: io.Scene
) -> None:
    for by in (small_engine, recognizer):
        found = by.recognize(bracket_scene)
        best = found.detections[0]
        assert isinstance(best, partpose.Detection) and isinstance(best, pipeline.Detection)
        assert best.part == found.part and best.score == found.score
        assert np.array_equal(best.camera_from_model, found.camera_from_model)
        assert best.confidence == found.confidence and "bracket" in repr(best) and "bracket" in repr(found)
        if best.confidence is None:
            assert best.covariance is None and best.explanation is None
        else:
            assert 0 < best.confidence <= 1 and best.covariance is not None and best.covariance.shape == (6, 6)
            assert isinstance(best.explanation, pipeline.Explanation) and 0.8 < best.explanation.agreement <= 1
            assert best.explanation.explained_pixels > 100 and best.explanation.unexplained < 0.1
            assert np.allclose(best.covariance, best.covariance.T) and f"{best.confidence:.3f}" in repr(found)
        assert len(found.alternatives) == len(best.alternatives)
        for other in found.alternatives:
            assert isinstance(other, pipeline.Alternative) and other.part in ("bracket", "flange")
            assert 0 <= other.probability <= 1 and other.camera_from_model.shape == (4, 4)
    # The Recognizer states no confidence, and says so.
    assert recognizer.recognize(bracket_scene).confidence is None


def test_the_engine_knows_poses_that_look_the_same(small_engine: partpose.Engine) -> None:
    found = small_engine.recognize(partpose.read_scene(ROOT / "scenes" / "flange.png"))
    assert found.part == "flange" and len(found.equivalent_poses()) == 6  # it has six equal holes


def test_nothing_has_no_detections(small_engine: partpose.Engine, bracket_scene: io.Scene) -> None:
    camera = bracket_scene.intrinsics
    assert camera is not None
    empty = small_engine.recognize(np.zeros((480, 640), np.uint16), camera)
    assert not empty and empty.detections == [] and empty.alternatives == [] and empty.confidence is None


def test_engine_options(small_engine: partpose.Engine, bracket_scene: io.Scene) -> None:
    strict = engine.EngineOptions(min_score=1)
    assert strict.min_score == 1 and 0 < partpose.EngineOptions().min_score < 1 and "min_score" in repr(strict)
    with pytest.raises(Error, match="min_score"):
        engine.EngineOptions(min_score=2)
    found = engine.Engine(small_engine.catalogue, strict).recognize(bracket_scene)
    assert not found and found.reason and found.confidence is None
    with pytest.raises(Error, match="nowhere"):
        engine.Engine.from_files(["nowhere"])


def test_what_is_given_otherwise(small_engine: partpose.Engine, tmp_path: Path) -> None:
    assert repr(small_engine) == "Engine(2 parts: bracket, flange)"
    one = engine.Engine.from_files(ROOT / "parts" / "bracket.stl")
    assert repr(one) == "Engine(1 part: bracket)"
    assert one.recognize(ROOT / "scenes" / "bracket.png").part == "bracket"
    with pytest.raises(Error, match="depth: uint16, float32 or float64 is expected, got int32"):
        one.recognize(np.zeros((4, 6), np.int32), partpose.Intrinsics(6, 4, 5, 5, 2.5, 1.5))
    with pytest.raises(Error, match=r"N x 3 array of float32 or float64 is expected, got float64 of shape \(5, 2\)"):
        one.recognize(np.zeros((5, 2)))
    mesh = one.catalogue.parts[0].mesh
    io.write_stl(tmp_path / "metres.stl", partpose.TriangleMesh(mesh.vertices * 0.001, mesh.triangles))
    with pytest.warns(UserWarning, match="metres.stl: is 0.134. mm across; is it in metres") as warned:
        engine.Engine.from_files([tmp_path / "metres.stl"])
    assert warned[0].filename == __file__


def test_parts_come_and_go(bracket_scene: io.Scene) -> None:
    flange, bracket = (io.read_meshes([ROOT / "parts" / f"{name}.stl"])[0] for name in ("flange", "bracket"))
    growing = engine.Engine.from_files([ROOT / "parts/flange.stl"])
    assert not growing.recognize(bracket_scene)
    growing.add(bracket)
    assert growing.recognize(bracket_scene).part == "bracket"
    with pytest.raises(Error, match="flange"):
        growing.add(flange)
    growing.remove("bracket")
    assert not growing.recognize(bracket_scene)
    with pytest.raises(Error, match="bracket"):
        growing.remove("bracket")


def test_reports(tmp_path: Path, recognizer: partpose.Recognizer, bracket_scene: io.Scene) -> None:
    config = pipeline.GlobalPipelineConfig()
    found = recognizer.recognize(bracket_scene)
    pipeline.write_iteration(tmp_path / "out", found, bracket_scene, recognizer.catalogue, config)
    told: list[tuple[str, int, int]] = []
    summary = report.write_report(
        tmp_path / "out", tmp_path / "report.html", title="one frame", progress=lambda *step: told.append(step)
    )
    assert told == [("reading frames", 1, 1), ("packing frames", 1, 1)]
    assert isinstance(summary, report.ReportSummary) and summary.frames == 1 and not summary.thinned
    assert summary.bytes == (tmp_path / "report.html").stat().st_size and summary.problems == []
    report.write_report(tmp_path / "out", tmp_path / "other.html", title="another title")
    assert (tmp_path / "other.html").read_bytes() != (tmp_path / "report.html").read_bytes()
    with pytest.raises(Error, match="empty"):
        (tmp_path / "empty").mkdir()
        report.write_report(tmp_path / "empty", tmp_path / "r.html")

# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Without hardware: RealSense by the SDK's own software device, OpenNI2 by its library's dummy driver."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import partpose
from partpose import live, sources
from partpose.core import Error, Intrinsics

CAMERA = Intrinsics(64, 48, 60, 61, 31.5, 23.5)


def put_frame(folder: Path, name: str, value: int = 5000) -> None:
    """A depth PNG written beside and renamed, with camera.json for all."""
    folder.mkdir(exist_ok=True)
    camera = partpose.io.CameraFile(width=64, height=48, fx=60, fy=61, cx=31.5, cy=23.5, depth_scale_mm=0.1)
    partpose.io.write_camera(folder / "camera.json", camera)
    depth = partpose.DepthImage(np.full((48, 64), value, np.uint16), depth_scale_mm=0.1)
    partpose.io.write_depth_png(folder / f"{name}.part", depth, 0.1)
    (folder / f"{name}.part").rename(folder / name)


def test_folders(tmp_path: Path) -> None:
    for i, name in enumerate(("b.png", "a.png", "c.png")):
        put_frame(tmp_path / "frames", name, 5000 + i)
    with sources.open_source(tmp_path / "frames") as source:
        assert isinstance(source, sources.DepthFolder) and isinstance(source, sources.Source)
        assert source.folder == tmp_path / "frames" and not source.follow
        frames = list(source)
    assert [Path(f.name).name for f in frames] == ["a.png", "b.png", "c.png"] and [f.number for f in frames] == [0, 1, 2]
    frame = frames[0]
    assert isinstance(frame, sources.Frame) and frame.intrinsics == CAMERA and frame.depth_mm.dtype == np.float32
    assert np.allclose(frame.depth_mm, 500.1) and "64 x 48" in repr(frame)
    assert frame.timestamp_s == (tmp_path / "frames" / "a.png").stat().st_mtime
    (tmp_path / "empty").mkdir()
    with pytest.raises(Error, match="follow"):
        sources.DepthFolder(tmp_path / "empty")
    with pytest.raises(Error, match="no such folder"):
        sources.DepthFolder(tmp_path / "nowhere")
    os.rename(tmp_path / "frames" / "camera.json", tmp_path / "other.json")
    with pytest.raises(Error, match="camera.json"):
        sources.DepthFolder(tmp_path / "frames").read()
    with sources.open_source(tmp_path / "frames", camera=tmp_path / "other.json") as source:
        assert [f.intrinsics for f in source] == 3 * [CAMERA]
    with pytest.raises(Error, match="realsense: --camera is of folders"):
        sources.open_source("realsense", camera=tmp_path / "other.json")


def test_pictures_beside_the_depth_images_are_left_out(tmp_path: Path) -> None:
    for name in ("0.png", "1.png"):
        put_frame(tmp_path / "frames", name)
        partpose.io.write_png(tmp_path / "frames" / f"colour_{name}", np.zeros((48, 64, 3), np.uint8))
    assert partpose.io.is_picture_png(tmp_path / "frames" / "colour_0.png")
    assert not partpose.io.is_picture_png(tmp_path / "frames" / "0.png")
    with sources.open_source(tmp_path / "frames") as source, pytest.warns(UserWarning, match="picture") as warned:
        assert [Path(f.name).name for f in source] == ["0.png", "1.png"]
    assert len(warned) == 1


def test_a_followed_folder_gives_what_comes(tmp_path: Path) -> None:
    put_frame(tmp_path / "frames", "0.png")
    source = sources.DepthFolder(tmp_path / "frames", follow=True)
    assert source.read() is not None and source.read(timeout_s=0.1) is None
    threading.Timer(0.2, put_frame, (tmp_path / "frames", "1.png", 6000)).start()
    frame = source.read(timeout_s=5)
    assert frame is not None and frame.number == 1 and np.allclose(frame.depth_mm, 600)
    threading.Timer(0.2, source.close).start()
    assert list(source) == []  # ends by close


def test_what_is_no_source(tmp_path: Path) -> None:
    with pytest.raises(Error, match="no such source; give a folder"):
        sources.open_source("relasense")
    with pytest.raises(Error, match="no such file"):
        sources.open_source(tmp_path / "x.oni")
    with pytest.raises(Error, match="only a folder can be followed"):
        sources.open_source("realsense", follow=True)


# RealSense -----------------------------------------------------------------------------------------------------------


class SoftwareCamera:
    """A depth camera of the SDK that has no hardware behind it."""

    def __init__(self, distortion: float = 0) -> None:
        self.rs = rs = pytest.importorskip("pyrealsense2", exc_type=ImportError)
        self.device = rs.software_device()
        self.sensor = self.device.add_sensor("Depth")
        intrinsics = rs.intrinsics()
        intrinsics.width, intrinsics.height = CAMERA.width, CAMERA.height
        intrinsics.fx, intrinsics.fy, intrinsics.ppx, intrinsics.ppy = CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy
        intrinsics.model, intrinsics.coeffs = rs.distortion.brown_conrady, [distortion, 0, 0, 0, 0]
        stream = rs.video_stream()
        stream.type, stream.index, stream.uid, stream.fmt = rs.stream.depth, 0, 0, rs.format.z16
        stream.width, stream.height, stream.fps, stream.bpp = CAMERA.width, CAMERA.height, 30, 2
        stream.intrinsics = intrinsics
        self.profile = self.sensor.add_video_stream(stream, True)
        self.sensor.add_read_only_option(rs.option.depth_units, 0.0001)

    def take(self, number: int) -> None:
        rs, frame = self.rs, self.rs.software_video_frame()
        self.pixels = np.full((CAMERA.height, CAMERA.width), 5000 + number, np.uint16)
        frame.pixels, frame.stride, frame.bpp = self.pixels, 2 * CAMERA.width, 2
        frame.timestamp, frame.domain, frame.frame_number = 100.0 * number, rs.timestamp_domain.system_time, number
        frame.profile, frame.depth_units = self.profile.as_video_stream_profile(), 0.0001
        self.sensor.on_video_frame(frame)


def test_realsense_live() -> None:
    camera = SoftwareCamera()
    source = sources.RealSense(device=camera.device)
    with source:
        assert source.intrinsics == CAMERA
        for number in (0, 1):
            camera.take(number)
            frame = source.read()
            assert frame is not None and frame.number == number and np.isclose(frame.timestamp_s, 0.1 * number)
            assert frame.depth_mm.dtype == np.float32 and np.allclose(frame.depth_mm, 500 + 0.1 * number, atol=1e-3)
            assert frame.intrinsics == CAMERA
        kept = frame.depth_mm
        for number in range(2, 6):
            camera.take(number)
        newest = source.read()
        assert newest is not None and newest.number == 5 and np.allclose(kept, 500.1, atol=1e-3)
        with pytest.raises(Error, match="no depth frame within 0.3 s"):
            source.read(timeout_s=0.3)
    assert source.read() is None  # closed
    source.close()


def test_realsense_streams_are_chosen_and_checked() -> None:
    camera = SoftwareCamera()
    with sources.RealSense(device=camera.device, width=64, fps=30) as source:
        camera.take(7)
        frame = source.read()
        assert frame is not None and frame.number == 7
    with pytest.raises(Error, match="there are: 64 x 48 at 30/s"):
        sources.RealSense(device=SoftwareCamera().device, width=640)
    with pytest.raises(Error, match="distorted"):
        sources.RealSense(device=SoftwareCamera(distortion=0.1).device)
    with pytest.raises(Error, match="no camera is connected|there is no camera"):
        sources.RealSense(serial="no such serial")


def record(folder: Path, count: int) -> Path:
    """A recording by the SDK's own recorder."""
    camera = SoftwareCamera()
    rs = camera.rs
    for ending in (".bag", ".db3"):  # older SDKs write the one, newer ones the other
        try:
            recorder = rs.recorder(str(folder / f"r{ending}"), camera.device)
            break
        except RuntimeError:
            continue
    sensor = recorder.query_sensors()[0]
    queue = rs.frame_queue(count)
    sensor.open(sensor.get_stream_profiles()[0])
    sensor.start(queue)
    for number in range(count):
        camera.take(number)
        time.sleep(0.02)
    time.sleep(0.3)
    sensor.stop()
    sensor.close()
    return folder / f"r{ending}"


def test_realsense_recordings(tmp_path: Path) -> None:
    recording = record(tmp_path, 30)
    with sources.open_source(recording) as source:
        assert isinstance(source, sources.RealSense) and source.intrinsics == CAMERA
        frames = []
        for frame in source:
            frames.append(frame)
            time.sleep(0.005)
    assert [f.number for f in frames] == list(range(30))  # none is dropped
    assert np.allclose(frames[29].depth_mm, 502.9, atol=1e-3) and np.isclose(frames[29].timestamp_s, 2.9)
    (tmp_path / "broken.bag").write_bytes(b"hello")
    with pytest.raises(Error, match="broken.bag: is no recording"):
        sources.open_source(tmp_path / "broken.bag")
    with pytest.raises(Error, match="nowhere.db3: no such file"):
        sources.open_source(tmp_path / "nowhere.db3")


def test_without_the_sdks(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pyrealsense2", "openni", "openni.openni2"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(Error, match=r"partpose\[realsense\]"):
        sources.open_source("realsense")
    with pytest.raises(Error, match=r"partpose\[openni\]"):
        sources.open_source("openni")


# OpenNI2 -------------------------------------------------------------------------------------------------------------


def openni() -> Any:
    pytest.importorskip("openni")
    if not any(Path(f, "libOpenNI2.so").exists() for f in sources._openni_folders()):
        pytest.skip("needs OpenNI2's library (Debian: libopenni2-dev)")


def test_openni_by_its_dummy_driver() -> None:
    openni()
    camera = Intrinsics(320, 240, 285, 285, 159.5, 119.5)
    with sources.OpenNI2("Dummy", intrinsics=camera) as source:
        frames = [source.read(), source.read()]
    first, second = frames
    assert first is not None and second is not None and second.number > first.number
    assert second.timestamp_s > first.timestamp_s and first.intrinsics == camera
    assert first.depth_mm.shape == (240, 320) and first.depth_mm.dtype == np.float32
    assert (first.depth_mm[0] == 2000).all()  # the row that this driver writes into each frame
    assert source.read() is None  # closed
    with pytest.raises(Error, match="field of view"):
        sources.open_source("openni:Dummy")
    with pytest.raises(Error, match="OpenNI2: no_such_device"):
        sources.OpenNI2("no_such_device")
    with pytest.raises(Error, match="320 x 240"):
        with sources.OpenNI2("Dummy", intrinsics=CAMERA) as wrong:
            wrong.read()


# partpose-live -------------------------------------------------------------------------------------------------------


def run(root: Path, cache: Path, *arguments: object, **more: Any) -> subprocess.CompletedProcess[str]:
    models = [root / "parts" / "bracket.stl", root / "parts" / "flange.stl"]
    command = [sys.executable, "-m", "partpose", "live", *arguments, "--cache", cache, "--models", *models]
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=300, **more)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def test_live_prints_a_line_for_each_frame(root: Path, cache: Path, tmp_path: Path) -> None:
    for name in ("bracket", "empty_table"):
        for ending in (".png", ".camera.json"):
            shutil.copy(root / "scenes" / f"{name}{ending}", tmp_path)
    done = run(root, cache, tmp_path, "--json", "--jsonl", tmp_path / "out.jsonl")
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line["part"] for line in lines] == ["bracket", None] and lines[1]["reason"]
    assert np.array(lines[0]["camera_from_model"]).shape == (4, 4) and lines[0]["score"] > 0.8
    assert lines[0]["detections"][0]["part"] == "bracket" and lines[0]["time_ms"] > 0
    assert lines[0]["name"] == str(tmp_path / "bracket.png") and lines[1]["camera_from_model"] is None
    assert (tmp_path / "out.jsonl").read_text() == done.stdout
    assert done.stderr.startswith("2 frames, 1 recognized")
    plain = run(root, cache, tmp_path, "--frames", 1, "--recognizer", "recognizer", "-q")
    assert plain.stdout.startswith(f"{tmp_path / 'bracket.png'}: bracket at (-5.") and plain.stderr == ""


def test_the_program_live_writes_the_same_lines(root: Path, cache: Path, tmp_path: Path) -> None:
    program = root / "build" / "release" / "partpose"
    if not program.exists():
        pytest.skip("needs the built command line, as script/test_python makes it")
    for name in ("bracket", "empty_table"):
        for ending in (".png", ".camera.json"):
            shutil.copy(root / "scenes" / f"{name}{ending}", tmp_path)
    for recognizer in ("engine", "recognizer"):
        arguments = [tmp_path, "--json", "--recognizer", recognizer]
        by_package = run(root, cache, *arguments).stdout.splitlines()
        models = ["--models", root / "parts" / "bracket.stl", "--models", root / "parts" / "flange.stl"]
        command = [program, "live", *arguments, "--cache", cache, *models]
        by_program = subprocess.run([str(c) for c in command], capture_output=True, text=True).stdout.splitlines()
        assert len(by_package) == len(by_program) == 2
        for one, other in zip(map(json.loads, by_package), map(json.loads, by_program)):
            assert list(one) == list(other)
            for line in (one, other):
                assert line.pop("time_ms") > 0
            assert close(one, other)


def close(one: Any, other: Any) -> bool:
    """The same JSON, numbers to five digits."""
    if isinstance(one, dict) and isinstance(other, dict):
        return list(one) == list(other) and all(close(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(close, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= 1e-5 * max(1, abs(one))
    return bool(one == other)


def test_one_bad_file_of_a_folder_does_not_end_live(root: Path, cache: Path, tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("no picture")
    for ending in (".png", ".camera.json"):
        shutil.copy(root / "scenes" / f"bracket{ending}", tmp_path)
    shutil.copy(root / "scenes" / "bracket.camera.json", tmp_path / "camera.json")
    done = run(root, cache, tmp_path, "-q", "-v")
    assert done.returncode == 2 and "not allowed with" in done.stderr
    done = run(root, cache, tmp_path, "-v", "--threads", 1)
    assert done.returncode == 2 and "bracket at (-5." in done.stdout and " ms  " in done.stderr
    assert done.stderr.startswith(f"partpose-live: {tmp_path / 'a.png'}: ") and "1 frame, 1 recognized" in done.stderr


def test_live_says_what_is_wrong_in_one_line(root: Path, cache: Path, tmp_path: Path) -> None:
    for wrong in (("nowhere",), (tmp_path, "--frames", 0), (tmp_path,), (root / "scenes", "--min-score", 3)):
        done = run(root, cache, *wrong)
        assert done.returncode == 2 and done.stdout == ""
        assert done.stderr.startswith("partpose-live: ") and len(done.stderr.splitlines()) == 1
    other = subprocess.run([sys.executable, "-m", "partpose", "recognise"], capture_output=True, text=True)
    assert other.returncode == 2 and "python -m partpose live" in other.stderr
    with pytest.raises(SystemExit) as version:
        live.main(["--version"])
    assert version.value.code == 0


def test_live_ends_by_ctrl_c(root: Path, cache: Path, tmp_path: Path) -> None:
    put_frame(tmp_path / "frames", "0.png")
    command = [sys.executable, "-m", "partpose", "live", tmp_path / "frames", "--follow", "--json", "--cache", cache,
               "--models", root / "parts" / "bracket.stl"]  # fmt: skip
    program = subprocess.Popen(
        [str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1
    )
    assert program.stdout is not None and program.stderr is not None
    first = json.loads(program.stdout.readline())
    put_frame(tmp_path / "frames", "1.png")
    second = json.loads(program.stdout.readline())
    assert (first["frame"], second["frame"]) == (0, 1)
    program.send_signal(signal.SIGINT)
    assert program.wait(timeout=20) == 0
    assert program.stderr.read().startswith("2 frames, 0 recognized")


def test_live_ends_before_the_first_frame(root: Path, tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    log = tmp_path / "live.jsonl"
    command = [sys.executable, "-m", "partpose", "live", tmp_path / "frames", "--follow", "--jsonl", log,
               "--models", root / "parts" / "bracket.stl"]  # fmt: skip
    program = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not log.exists() and program.poll() is None:
        time.sleep(0.01)
    time.sleep(0.2)  # until it waits
    program.send_signal(signal.SIGINT)
    assert program.wait(timeout=20) == 130


def test_live_takes_a_dash_for_standard_output(
    root: Path, cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    put_frame(tmp_path / "frames", "0.png")
    arguments = [tmp_path / "frames", "--jsonl", "-", "--cache", cache, "--models", root / "parts" / "bracket.stl"]
    assert live.main([str(a) for a in arguments]) == 0
    assert json.loads(capsys.readouterr().out)["frame"] == 0


def test_lines_of_a_recording(tmp_path: Path, recognizer: partpose.Recognizer) -> None:
    with sources.open_source(record(tmp_path, 3)) as source:
        lines = [live.line_of(frame, recognizer.recognize(frame.depth_mm, frame.intrinsics)) for frame in source]
    assert [line["frame"] for line in lines] == [0, 1, 2] and all(line["part"] is None for line in lines)
    json.dumps(lines)

# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras, recordings and folders of depth images. All give the same frames: depth in mm, intrinsics, timestamp."""

from __future__ import annotations

import os
import re
import threading
import time
import warnings
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from partpose.core import Error, Intrinsics
from partpose.io import CameraFile, camera_file_of, is_picture_png, read_camera, read_depth_png

_Path = str | os.PathLike[str]

__all__ = ["Frame", "Source", "DepthFolder", "RealSense", "OpenNI2", "open_source"]


@dataclass(frozen=True)
class Frame:
    """What a camera measured at one moment. `recognizer.recognize(frame.depth_mm, frame.intrinsics)` takes it."""

    depth_mm: Annotated[npt.NDArray[np.float32], dict(shape=(None, None))]
    """Height x width, along the optical axis; 0: no value."""
    intrinsics: Intrinsics
    timestamp_s: float
    """By the source's own clock: of a file, the time it was written."""
    number: int
    """Counts up; a number that is left out is a frame that nobody fetched."""
    name: str = ""
    """The file of a folder's frame."""

    def __repr__(self) -> str:
        height, width = self.depth_mm.shape
        name = f", name={self.name!r}" if self.name else ""
        return f"Frame(number={self.number}, timestamp_s={self.timestamp_s:.3f}, {width} x {height} px{name})"


class Source(ABC):
    """Gives frames: `for frame in source`, or `read()` by hand. To be closed, as by `with`."""

    @abstractmethod
    def read(self, timeout_s: float = 5.0) -> Frame | None:
        """The next frame, of a camera the newest one. None: the recording or the folder has ended. Error when no frame
        comes in time."""

    @abstractmethod
    def close(self) -> None:
        """Lets the camera go. May be called again."""

    def __iter__(self) -> Iterator[Frame]:
        while (frame := self.read()) is not None:
            yield frame

    def __enter__(self) -> Source:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class DepthFolder(Source):
    """The 16-bit depth PNGs of a folder, by their names; the camera of NAME.png is NAME.camera.json or camera.json. With
    `follow`, waits for files to come, as any program may write them: beside (with another ending) and then renamed.
    `camera` is a camera file for all of them.
    Pictures among them (8-bit or in colours) are left out, with a warning."""

    def __init__(self, folder: _Path, *, follow: bool = False, camera: _Path | None = None) -> None:
        self.folder = Path(folder)
        self.follow = follow
        self._camera = None if camera is None else Path(camera)
        self._done: set[Path] = set()
        self._waiting: list[Path] = []
        self._cameras: dict[Path, CameraFile] = {}
        self._number = 0
        self._closed = False
        self._has_pictures = False
        if not self.folder.is_dir():
            raise Error(f"{self.folder}: no such folder")
        if not follow and not any(self.folder.glob("*.png")):
            raise Error(f"{self.folder}: holds no .png; to wait for files to come, give follow=True (--follow)")

    def read(self, timeout_s: float = 5.0) -> Frame | None:
        """The next file by name, each once; None after the last. With `follow`, None when none came in time."""
        deadline = time.monotonic() + timeout_s
        while not self._closed:
            if not self._waiting:
                self._waiting = sorted(set(self.folder.glob("*.png")) - self._done, reverse=True)
            if self._waiting:
                file = self._waiting.pop()
                self._done.add(file)
                if not is_picture_png(file):
                    return self._frame(file)
                if not self._has_pictures:
                    warnings.warn(
                        f"{file}: is a picture (8-bit or in colours), not a depth image: such files are left out",
                        stacklevel=2,
                    )
                self._has_pictures = True
                continue
            if not self.follow or time.monotonic() > deadline:
                return None
            time.sleep(0.05)
        return None

    def __iter__(self) -> Iterator[Frame]:
        while True:
            frame = self.read()
            if frame is not None:
                yield frame
            elif not self.follow or self._closed:
                return

    def _frame(self, file: Path) -> Frame:
        camera_file = self._camera or camera_file_of(file)
        if camera_file not in self._cameras:
            self._cameras[camera_file] = read_camera(camera_file)
        camera = self._cameras[camera_file]
        depth_mm = read_depth_png(file, camera.depth_scale_mm).z_mm
        height, width = depth_mm.shape
        if (width, height) != (camera.intrinsics.width, camera.intrinsics.height):
            raise Error(
                f"{file}: is {width} x {height} px, but {camera_file} is of a camera of "
                f"{camera.intrinsics.width} x {camera.intrinsics.height} px"
            )
        self._number += 1
        return Frame(depth_mm, camera.intrinsics, file.stat().st_mtime, self._number - 1, str(file))

    def close(self) -> None:
        """Ends the waiting."""
        self._closed = True


class _Mailbox:
    """Frames on their way from a camera's thread to the reader. Without `keep_all` the oldest is dropped where there is no
    room; with it, the camera's thread waits."""

    def __init__(self, room: int, keep_all: bool) -> None:
        self._room, self._keep_all = room, keep_all
        self._frames: deque[Frame] = deque()
        self._changed = threading.Condition()
        self._closed = False

    def put(self, frame: Frame) -> None:
        with self._changed:
            while self._keep_all and len(self._frames) >= self._room and not self._closed:
                self._changed.wait()
            if len(self._frames) >= self._room:
                self._frames.popleft()
            self._frames.append(frame)
            self._changed.notify_all()

    def get(self, timeout_s: float) -> Frame | None:
        with self._changed:
            self._changed.wait_for(lambda: self._frames, timeout_s)
            if not self._frames:
                return None
            self._changed.notify_all()
            return self._frames.popleft()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class RealSense(Source):
    """A RealSense camera, or a recording of one (.bag, or .db3 of newer SDKs), through pyrealsense2 (`pip install
    'partpose[realsense]'`). Depth as the camera gives it, without filters, with the depth imager's own intrinsics.

    `serial`: which camera; None: the first. `width`, `height`, `fps`: which stream; None: the camera's default.
    `device`: any device of the SDK, in place of a camera or a recording. Recordings are read frame by frame, however
    long each takes; of a camera, the newest frame is given and older ones are dropped."""

    def __init__(
        self,
        recording: _Path | None = None,
        *,
        serial: str | None = None,
        width: int | None = None,
        height: int | None = None,
        fps: int | None = None,
        device: Any = None,
    ) -> None:
        try:
            import pyrealsense2 as rs
        except ImportError as error:
            if not isinstance(error, ModuleNotFoundError):
                raise Error(f"RealSense: pyrealsense2 cannot be loaded: {error} (libusb: apt-get install libusb-1.0-0)") from error
            raise Error("RealSense: pyrealsense2 is not installed: pip install 'partpose[realsense]'") from error
        self._sensor: Any = None
        self._playback: Any = None
        if recording is not None:
            if not Path(recording).is_file():
                raise Error(f"{Path(recording)}: no such file")
            try:
                device = rs.context().load_device(os.fspath(recording))
            except RuntimeError as error:
                raise Error(f"{Path(recording)}: is no recording that this SDK reads: {error}") from error
            self._playback = device.as_playback()
            self._playback.set_real_time(False)
        elif device is None:
            device = _realsense_camera(rs, serial)
        self._device = device
        sensor = next((s for s in device.query_sensors() if s.is_depth_sensor() or _depth_profiles(rs, s)), None)
        if sensor is None:
            raise Error("RealSense: the device has no depth sensor")
        profile = _chosen_profile(_depth_profiles(rs, sensor), width, height, fps)
        self.intrinsics = _pinhole(rs, profile)
        self._frames = _Mailbox(room=1 if self._playback is None else 16, keep_all=self._playback is not None)
        sensor.open(profile)
        self._sensor = sensor
        sensor.start(self._take)

    def _take(self, frame: Any) -> None:
        """Called by the SDK's thread."""
        if frame.is_depth_frame():
            depth = frame.as_depth_frame()
            depth_mm = np.asanyarray(depth.get_data()).astype(np.float32) * np.float32(1000 * depth.get_units())
            self._frames.put(Frame(depth_mm, self.intrinsics, depth.get_timestamp() / 1000, depth.get_frame_number()))

    def read(self, timeout_s: float = 5.0) -> Frame | None:
        """The newest frame of a camera, the next of a recording."""
        deadline = time.monotonic() + timeout_s
        while self._sensor is not None:
            ended = self._playback is not None and "stopped" in str(self._playback.current_status())
            frame = self._frames.get(0.1)  # short waits, so that Ctrl-C is not kept waiting
            if frame is not None or ended:
                return frame
            if time.monotonic() > deadline:
                raise Error(f"RealSense: no depth frame within {timeout_s:g} s; is the camera still connected?")
        return None

    def close(self) -> None:
        """Stops the stream."""
        sensor, self._sensor = self._sensor, None
        if sensor is not None:
            self._frames.close()
            sensor.stop()
            sensor.close()


def _realsense_camera(rs: Any, serial: str | None) -> Any:
    cameras = {d.get_info(rs.camera_info.serial_number): d for d in rs.context().query_devices()}
    if not cameras:
        raise Error("RealSense: no camera is connected")
    if serial is None:
        return next(iter(cameras.values()))
    if serial not in cameras:
        raise Error(f"RealSense: there is no camera {serial}; connected: {', '.join(cameras)}")
    return cameras[serial]


def _depth_profiles(rs: Any, sensor: Any) -> list[Any]:
    return [
        p.as_video_stream_profile()
        for p in sensor.get_stream_profiles()
        if p.stream_type() == rs.stream.depth and p.format() == rs.format.z16
    ]


def _chosen_profile(profiles: list[Any], width: int | None, height: int | None, fps: int | None) -> Any:
    fitting = [
        p
        for p in profiles
        if width in (None, p.width()) and height in (None, p.height()) and fps in (None, p.fps())
    ]
    if not fitting:
        there = sorted({f"{p.width()} x {p.height()} at {p.fps()}/s" for p in profiles})
        raise Error(f"RealSense: no depth stream as asked for; there are: {', '.join(there) or 'none'}")
    return next((p for p in fitting if p.is_default()), fitting[0])


def _pinhole(rs: Any, profile: Any) -> Intrinsics:
    given = profile.get_intrinsics()
    if given.model != rs.distortion.none and any(abs(c) > 1e-9 for c in given.coeffs):
        raise Error(f"RealSense: this stream is distorted ({given.model}); depth must be rectified, as a D400's is")
    return Intrinsics(given.width, given.height, given.fx, given.fy, given.ppx, given.ppy)


class OpenNI2(Source):
    """A camera with an OpenNI2 driver, or a recording (.oni), through the Python package openni (`pip install
    'partpose[openni]'`) and OpenNI2's own library (Debian: libopenni2-dev).

    `uri`: a camera's address or a recording's file; None: the first camera. `intrinsics`: of the depth image; None: by
    the field of view that the driver states. `library_folder`: where libOpenNI2.so is; None: OPENNI2_REDIST, or else
    where Debian has it."""

    def __init__(
        self, uri: _Path | None = None, *, intrinsics: Intrinsics | None = None, library_folder: _Path | None = None
    ) -> None:
        try:
            from openni import openni2, utils
        except ImportError as error:
            raise Error("OpenNI2: the package openni is not installed: pip install 'partpose[openni]'") from error
        self._openni2 = openni2
        self._stream: Any = None
        self._device: Any = None
        folders = [os.fspath(library_folder)] if library_folder is not None else _openni_folders()
        try:
            openni2.initialize(folders)
        except utils.InitializationError as error:
            raise Error(f"OpenNI2: libOpenNI2.so is in none of {', '.join(folders)}: give library_folder") from error
        address = None if uri is None else os.fsencode(uri)
        try:
            self._device = openni2.Device(address)
            self._stream = self._device.create_depth_stream()
            if self._stream is None:
                raise Error("OpenNI2: the device has no depth stream")
            mode = self._stream.get_video_mode()
            formats = {int(openni2.PIXEL_FORMAT_DEPTH_1_MM.value): 1.0, int(openni2.PIXEL_FORMAT_DEPTH_100_UM.value): 0.1}
            if int(mode.pixelFormat.value) not in formats:
                raise Error(f"OpenNI2: the depth stream's pixels are {mode.pixelFormat}, not a depth in mm")
            self._scale_mm = formats[int(mode.pixelFormat.value)]
            self.intrinsics = intrinsics or self._by_field_of_view(mode)
            if self._device.playback is not None:
                self._device.playback.set_repeat_enabled(False)
            elif self._stream.is_property_supported(7):  # ONI_STREAM_PROPERTY_MIRRORING: as the camera sees it
                self._stream.set_mirroring_enabled(False)
            self._stream.start()
        except utils.OpenNIError as error:
            self.close()
            what = "the first camera" if uri is None else os.fspath(uri)
            raise Error(f"OpenNI2: {what}: {_openni_text(error)}") from error
        except BaseException:
            self.close()
            raise

    def _by_field_of_view(self, mode: Any) -> Intrinsics:
        try:
            horizontal, vertical = self._stream.get_horizontal_fov(), self._stream.get_vertical_fov()
        except Exception as error:
            raise Error("OpenNI2: the driver does not state the field of view: give the intrinsics") from error
        return Intrinsics.from_field_of_view(
            mode.resolutionX, mode.resolutionY, float(np.degrees(horizontal)), float(np.degrees(vertical))
        )

    def read(self, timeout_s: float = 5.0) -> Frame | None:
        """The newest frame of a camera, the next of a recording."""
        deadline = time.monotonic() + timeout_s
        while self._stream is not None:
            # Short waits, so that Ctrl-C is not kept waiting.
            if self._openni2.wait_for_any_stream([self._stream], 0.1) is not None:
                return self._frame(self._stream.read_frame())
            if time.monotonic() > deadline:
                if self._device.playback is not None:
                    return None  # the end of a recording
                raise Error(f"OpenNI2: no depth frame within {timeout_s:g} s; is the camera still connected?")
        return None

    def _frame(self, frame: Any) -> Frame:
        width, height = frame.width, frame.height
        if (width, height) != (self.intrinsics.width, self.intrinsics.height):
            raise Error(
                f"OpenNI2: a frame of {width} x {height} px, but the intrinsics are of "
                f"{self.intrinsics.width} x {self.intrinsics.height} px"
            )
        rows = np.frombuffer(frame.get_buffer_as_uint16(), np.uint16).reshape(height, frame.stride // 2)
        depth_mm = rows[:, :width].astype(np.float32) * np.float32(self._scale_mm)
        made = Frame(depth_mm, self.intrinsics, frame.timestamp / 1e6, frame.frameIndex)
        frame.close()
        return made

    def close(self) -> None:
        """Lets the camera go."""
        stream, self._stream = self._stream, None
        device, self._device = self._device, None
        for each in (stream, device):
            if each is not None:
                each.close()


def _openni_folders() -> list[str]:
    given = [os.environ[name] for name in ("OPENNI2_REDIST64", "OPENNI2_REDIST") if name in os.environ]
    system = [str(p.parent) for p in sorted(Path("/usr/lib").glob("*/libOpenNI2.so"))]
    return given + system + ["/usr/local/lib", "/usr/lib"]


def _openni_text(error: Exception) -> str:
    message = error.args[1] if len(error.args) > 1 else error
    return message.decode(errors="replace") if isinstance(message, bytes) else str(message)


def open_source(name: _Path, *, follow: bool = False, camera: _Path | None = None) -> Source:
    """The source that a text names: a folder of depth PNGs, a recording (.bag, .db3, .oni), "realsense",
    "realsense:SERIAL", "openni" or "openni:URI". `follow` and `camera` are of folders, as of DepthFolder."""
    text = os.fspath(name)
    kind = re.fullmatch(r"(realsense|openni)(?::(.+))?", text)
    ending = Path(text).suffix.lower()
    if kind or ending in (".bag", ".db3", ".oni"):
        if follow:
            raise Error(f"{text}: only a folder can be followed")
        if camera is not None:
            raise Error(f"{text}: --camera is of folders; cameras and recordings know their own")
    if kind:
        return RealSense(serial=kind[2]) if kind[1] == "realsense" else OpenNI2(kind[2])
    if ending in (".bag", ".db3"):
        return RealSense(text)
    if ending == ".oni":
        if not Path(text).is_file():
            raise Error(f"{text}: no such file")
        return OpenNI2(text)
    if not Path(text).is_dir():
        raise Error(
            f"{text}: no such source; give a folder of depth PNGs, a recording (.bag, .db3, .oni), realsense, "
            "realsense:SERIAL, openni or openni:URI"
        )
    return DepthFolder(text, follow=follow, camera=camera)

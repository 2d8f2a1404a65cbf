# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""`partpose-live`, or `python -m partpose live`: recognizes frames as a camera gives them. The program `partpose live` is the
same command; it reads folders itself (src/partpose/apps/live_command.cpp) and leaves cameras and recordings to this one."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from collections.abc import Sequence
from types import FrameType
from typing import Any, TextIO

from partpose import sources
from partpose._partpose import __version__
from partpose.core import Error, ThreadLimit
from partpose.engine import Engine, EngineOptions
from partpose.pipeline import PartRecognizer, Recognition, Recognizer, RecognizerOptions

__all__ = ["main", "line_of"]

_EXAMPLES = """examples:
  partpose-live realsense --models parts/                       a line of text for each frame
  partpose-live recording.bag --models parts/ --json            a line of JSON for each frame of a recording
  partpose-live frames/ --models parts/ --follow --jsonl out.jsonl
                                                                depth PNGs as some program writes them
Ctrl-C ends it after the frame at hand. Exit code 0: done, also by Ctrl-C; 2: bad input, with one line that says what is
wrong, also when only some files of a folder could not be read; 130: ended by Ctrl-C before the first frame."""


def line_of(frame: sources.Frame, found: Recognition) -> dict[str, Any]:
    """What a line of JSON says of a frame: part (None: nothing recognized, see reason), camera_from_model (4 x 4, mm),
    score, confidence, all detections, alternatives, time."""
    return {
        "frame": frame.number,
        "timestamp_s": frame.timestamp_s,
        "name": frame.name,
        "part": found.part,
        "camera_from_model": None if found.camera_from_model is None else found.camera_from_model.tolist(),
        "score": found.score,
        "confidence": found.confidence,
        "reason": found.reason,
        "detections": [
            {
                "part": each.part,
                "camera_from_model": each.camera_from_model.tolist(),
                "score": each.score,
                "confidence": each.confidence,
                "alternatives": [
                    {
                        "part": other.part,
                        "camera_from_model": other.camera_from_model.tolist(),
                        "probability": other.probability,
                    }
                    for other in each.alternatives
                ],
            }
            for each in found.detections
        ],
        "time_ms": found.total_ms,
    }


def _text_of(frame: sources.Frame, found: Recognition) -> str:
    head = f"{frame.name or frame.number}: "
    if found.camera_from_model is None:
        return f"{head}nothing recognized: {found.reason} ({found.total_ms:.0f} ms)"
    x, y, z = found.camera_from_model[:3, 3]
    sure = "" if found.confidence is None else f", confidence {found.confidence:.2f}"
    return f"{head}{found.part} at ({x:.1f}, {y:.1f}, {z:.1f}) mm, score {found.score:.2f}{sure} ({found.total_ms:.0f} ms)"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="partpose-live",
        description="Recognizes parts in the frames of a camera, a recording or a folder, as they come.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "source", help="realsense, realsense:SERIAL, openni, openni:URI, a recording (.bag, .db3, .oni) or a folder"
    )
    parser.add_argument("--models", nargs="+", required=True, help="model files, or folders of them")
    parser.add_argument("--camera", help="of a folder: camera JSON for all depth images")
    parser.add_argument("--recognizer", choices=["engine", "recognizer"], default="engine", help="default: engine")
    parser.add_argument("--min-score", type=float, help="a candidate below is not believed, 0 to 1")
    parser.add_argument("--cache", help="where catalogues of the recognizer are kept (default: ~/.cache/partpose)")
    parser.add_argument("--json", action="store_true", help="one line of JSON for each frame, on standard output")
    parser.add_argument("--jsonl", metavar="FILE", help="append the lines of JSON to this file (-: as --json)")
    parser.add_argument("--frames", type=int, help="end after so many frames")
    parser.add_argument("--follow", action="store_true", help="of a folder: wait for files to come")
    parser.add_argument("--threads", type=int, default=0, help="at most so many threads (0: as many as the machine has)")
    loudness = parser.add_mutually_exclusive_group()
    loudness.add_argument("-q", "--quiet", action="store_true", help="nothing but results")
    loudness.add_argument("-v", "--verbose", action="store_true", help="also how long each step takes")
    parser.add_argument("--version", action="version", version=__version__)
    return parser


def _recognizer(options: argparse.Namespace) -> PartRecognizer:
    kwargs = {} if options.min_score is None else {"min_score": options.min_score}
    if options.recognizer == "engine":
        return Engine.from_files(options.models, EngineOptions(**kwargs))
    return Recognizer.from_files(options.models, RecognizerOptions(**kwargs), options.cache)


class _Stop:
    """Ctrl-C and SIGTERM, remembered until the frame at hand is done; a second Ctrl-C ends at once."""

    def __init__(self) -> None:
        self.asked = False
        self._before = {s: signal.signal(s, self._ask) for s in (signal.SIGINT, signal.SIGTERM)}

    def _ask(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True

    def restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


def _run(options: argparse.Namespace, output: TextIO) -> int:
    if options.frames is not None and options.frames < 1:
        raise Error(f"--frames: must be 1 or more, got {options.frames}")
    if options.threads < 0:
        raise Error(f"--threads: must be 0 or more, got {options.threads}")
    if options.jsonl == "-":
        options.json, options.jsonl = True, None
    failures = 0
    opened = sources.open_source(options.source, follow=options.follow, camera=options.camera)
    with ThreadLimit(options.threads), opened as source:
        recognizer = _recognizer(options)
        log = open(options.jsonl, "a", encoding="utf-8") if options.jsonl else None
        stop = _Stop()
        begun, count, recognized = time.monotonic(), 0, 0
        try:
            while not stop.asked and count != options.frames:
                try:
                    frame = _next(source, stop)
                except Error as error:
                    if not isinstance(source, sources.DepthFolder):
                        raise
                    _complain(error)  # one bad file does not end it
                    failures += 1
                    continue
                if frame is None:
                    break
                found = recognizer.recognize(frame.depth_mm, frame.intrinsics)
                count, recognized = count + 1, recognized + bool(found)
                line = json.dumps(line_of(frame, found))
                print(line if options.json else _text_of(frame, found), file=output, flush=True)
                if log is not None:
                    print(line, file=log, flush=True)
                if options.verbose:
                    for stage in found.stages:
                        print(f"{stage.measure_ms:9.1f} ms  {stage.tag}", file=sys.stderr)
        finally:
            stop.restore()
            if log is not None:
                log.close()
    if stop.asked and count == 0:
        return 130
    if not options.quiet:
        seconds = max(time.monotonic() - begun, 1e-9)
        print(f"{count} frame{'s' * (count != 1)}, {recognized} recognized, {count / seconds:.1f} frames/s", file=sys.stderr)
    return 2 if failures else 0


def _complain(error: Exception) -> None:
    print(f"partpose-live: {error}", file=sys.stderr)


def _next(source: sources.Source, stop: _Stop) -> sources.Frame | None:
    """The next frame; None also when Ctrl-C came while waiting for it."""
    if not (isinstance(source, sources.DepthFolder) and source.follow):
        try:
            return source.read()
        except Error:
            if stop.asked:
                return None  # the camera gave nothing more, and nobody waits for it
            raise
    while not stop.asked:
        frame = source.read(timeout_s=0.2)
        if frame is not None:
            return frame
    return None


def main(arguments: Sequence[str] | None = None) -> int:
    """The program; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return _run(options, sys.stdout)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        sys.stderr.close()  # nobody reads any more, as after `| head`
        return 0
    except (Error, OSError) as error:
        _complain(error)
        return 2

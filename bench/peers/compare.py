# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Asks all peers about the same frames, frame by frame in turns, has the answers judged, and writes table and plot."""
from __future__ import annotations

import argparse
import json
import math
import os
import queue
import statistics
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
PARTPOSE = "partpose"


@dataclass
class Peer:
    """A program that answers frames, see README.md."""

    name: str
    command: list[str]
    process: subprocess.Popen | None = None
    lines: queue.Queue = field(default_factory=queue.Queue)
    setup_s: float = math.nan

    def start(self, timeout_s: float) -> None:
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
        self.lines = queue.Queue()
        self.process = subprocess.Popen(
            self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )
        threading.Thread(target=self._read, args=(self.process, self.lines), daemon=True).start()
        ready = self._answer(timeout_s)
        if ready is None:
            self.stop()
            raise SystemExit(f"{self.name}: did not become ready within {timeout_s:.0f} s: {' '.join(self.command)}")
        self.setup_s = ready["setup_s"]

    @staticmethod
    def _read(process: subprocess.Popen, lines: queue.Queue) -> None:
        for line in process.stdout:
            lines.put(line)
        lines.put(None)  # the program has ended

    def _answer(self, timeout_s: float) -> dict | None:
        try:
            line = self.lines.get(timeout=timeout_s)
        except queue.Empty:
            return None
        return None if line is None else json.loads(line)

    def ask(self, frame: dict, timeout_s: float) -> dict:
        """A peer that crashes or takes too long has recognized nothing, and is started anew."""
        began = time.perf_counter()
        try:
            self.process.stdin.write(json.dumps(frame) + "\n")
            self.process.stdin.flush()
            answer = self._answer(timeout_s)
        except BrokenPipeError:
            answer = None
        if answer is None:
            print(f"{self.name}: no answer to {frame['name']}", file=sys.stderr)
            ms = 1e3 * (time.perf_counter() - began)
            answer = {"frame": frame["name"], "part": None, "ms": ms, "cpu_ms": ms, "no_answer": True}
            self.stop()
            setup_s = self.setup_s
            self.start(600)
            self.setup_s = setup_s
        return dict(answer, peer=self.name)

    def stop(self) -> None:
        if self.process is None:
            return
        self.process.kill()
        self.process.wait()
        self.process = None


def all_peers(build: Path, work: Path, python: str) -> list[Peer]:
    setup = str(work / "setup.json")
    pcl = str(build / "peers_pcl")
    return [
        Peer(PARTPOSE, [str(build / "peers_partpose"), setup]),
        Peer("PCL as written, VFH", [pcl, setup, "as-written", "vfh"]),
        Peer("PCL as written, CVFH", [pcl, setup, "as-written", "cvfh"]),
        Peer("PCL as written, GOOD", [pcl, setup, "as-written", "good"]),
        Peer("PCL tuned, GOOD", [pcl, setup, "tuned", "good"]),
        Peer("OpenCV PPF", [str(build / "peers_ppf"), setup]),
        Peer("Open3D FPFH", [python, str(HERE / "open3d_peer.py"), setup, str(build / "libpeers_shared.so")]),
    ]


def ask_all(peers: list[Peer], frames: list[dict], timeout_s: float) -> list[dict]:
    """Each peer in its turn has the machine for itself; who comes first changes from frame to frame. A round of one
    frame of each protocol comes first, and does not count: caches and memory are warm for all."""
    answers = []
    protocols = sorted({frame["protocol"] for frame in frames})
    rounds = [[f for f in frames if f["protocol"] == p] for p in protocols]
    warm_up = [r[0] for r in rounds]
    in_turns = [frame for group in zip(*rounds) for frame in group]
    for i, frame in enumerate(warm_up + in_turns):
        turn = i % len(peers)
        for peer in peers[turn:] + peers[:turn]:
            answer = peer.ask(frame, timeout_s)
            if i >= len(warm_up):
                answers.append(answer)
        if sys.stderr.isatty() or i % 5 == 0:
            print(f"frame {i + 1} of {len(warm_up) + len(in_turns)}", file=sys.stderr)
    return answers


def judged(build: Path, work: Path, answers: list[dict]) -> list[dict]:
    lines = "".join(json.dumps(a) + "\n" for a in answers)
    done = subprocess.run([str(build / "peers_judge"), str(work)], input=lines, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr.strip())
    (work / "judged.jsonl").write_text(done.stdout, encoding="utf-8")
    return [json.loads(line) for line in done.stdout.splitlines()]


def percent(records: list[dict], key: str) -> str:
    return f"{100 * sum(r[key] for r in records) / len(records):.0f}"


def short(value: float) -> str:
    """A time or a ratio: three digits are enough."""
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:.0f}" if value >= 20 else f"{value:.1f}"


def table(records: list[dict], peers: list[Peer], protocols: list[str], frames: list[dict]) -> str:
    out = []
    protocol_of = {frame["name"]: frame["protocol"] for frame in frames}
    for p, title in enumerate(protocols):
        of = {
            peer.name: [r for r in records if r["peer"] == peer.name and protocol_of[r["frame"]] == p] for peer in peers
        }
        mine = {r["frame"]: r for r in of.get(PARTPOSE, [])}
        out += [
            f"**{title[0].upper() + title[1:]}**, {len(next(iter(of.values())))} frames",
            "",
            "| | recognized % | wrong % | pose right % | MSSD < 10 % | MSSD < 5 % | 15° and 15 mm "
            "| ms, median | CPU ms, median | CPU, times partpose's | setup, s |",
            "|---|---|---|---|---|---|---|---|---|---|---|",
        ]
        for peer in peers:
            r = of[peer.name]
            ratios = [x["cpu_ms"] / mine[x["frame"]]["cpu_ms"] for x in r if x["frame"] in mine]
            cells = [
                peer.name,
                *(
                    percent(r, key)
                    for key in (
                        "recognized", "wrong", "pose_right", "mssd_below_10", "mssd_below_5", "within_15_deg_15_mm"
                    )
                ),
                short(statistics.median(x["ms"] for x in r)),
                short(statistics.median(x["cpu_ms"] for x in r)),
                short(statistics.median(ratios)) if ratios else "-",
                short(peer.setup_s),
            ]
            out.append("| " + " | ".join(cells) + " |")
        out.append("")
    return "\n".join(out)


COLOURS = ["#0072b2", "#e69f00", "#d55e00", "#cc79a7", "#009e73", "#56b4e9", "#666666"]
"""Of Okabe and Ito: told apart by colour-blind readers too."""


def plot(records: list[dict], peers: list[Peer], protocols: list[str], frames: list[dict]) -> str:
    """Share of right poses over the median CPU time a frame: one panel a protocol, up and left is better."""
    protocol_of = {frame["name"]: frame["protocol"] for frame in frames}
    width, height, left, top, gap = 340, 260, 50, 50, 60
    total_width = len(protocols) * (width + gap) + left
    decades = range(0, 5)

    def x_of(ms: float) -> float:
        return width * min(max(math.log10(max(ms, 1e-9)), 0), decades[-1]) / decades[-1]

    def text(x: float, y: float, what: str, extra: str = "") -> str:
        return f'<text x="{x:.1f}" y="{y:.1f}" {extra}>{what}</text>'

    svg = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{total_width}" height="{height + 165}" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for p, title in enumerate(protocols):
        svg.append(f'<g transform="translate({left + p * (width + gap)} {top})">')
        svg.append(text(width / 2, -14, title, 'text-anchor="middle" font-size="14"'))
        svg.append(f'<rect width="{width}" height="{height}" fill="none" stroke="#888"/>')
        for d in decades:
            x = x_of(10**d)
            svg.append(f'<line x1="{x}" y1="0" x2="{x}" y2="{height}" stroke="#ddd"/>')
            svg.append(text(x, height + 16, f"{10**d:,}", 'text-anchor="middle"'))
        for share in range(0, 101, 20):
            y = height * (1 - share / 100)
            svg.append(f'<line x1="0" y1="{y}" x2="{width}" y2="{y}" stroke="#ddd"/>')
            svg.append(text(-6, y + 4, str(share), 'text-anchor="end"'))
        svg.append(text(width / 2, height + 34, "CPU ms a frame, median", 'text-anchor="middle"'))
        svg.append(
            text(0, 0, "pose right, % of all frames",
                 f'text-anchor="middle" transform="translate(-34 {height / 2}) rotate(-90)"')
        )
        for i, peer in enumerate(peers):
            r = [x for x in records if x["peer"] == peer.name and protocol_of[x["frame"]] == p]
            x = x_of(statistics.median(a["cpu_ms"] for a in r))
            y = height * (1 - sum(a["pose_right"] for a in r) / len(r))
            svg.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="{COLOURS[i % len(COLOURS)]}" stroke="white"/>')
        svg.append("</g>")
    for i, peer in enumerate(peers):
        x, y = left + (i % 3) * 260, top + height + 62 + (i // 3) * 20
        svg.append(f'<circle cx="{x}" cy="{y - 4}" r="6" fill="{COLOURS[i % len(COLOURS)]}"/>')
        svg.append(text(x + 12, y, peer.name))
    svg.append("</svg>")
    return "\n".join(svg) + "\n"


def put_between_marks(page: Path, content: str) -> None:
    begin, end = "<!-- bench/peers begins -->", "<!-- bench/peers ends -->"
    old = page.read_text(encoding="utf-8")
    if old.count(begin) != 1 or old.count(end) != 1:
        raise SystemExit(f"{page}: give it one line {begin} and one line {end}: the table goes between them")
    before, rest = old.split(begin)
    page.write_text(before + begin + "\n\n" + content + "\n" + end + rest.split(end)[1], encoding="utf-8")


def processor() -> str:
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "processor unknown"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help="folder of the peers' programs")
    parser.add_argument("--work", type=Path, required=True, help="folder that peers_scenes wrote")
    parser.add_argument("--python", default=sys.executable, help="Python with Open3D")
    parser.add_argument("--only", nargs="*", default=[], help="peers whose names contain one of these, and partpose")
    parser.add_argument("--without", nargs="*", default=[], help="no peers whose names contain one of these")
    parser.add_argument("--timeout", type=float, default=300, help="seconds a frame; then nothing was recognized")
    parser.add_argument("--plot", type=Path, help="SVG file to write")
    parser.add_argument("--page", type=Path, help="Markdown page whose marked table is replaced")
    parser.add_argument("--note", default="", help="a line above the table: what was run")
    arguments = parser.parse_args()

    setup = json.loads((arguments.work / "setup.json").read_text(encoding="utf-8"))
    frames = json.loads((arguments.work / "frames.json").read_text(encoding="utf-8"))
    protocols = [protocol["name"] for protocol in setup["protocols"]]
    peers = all_peers(arguments.build, arguments.work, arguments.python)
    if arguments.only:
        peers = [p for p in peers if p.name == PARTPOSE or any(o.lower() in p.name.lower() for o in arguments.only)]
    peers = [p for p in peers if not any(w.lower() in p.name.lower() for w in arguments.without)]
    try:
        for peer in peers:
            peer.start(600)
            print(f"{peer.name}: ready after {peer.setup_s:.1f} s", file=sys.stderr)
        answers = ask_all(peers, frames, arguments.timeout)
    finally:
        for peer in peers:
            peer.stop()
    records = judged(arguments.build, arguments.work, answers)

    busy = statistics.median(r["ms"] / r["cpu_ms"] for r in records)
    names = ", ".join(f"`{part['name']}`" for part in setup["parts"])
    content = "\n".join(
        [
            *([arguments.note, ""] if arguments.note else []),
            f"{len(setup['parts'])} parts ({names}); {processor()}, one thread for each peer; "
            f"median of wall time over CPU time {busy:.2f} (1: the machine was idle).",
            "",
            table(records, peers, protocols, frames),
        ]
    )
    print(content)
    if arguments.plot:
        arguments.plot.write_text(plot(records, peers, protocols, frames), encoding="utf-8")
    if arguments.page:
        put_between_marks(arguments.page, content)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Prints the tables of bench/engine from its output folder, as Markdown, at once. Needs nothing but Python."""
import argparse
import json
from pathlib import Path

# (experiment, protocol, row, target: recognized, wrong, pose right)
ROWS = [
    ("virtual_noise_6", "virtual noise", "virtual noise, 6 parts", ">= 99.8", "<= 0.1", ">= 99.5"),
    ("virtual_noise_30", "virtual noise", "virtual noise, 30 parts", ">= 99", "<= 0.5", ">= 98.5"),
    ("stereo_6", "stereo, at rest on a table", "stereo, full frame, 6 parts", ">= 99.5", "<= 0.2", ">= 99"),
    ("stereo_hard", "stereo, at rest on a table", "mirror pair, two sizes, symmetric", ">= 99", "<= 0.5", ">= 98.5"),
    ("stereo_sheet", "stereo, at rest on a table", "bent sheet metal, 6 parts", "", "", ""),
    ("stereo_hidden", "stereo, 20 % hidden", "20 % of the part hidden", ">= 98", "<= 1", ">= 97"),
    ("stereo_hidden", "stereo, 40 % hidden", "40 % of the part hidden", ">= 90", "<= 3", ">= 87"),
    ("stereo_1000", "stereo, at rest on a table", "1000 parts in the catalogue", ">= 98", "<= 1", ">= 97"),
    ("real", "cranfield, object only", "real: cranfield, object only", ">= 99", "<= 1", ">= 97"),
    ("real", "cranfield, with table", "real: cranfield, with table", ">= 97", "<= 2", ">= 95"),
    ("real", "cube, full frames", "real: cube, full frames", "", "", ""),
    ("real", "cube, cut out", "real: cube, cut out", "", "", ""),
    ("real", "bottle, full frames", "real: bottle, full frames", "", "", ""),
    ("real", "bottle, cut out", "real: bottle, cut out", "", "", ""),
]
UNKNOWN = [  # experiment, known protocol, unknown protocol, row
    ("virtual_noise_6", "virtual noise", "virtual noise, part left out", "virtual noise, 6 parts"),
    ("stereo_6", "stereo, at rest on a table", "stereo, part left out", "stereo, 6 parts"),
    ("stereo_sheet", "stereo, at rest on a table", "stereo, part left out", "bent sheet metal, 6 parts"),
    ("real", "cranfield, object only", "cranfield, object only, part left out", "real: cranfield, object only"),
    ("real", "cranfield, with table", "cranfield, with table, part left out", "real: cranfield, with table"),
    ("stereo_hard", "stereo, at rest on a table", "stereo, part left out", "mirror pair, two sizes (apart)"),
]


def runs_of(output):
    """(experiment, protocol) -> run of tables.json"""
    runs = {}
    for file in output.glob("*/tables.json"):
        for run in json.loads(file.read_text())["runs"]:
            runs[file.parent.name, run["protocol"]] = run
    return runs


def percent(part, whole):
    return f"{100 * part / whole:.1f}" if whole else "-"


def print_table(header, rows):
    print("| " + " | ".join(header) + " |")
    print("|---" + "|---:" * (len(header) - 1) + "|")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def accuracy(runs):
    rows = []
    for experiment, protocol, name, recognized, wrong, pose in ROWS:
        run = runs.get((experiment, protocol))
        if not run:
            continue
        of = lambda key: percent(run[key], run["frames"])
        rows.append([name, run["frames"], of("correct"), of("incorrect"), of("mssd_under_10_percent_or_indistinguishable"),
                     of("pose_under_limits"), of("mssd_under_10_percent"), of("mssd_under_5_percent"),
                     f"{recognized} / {wrong} / {pose}" if recognized else "-"])
    print("## Accuracy [% of all frames]\n")
    print_table(["protocol", "frames", "recognized", "wrong", "pose right", "15 deg, 15 mm (real: 30 mm)", "MSSD < 10 %",
                 "MSSD < 5 %", "to reach"], rows)
    run = runs.get(("stereo_touching", "stereo, touching"))
    if run:
        print("## 5 to 8 parts that touch and cover one another, those at least 60 % visible\n")
        print_table(["frames", "objects", "found [%]", "pose right [%]", "detections", "wrong detections [%]", "to reach"],
                    [[run["frames"], run["objects"], percent(run["objects_found"], run["objects"]),
                      percent(run["objects_pose_right"], run["objects"]), run["detections"],
                      percent(run["wrong_detections"], run["detections"]), ">= 95 / >= 93 / <= 2"]])


def unknown(runs):
    rows = []
    for experiment, known, left_out, name in UNKNOWN:
        a, b = runs.get((experiment, known)), runs.get((experiment, left_out))
        if a and b:
            rows.append([name, a["frames"], percent(a["accepted"], a["frames"]), b["frames"],
                         percent(b["accepted"], b["frames"])])
    print("## Parts that are not in the catalogue: accepted by the engine's own decision (to reach: known >= 99, unknown <= 1)\n")
    print_table(["protocol", "known frames", "accepted [%]", "unknown frames", "accepted [%]"], rows)


def calibration_error(bins):
    """Mean distance of stated confidence and share that is right, over ten bins, in points."""
    count = sum(len(bin_) for bin_ in bins)
    return sum(100 * abs(sum(c - right for c, right in bin_)) for bin_ in bins) / max(count, 1)


def calibration(output):
    known, without_twins, stated = ([[] for _ in range(10)] for _ in range(3))
    for file in sorted(output.glob("*/frames.jsonl")):
        for line in file.read_text().splitlines():
            try:
                record = json.loads(line)
            except ValueError:
                continue   # cut off when the run was stopped
            for d in record.get("objects", {}).get("detections", []):
                bin_ = min(9, int(10 * min(max(d["confidence"], 0), 1)))
                pair = (d["confidence"], d["right"])
                stated[bin_].append(pair)
                if not record["left_out"]:
                    known[bin_].append(pair)
                if not record["left_out"] or file.parent.name != "stereo_hard":
                    without_twins[bin_].append(pair)
    rows = []
    for i, bin_ in enumerate(stated):
        if bin_:
            mean, share = (sum(x[k] for x in bin_) / len(bin_) for k in (0, 1))
            rows.append([f"{i / 10:.1f} to {(i + 1) / 10:.1f}", len(bin_), f"{100 * share:.1f}", f"{100 * mean:.1f}"])
    print("## Confidence\n")
    print(f"Expected calibration error over all protocols: {calibration_error(stated):.2f} points (to reach: 2), of "
          f"{sum(map(len, stated))} detections; without the frames whose part is left out of the catalogue while its twin "
          f"is in it: {calibration_error(without_twins):.2f} points, of {sum(map(len, without_twins))}; without all frames "
          f"whose part is left out, where every detection is wrong: {calibration_error(known):.2f} points, of "
          f"{sum(map(len, known))}. The table has all.\n")
    print_table(["confidence", "detections", "right [%]", "mean confidence [%]"], rows)


def limit(runs):
    rows = []
    for name in ("virtual_noise_6", "virtual_noise_30"):
        bound = runs.get((name, "virtual noise"), {}).get("bound")
        if bound:
            rows.append([name, bound["frames"], bound["frames_left_out"], f"{bound['rotation_error_over_bound']:.2f}",
                         f"{bound['translation_error_over_bound']:.2f}"])
    print("## The physical limit: median of error / Cramer-Rao bound (to reach: 1.5)\n")
    print_table(["experiment", "frames", "left out", "rotation", "translation"], rows)


def times(output):
    targets = {"6_1": "<= 5, p99 <= 12", "6_2": "<= 3", "6_1_hd": "<= 8", "100_2": "<= 8", "1000_2": "<= 20"}
    rows = []
    for name in ("6_1", "6_2", "6_1_hd", "100_1", "100_2", "1000_1", "1000_2"):
        file = output / f"times_{name}.json"
        if not file.exists():
            continue
        t = json.loads(file.read_text())
        rows.append([f"{t['width']} x {t['height']}, {t['parts']} parts, {t['threads']} thread{'s' * (t['threads'] > 1)}",
                     t["frames"], f"{t['median_ms']:.2f}", f"{t['p99_ms']:.2f}", targets.get(name, "-"),
                     f"{t['setup_ms_a_part']:.1f}", f"{t['memory_mb_a_part']:.2f}", f"{t['memory_stated_mb_a_part']:.2f}"])
    print("## Time of a frame, everything after PNG decoding, and memory (to reach: 2 MB a part)\n")
    print_table(["frames", "count", "median [ms]", "p99 [ms]", "to reach", "made in, a part [ms]", "memory a part [MB]",
                 "as the engine states [MB]"], rows)
    usable = output / "times_usable.json"
    if usable.exists():
        t = json.loads(usable.read_text())
        print(f"STL to usable, {t['stl']} ({t['triangles']} triangles): {t['usable_ms']:.0f} ms (to reach: 200).")


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog="example: bench/engine_table.py bench_engine_output")
    parser.add_argument("output", type=Path, help="what bench/engine wrote")
    output = parser.parse_args().output
    runs = runs_of(output)
    if not runs:
        raise SystemExit(f"{output}: holds no output of bench/engine")
    accuracy(runs)
    unknown(runs)
    calibration(output)
    limit(runs)
    times(output)


if __name__ == "__main__":
    main()

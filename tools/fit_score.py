#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Fit the constants of the engine's score (`probability_of_part` in src/partpose/engine/verdict.cpp).

Recognizes tuning frames with and without the part in the catalogue, everything accepted, and fits a logistic regression
of whether a detection names the right part on what its explanation says. No part and seed of bench/engine is among
them, but for the real captures. Prints the constants, and what an acceptance at 0.5 gives, each part's frames judged by
constants fitted to the other parts'. 15 to 20 minutes; goes on where it was stopped.

  tools/fit_score.py OUT --data ../shared/data --made OUT/parts      # OUT/parts: tools/make_many_parts.py OUT/parts --sets
"""
import argparse
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PUBLIC = {   # three sets of public parts by name, then the same mixed
    "a": "28BYJ-48_Stepper_Motor ADIS16480 DIN471_CLASS_A_M34RetainingRings NEMA-17_Stepper_Motor_40mm angle_block "
         "battery_collision",
    "b": "ISO4762_Hex_Socket_Head_Cap_Screw_M6x40 octagonal_pocket regulator_collision robotiq_ft300 round soft-drink-can",
    "c": "link_1 link_2 robotiq_arg2f_140_inner_knuckle robotiq_arg2f_140_outer_finger robotiq_gripper_coupling "
         "sensor_collision",
    "d": "ISO4762_Hex_Socket_Head_Cap_Screw_M6x40 angle_block battery_collision robotiq_arg2f_140_inner_knuckle "
         "robotiq_ft300 robotiq_gripper_coupling",
    "e": "ADIS16480 DIN471_CLASS_A_M34RetainingRings NEMA-17_Stepper_Motor_40mm robotiq_arg2f_140_outer_finger round "
         "sensor_collision",
    "f": "28BYJ-48_Stepper_Motor link_1 link_2 octagonal_pocket regulator_collision soft-drink-can",
}
SHIPPED = "pump_body bracket link keyed_shaft housing flange"
ALIKE = "mount_left mount_right elbow_100 elbow_130 plain_shaft flange"
UNKNOWN = 0.6   # in use so many parts are unknown for each that is known


def log_disagreement(e):
    return math.log(1.02 - e["agreement"])


def log_few(e):
    return math.log(min(max(e["explained_pixels"], 30) / 2000, 1))


def log_noise(e):
    return math.log(max(e["noise"], 0.008))


def log_local(e):
    return math.log(min(max(e["local_noise"], 0.05), 1))


def log_relief(e):
    return math.log(max(e["relief"], 0.5))


def log_larger(e):
    return math.log(min(max(e["size_ratio"], 1), 3))


# Each constant's factor, as in probability_of_part.
FEATURES = {
    "1": lambda e: 1.0,
    "log_disagreement": log_disagreement,
    "deviation": lambda e: e["deviation"],
    "log(clamp(roughness, 0.2, 3))": lambda e: math.log(min(max(e["roughness"], 0.2), 3)),
    "sqrt(unexplained)": lambda e: math.sqrt(e["unexplained"]),
    "min(free_space, 0.1) * log_disagreement": lambda e: min(e["free_space"], 0.1) * log_disagreement(e),
    "not_measured": lambda e: e["not_measured"],
    "log_noise": log_noise,
    "log_relief": log_relief,
    "edges * log_local": lambda e: e["edges"] * log_local(e),
    "edges * log_few": lambda e: e["edges"] * log_few(e),
    "log_larger * log_relief": lambda e: log_larger(e) * log_relief(e),
    "fine_shape": lambda e: e["fine_shape"],
    "fine_gain * log_noise": lambda e: e["fine_gain"] * log_noise(e),
    "log(narrower + 0.003)": lambda e: math.log(e["narrower"] + 0.003),
    "min(not_measured, 0.3) * log_relief": lambda e: min(e["not_measured"], 0.3) * log_relief(e),
    "min(noise, 0.15) * log_local": lambda e: min(e["noise"], 0.15) * log_local(e),
    "beside * log_few": lambda e: e["beside"] * log_few(e),
}


def given(e):
    """Of log-odds, what is not fitted, since tuning frames hardly show it."""
    height, deviations = e["height"], e["height_deviations"]
    return (-22.27 * min(max(height, 0), 0.3) - 0.58 * min(max(deviations, 0), 10) - 19.87 * min(max(-height, 0), 0.3)
            - 30 * max(e["beside"] - 0.25, 0) - 30 * max(e["unexplained"] - 0.3, 0))


def experiments(output, data, made):
    """name -> (model files or folders, protocols, weight of a detection)"""
    shipped = lambda names: [str(ROOT / "parts" / f"{name}.stl") for name in names.split()]
    public = lambda names: [str(data / "parts" / "stl" / f"{name}.stl") for name in names.split()]
    with_and_without = lambda protocol: [{"name": "known", **protocol},
                                         {"name": "left out", "left_out": True, **protocol}]

    def stereo(seed, frames, **scene):
        file = output / f"scenes_{seed}.json"
        file.write_text(json.dumps({"scene": {"seed": seed, **scene}, "sensor": {"model": "stereo"}}))
        return with_and_without({"scenes": str(file), "frames": frames})

    virtual = with_and_without({"views": str(ROOT / "configs/dataset_virtual_noise.json")})
    captured = lambda name, kinds: [protocol for kind in kinds for protocol in with_and_without(
        {"captured": str(data / name), "kinds": [kind]})]
    found = {"shipped": (shipped(SHIPPED), stereo(201, 96), 1), "alike": (shipped(ALIKE), stereo(202, 96), 1)}
    for i, (key, names) in enumerate(PUBLIC.items()):
        found[f"public_{key}"] = (public(names), stereo(203 + i, 72), 1)
    for i, name in enumerate(("sheet_tuning", "sheet_tuning_2", "sheet_tuning_3", "hard_tuning_1", "hard_tuning_2",
                              "hard_tuning_3", "six_tuning_1", "six_tuning_2", "six_tuning_3")):
        found[name] = ([str(made / name)], stereo(230 + i, 96), 1)
    for share in (0.2, 0.4):
        for i, parts in enumerate((shipped(SHIPPED), public(PUBLIC["d"]), public(PUBLIC["a"]), public(PUBLIC["c"]))):
            found[f"hidden_{share}_{i}"] = (
                parts, stereo(210 + int(10 * share) + i, 72, hidden_fraction=[share - 0.02, share + 0.02]), 1)
    found["thirty"] = ([str(made / "thirty_tuning")], stereo(220, 96), 1)
    found["virtual"] = (shipped(SHIPPED), virtual, 1)
    for key in "abce":
        found[f"virtual_{key}"] = (public(PUBLIC[key]), virtual, 1)
    touching = [{"name": "touching", "scenes": str(ROOT / "experiments/scenes_engine_touching_tuning.json"), "frames": 64}]
    found["touching"] = (shipped(SHIPPED), touching, 1)
    found["touching_b"] = (public(PUBLIC["b"]), touching, 1)
    # The real ones are few, and they are what it is for.
    found["cranfield"] = ([str(data / "cranfield/models")], captured("cranfield", ["object_only", "with_table"]), 8)
    found["cube"] = ([str(data / "cube/models")], captured("cube", ["full_frame", "instance"]), 4)
    for i, protocol in enumerate(found["cranfield"][1] + found["cube"][1]):
        protocol["name"] += f" {i}"
    return found


def run(output, name, parts, protocols, partpose):
    spec = output / f"{name}.json"
    text = json.dumps({"name": name, "groups": [{"name": name, "parts": parts}], "protocols": protocols,
                       "configurations": [{"name": "engine", "min_score": 0.0}], "save_frames": "none",
                       "most_frames": 96})
    if not spec.exists() or spec.read_text() != text:
        spec.write_text(text)
    print(name, file=sys.stderr, flush=True)
    subprocess.run([partpose, "--quiet", "experiment", spec, "--output", output / name], check=True,
                   stdout=subprocess.DEVNULL)


def detections(folder):
    """(explanation, names the right part, part shown, whether it is left out of the catalogue)"""
    for line in (folder / "frames.jsonl").read_text().splitlines():
        record = json.loads(line)
        truth = record["evaluation"]["ground_truth_model_name"] or f"{folder.name} {record['frame']}"
        for found in (record["objects"] or {"detections": []})["detections"]:
            if found.get("explanation") and found["explanation"]["explained_pixels"] > 0:
                yield found["explanation"], found["part_right"] or found["right"], truth, record["left_out"]


def probability(x, offset, constants):
    return 1 / (1 + np.exp(-np.clip(x @ constants + offset, -30, 30)))


def fitted(x, y, weight, offset, strength=0.03):
    """Constants of a logistic regression by Newton's method, with a weak pull towards 0 in standard deviations."""
    pull = strength * x.std(axis=0) ** 2
    w = np.zeros(x.shape[1])
    for _ in range(30):
        p = probability(x, offset, w)
        gradient = x.T @ (weight * (p - y)) + pull * w
        hessian = (x * (weight * p * (1 - p))[:, None]).T @ x + np.diag(pull + 1e-9)
        w -= np.linalg.solve(hessian, gradient)
    return w


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path, help="output folder")
    parser.add_argument("--data", type=Path, required=True, help="folder of the real captures and public parts")
    parser.add_argument("--made", type=Path, required=True, help="folder of tools/make_many_parts.py --sets")
    parser.add_argument("--partpose", default=ROOT / "build/release/partpose", help="the program (%(default)s)")
    arguments = parser.parse_args()
    output = arguments.output.resolve()
    output.mkdir(parents=True, exist_ok=True)

    rows = []   # features, right, weight, given, experiment, part shown
    for name, (parts, protocols, weight) in experiments(output, arguments.data.resolve(), arguments.made.resolve()).items():
        run(output, name, parts, protocols, arguments.partpose)
        for explanation, right, truth, left_out in detections(output / name):
            rows.append(([f(explanation) for f in FEATURES.values()], right, weight * (UNKNOWN if left_out else 1),
                         given(explanation), name, truth))
    x, y, weight, offset = (np.array([row[i] for row in rows], float) for i in range(4))

    held_out = np.zeros(len(y))
    truths = sorted({row[5] for row in rows})
    fold = np.array([truths.index(row[5]) % 6 for row in rows])
    for k in range(6):
        others, of_fold = fold != k, fold == k
        w = fitted(x[others], y[others], weight[others], offset[others])
        held_out[of_fold] = probability(x[of_fold], offset[of_fold], w)
    print(f"{'experiment':16} right  refused  wrong  accepted: by constants fitted to other parts")
    for name in dict.fromkeys(row[4] for row in rows):
        of = np.array([row[4] == name for row in rows])
        right = of & (y == 1)
        wrong = of & (y == 0)
        print(f"{name:16} {right.sum():5} {(held_out[right] < 0.5).sum():8} {wrong.sum():6} {(held_out[wrong] >= 0.5).sum():9}")
    print()
    for name, constant in zip(FEATURES, fitted(x, y, weight, offset)):
        print(f"{constant:8.2f} {name}")


if __name__ == "__main__":
    main()

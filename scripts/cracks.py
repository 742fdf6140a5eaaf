#!/usr/bin/python3
"""Where a run's cracks started and which way the main one went.

    cracks.py RUN_FOLDER [--until PEAK_SHARE]

Prints the first broken joints, and the direction of the cracks broken before the load had fallen to a share of its peak: the
main axis of their midpoints, weighted by length or area (principal component), and its angle to the y axis.
"""
import argparse
import csv
import glob
import json
import os

import h5py
import numpy as np


def broken(folder):
    """Midpoints [n, 3], times [n] and sizes [n] of the broken joints in the last frame, in order of breaking."""
    frames = sorted(f for f in glob.glob(os.path.join(folder, "frames", "*.h5")) if os.path.basename(f)[0].isdigit())
    with h5py.File(frames[-1]) as file:
        cracks = file["cracks"]
        points, cells = np.array(cracks["points"]), np.array(cracks["connectivity"])
        damage, time = np.array(cracks["cell/damage"]), np.array(cracks["cell/time_broken"])
        corners = points[cells.reshape(len(damage), -1)]
    edges = corners[:, 1:] - corners[:, :1]
    size = np.linalg.norm(edges[:, 0], axis=1) if edges.shape[1] == 1 else 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    keep = (damage >= 1) & (time >= 0)
    order = np.argsort(time[keep], kind="stable")
    return corners[keep].mean(axis=1)[order], time[keep][order], size[keep][order]


def history(folder):
    with open(os.path.join(folder, "history.csv")) as file:
        rows = list(csv.reader(file))
    return {name.split(" [")[0]: np.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(rows[0])}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder")
    parser.add_argument("--measure", help="the measure whose peak counts (default: the first plotted one)")
    parser.add_argument("--until", type=float, default=0.5, help="share of its peak to which the measure has fallen (default 0.5)")
    options = parser.parse_args()
    with open(os.path.join(options.folder, "run.json")) as file:
        record = json.load(file)
    measure = options.measure or record["plots"][0]["name"]
    past = history(options.folder)
    peak = int(np.argmax(past[measure]))
    fallen = np.nonzero(past[measure][peak:] < options.until * past[measure][peak])[0]
    until = past["time"][peak + fallen[0]] if len(fallen) else past["time"][-1]
    middle, time, size = broken(options.folder)
    print(f"peak {measure} {past[measure][peak]:.6g} at {past['time'][peak] * 1e6:.1f} us; {int(np.sum(time <= past['time'][peak]))} joints broken by then")
    for x, t in zip(middle[:5], time[:5]):
        print(f"  broke at {t * 1e6:8.1f} us: x {x[0] * 1e3:7.2f}, y {x[1] * 1e3:7.2f}, z {x[2] * 1e3:7.2f} mm")
    main_crack = time <= until
    if np.sum(main_crack) < 3:
        print("too few broken joints for a direction")
        return
    x, w = middle[main_crack][:, :2], size[main_crack]
    centred = x - np.average(x, axis=0, weights=w)
    direction = np.linalg.eigh((centred * w[:, None]).T @ centred)[1][:, -1]
    angle = np.degrees(np.arctan2(abs(direction[0]), abs(direction[1])))
    print(f"main crack (to {until * 1e6:.1f} us, {np.sum(main_crack)} joints): {angle:.1f} degrees from the y axis, "
          f"y from {x[:, 1].min() * 1e3:.1f} to {x[:, 1].max() * 1e3:.1f} mm, mean x {np.average(x[:, 0], weights=w) * 1e3:.2f} mm")


if __name__ == "__main__":
    main()

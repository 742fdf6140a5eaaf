#!/usr/bin/python3
"""Where a run's cracks started and which way the main one went.

    cracks.py RUN_FOLDER [--until PEAK_SHARE]

Prints the first broken joints, and the direction of the cracks broken before the load had fallen to a share of its peak: the
main axis of their midpoints, weighted by length or area (principal component), and its angle to the y axis.
"""
import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "python"))
import fissure


def broken(run):
    """Midpoints [n, 3], times [n] and sizes [n] of the broken joints in the last frame, in order of breaking."""
    cracks = run.frames[-1].cracks
    keep = cracks.broken & (cracks.time_broken >= 0)
    order = np.argsort(cracks.time_broken[keep], kind="stable")
    return cracks.points[keep].mean(axis=1)[order], cracks.time_broken[keep][order], cracks.size[keep][order]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder")
    parser.add_argument("--measure", help="the measure whose peak counts (default: the first plotted one)")
    parser.add_argument("--until", type=float, default=0.5, help="share of its peak to which the measure has fallen (default 0.5)")
    options = parser.parse_args()
    run = fissure.open(options.folder)
    measure, past = options.measure or run.record["plots"][0]["name"], run.history
    peak = int(np.argmax(past[measure]))
    fallen = np.nonzero(past[measure][peak:] < options.until * past[measure][peak])[0]
    until = past["time"][peak + fallen[0]] if len(fallen) else past["time"][-1]
    middle, time, size = broken(run)
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

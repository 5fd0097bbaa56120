"""Draws a landing, flown for the purpose with both FMUs, as the picture in the README.

`python -m touchdown_cosim.figure SCENARIO OUT.svg --fmus DIR`
"""

import argparse
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

from .table import fly

INK, SKY, FLAME, LEG = "#1b2838", "#2f6fb0", "#e4572e", "#5a8f3c"


def path_panel(axes, t):
    """Path in the plane of the approach, thrust as a flame, axis of the vehicle every second."""
    ground = np.hypot(t["position_w[1]"], t["position_w[2]"])
    ground = ground * np.sign(t["position_w[1]"][0] * t["position_w[1]"] + 1e-9)
    height = t["position_w[3]"]
    axes.plot(ground, height, color=INK, linewidth=1.2, label="path")
    burning = t["thrust_n"] > 400.0
    axes.scatter(ground[burning][::5], height[burning][::5], s=7, color=FLAME, label="engine on")
    axes.plot([0.0], [0.0], marker="^", color=LEG, markersize=8, linestyle="none", label="target")
    axes.set(xlabel="distance to the target, m", ylabel="height, m", title="Powered descent")
    axes.legend(frameon=False, loc="upper left")


def thrust_panel(axes, t):
    axes.plot(t["time_s"], t["thrust_n"] / 1e3, color=FLAME, label="thrust, kN")
    axes.plot(t["time_s"], t["tilt_deg"] / 10.0, color=SKY, label="tilt, 10°")
    axes.plot(t["time_s"], -t["velocity_w[3]"] / 10.0, color=INK, label="descent, 10 m/s")
    # Room for the legend above the highest curve.
    axes.set(xlabel="time, s", title="Engine, attitude, speed", ylim=(-0.2, 4.6))
    axes.legend(frameon=False, loc="upper left")


def contact_panel(axes, t, feet: int):
    """Legs from a tenth of a second before first contact."""
    start = np.nanmin(t["contact_time_s"])
    near = (t["time_s"] > start - 0.1) & (t["time_s"] < start + 1.0)
    after = t["time_s"][near] - start
    for n in range(feet):
        stroke = t[f"foot_stroke_m[{n + 1}]"][near] * 100.0
        axes.plot(after, stroke, color=LEG, linewidth=1.0, label="stroke of a leg, cm" if n == 0 else None)
    axes.set(xlabel="time from first contact, s", ylabel="stroke, cm", title="Touchdown")
    margin = axes.twinx()
    margin.plot(after, t["tip_energy_margin_j"][near], color=SKY, linestyle="--")
    margin.set_ylabel("least tip-over margin so far, J", color=SKY)
    margin.set_ylim(bottom=0.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenario", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--fmus", type=Path, required=True)
    options = parser.parse_args()
    table = fly(options.scenario, options.fmus)
    # Equal landings give equal pictures: no date, no random identifiers.
    plt.rcParams.update({"svg.hashsalt": "landing", "svg.fonttype": "none", "font.size": 9})
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    path_panel(left, table)
    thrust_panel(middle, table)
    contact_panel(right, table, feet=4)
    for axes in (left, middle, right):
        axes.grid(alpha=0.25)
        axes.spines[["top"]].set_visible(False)
    figure.savefig(options.picture, metadata={"Date": None})


if __name__ == "__main__":
    main()

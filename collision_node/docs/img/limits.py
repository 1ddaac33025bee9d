#!/usr/bin/env python3
"""Draws the pictures of docs/limits.md: limit_*.svg beside this file. Needs matplotlib."""
import math
import pathlib

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "limits", "svg.fonttype": "none", "font.size": 9})
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import Circle, Polygon, Rectangle  # noqa: E402

HERE = pathlib.Path(__file__).parent
TRUE, MODEL, TARGET = "#c02020", "#2050b0", "#b0b0b0"


def canvas(width, height, x, y):
    figure, axes = plt.subplots(figsize=(width, height))
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure, axes


def save(figure, name):
    figure.savefig(HERE / f"limit_{name}.svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def arc():
    figure, axes = canvas(5.4, 2.2, (-6.2, 6.2), (8.0, 11.3))
    angles = [-0.5 + i / 60.0 for i in range(61)]
    axes.plot([10 * math.sin(a) for a in angles], [10 * math.cos(a) for a in angles], color=TRUE, label="true path")
    ends = [10 * math.sin(-0.5), 10 * math.sin(0.5)], [10 * math.cos(0.5)] * 2
    axes.plot(*ends, color=MODEL, label="slerp, the default")
    axes.plot(*ends, "o", color="black", markersize=4)
    axes.add_patch(Circle((0, 10), 0.3, color=TARGET))
    axes.text(0, 10.55, "this post is hit, and not reported", ha="center")
    axes.add_patch(Circle((0, 10 * math.cos(0.5)), 0.3, color=TARGET))
    axes.text(0, 8.05, "this one is reported, and never met", ha="center")
    axes.text(-5.2, 8.3, "pose", ha="center")
    axes.text(5.2, 8.3, "pose", ha="center")
    axes.legend(loc="upper left", frameon=False, fontsize=8)
    save(figure, "arc")


def bar(axes, angle, colour, alpha):
    c, s = math.cos(angle), math.sin(angle)
    corners = [(1, 0.05), (-1, 0.05), (-1, -0.05), (1, -0.05)]
    points = [(c * x - s * y, s * x + c * y) for x, y in corners]
    axes.add_patch(Polygon(points, color=colour, alpha=alpha, linewidth=0))


def turn():
    figure, axes = canvas(5.4, 2.2, (-1.4, 4.6), (-1.15, 1.35))
    for i in range(1, 12):
        bar(axes, 2 * math.pi * i / 24, TRUE, 0.18)
    bar(axes, 0, "black", 1.0)
    axes.add_patch(Circle((0, 0.8), 0.1, color=TARGET, zorder=5))
    axes.text(0, 1.12, "truth: one turn, two hits", ha="center")
    axes.add_patch(Rectangle((2.2, -0.05), 2, 0.1, color=MODEL))
    axes.add_patch(Circle((3.2, 0.8), 0.1, color=TARGET, zorder=5))
    axes.text(3.2, 1.12, "slerp: two equal poses, no turn", ha="center")
    save(figure, "turn")


def rounding():
    figure, axes = canvas(5.4, 1.9, (-0.5, 10.5), (-1.0, 2.6))
    for i in range(6):
        axes.plot([2 * i, 2 * i], [-0.4, 0.1], color="black", linewidth=0.8)
    axes.plot([-0.3, 10.3], [-0.15, -0.15], color="black", linewidth=0.8)
    axes.text(10.3, -0.85, "float32 near 1000 m: one step is 61 micrometres", ha="right")
    axes.plot([3.3, 3.3], [0.1, 2.1], color=TRUE)
    axes.plot([4.0, 4.0], [0.1, 2.1], color=MODEL)
    axes.annotate("", (4.0, 1.1), (3.3, 1.1), arrowprops={"arrowstyle": "->"})
    axes.text(3.15, 1.6, "the wall as drawn", ha="right", color=TRUE)
    axes.text(4.15, 1.6, "as loaded: certificates speak of this one", color=MODEL)
    save(figure, "rounding")


def flush():
    figure, axes = canvas(5.4, 1.7, (-0.4, 8.4), (-0.2, 2.4))
    for left, gap, word in ((0, 0.0, "resting exactly: POSSIBLE"), (4.6, -0.22, "a nanometre deep: CONFIRMED")):
        axes.add_patch(Rectangle((left, 0), 3.4, 0.8, color=TARGET))
        axes.add_patch(Rectangle((left + 0.9, 0.8 + gap), 1.6, 0.8, facecolor="none", edgecolor=MODEL, linewidth=1.5))
        axes.text(left + 1.7, 1.95, word, ha="center")
    save(figure, "flush")


arc()
turn()
rounding()
flush()

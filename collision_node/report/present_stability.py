#!/usr/bin/python3
"""Draws the walks of `report --stability`: FOLDER/stability.csv -> stability.png and stability.svg.

One strip for each direction: a row for each method, a cell for each rung. Needs python3-matplotlib.
"""
import csv
import sys

KEPT, UNDECIDED, WRONG, NOT_ASKED = "#3b8f5a", "#f2c14e", "#c8412f", "#d9d9d9"
WRONGS = ("missed", "false", "late", "early", "bound")


def read(path):
    """{direction: (about, unit, values, {method: [row of a rung]})}, all in the file's order."""
    directions = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            _, _, values, methods = directions.setdefault(row["direction"], (row["about"], row["unit"], [], {}))
            if row["value"] not in values:
                values.append(row["value"])
            methods.setdefault(row["method"], []).append(row)
    return directions


def colour(row):
    if any(int(row[name]) for name in WRONGS):
        return WRONG
    if int(row["undecided"]):
        return UNDECIDED
    return KEPT if int(row["kept"]) else NOT_ASKED if int(row["not_asked"]) else None


def label(value):
    number = float(value)
    return f"{number:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e0", "") if number else "0"


def draw_direction(axes, name, about, unit, values, methods):
    shown = [method for method, rows in methods.items() if any(colour(row) for row in rows)]
    for y, method in enumerate(shown):
        for x, row in enumerate(methods[method]):
            fill = colour(row)
            if not fill:
                continue
            axes.add_patch(plt.Rectangle((x - 0.47, y - 0.42), 0.94, 0.84, color=fill, linewidth=0))
            wrong = sum(int(row[kind]) for kind in WRONGS)
            if wrong:
                axes.text(x, y, str(wrong), ha="center", va="center", fontsize=6, color="white")
    axes.set_xlim(-0.6, len(values) - 0.4)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xticks(range(len(values)), [label(value) for value in values], fontsize=7)
    axes.set_yticks(range(len(shown)), shown, fontsize=7)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title(f"{name}{f' [{unit}]' if unit else ''}: {about}", fontsize=8, loc="left")


def draw(folder):
    directions = read(f"{folder}/stability.csv")
    columns = 2
    lines = -(-len(directions) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(15, 2.3 * lines), layout="constrained")
    figure.get_layout_engine().set(rect=(0, 0.02, 1, 0.98))
    for axes in grid.flat[len(directions):]:
        axes.set_axis_off()
    for axes, (name, (about, unit, values, methods)) in zip(grid.flat, directions.items()):
        draw_direction(axes, name, about, unit, values, methods)
    legend = [plt.Rectangle((0, 0), 1, 1, color=fill) for fill in (KEPT, UNDECIDED, WRONG, NOT_ASKED)]
    figure.legend(legend, ("promise kept", "some undecided, none wrong", "wrong (how many)", "no time left"),
                  loc="lower center", ncol=4, fontsize=8)
    figure.savefig(f"{folder}/stability.png", dpi=110)
    figure.savefig(f"{folder}/stability.svg")


if __name__ == "__main__":
    try:
        import matplotlib
    except ImportError:
        sys.exit("python3-matplotlib is not installed: no picture of the walks")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    draw(sys.argv[1])

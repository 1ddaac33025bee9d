#!/usr/bin/python3
"""Draws a recorded run (`report --from-bag`): FOLDER/from_bag.csv -> from_bag.png and from_bag.svg.

Left: the worst bracket of each heartbeat against its wall time. Right: wall time along the data. Needs
python3-matplotlib.
"""
import csv
import sys


def draw(folder):
    with open(f"{folder}/from_bag.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    stamps = [float(row["stamp_s"]) for row in rows]
    times = [float(row["wall_time_s"]) for row in rows]
    brackets = [float(row["worst_bracket_s"]) for row in rows]
    errors, along = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")[1]
    hits = [(time, bracket) for time, bracket in zip(times, brackets) if bracket > 0]
    errors.loglog([time for time, _ in hits], [bracket for _, bracket in hits], "o", color="#c8412f", markersize=5)
    errors.set_xlabel("wall time of a heartbeat [s]")
    errors.set_ylabel("worst bracket in it [s]")
    errors.set_title(f"{len(hits)} of {len(rows)} heartbeats with events", fontsize=9)
    along.semilogy(stamps, times, "-", color="#444444", linewidth=1)
    along.semilogy([stamp for stamp, bracket in zip(stamps, brackets) if bracket > 0],
                   [time for time, bracket in zip(times, brackets) if bracket > 0], "o", color="#c8412f", markersize=5)
    along.set_xlabel("data time since the first heartbeat [s]")
    along.set_ylabel("wall time of a heartbeat [s]")
    along.set_title("dots: with events", fontsize=9)
    for axes in (errors, along):
        axes.grid(True, which="major", color="#dddddd")
    errors.figure.savefig(f"{folder}/from_bag.png", dpi=110)
    errors.figure.savefig(f"{folder}/from_bag.svg")


if __name__ == "__main__":
    try:
        import matplotlib
    except ImportError:
        sys.exit("python3-matplotlib is not installed: no picture of the recording")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    draw(sys.argv[1])

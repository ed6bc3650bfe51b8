"""Turns the results of cycles_compare.sh into tables (Markdown, standard output) and a plot (SVG).

cycles_report.py RESULTS.tsv PLOT.svg

CPU is user + system time of all threads: of the bake itself (scene set-up and acceleration structures included, reading
and writing files and starting the program excluded) and, for relume, of the whole process.
"""

import csv
import math
import sys

NAMES = {"cycles": "Cycles", "smooth": "relume hybrid", "plain": "relume hybrid --no-smooth"}
COLOURS = {"cycles": "#d55e00", "smooth": "#0072b2", "plain": "#009e73"}


def read(path):
    """Rows by kind, by samples, each (samples, CPU seconds, process CPU seconds, error, error against Cycles)."""
    rows, agreement = {kind: [] for kind in NAMES}, None
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            if row["kind"] == "agreement":
                agreement = float(row["error_cycles"])
                continue
            cpu, process = float(row["bake_cpu"]), float(row["process_cpu"] or 0)
            errors = float(row["error_relume"]), float(row["error_cycles"])
            rows[row["kind"]].append((int(row["samples"]), cpu, process) + errors)
    for points in rows.values():
        points.sort()
    return rows, agreement


def cpu_for(points, error, column):
    """CPU seconds at which a series first gets below an error: log-log between points; None beyond the last."""
    for before, after in zip(points, points[1:]):
        if before[3] > error >= after[3]:
            share = math.log(before[3] / error) / math.log(before[3] / after[3])
            return before[column] * (after[column] / before[column]) ** share
    if points and points[0][3] <= error:
        return points[0][column]
    return None


def table(rows):
    print("| | samples | CPU of the bake | CPU of the process | relRMSE against relume | against Cycles |")
    print("|---|---:|---:|---:|---:|---:|")
    for kind, points in rows.items():
        for samples, cpu, process, error, against in points:
            whole = "%.3g s" % process if kind != "cycles" else ""
            errors = 100 * error, 100 * against
            print("| %s | %d | %.3g s | %s | %.2f %% | %.2f %% |" % ((NAMES[kind], samples, cpu, whole) + errors))


def summary(rows):
    print("\n| CPU seconds to relRMSE | 2 % | 1 % |")
    print("|---|---:|---:|")
    for kind, points in rows.items():
        cells = []
        for error in (0.02, 0.01):
            own, theirs = cpu_for(points, error, 1), cpu_for(rows["cycles"], error, 1)
            note = ""
            if theirs is None:  # Monte-Carlo error falls with the root of the time
                last = rows["cycles"][-1]
                theirs = last[1] * (last[3] / error) ** 2
                if kind == "cycles":
                    own, note = theirs, ", extrapolated"
            text = "not reached" if own is None else "%.3g%s" % (own, note)
            if own is not None and kind != "cycles":
                text += " (1/%.0f)" % (theirs / own)
            cells.append(text)
        print("| %s | %s |" % (NAMES[kind], " | ".join(cells)))


def plot(rows, path):
    width, height, left, right, top, bottom = 720, 440, 70, 20, 20, 56
    points = [p for series in rows.values() for p in series if p[1] > 0 and p[3] > 0]
    low_x, high_x = (f(math.log10(p[1]) for p in points) for f in (min, max))
    low_y, high_y = (f(math.log10(p[3]) for p in points) for f in (min, max))
    low_x, high_x, low_y, high_y = low_x - 0.15, high_x + 0.15, low_y - 0.15, high_y + 0.15

    def x(value):
        return left + (math.log10(value) - low_x) / (high_x - low_x) * (width - left - right)

    def y(value):
        return height - bottom - (math.log10(value) - low_y) / (high_y - low_y) * (height - top - bottom)

    out = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" role="img">' % (width, height),
        "<title>Error over CPU time: relume hybrid and Cycles</title>",
        "<style>text{font:13px system-ui,sans-serif;fill:#30363c}.g{stroke:#8885;fill:none}"
        ".l{fill:none;stroke-width:2}@media(prefers-color-scheme:dark){text{fill:#d8dde2}}</style>",
    ]
    for decade in range(math.floor(low_x), math.ceil(high_x) + 1):
        for step in (1, 2, 5):
            value = step * 10.0**decade
            if low_x <= math.log10(value) <= high_x:
                out.append('<path class="g" d="M%.1f %dV%d"/>' % (x(value), top, height - bottom))
                if step == 1:
                    out.append('<text x="%.1f" y="%d" text-anchor="middle">%g</text>' % (x(value), height - 36, value))
    for percent in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100):
        if low_y <= math.log10(percent / 100) <= high_y:
            at = y(percent / 100)
            out.append('<path class="g" d="M%d %.1fH%d"/>' % (left, at, width - right))
            out.append('<text x="%d" y="%.1f" text-anchor="end">%g %%</text>' % (left - 8, at + 4, percent))
    out.append('<text x="%d" y="%d" text-anchor="middle">CPU time of the bake [s]</text>' % (width / 2, height - 12))
    out.append('<text transform="translate(16 %d) rotate(-90)" text-anchor="middle">relRMSE</text>' % (height / 2))
    for number, (kind, series) in enumerate(rows.items()):
        series = [p for p in series if p[1] > 0 and p[3] > 0]
        line = " ".join("%.1f,%.1f" % (x(p[1]), y(p[3])) for p in series)
        out.append('<polyline class="l" stroke="%s" points="%s"/>' % (COLOURS[kind], line))
        for p in series:
            out.append(
                '<circle cx="%.1f" cy="%.1f" r="4" fill="%s"><title>%s, %d samples: %.3g s, %.2f %%</title></circle>'
                % (x(p[1]), y(p[3]), COLOURS[kind], NAMES[kind], p[0], p[1], 100 * p[3])
            )
        place = width - right - 210, top + 22 + 20 * number
        out.append('<path class="l" stroke="%s" d="M%d %dh24"/>' % (COLOURS[kind], place[0], place[1] - 4))
        out.append('<text x="%d" y="%d">%s</text>' % (place[0] + 32, place[1], NAMES[kind]))
    out.append("</svg>")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


def main(results, picture):
    rows, agreement = read(results)
    table(rows)
    summary(rows)
    if agreement is not None:
        print("\nWithout their noise the two programs' maps differ by %.2f %% (relRMSE)." % (100 * agreement))
    plot(rows, picture)


main(*sys.argv[1:])

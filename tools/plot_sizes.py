"""Draws the cost of a step against the width of the grid: python plot_sizes.py JSON SVG

JSON is what `cargo bench -- sizes --json JSON` wrote. The picture has the style of the book's others, for a light and for a dark
ground. A set of instructions has one colour, dash and mark; of several threads lines are fainter and marks larger.
"""

import json
import math
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STYLE_OF = ROOT / "book/src/paper/figure-2-laws.svg"  # any figure of the book: all have one style

WIDTH, FIELD_HEIGHT = 480.0, 240.0
LEFT, RIGHT, TOP, BELOW = 58.0, 14.0, 34.0, 44.0
LEGEND_ROW, SAMPLE, CHARACTER = 20.0, 30.0, 6.6
DASHES = ["", "7 3", "2 3", "9 3 2 3", "12 4", "1 2"]


def main():
    source, target = sys.argv[1:]
    series = read(json.loads(Path(source).read_text(encoding="utf-8")))
    Path(target).write_text(draw(series), encoding="utf-8")


def read(measured):
    """Width and time [ns] of every point, by instructions and threads."""
    sections = [section for section in measured["sections"] if section["name"] == "sizes"]
    if not sections:
        sys.exit("there is no section `sizes` in it")
    series = {}
    for row in sections[0]["rows"]:
        if "width" in row:
            series.setdefault((row["instructions"], row["threads"]), []).append((row["width"], row["value"]))
    return series


def draw(series):
    points = [point for line in series.values() for point in line]
    x_axis = Axis([x for x, _ in points])
    y_axis = Axis([y for _, y in points])
    width = WIDTH - LEFT - RIGHT

    def place(point):
        return LEFT + width * x_axis.share(point[0]), TOP + FIELD_HEIGHT * (1.0 - y_axis.share(point[1]))

    out = []
    for value in sorted({x for x, _ in points}):
        x, _ = place((value, y_axis.low))
        out.append(f'<path class="rule" d="M{x:.1f} {TOP}v{FIELD_HEIGHT}"/>')
        # 100 and 128 would run into each other.
        if value != 100:
            out.append(text(x, TOP + FIELD_HEIGHT + 17.0, value, "middle"))
    for value in y_axis.ticks():
        _, y = place((x_axis.low, value))
        out.append(f'<path class="rule" d="M{LEFT} {y:.1f}h{width}"/>')
        out.append(text(LEFT - 6.0, y + 4.5, f"{value:g}", "end"))
    out.append(f'<path class="frame" d="M{LEFT} {TOP}h{width}v{FIELD_HEIGHT}h{-width}z"/>')
    out.append(text(LEFT + width, TOP + FIELD_HEIGHT + 36.0, "particles along each edge", "end", "axis"))
    out.append(text(8.0, 18.0, "ns per particle and step", "start", "axis"))
    names = list(dict.fromkeys(instructions for instructions, _ in series))
    x, row = LEFT, 0
    for (instructions, threads), line in series.items():
        number = names.index(instructions)
        style = f'class="c{number + 1} line" stroke-dasharray="{DASHES[number]}"'
        style += f' stroke-opacity="{1 if threads == 1 else 0.55}"'
        places = [place(point) for point in line]
        out.append(f'<path {style} d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in places)}"/>')
        out += [mark(number, threads, *point) for point in places]
        label = f"{instructions}, {threads} thread{'' if threads == 1 else 's'}"
        length = SAMPLE + 24.0 + CHARACTER * len(label)
        if LEFT < x and WIDTH < x + length:
            x, row = LEFT, row + 1
        y = TOP + FIELD_HEIGHT + BELOW + LEGEND_ROW * (row + 0.6)
        out.append(f'<path {style} d="M{x:.1f} {y:.1f}h{SAMPLE}"/>')
        out.append(mark(number, threads, x + 0.5 * SAMPLE, y))
        out.append(text(x + SAMPLE + 6.0, y + 4.5, label, "start"))
        x += length
    height = TOP + FIELD_HEIGHT + BELOW + LEGEND_ROW * (row + 1) + 6.0
    style = STYLE_OF.read_text(encoding="utf-8").split("<style>")[1].split("</style>")[0]
    caption = "Time per particle and step against the particles along each edge of a square cloth."
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:g}" height="{height:g}" class="figure" '
        f'viewBox="0 0 {WIDTH:g} {height:g}" role="img" aria-label="{caption}">\n<style>{style}</style>\n'
        '<rect class="ground" width="100%" height="100%"/>\n' + "\n".join(out) + "\n</svg>\n"
    )


class Axis:
    """A logarithmic axis with some room at both ends."""

    def __init__(self, values):
        self.low, self.high = min(values) / 1.15, max(values) * 1.15

    def share(self, value):
        return math.log(value / self.low) / math.log(self.high / self.low)

    def ticks(self):
        steps = [digit * 10.0**power for power in range(-3, 7) for digit in (1, 2, 3, 5, 7)]
        return [value for value in steps if self.low <= value <= self.high]


def text(x, y, content, anchor, kind=""):
    kind = f' class="{kind}"' if kind else ""
    return f'<text{kind} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(str(content))}</text>'


def mark(number, threads, x, y):
    """A disc, square or triangle by the number of the colour; larger for several threads."""
    r = 3.5 if threads == 1 else 5.0
    shapes = [
        f"M{x - r:.1f} {y:.1f}a{r} {r} 0 1 0 {2 * r} 0a{r} {r} 0 1 0 {-2 * r} 0",
        f"M{x - r:.1f} {y - r:.1f}h{2 * r}v{2 * r}h{-2 * r}z",
        f"M{x:.1f} {y - r:.1f}l{r} {1.7 * r}h{-2 * r}z",
    ]
    return f'<path class="c{number + 1} mark" d="{shapes[number % len(shapes)]}"/>'


if __name__ == "__main__":
    main()

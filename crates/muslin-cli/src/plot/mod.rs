//! Line plots as SVG: axes with ticks, linear or logarithmic, and a legend.
//!
//! Colours, dashes and marks go together, so that a series is known without seeing colours. The SVG has no colours of its
//! own but the style of the page, or of the file, gives them, for a light and for a dark ground.

mod axis;
mod svg;
mod text;

use std::fmt::Write as _;

use serde::Serialize;
use serde_json::{Value, json};

pub(crate) use self::axis::Axis;
pub(crate) use self::svg::{FIGURE_STYLE, escaped, svg_element};
pub(crate) use self::text::{csv_field, power_of_ten};

/// Width of a plot, in the units of its text's size.
const WIDTH: f64 = 480.0;

/// Space left, right and above the field.
const MARGINS: [f64; 3] = [58.0, 14.0, 34.0];

/// Height of the field.
const FIELD_HEIGHT: f64 = 240.0;

/// Space below the field for the ticks and the label.
const BELOW: f64 = 44.0;

/// Height of a row of the legend.
const LEGEND_ROW: f64 = 20.0;

/// Width of a character of the legend, about.
const CHARACTER: f64 = 6.6;

/// Width of a line in the legend.
const SAMPLE: f64 = 30.0;

/// Dashes by the number of the colour.
const DASHES: [&str; 8] = ["", "", "7 3", "2 3", "9 3 2 3", "12 4", "1 2", "6 2 2 2"];

/// A plot of series over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

/// A line through points.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) name: String,
    /// Points in the units of the axes.
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) style: Style,
    /// Number of its colour; 0 is that of text.
    pub(crate) colour: usize,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    Line,
    /// A line with a mark at every point.
    Marked,
    /// Marks alone.
    Marks,
    /// A thin line to compare with.
    Guide,
}

impl Series {
    /// A line through `points`.
    pub(crate) fn new(
        name: impl Into<String>,
        colour: usize,
        style: Style,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        Self { name: name.into(), points: points.into_iter().collect(), style, colour }
    }
}

impl Plot {
    /// Width and height.
    pub(crate) fn size(&self) -> [f64; 2] {
        [WIDTH, MARGINS[2] + FIELD_HEIGHT + BELOW + LEGEND_ROW * self.legend().1 as f64 + 6.0]
    }

    /// The elements inside the SVG element; `name` is that of the figure, which no other on the page has.
    pub(crate) fn elements(&self, name: &str) -> String {
        let [left, right, top] = MARGINS;
        let [width, height] = [WIDTH - left - right, FIELD_HEIGHT];
        let values =
            |axis: usize| self.series.iter().flat_map(move |s| s.points.iter().map(move |p| p[axis]));
        let (x_ends, y_ends) = (self.x.ends(values(0)), self.y.ends(values(1)));
        let place = |point: [f64; 2]| {
            let x = left + width * self.x.place(point[0], x_ends);
            let y = top + height * (1.0 - self.y.place(point[1], y_ends));
            [x, y]
        };
        let mut out = String::new();
        for tick in self.x.ticks(x_ends) {
            let x = left + width * self.x.place(tick.value, x_ends);
            let _ = writeln!(out, "<path class=\"rule\" d=\"M{x:.1} {top}v{height}\"/>");
            let y = top + height + 17.0;
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\">{}</text>", tick.text);
        }
        for tick in self.y.ticks(y_ends) {
            let y = top + height * (1.0 - self.y.place(tick.value, y_ends));
            let _ = writeln!(out, "<path class=\"rule\" d=\"M{left} {y:.1}h{width}\"/>");
            let (x, y) = (left - 6.0, y + 4.5);
            let _ = writeln!(out, "<text x=\"{x}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>", tick.text);
        }
        let _ = writeln!(
            out,
            "<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>\n\
             <clipPath id=\"clip-{name}\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/></clipPath>"
        );
        let _ = writeln!(out, "<text class=\"axis\" x=\"6\" y=\"18\">{}</text>", escaped(&self.y.label));
        let (x, y) = (left + width, top + height + 36.0);
        let label = escaped(&self.x.label);
        let _ = writeln!(out, "<text class=\"axis\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\">{label}</text>");
        let _ = writeln!(out, "<g clip-path=\"url(#clip-{name})\">");
        for series in &self.series {
            let takes = |point: &&[f64; 2]| self.x.takes(point[0]) && self.y.takes(point[1]);
            let runs = series.points.split(|point| !takes(&point));
            let runs: Vec<Vec<[f64; 2]>> =
                runs.map(|run| run.iter().map(|point| place(*point)).collect()).collect();
            series.write_line(&mut out, &runs);
            series.write_marks(&mut out, runs.iter().flatten());
        }
        out.push_str("</g>\n");
        self.write_legend(&mut out, top + height + BELOW);
        out
    }

    /// Place of each series' entry in the legend, column and row, and the number of rows.
    fn legend(&self) -> (Vec<(f64, usize)>, usize) {
        let mut places = Vec::new();
        let (mut x, mut row) = (MARGINS[0], 0);
        for series in &self.series {
            let width = SAMPLE + 24.0 + CHARACTER * series.name.chars().count() as f64;
            if MARGINS[0] < x && WIDTH < x + width {
                (x, row) = (MARGINS[0], row + 1);
            }
            places.push((x, row));
            x += width;
        }
        let rows = if places.is_empty() { 0 } else { row + 1 };
        (places, rows)
    }

    fn write_legend(&self, out: &mut String, top: f64) {
        for (series, (x, row)) in self.series.iter().zip(self.legend().0) {
            let y = top + LEGEND_ROW * (row as f64 + 0.6);
            series.write_line(out, &[vec![[x, y], [x + SAMPLE, y]]]);
            series.write_marks(out, [[x + 0.5 * SAMPLE, y]].iter());
            let (x, y) = (x + SAMPLE + 6.0, y + 4.5);
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(&series.name));
        }
    }

    /// Every number that is drawn.
    pub(crate) fn to_json(&self, caption: &str) -> Value {
        let finite = |value: f64| value.is_finite().then_some(value);
        let series = self.series.iter().map(|series| {
            let points = series.points.iter().map(|[x, y]| PlotPoint(finite(*x), finite(*y)));
            json!({ "name": series.name, "points": points.collect::<Vec<_>>() })
        });
        json!({
            "caption": caption,
            "x": self.x.label,
            "y": self.y.label,
            "series": series.collect::<Vec<_>>(),
        })
    }

    /// Every number that is drawn, one line per point; what is no finite number is left empty.
    pub(crate) fn to_csv(&self) -> String {
        let mut text = format!("series,{},{}\n", csv_field(&self.x.label), csv_field(&self.y.label));
        let finite = |value: f64| if value.is_finite() { format!("{value:?}") } else { String::new() };
        for series in &self.series {
            for [x, y] in &series.points {
                let _ = writeln!(text, "{},{},{}", csv_field(&series.name), finite(*x), finite(*y));
            }
        }
        text
    }
}

impl Series {
    /// The line through every one of `runs` of points, unless the series has marks alone.
    fn write_line(&self, out: &mut String, runs: &[Vec<[f64; 2]>]) {
        let class = match self.style {
            Style::Marks => return,
            Style::Guide => "guide",
            Style::Line | Style::Marked => "line",
        };
        let dashes = DASHES[self.colour % DASHES.len()];
        for run in runs.iter().filter(|run| 1 < run.len()) {
            let mut path = String::new();
            for (index, [x, y]) in run.iter().enumerate() {
                // Far outside numbers would only make the file longer.
                let y = y.clamp(-1e4, 1e4);
                let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
            }
            let _ = writeln!(
                out,
                "<path class=\"c{} {class}\" stroke-dasharray=\"{dashes}\" d=\"{path}\"/>",
                self.colour
            );
        }
    }

    /// Marks at `points`, if the series has any.
    fn write_marks<'p>(&self, out: &mut String, points: impl Iterator<Item = &'p [f64; 2]>) {
        if matches!(self.style, Style::Line | Style::Guide) {
            return;
        }
        for [x, y] in points {
            let shape = match self.colour % 5 {
                0 => format!("M{x:.1} {:.1}m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", y),
                1 => format!("M{:.1} {:.1}h7v7h-7z", x - 3.5, y - 3.5),
                2 => format!("M{x:.1} {:.1}l5 8h-10z", y - 5.0),
                3 => format!("M{x:.1} {:.1}l5 5l-5 5l-5 -5z", y - 5.0),
                _ => format!("M{x:.1} {:.1}l5 -8h-10z", y + 5.0),
            };
            let _ = writeln!(out, "<path class=\"c{} mark\" d=\"{shape}\"/>", self.colour);
        }
    }
}

/// A point of a plot as JSON: null where it is no finite number.
#[derive(Serialize)]
struct PlotPoint(Option<f64>, Option<f64>);

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: &[[f64; 2]]) -> Plot {
        Plot {
            x: Axis::logarithmic("step [s]"),
            y: Axis::linear("a < b"),
            series: vec![Series::new("one", 1, Style::Marked, points.iter().copied())],
        }
    }

    #[test]
    fn what_is_no_number_is_not_drawn_and_breaks_the_line() {
        let plot = plot(&[[1.0, 1.0], [2.0, 2.0], [3.0, f64::NAN], [0.0, 3.0], [5.0, 1.0], [6.0, 2.0]]);
        let svg = plot.elements("figure");
        assert_eq!(svg.matches("class=\"c1 line\"").count(), 2 + 1, "two pieces and the legend's: {svg}");
        assert_eq!(svg.matches("class=\"c1 mark\"").count(), 4 + 1);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(svg.contains("a &lt; b"));
        assert!(plot.to_csv().contains("\none,3.0,\n"));
        assert_eq!(plot.to_json("")["series"][0]["points"][2], json!([3.0, null]));
    }

    #[test]
    fn points_lie_where_the_axes_say() {
        let mut plot = plot(&[[1.0, 0.0], [10.0, 5.0], [100.0, 10.0]]);
        plot.x = plot.x.between(1.0, 100.0);
        let svg = plot.elements("figure");
        let [left, right, top] = MARGINS;
        let middle = [left + 0.5 * (WIDTH - left - right), top + 0.5 * FIELD_HEIGHT];
        assert!(svg.contains(&format!("L{:.1} {:.1}L", middle[0], middle[1])), "{svg}");
    }
}

//! A drawing made of lines and dots, as SVG.

use std::fmt::Write as _;

/// Lines, dots and labels in a box of its own units, x to the right and y down.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    pub(crate) size: [f64; 2],
    pub(crate) strokes: Vec<Stroke>,
    pub(crate) dots: Vec<Dot>,
    pub(crate) labels: Vec<Label>,
}

/// A line, bent towards `bow` beside its middle if there is any.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub(crate) ends: [[f64; 2]; 2],
    /// How far the line's middle is beside the straight one.
    pub(crate) bow: f64,
    /// Number of its colour.
    pub(crate) colour: usize,
    pub(crate) is_bold: bool,
}

/// A filled circle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dot {
    pub(crate) place: [f64; 2],
    pub(crate) is_bold: bool,
}

/// Text centred above a place.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    pub(crate) place: [f64; 2],
    pub(crate) text: String,
}

impl Drawing {
    /// The elements inside the SVG element.
    pub(crate) fn elements(&self) -> String {
        let mut out = String::new();
        for stroke in &self.strokes {
            let [[x1, y1], [x2, y2]] = stroke.ends;
            let (dx, dy) = (x2 - x1, y2 - y1);
            let length = (dx * dx + dy * dy).sqrt().max(f64::MIN_POSITIVE);
            // The middle of a quadratic curve is half way to its control point.
            let (cx, cy) = (
                0.5 * (x1 + x2) - 2.0 * stroke.bow * dy / length,
                0.5 * (y1 + y2) + 2.0 * stroke.bow * dx / length,
            );
            let weight = if stroke.is_bold { "bold" } else { "light" };
            let _ = writeln!(
                out,
                "<path class=\"c{} {weight}\" d=\"M{x1:.1} {y1:.1}Q{cx:.1} {cy:.1} {x2:.1} {y2:.1}\"/>",
                stroke.colour
            );
        }
        for dot in &self.dots {
            let radius = if dot.is_bold { 5.0 } else { 3.0 };
            let [x, y] = dot.place;
            let _ = writeln!(out, "<circle class=\"dot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>");
        }
        for label in &self.labels {
            let [x, y] = label.place;
            let text = crate::plot::escaped(&label.text);
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{text}</text>");
        }
        out
    }
}

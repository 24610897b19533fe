//! `view.html`: one self-contained page that turns and plays a run and plots its energies and strains.
//!
//! The page is a template, built from the sources in the repository's `viewer` folder, with three places to fill: the
//! title, the description of the run as JSON, and the frames as a compressed payload. Content is only ever put between
//! pieces of the template, so nothing in a title can be taken for a placeholder, and it is escaped, so nothing in it
//! can become markup.

mod payload;
mod series;

use std::io::{self, Write};

use serde_json::{Value, json};

use self::payload::{PayloadBounds, write_payload};
use self::series::thin_series;
use super::FrameSource;
use crate::Points;
use crate::model::Surface;

/// Vertices times frames that a page holds at most.
///
/// Where a run has more, the page shows every n-th frame and the last, with the smallest n that fits, and says so. A
/// vertex of a frame takes seven bytes before compression; as it is written, one to two in a smooth motion and at most
/// nine and a half in one without any order. So a page stays below some four megabytes, or twenty at worst.
pub const VIEW_VERTEX_FRAMES: usize = 1 << 21;

/// What a page says of a run besides its frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewInfo {
    /// Title of the run; `muslin` is shown in place of a blank one.
    pub title: String,
    /// What is shown prominently below the title: why the run stopped before its end, warnings.
    pub notice: Option<String>,
    /// Frames of the run per simulated second [1/s]: frame n is at n / `frame_rate`.
    pub frame_rate: f64,
    /// Name and value of each fact to show, in order, with units.
    pub facts: Vec<(String, String)>,
    /// Times [s] of the samples of all series, ascending. Those after the last frame are left out.
    pub times: Vec<f64>,
    /// Energies [J] over time. The one named `residual` is drawn apart from the others.
    pub energies: Vec<ViewSeries>,
    /// Strains [1] over time. Names that differ in a last word `max` or `mean` share a colour.
    pub strains: Vec<ViewSeries>,
}

/// One quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewSeries {
    /// Name, for the legend.
    pub name: String,
    /// One value per time of [`ViewInfo::times`]; a value that is not finite leaves a gap.
    pub values: Vec<f64>,
}

/// Writes the page of a run.
///
/// `pins` are the particles that are held; those among the surface's vertices are marked. `strains` overwrites its
/// vector with the strain [1] of every particle at the given positions [m]; it colours the cloth. An infinite strain
/// counts as the largest finite one. Frames are read twice, one at a time. Positions are rounded to
/// 1/65534 of the largest extent that the surface has in any one frame (or to 2⁻³⁰ of the whole run's extent, if that
/// is more), strains to eight bits that are finest around zero. The same input gives the same bytes.
///
/// # Errors
/// If a frame cannot be read or `out` cannot be written. [`io::ErrorKind::InvalidInput`] if there is no frame or no
/// vertex, if the frame rate is not positive and finite, or if a series is not as long as its times.
/// [`io::ErrorKind::InvalidData`] if a position is not finite, a strain is NaN, or the extent of the run overflows.
///
/// # Panics
/// If a vertex's particle is missing from a frame or from its strains.
pub fn write_view(
    mut out: impl Write,
    info: &ViewInfo,
    surface: &Surface,
    pins: &[u32],
    strains: &mut dyn FnMut(&Points, &mut Vec<f32>),
    frames: &mut (impl FrameSource + ?Sized),
) -> io::Result<()> {
    let frame_count = frames.frame_count();
    check(info, surface, frame_count)?;
    let stride = frame_stride(frame_count, surface.vertices.len(), VIEW_VERTEX_FRAMES);
    let shown = shown_frames(frame_count, stride);
    let pinned: Vec<u32> = (0u32..)
        .zip(&surface.vertices)
        .filter(|(_, particle)| pins.contains(particle))
        .map(|(vertex, _)| vertex)
        .collect();

    let bounds = PayloadBounds::measure(surface, &shown, strains, frames)?;
    let description = describe(info, surface, &pinned, &bounds, frame_count, stride);

    let [head, heading, before_run, before_payload, end] = template_pieces();
    let title = escape_text(if info.title.trim().is_empty() { "muslin" } else { &info.title });
    for piece in [head, &title, heading, &title, before_run, &escape_json(&description), before_payload] {
        out.write_all(piece.as_bytes())?;
    }
    write_payload(&mut out, surface, &pinned, &bounds, &shown, strains, frames)?;
    out.write_all(end.as_bytes())?;
    out.flush()
}

/// Checks what does not depend on the frames' contents.
fn check(info: &ViewInfo, surface: &Surface, frame_count: usize) -> io::Result<()> {
    let invalid = |message: String| Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    if frame_count == 0 {
        return invalid("a page needs at least one frame".to_owned());
    }
    if surface.vertices.is_empty() {
        return invalid("a page needs at least one vertex".to_owned());
    }
    if !(0.0 < info.frame_rate && info.frame_rate.is_finite()) {
        return invalid(format!(
            "the frame rate is {} 1/s, but must be positive and finite",
            info.frame_rate
        ));
    }
    for series in info.energies.iter().chain(&info.strains) {
        if series.values.len() != info.times.len() {
            return invalid(format!(
                "the series `{}` has {} values, but there are {} times",
                series.name,
                series.values.len(),
                info.times.len()
            ));
        }
    }
    Ok(())
}

/// The smallest n for which every n-th of `frame_count` frames and the last fit the `budget` of vertices times
/// frames; the first and the last frame always do.
fn frame_stride(frame_count: usize, vertex_count: usize, budget: usize) -> usize {
    let most = (budget / vertex_count).max(2);
    if frame_count <= most { 1 } else { (frame_count - 1).div_ceil(most - 1) }
}

/// Every `stride`-th of `frame_count` frames, and the last.
fn shown_frames(frame_count: usize, stride: usize) -> Vec<usize> {
    let last = frame_count - 1;
    (0..last).step_by(stride).chain([last]).collect()
}

/// The run as the page's script reads it.
fn describe(
    info: &ViewInfo,
    surface: &Surface,
    pinned: &[u32],
    bounds: &PayloadBounds,
    frame_count: usize,
    stride: usize,
) -> Value {
    // Half a frame of room, so that round-off in the times leaves out none.
    let end = (frame_count as f64 - 0.5) / info.frame_rate;
    let shown = info.times.partition_point(|time| *time < end);
    let series = info.energies.iter().chain(&info.strains);
    let (times, columns) = thin_series(&info.times[..shown], series.map(|series| &series.values[..shown]));
    let named = |series: &[ViewSeries], columns: &[Vec<f32>]| -> Vec<Value> {
        let pairs = series.iter().zip(columns);
        // A JSON number is finite: serde_json writes any other as null, which the plot shows as a gap.
        pairs.map(|(series, values)| json!({ "name": series.name, "values": values })).collect()
    };
    let (energies, strains) = columns.split_at(info.energies.len());
    json!({
        "title": info.title,
        "notice": info.notice,
        "facts": info.facts,
        "frameRate": info.frame_rate,
        "frameCount": frame_count,
        "frameStride": stride,
        "counts": {
            "vertices": surface.vertices.len(),
            "triangles": surface.triangles.len(),
            "lines": surface.lines.len(),
            "points": surface.points.len(),
            "pins": pinned.len(),
        },
        "low": bounds.low().to_array(),
        "extent": bounds.extent_quanta(),
        "quantum": bounds.quantum(),
        "largestStrain": bounds.largest_strain(),
        "times": times,
        "energies": named(&info.energies, energies),
        "strains": named(&info.strains, strains),
    })
}

/// The template around its placeholders: twice the title, the description, the payload.
fn template_pieces() -> [&'static str; 5] {
    const TEMPLATE: &str = include_str!("view/template.html");
    let mut rest = TEMPLATE;
    let mut next = |placeholder: &str| {
        let (piece, after) = rest.split_once(placeholder).expect("the template has every placeholder");
        rest = after;
        piece
    };
    let pieces = [next("@@TITLE@@"), next("@@TITLE@@"), next("@@RUN@@"), next("@@FRAMES@@")];
    let [head, heading, before_run, before_payload] = pieces;
    [head, heading, before_run, before_payload, rest]
}

/// `text` as the content of an HTML element.
fn escape_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// `value` as JSON that can stand in a script element: without `<`, which could close or comment out the element.
fn escape_json(value: &Value) -> String {
    // These characters occur in JSON only inside strings, where an escape means the same.
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

#[cfg(test)]
mod tests;

//! Writes the page of a made-up run: `cargo run --example view_page -- PAGE sheet 100`.
//!
//! The second argument is a motion (`sheet`, `falling`, `thread`, `beads`), the third the number of particles along it.

mod motions;

use std::fs::File;
use std::io::{self, BufWriter};

use muslin::Points;
use muslin::write::{ViewInfo, ViewSeries, write_view};

use crate::motions::{Curve, Motion};

const FRAME_RATE: f64 = 60.0;

fn main() -> io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [page, motion, count] = &arguments[..] else {
        return Err(io::Error::other("usage: view_page PAGE sheet|falling|thread|beads COUNT"));
    };
    let motion = Motion::new(motion, count.parse().map_err(io::Error::other)?)?;
    let times: Vec<f64> = (0..=180).map(|frame| f64::from(frame) / FRAME_RATE).collect();
    let mut frames: Vec<Points> = times.iter().map(|&time| motion.positions(time)).collect();

    let fact = |name: &str, value: String| (name.to_owned(), value);
    let info = ViewInfo {
        title: motion.title().to_owned(),
        notice: None,
        frame_rate: FRAME_RATE,
        facts: vec![
            fact("particles", frames[0].len().to_string()),
            fact("springs", motion.spring_count().to_string()),
            fact("step", "1 ms".to_owned()),
            fact("duration", "3 s".to_owned()),
            fact("method", "made up".to_owned()),
            fact("largest strain", "8.3 %".to_owned()),
            fact("energy residual", "3.4e-5".to_owned()),
            fact("hash", "9f2c41d07be3".to_owned()),
        ],
        energies: series(&motions::ENERGIES, &times),
        strains: series(&motions::STRAINS, &times),
        times,
    };
    let mut strains = |positions: &Points, strains: &mut Vec<f32>| motion.eval_strains(positions, strains);
    let file = BufWriter::new(File::create(page)?);
    write_view(file, &info, &motion.surface(), &motion.pins(), &mut strains, &mut frames[..])?;

    let text = std::fs::read_to_string(page)?;
    assert!(text.ends_with("</html>\n") && text.contains(motion.title()), "the page is whole");
    Ok(())
}

/// Named functions of time, sampled.
fn series(named: &[Curve], times: &[f64]) -> Vec<ViewSeries> {
    let sample = |(name, value): &Curve| ViewSeries {
        name: (*name).to_owned(),
        values: times.iter().map(|&time| value(time)).collect(),
    };
    named.iter().map(sample).collect()
}

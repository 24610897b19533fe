//! Fig. 2: stretch curves of fabrics, and the tangent law fitted to what is published of them.

use std::f64::consts::{FRAC_PI_2, PI};

use muslin::force::{LinearLaw, TangentLaw, TensionLaw};

use super::report::{Cell, Column, Content, Figure, Item, Section, Table, per_cent, rounded};
use crate::plot::{Axis, Plot, Series, Style};

/// Published data, with their origin.
const DATA: &str = include_str!("tensile.csv");

/// Tension at which EMT is measured [N/m]: 500 gf/cm.
const TENSION: f64 = 500.0 * 0.980665;

/// Strain scale of the paper's curve [1].
const PAPER_SCALE: f64 = 0.06;

/// Points of a drawn curve.
const POINTS: usize = 80;

/// What is published of a fabric in one direction.
#[derive(Clone, Debug)]
struct Measurement {
    fabric: String,
    direction: String,
    /// Strain at [`TENSION`] [1].
    emt: f64,
    /// Linearity [1], if it is known.
    lt: Option<f64>,
    source: String,
}

impl Measurement {
    /// The source's authors and year.
    fn source_name(&self) -> &str {
        self.source.split(':').next().unwrap_or_default()
    }
}

/// Every source once, by its authors and year.
fn sources(measurements: &[Measurement]) -> Vec<(String, String)> {
    let mut sources: Vec<(String, String)> = Vec::new();
    for measurement in measurements {
        let (name, work) = measurement.source.split_once(':').unwrap_or((&measurement.source, ""));
        if sources.iter().all(|(known, _)| known != name) {
            sources.push((name.to_owned(), format!("{}, quoted second-hand.", work.trim())));
        }
    }
    sources
}

/// The tangent law with the extension and the linearity of a measurement.
#[derive(Clone, Copy, Debug)]
struct Fit {
    /// Strain scale a [1].
    scale: f64,
    /// Stiffness K₀ at rest, per width [N/m].
    initial_stiffness: f64,
    law: TangentLaw,
}

impl Fit {
    /// Solves LT(u) for u = EMT / a; the rest follows: a = EMT / u, K₀ = F / (a tan u).
    fn new(emt: f64, lt: f64) -> Self {
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        // LT falls from 1 to 0; a hundred halvings leave nothing of the interval.
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if lt < linearity(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let u = 0.5 * (low + high);
        let scale = emt / u;
        let initial_stiffness = TENSION / (scale * libm::tan(u));
        // The law takes the paper's k = 0.3π K₀.
        Self { scale, initial_stiffness, law: TangentLaw::new(0.3 * PI * initial_stiffness, scale) }
    }

    /// The extension [1] at [`TENSION`] and the linearity [1] that the law gives back.
    fn measured_again(&self) -> [f64; 2] {
        let emt = self.law.extension(TENSION, 1.0);
        [emt, self.law.energy(emt, 1.0) / (0.5 * TENSION * emt)]
    }
}

/// Linearity [1] of the law f = K₀ a tan(e / a) up to e = u a: LT = −2 ln cos u / (u tan u).
fn linearity(u: f64) -> f64 {
    let sine = libm::sin(u);
    -libm::log1p(-sine * sine) / (u * libm::tan(u))
}

/// Lines of [`DATA`].
fn measurements() -> Vec<Measurement> {
    let lines = DATA.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines
        .map(|line| {
            let fields = fields(line);
            let [fabric, direction, emt, lt, source] = &fields[..] else { panic!("five fields in {line}") };
            let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("a number in {line}"));
            Measurement {
                fabric: fabric.clone(),
                direction: direction.clone(),
                emt: number(emt),
                lt: (!lt.is_empty()).then(|| number(lt)),
                source: source.clone(),
            }
        })
        .collect()
}

/// Comma-separated fields of `line`, some of them in quotation marks.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut is_quoted = false;
    for character in line.chars() {
        match character {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => fields.push(String::new()),
            other => fields.last_mut().expect("there is always a field").push(other),
        }
    }
    fields
}

/// The section with the curves and the constants of the fits.
pub(crate) fn section() -> Section {
    let measurements = measurements();
    let paper = TangentLaw::new(1.0, PAPER_SCALE);
    let fits: Vec<(&Measurement, Fit)> =
        measurements.iter().filter_map(|m| Some((m, Fit::new(m.emt, m.lt?)))).collect();
    Section {
        name: "stretch",
        title: "Fig. 2: stretch curves",
        finding: format!(
            "With its scale left free, the tangent law meets both published numbers of a fabric, extension and linearity, exactly. \
             The paper's one scale ends at a strain of {}, but {} of {} published extensions are larger.",
            per_cent(paper.asymptote()),
            measurements.iter().filter(|m| paper.asymptote() < m.emt).count(),
            measurements.len()
        ),
        items: vec![
            Item::text(
                "Fig. 2 of the paper shows stretch curves of fabrics made of natural fibres, without numbers, to say that a \
                 spring stiffens as it is stretched. Woven cloth does: its yarns are crimped, and first unbend before they \
                 stretch. It is the fabric that stiffens; the fibres alone do not.",
            ),
            Item::text(format!(
                "What is published of the curve of a fabric is mostly two numbers: the strain EMT at a tension of {} N/m, and the \
                 linearity LT, 1 for a straight line. They fix the two constants of the tangent law exactly: with u = EMT / a, \
                 LT = −2 ln cos u / (u tan u). All values here are second-hand, quoted by others; for men's suiting it is \
                 a recommended band and not one fabric. Where no LT is known there is a point and no curve.",
                rounded(TENSION, 5)
            )),
            Item::Figure(fabrics_figure(&measurements, &fits)),
            Item::Figure(law_figure(&fits)),
            Item::Table(table(&measurements)),
            Item::Terms(sources(&measurements)),
            Item::text(format!(
                "The paper's curve has one scale for all, a = {PAPER_SCALE}: it ends at a strain of {}. A fabric with a larger EMT \
                 cannot be described by it, which is why muslin takes any `strain_scale`.",
                per_cent(paper.asymptote())
            )),
        ],
    }
}

fn fabrics_figure(measurements: &[Measurement], fits: &[(&Measurement, Fit)]) -> Figure {
    let middle =
        |direction: &str| fits.iter().find(|(m, _)| m.fabric.ends_with("middle") && m.direction == direction);
    let mut series = Vec::new();
    for (colour, direction) in [(1, "warp"), (2, "weft")] {
        if let Some((measurement, fit)) = middle(direction) {
            let strains = (0..=POINTS).map(|n| measurement.emt * n as f64 / POINTS as f64);
            series.push(Series::new(
                format!("suiting, {direction}"),
                colour,
                Style::Line,
                strains.map(|strain| [100.0 * strain, fit.law.tension(strain, 1.0)]),
            ));
        }
    }
    let points = |has_lt: bool| {
        let chosen = measurements.iter().filter(move |m| m.lt.is_some() == has_lt);
        chosen.map(|m| [100.0 * m.emt, TENSION])
    };
    series.push(Series::new("suiting, EMT", 0, Style::Marks, points(true)));
    series.push(Series::new("cotton and blends, EMT", 3, Style::Marks, points(false)));
    Figure {
        name: "figure-2-fabrics",
        caption: "Fig. 2: tension against strain of men's suiting, fitted to the middle of the published band; and measured \
                  points."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("strain [%]").between(0.0, 20.0),
            y: Axis::linear("tension per width [N/m]").between(0.0, 600.0),
            series,
        }),
    }
}

/// Laws alike but for their scale.
fn law_figure(fits: &[(&Measurement, Fit)]) -> Figure {
    let mut scales: Vec<(String, f64, usize)> =
        vec![(format!("the paper, a = {PAPER_SCALE}"), PAPER_SCALE, 4)];
    for (colour, direction) in [(1, "warp"), (2, "weft")] {
        let fit = fits.iter().find(|(m, _)| m.fabric.ends_with("middle") && m.direction == direction);
        scales.extend(fit.map(|(_, fit)| {
            (format!("suiting, {direction}, a = {}", rounded(fit.scale, 3)), fit.scale, colour)
        }));
    }
    let mut series: Vec<Series> = scales
        .into_iter()
        .map(|(name, scale, colour)| {
            let law = TangentLaw::new(0.3 * PI, scale);
            let end = law.asymptote().min(0.2);
            let strains = (0..=POINTS).map(|n| end * n as f64 / POINTS as f64);
            Series::new(name, colour, Style::Line, strains.map(|e| [100.0 * e, law.tension(e, 1.0)]))
        })
        .collect();
    let hooke = LinearLaw { stiffness: 1.0 };
    let line = [0.0, 0.2].map(|strain| [100.0 * strain, hooke.tension(strain, 1.0)]);
    series.push(Series::new("Hooke's law", 0, Style::Guide, line));
    Figure {
        name: "figure-2-laws",
        caption: "The tangent law with the paper's scale and with those of the fits, relative to the stiffness at rest. Each \
                  stiffens without bound at a strain of ½π a."
            .to_owned(),
        content: Content::Plot(Plot {
            x: Axis::linear("strain [%]").between(0.0, 20.0),
            y: Axis::linear("tension / stiffness at rest [1]").between(0.0, 0.4),
            series,
        }),
    }
}

fn table(measurements: &[Measurement]) -> Table {
    let rows = measurements.iter().map(|measurement| {
        let fit = measurement.lt.map(|lt| Fit::new(measurement.emt, lt));
        let number = |value: Option<f64>| value.map_or(Cell::None, Cell::rounded);
        let again = fit.map(|fit| fit.measured_again());
        vec![
            Cell::text(&*measurement.fabric),
            Cell::text(&*measurement.direction),
            Cell::per_cent(measurement.emt),
            number(measurement.lt),
            number(fit.map(|fit| fit.scale)),
            fit.map_or(Cell::None, |fit| {
                Cell::number(fit.initial_stiffness, format!("{:.0}", fit.initial_stiffness))
            }),
            fit.map_or(Cell::None, |fit| Cell::per_cent(fit.law.asymptote())),
            again.map_or(Cell::None, |[emt, _]| Cell::per_cent(emt)),
            number(again.map(|[_, lt]| lt)),
            Cell::text(measurement.source_name()),
        ]
    });
    Table {
        name: "table-2-fabrics",
        caption:
            "Published data, the tangent law fitted to them, and what the law in the program gives back."
                .to_owned(),
        columns: [
            "fabric",
            "direction",
            "EMT",
            "LT [1]",
            "scale a [1]",
            "stiffness at rest [N/m]",
            "asymptote",
            "EMT of the law",
            "LT of the law [1]",
            "source",
        ]
        .map(Column::new)
        .to_vec(),
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fits give back what they were fitted to, by the law's own energy and inverse.
    #[test]
    fn fits_give_back_extension_and_linearity() {
        let mut count = 0;
        for measurement in measurements() {
            let Some(lt) = measurement.lt else { continue };
            let [emt, again] = Fit::new(measurement.emt, lt).measured_again();
            assert!((emt / measurement.emt - 1.0).abs() < 1e-12, "{emt} for {}", measurement.emt);
            assert!((again - lt).abs() < 1e-12, "{again} for {lt}");
            count += 1;
        }
        assert_eq!(count, 6);
    }

    /// −2 ln cos 1 / tan 1 = 0.7906...
    #[test]
    fn linearity_has_its_known_values() {
        assert!((linearity(1.0) - 2.0 * 0.615_626_470_386_014_2 / 1.557_407_724_654_902_3).abs() < 1e-14);
        assert!((linearity(1e-6) - 1.0).abs() < 1e-9);
    }
}

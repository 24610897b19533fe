//! The table of problems and figures that the book shows.
//!
//! Every problem computes its rows once, for its own test and for the table. All figures have the same bits on every
//! machine, so the book's page is compared word for word; what is below 1e-12 is rounding and shown as that alone.

use std::fmt::Write as _;
use std::sync::LazyLock;

/// A problem with a known answer, and what came out.
pub(crate) struct Problem {
    pub(crate) title: &'static str,
    /// What is computed, how, and against what; Markdown.
    pub(crate) text: &'static str,
    pub(crate) rows: Vec<Row>,
}

/// One figure with a known value.
pub(crate) struct Row {
    what: String,
    exact: String,
    measured: String,
    error: f64,
    tolerance: f64,
    order: Option<Order>,
}

/// Order of convergence: measured and stated.
#[derive(Clone, Copy)]
struct Order {
    measured: f64,
    stated: f64,
    tolerance: f64,
}

impl Row {
    /// A figure whose error counts relative to the `exact` value.
    pub(crate) fn new(what: impl Into<String>, exact: f64, measured: f64, tolerance: f64) -> Self {
        let error = (measured / exact - 1.0).abs();
        let [exact, measured] = [exact, measured].map(significant);
        Self { what: what.into(), exact, measured, error, tolerance, order: None }
    }

    /// A figure that should be zero, relative to what it might be.
    pub(crate) fn vanishing(what: impl Into<String>, measured: f64, tolerance: f64) -> Self {
        let (what, error) = (what.into(), measured.abs());
        Self { what, exact: "0".to_owned(), measured: small(error, tolerance), error, tolerance, order: None }
    }

    /// A measured order of convergence.
    pub(crate) fn of_order(what: impl Into<String>, stated: f64, measured: f64, tolerance: f64) -> Self {
        let error = (measured - stated).abs();
        let (exact, measured) = (format!("{stated}"), format!("{measured:.4}"));
        Self { what: what.into(), exact, measured, error, tolerance, order: None }
    }

    /// The same figure with an error that counts otherwise: the largest of a run, or relative to another scale.
    pub(crate) fn with_error(self, error: f64) -> Self {
        Self { error, ..self }
    }

    /// The same figure with the order in which its error falls.
    pub(crate) fn with_order(self, measured: f64, stated: f64, tolerance: f64) -> Self {
        Self { order: Some(Order { measured, stated, tolerance }), ..self }
    }

    /// Written so that NaN does not hold.
    fn holds(&self) -> bool {
        let order_holds =
            self.order.is_none_or(|order| (order.measured - order.stated).abs() <= order.tolerance);
        self.error <= self.tolerance && order_holds
    }

    fn line(&self) -> String {
        let order = self.order.map_or("—".to_owned(), |Order { measured, stated, tolerance }| {
            format!("{measured:.2} ({stated} ± {tolerance})")
        });
        format!(
            "| {} | {} | {} | {} | {:.0e} | {order} |",
            self.what,
            self.exact,
            self.measured,
            small(self.error, self.tolerance),
            self.tolerance,
        )
    }
}

impl Problem {
    /// Fails with all rows that do not hold.
    pub(crate) fn assert(&self) {
        let failed: Vec<String> = self.rows.iter().filter(|row| !row.holds()).map(Row::line).collect();
        assert!(!self.rows.is_empty() && failed.is_empty(), "{}:\n{}", self.title, failed.join("\n"));
    }
}

/// Order between errors of a spacing or step that is divided by `ratio`.
pub(crate) fn order(coarse: f64, fine: f64, ratio: f64) -> f64 {
    libm::log2((coarse / fine).abs()) / libm::log2(ratio)
}

/// Ten significant digits, without zeros at the end.
fn significant(value: f64) -> String {
    let scientific = format!("{value:.9e}");
    let exponent: i32 = scientific.split_once('e').map_or(0, |(_, exponent)| exponent.parse().unwrap_or(0));
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(-4..10).contains(&exponent) {
        return scientific;
    }
    let text = format!("{value:.*}", (9 - exponent) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// An error to one digit, unless it is that of rounding and less than the `tolerance`.
fn small(error: f64, tolerance: f64) -> String {
    let rounding = tolerance.min(1e-12);
    if error < rounding { format!("< {rounding:.0e}") } else { format!("{error:.0e}") }
}

/// Every problem, in the order of the book.
const PROBLEMS: [&LazyLock<Problem>; 21] = [
    &crate::falling::PROBLEM,
    &crate::oscillator::PROBLEM,
    &crate::hanging_chain::PROBLEM,
    &crate::membrane::PROBLEM,
    &crate::pendulum::PROBLEM,
    &crate::catenary::PROBLEM,
    &crate::statics::PROBLEM,
    &crate::laws::PROBLEM,
    &crate::picture_frame::PROBLEM,
    &crate::moduli::PROBLEM,
    &crate::measured::PROBLEM,
    &crate::cantilever::PROBLEM,
    &crate::choi_ko::PROBLEM,
    &crate::friction::PROBLEM,
    &crate::damping::PROBLEM,
    &crate::instruments::PROBLEM,
    &crate::instruments::STRIPS,
    &crate::conservation::PROBLEM,
    &crate::energy::PROBLEM,
    &crate::order::PROBLEM,
    &crate::adaptive::PROBLEM,
];

fn page() -> String {
    let mut page =
        "<!-- Written by the tests in verification/report.rs, which say how to renew it. -->\n".to_owned();
    for problem in PROBLEMS {
        let _ = write!(
            page,
            "\n### {}\n\n{}\n\n| what | exact | measured | error | tolerance | order |\n|---|---|---|---|---|---|\n",
            problem.title, problem.text
        );
        for row in &problem.rows {
            let _ = writeln!(page, "{}", row.line());
        }
    }
    page
}

#[test]
fn the_book_has_the_computed_figures() {
    let (page, shown) = (page(), include_str!("../../../../book/src/verification-figures.md"));
    if page == shown {
        return;
    }
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("verification-figures.md");
    std::fs::write(&file, &page).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let differs = page.lines().zip(shown.lines()).find(|(computed, shown)| computed != shown);
    let (computed, shown) = differs.unwrap_or(("another number of lines", ""));
    panic!(
        "the book shows other figures than were computed\ncomputed: {computed}\nshown:    {shown}\n\
         the page as it should be is {}: if its figures are right, copy it to book/src/",
        file.display()
    );
}

/// Digits, signs and ends of ranges.
#[test]
fn figures_are_written_to_ten_digits() {
    let written = [0.0, 2.0, -0.25, 1.0 / 3.0, 12345.678901234, 9.99999999999, 1e-5, 12_345_678_901.0];
    let expected =
        ["0", "2", "-0.25", "0.3333333333", "12345.6789", "10", "1.000000000e-5", "1.234567890e10"];
    assert_eq!(written.map(significant), expected);
    let written = [(0.0, 1e-9), (9e-13, 1e-9), (0.0, 2e-13), (1.4e-12, 1e-9), (0.03, 0.1)];
    let expected = ["< 1e-12", "< 1e-12", "< 2e-13", "1e-12", "3e-2"];
    assert_eq!(written.map(|(error, tolerance)| small(error, tolerance)), expected);
}

/// A row that is wrong, or is no number, is found.
#[test]
fn rows_can_fail() {
    assert!(Row::new("", 2.0, 2.0002, 2e-4).with_order(2.04, 2.0, 0.05).holds());
    assert!(!Row::new("", 2.0, 2.0002, 0.5e-4).holds());
    assert!(!Row::new("", 2.0, 2.0, 1e-4).with_order(1.9, 2.0, 0.05).holds());
    assert!(!Row::new("", 2.0, f64::NAN, 1e-4).holds());
    assert!(!Row::new("", 2.0, 2.0, 1e-4).with_order(f64::NAN, 2.0, 0.05).holds());
}

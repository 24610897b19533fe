//! Tabulated tension against strain.

/// The least distance of neighbouring strains [1]: slopes between them stay numbers.
const LEAST_WIDTH: f64 = 1e-9;

/// The largest strain [1] of a table. No cloth is meant that stretches further.
const LARGEST_STRAIN: f64 = 10.0;

/// Sizes of tensions [N] unless they are zero.
const TENSIONS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Points of tension against strain, as measured: of a spring [N], or of a fabric per width [N/m].
///
/// Invariants: at least two points; strains ascend by at least 1e-9 and lie above −1 and at or below 10; tensions never
/// fall; the point (0, 0) is among them and is not the last; tension rises from it, and to it if it is not the first.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionCurve {
    points: Vec<[f64; 2]>,
}

/// Which point of a table breaks which rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{} {}, but {rule}", ["strain", "tension"][*.coordinate], .value)]
pub struct TensionCurveError {
    /// Number of the point, from zero; that of the last if there are too few.
    pub point: usize,
    /// Which of its numbers: 0 for the strain, 1 for the tension.
    pub coordinate: usize,
    /// What it is, beginning with a verb.
    pub value: String,
    /// What it must be.
    pub rule: String,
    /// What to do about it.
    pub help: &'static str,
}

impl TensionCurve {
    /// The curve through `points` of strain [1] and tension [N] of a spring.
    ///
    /// A table whose first strain is above zero is started at (0, 0).
    ///
    /// # Errors
    /// The first rule of the invariants that a point breaks.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, TensionCurveError> {
        Self::checked(points, "N")
    }

    /// The curve through `points` of strain [1] and tension per width [N/m] of a fabric.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn per_width(points: &[[f64; 2]]) -> Result<Self, TensionCurveError> {
        Self::checked(points, "N/m")
    }

    fn checked(points: &[[f64; 2]], unit: &'static str) -> Result<Self, TensionCurveError> {
        let is_started = points.first().is_some_and(|&[strain, _]| 0.0 < strain);
        let origin = is_started.then_some([0.0, 0.0]);
        // −0 is 0: neighbours may be compared bit by bit.
        let rows = points.iter().map(|point| point.map(|number| number + 0.0));
        let curve = Self { points: origin.into_iter().chain(rows).collect() };
        let offset = usize::from(is_started);
        curve
            .check(unit)
            .map_err(|error| TensionCurveError { point: error.point.saturating_sub(offset), ..error })?;
        Ok(curve)
    }

    /// The curve of `width` [m] of a fabric with this tension per width [N/m], less `modulus` [N/m] times the strain.
    ///
    /// The modulus is less than the slope of any part, and the width positive, so that the invariants stay.
    pub(crate) fn reduced(&self, modulus: f64, width: f64) -> Self {
        let points =
            self.points.iter().map(|&[strain, tension]| [strain, width * (tension - modulus * strain)]);
        Self { points: points.collect() }
    }

    /// Strain [1] and tension [N], or N/m if it is per width, of every point, strains ascending.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    fn check(&self, unit: &str) -> Result<(), TensionCurveError> {
        for (point, &[strain, tension]) in self.points.iter().enumerate() {
            check_sizes(point, strain, tension, unit)?;
            if let Some(&[strain_before, tension_before]) =
                point.checked_sub(1).and_then(|i| self.points.get(i))
            {
                check_order(point, [strain_before, tension_before], [strain, tension], unit)?;
            }
        }
        self.check_rest(unit)
    }

    /// The point at rest, and what is beside it.
    fn check_rest(&self, unit: &str) -> Result<(), TensionCurveError> {
        let fault = |point: usize, coordinate: usize, value: String, rule: &str, help: &'static str| {
            Err(TensionCurveError { point, coordinate, value, rule: rule.to_owned(), help })
        };
        let last = self.points.len().saturating_sub(1);
        let rest = self.points.partition_point(|&[strain, _]| strain < 0.0);
        match self.points.get(rest) {
            Some(&[0.0, 0.0]) => {}
            Some(&[0.0, tension]) => {
                let rule = "must be 0 at strain 0, where the cloth is at rest";
                return fault(
                    rest,
                    1,
                    format!("is {tension:?} {unit}"),
                    rule,
                    "take off the tension of the empty instrument",
                );
            }
            _ => {
                let value = match self.points.get(rest) {
                    Some([strain, _]) => format!("goes on with {strain:?}"),
                    None => "ends below 0".to_owned(),
                };
                let rule = "a table with strains below 0 must have the point (0, 0) too";
                return fault(rest.min(last), 0, value, rule, "add the line `0,0` between them");
            }
        }
        let Some(&[_, after]) = self.points.get(rest + 1) else {
            let help = "add measured points above strain 0";
            return fault(last, 0, "ends at 0".to_owned(), "must go on above it", help);
        };
        if after <= 0.0 {
            let rule = "must rise from strain 0 on: a spring without stiffness at rest holds no cloth";
            return fault(
                rest + 1,
                1,
                format!("is still 0 {unit}"),
                rule,
                "leave out points of the slack before the fabric resists",
            );
        }
        match rest.checked_sub(1).and_then(|before| self.points.get(before)) {
            Some(&[_, before]) if 0.0 <= before => {
                let rule = "must rise up to strain 0: a spring without stiffness at rest holds no cloth";
                fault(
                    rest - 1,
                    1,
                    format!("is 0 {unit}"),
                    rule,
                    "leave out the points below strain 0, and compression is linear",
                )
            }
            _ => Ok(()),
        }
    }
}

fn check_sizes(point: usize, strain: f64, tension: f64, unit: &str) -> Result<(), TensionCurveError> {
    let fault = |coordinate: usize, value: String, rule: &str, help: &'static str| {
        Err(TensionCurveError { point, coordinate, value, rule: rule.to_owned(), help })
    };
    if strain.is_nan() || strain <= -1.0 {
        return fault(
            0,
            format!("is {strain:?}"),
            "must be above -1, where nothing is left of the length",
            PER_CENT,
        );
    }
    if LARGEST_STRAIN < strain {
        let rule = format!("must be at most {LARGEST_STRAIN}");
        return fault(0, format!("is {strain:?}"), &rule, PER_CENT);
    }
    let is_quantity = tension == 0.0 || TENSIONS.contains(&tension.abs());
    if !is_quantity {
        let rule = format!("must be 0 or from 1e-30 to 1e30 {unit} in size");
        return fault(1, format!("is {tension:?} {unit}"), &rule, "see that it is in the unit of its column");
    }
    Ok(())
}

const PER_CENT: &str =
    "head the column `strain [%]` if it is in per cent; see that the columns stand below their names";

fn check_order(point: usize, before: [f64; 2], at: [f64; 2], unit: &str) -> Result<(), TensionCurveError> {
    let [strain_before, tension_before] = before;
    let [strain, tension] = at;
    let fault = |coordinate: usize, value: String, rule: String, help: &'static str| {
        Err(TensionCurveError { point, coordinate, value, rule, help })
    };
    if strain - strain_before < LEAST_WIDTH {
        let rule = format!("must be above the {strain_before:?} before it, by at least {LEAST_WIDTH:?}");
        let help = "sort the points by strain, and keep the way out of a measured loop alone";
        return fault(0, format!("is {strain:?}"), rule, help);
    }
    if tension < tension_before {
        let rule = format!("must not be below the {tension_before:?} {unit} before it");
        let help = "smooth what is noise, and leave out what comes after the fabric tears";
        return fault(1, format!("is {tension:?} {unit}"), rule, help);
    }
    Ok(())
}

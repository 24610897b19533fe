//! The stop: a spring that slides.

/// A spring of stiffness k in a row with a slider that yields to a force Y: the element of Prandtl and Ishlinskii.
///
/// ```text
/// f = k (q − p)    as long as |f| ≤ Y; else p slips until |f| = Y
/// ```
///
/// Its only memory is the slip p, where the coordinate q would have to be for the element to pull nothing. What it does does
/// not depend on how fast it is done. It holds ½ f² / k and loses f dp, which is never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    /// Stiffness k, positive.
    pub(super) stiffness: f64,
    /// 1/k, but for a rounding.
    pub(super) compliance: f64,
    /// Slip p.
    pub(super) slip: f64,
    /// The force Y at which it slides here, not negative.
    pub(super) limit: f64,
}

impl Stop {
    /// The force f at the coordinate q.
    #[inline(always)]
    pub(super) fn force(self, coordinate: f64) -> f64 {
        let force = self.stiffness * (coordinate - self.slip);
        // Comparisons let through what is not a number.
        let force = if self.limit < force { self.limit } else { force };
        if force < -self.limit { -self.limit } else { force }
    }

    /// df/dq at the coordinate q, where Y grows by `growth` = dY/dq.
    #[inline(always)]
    pub(super) fn tangent(self, coordinate: f64, growth: f64) -> f64 {
        let force = self.stiffness * (coordinate - self.slip);
        if self.limit < force {
            growth
        } else if force < -self.limit {
            -growth
        } else {
            self.stiffness
        }
    }

    /// The slip once the element has slid as far as it must at the coordinate q: as it was where it holds.
    ///
    /// Where it slides, the new slip is by a few roundings farther away than Y / k, so that the force from it has the very
    /// bits that it had before.
    #[inline(always)]
    pub(super) fn slipped(self, coordinate: f64) -> f64 {
        let stretch = coordinate - self.slip;
        let slides = self.limit < (self.stiffness * stretch).abs();
        let least = self.limit * self.compliance * (1.0 + 8.0 * f64::EPSILON);
        let slipped = coordinate - least.copysign(stretch);
        let slipped = slipped - (slipped.abs() * f64::EPSILON).copysign(stretch);
        if slides { slipped } else { self.slip }
    }

    /// The energy lost on the way from the slip of `self` to `slip`, at the coordinate q where Y grows by `growth` = dY/dq.
    ///
    /// The force on the way is Y where the element was then. With the sign σ of the slip, q has changed by dp / (1 − σ Y'/k) for
    /// a slip of dp, so that to second order
    ///
    /// ```text
    /// loss = |dp| (Y − ½ Y' dp / (1 − σ Y'/k))
    /// ```
    ///
    /// and exactly Y |dp| where Y is the same everywhere.
    #[inline(always)]
    pub(super) fn loss(self, slip: f64, growth: f64) -> f64 {
        let change = slip - self.slip;
        let (size, growth) = (change.abs(), if change < 0.0 { -growth } else { growth });
        let slope = 1.0 - growth * self.compliance;
        // Where the limit grows as fast as the element can pull there is no slip but that of rounding.
        let correction = if slope.abs() < 1e-3 { 0.0 } else { 0.5 * growth * size / slope };
        let mean = self.limit - correction;
        size * if mean < 0.0 { 0.0 } else { mean }
    }

    /// The same where Y does not depend on the coordinate: Y |dp|.
    #[inline(always)]
    pub(super) fn constant_loss(self, slip: f64) -> f64 {
        (slip - self.slip).abs() * self.limit
    }

    /// The energy that it holds at the coordinate q.
    #[inline(always)]
    pub(super) fn energy(self, coordinate: f64) -> f64 {
        let force = self.force(coordinate);
        0.5 * force * force * self.compliance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(stiffness: f64, slip: f64, limit: f64) -> Stop {
        Stop { stiffness, compliance: 1.0 / stiffness, slip, limit }
    }

    fn random(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Over 15 orders of magnitude: the force keeps its bits when the slip is brought up to date, and a second time nothing
    /// changes.
    #[test]
    fn no_bit_depends_on_when_it_slips() {
        let (mut seed, mut slipped_count) = (1, 0);
        for _ in 0..100_000 {
            let mut size = || 10.0_f64.powf(7.5 * random(&mut seed));
            let (stiffness, limit, scale) = (size(), size(), size());
            let slip = scale * random(&mut seed);
            let coordinate = scale * random(&mut seed);
            let stop = stop(stiffness, slip, limit);
            let after = Stop { slip: stop.slipped(coordinate), ..stop };
            assert_eq!(stop.force(coordinate).to_bits(), after.force(coordinate).to_bits(), "{stop:?}");
            assert_eq!(after.slipped(coordinate).to_bits(), after.slip.to_bits(), "{stop:?}");
            slipped_count += u32::from(after.slip != slip);
        }
        assert!((10_000..90_000).contains(&slipped_count), "{slipped_count}");
    }

    /// There and back between ±a: a loop of height 2 Y, whose area 4 Y (a − Y/k) is lost, in any number of steps.
    #[test]
    fn a_loop_loses_its_area() {
        let (stiffness, limit, amplitude) = (3.0, 0.5, 2.0);
        for count in [4, 7, 1000] {
            let mut stop = stop(stiffness, 0.0, limit);
            let mut ends = [0.0; 3];
            let mut lost = [0.0; 2];
            for (cycle, lost) in lost.iter_mut().enumerate() {
                let corners = [0.0, amplitude, -amplitude, 0.0];
                for pair in corners.windows(2) {
                    for i in 1..=count {
                        let share = f64::from(i) / f64::from(count);
                        let coordinate = pair[0] + share * (pair[1] - pair[0]);
                        let slip = stop.slipped(coordinate);
                        *lost += stop.loss(slip, 0.0);
                        stop.slip = slip;
                    }
                }
                ends[cycle + 1] = stop.force(0.0);
            }
            // Each of up to 3000 slips is rounded to about 4e-16, and by 8 ε of Y / k away from the limit.
            let area = 4.0 * limit * (amplitude - limit / stiffness);
            assert!((lost[1] - area).abs() < 1e-12, "{lost:?}");
            assert_eq!(ends[1], ends[2]);
        }
    }

    /// A limit that grows with q is met at second order: Y = c q from the start loses ½ c (1 − c/k) q².
    #[test]
    fn a_growing_limit_is_counted_to_second_order() {
        let (stiffness, growth) = (3.0, 0.5);
        for (sign, name) in [(1.0, "loading"), (-1.0, "unloading")] {
            let (mut slip, mut lost) = (0.0, 0.0);
            for i in 0..=10 {
                // Unloading, all that is held to begin with has to be undone first.
                let coordinate = if sign > 0.0 { 0.1 * f64::from(i) } else { 1.0 - 0.1 * f64::from(i) };
                let stop = stop(stiffness, slip, growth * coordinate);
                if i == 0 && sign < 0.0 {
                    slip = coordinate + stop.limit / stiffness;
                    continue;
                }
                slip = stop.slipped(coordinate);
                lost += stop.loss(slip, growth);
            }
            let exact = 0.5 * growth * (1.0 - sign * growth / stiffness);
            assert!((lost - exact).abs() < 1e-14, "{name}: {lost} for {exact}");
        }
    }

    #[test]
    fn an_element_without_limit_never_pulls() {
        let stop = stop(2.0, 0.25, 0.0);
        assert_eq!(stop.force(0.5), 0.0);
        let after = Stop { slip: stop.slipped(0.5), ..stop };
        assert!((after.slip - 0.5).abs() < 1e-15);
        assert_eq!((after.force(0.5), stop.loss(after.slip, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        let stop = stop(2.0, 0.25, 1.0);
        assert!(stop.force(f64::NAN).is_nan());
    }
}

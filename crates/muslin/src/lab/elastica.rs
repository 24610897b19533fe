//! A strip bent by its own weight, by the law of a fabric with friction.

use std::f64::consts::FRAC_PI_2;

use crate::scene::BendingFriction;

/// Steps of the integration per bending length of the rigidity alone.
const STEPS: f64 = 200.0;

/// Halvings of an interval until nothing is left of it.
const HALVINGS: usize = 60;

/// A strip as new that does not stretch, with the moment M per width at the curvature κ ≥ 0
///
/// ```text
/// M = B κ + min(B_f κ, M_f)
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct HeavyStrip {
    /// Weight per area ρ g [N/m²].
    pub(super) weight: f64,
    /// Rigidity B [N m].
    pub(super) rigidity: f64,
    /// What holds: moment M_f and rigidity B_f.
    pub(super) friction: BendingFriction,
}

/// Where the strip is at a distance u [m] from its tip.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Angle θ [rad] below the horizontal.
    angle: f64,
    /// Moment per width [N].
    moment: f64,
    /// Distance from the tip [m], level and upwards.
    reach: f64,
    drop: f64,
}

impl HeavyStrip {
    /// Overhang [m] at which the tip is seen at `angle` [rad] below the horizontal from the edge, where the strip is level.
    ///
    /// From the tip, where M = 0, to the edge, where θ = 0, by the classical Runge–Kutta method:
    ///
    /// ```text
    /// dθ/du = −κ(M)    dM/du = ρ g u cos θ
    /// ```
    ///
    /// The angle at the tip, by bisection, is that which has the chord wanted.
    pub(super) fn overhang(&self, angle: f64) -> f64 {
        let (mut low, mut high) = (angle, FRAC_PI_2);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let (_, edge) = self.edge(middle);
            if libm::atan2(edge.drop, edge.reach) < angle { low = middle } else { high = middle }
        }
        self.edge(0.5 * (low + high)).0
    }

    /// Curvature [1/m] at a `moment` [N] that is not negative.
    fn curvature(&self, moment: f64) -> f64 {
        let BendingFriction { moment: limit, rigidity: held } = self.friction;
        let curvature = moment / (self.rigidity + held);
        if held * curvature <= limit { curvature } else { (moment - limit) / self.rigidity }
    }

    /// Distance [m] from the tip, which hangs at `angle` [rad], to where the strip is level, and that place.
    fn edge(&self, angle: f64) -> (f64, Place) {
        let step = libm::cbrt(self.rigidity / self.weight) / STEPS;
        let mut place = Place { angle, moment: 0.0, reach: 0.0, drop: 0.0 };
        let mut distance = 0.0;
        loop {
            let next = self.step(place, distance, step);
            if next.angle <= 0.0 {
                break;
            }
            (place, distance) = (next, distance + step);
        }
        let (mut low, mut high) = (0.0, step);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if 0.0 < self.step(place, distance, middle).angle { low = middle } else { high = middle }
        }
        (distance + high, self.step(place, distance, high))
    }

    /// The place that is `step` [m] further than that at `distance` [m].
    fn step(&self, place: Place, distance: f64, step: f64) -> Place {
        let rates = |place: Place, distance: f64| {
            let (sine, cosine) = libm::sincos(place.angle);
            let angle = -self.curvature(place.moment);
            Place { angle, moment: self.weight * distance * cosine, reach: cosine, drop: sine }
        };
        let moved = |rates: Place, step: f64| Place {
            angle: place.angle + step * rates.angle,
            moment: place.moment + step * rates.moment,
            reach: place.reach + step * rates.reach,
            drop: place.drop + step * rates.drop,
        };
        let half = 0.5 * step;
        let first = rates(place, distance);
        let second = rates(moved(first, half), distance + half);
        let third = rates(moved(second, half), distance + half);
        let fourth = rates(moved(third, step), distance + step);
        let mean = |of: fn(Place) -> f64| (of(first) + 2.0 * (of(second) + of(third)) + of(fourth)) / 6.0;
        let mean = Place {
            angle: mean(|place| place.angle),
            moment: mean(|place| place.moment),
            reach: mean(|place| place.reach),
            drop: mean(|place| place.drop),
        };
        moved(mean, step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Load ρ g L³ / B, and drop over distance of the tip.
    const HEAVY_ELASTICA: &str = include_str!("../../tests/verification/reference/heavy_elastica.csv");

    /// Without friction, or with one that never slips, the strip is an elastica: of B, or of B + B_f.
    #[test]
    fn a_strip_without_slip_is_an_elastica() {
        let (weight, rigidity) = (1.5, 1e-5);
        let slides = BendingFriction { moment: 1e-30, rigidity: 1e-25 };
        let holds = BendingFriction { moment: 1e30, rigidity: 3e-5 };
        let mut count = 0;
        for line in
            HEAVY_ELASTICA.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        {
            let values: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let angle = libm::atan(values[1]);
            for (friction, rigid) in [(slides, rigidity), (holds, 4.0 * rigidity)] {
                let overhang = HeavyStrip { weight, rigidity, friction }.overhang(angle);
                let load = weight * overhang * overhang * overhang / rigid;
                // The table has ten digits; steps of 1/200 leave less than 1e-9.
                assert!((load / values[0] - 1.0).abs() < 1e-8, "{load} for {line}");
            }
            count += 1;
        }
        assert_eq!(count, 4);
    }

    /// By hand, of a strip that is all but level, where M = ½ ρ g u² at the distance u from the tip and friction slips beyond u_s:
    ///
    /// ```text
    /// H = ρ g u_s⁴ / 8 (B + B_f) + (ρ g (L⁴ − u_s⁴) / 8 − M_f (L² − u_s²) / 2) / B
    /// ```
    #[test]
    fn a_level_strip_that_slips_is_known() {
        let (weight, rigidity) = (1.5, 1e-5);
        let friction = BendingFriction { moment: 4e-6, rigidity: 3e-5 };
        let angle = 1e-3;
        let length = HeavyStrip { weight, rigidity, friction }.overhang(angle);
        let slips = (2.0 * friction.moment * (1.0 + rigidity / friction.rigidity) / weight).sqrt();
        assert!(0.4 < slips / length && slips / length < 0.8, "friction slips along a part of it");
        let held = weight * slips.powi(4) / (8.0 * (rigidity + friction.rigidity));
        let slid = weight * (length.powi(4) - slips.powi(4)) / 8.0
            - 0.5 * friction.moment * (length * length - slips * slips);
        // Fifty steps lie on the strip, and one of them across the bend of the law: (1/50)² of an eighth of it.
        let drop = held + slid / rigidity;
        assert!((drop / (length * angle) - 1.0).abs() < 1e-4, "{drop} {length}");
    }
}

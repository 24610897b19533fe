//! A strip that bends under its own weight, exactly: the heavy elastica.

use std::f64::consts::FRAC_PI_2;

/// Step along the strip, in lengths c = (B / ρ g)^(1/3).
const STEP: f64 = 1.0 / 64.0;

/// Halvings of the bracket of a tip's angle, whose logarithm spans 30.
const HALVINGS: u32 = 48;

/// The load Γ = ρ g L³ / B [1] under which the chord of a clamped strip of length L, from the edge to the tip, hangs by `angle`
/// [rad] below the horizontal; the angle lies between 0 and ½π.
///
/// ```text
/// φ″ = τ sin φ    φ(0) = φ₀    φ′(0) = 0    φ(τ_L) = ½π    Γ = τ_L³
/// ```
///
/// with the angle φ of the strip to the vertical and the distance τ from the tip in lengths c = (B / ρ g)^(1/3). From the tip, where
/// there is no moment, to the clamp this is a problem of initial values: the angle φ₀ there picks the strip out of the family,
/// and is found by bisection.
#[must_use]
pub fn load_of_chord(angle: f64) -> f64 {
    // The nearer to the vertical the tip, the steeper the chord.
    let (mut steep, mut flat) = (libm::log(FRAC_PI_2) - 30.0, libm::log(FRAC_PI_2));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (steep + flat);
        if angle < Strip::hung_at(libm::exp(middle)).chord { steep = middle } else { flat = middle }
    }
    let length = Strip::hung_at(libm::exp(0.5 * (steep + flat))).length;
    length * length * length
}

/// A strip that is clamped horizontally where it is as long as its angle at the tip asks for.
struct Strip {
    /// Length in lengths c.
    length: f64,
    /// Angle of the chord [rad].
    chord: f64,
}

/// φ, φ′, and how far the strip has come across and up.
type Place = [f64; 4];

impl Strip {
    /// The strip whose tip is `tip` [rad] off the vertical.
    fn hung_at(tip: f64) -> Self {
        let mut place = [tip, 0.0, 0.0, 0.0];
        let mut length = 0.0;
        loop {
            let next = stepped(place, length, STEP);
            if FRAC_PI_2 <= next[0] {
                break;
            }
            place = next;
            length += STEP;
        }
        // The part of a step to the clamp, by Newton's method from the tangent; φ′ grows from the tip on.
        let mut part = 0.0;
        let mut end = place;
        for _ in 0..8 {
            let off = FRAC_PI_2 - end[0];
            if end[1] <= 0.0 {
                break;
            }
            part = (part + off / end[1]).clamp(0.0, STEP);
            end = stepped(place, length, part);
        }
        Self { length: length + part, chord: libm::atan2(end[3], end[2]) }
    }
}

/// The place after a step by the classical method of Runge and Kutta.
fn stepped(place: Place, length: f64, step: f64) -> Place {
    let slope = |place: Place, length: f64| {
        let (sine, cosine) = libm::sincos(place[0]);
        [place[1], length * sine, sine, cosine]
    };
    let moved = |slope: Place, step: f64| std::array::from_fn(|i| place[i] + step * slope[i]);
    let first = slope(place, length);
    let second = slope(moved(first, 0.5 * step), length + 0.5 * step);
    let third = slope(moved(second, 0.5 * step), length + 0.5 * step);
    let fourth = slope(moved(third, step), length + step);
    std::array::from_fn(|i| place[i] + step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Loads by the angle of the chord in degrees; the table has eight digits.
    const PEIRCE: &str = include_str!("../tests/reference/peirce_cantilever.csv");

    /// Loads and the angles of their chords, over seven decades; nine digits.
    const ELASTICA: &str = include_str!("../tests/reference/heavy_elastica_cantilever.csv");

    fn rows(table: &str) -> impl Iterator<Item = Vec<f64>> + '_ {
        let lines = table.lines().filter(|line| !line.starts_with('#')).skip(1);
        lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
    }

    /// The method is of fourth order: with steps of 1/64 it leaves 1/64⁴ = 6e-8 in parts, times a factor of about one.
    #[test]
    fn loads_are_those_of_the_tables() {
        let mut count = 0;
        for row in rows(PEIRCE) {
            let found = load_of_chord(row[0].to_radians());
            assert!((found / row[1] - 1.0).abs() < 1e-6, "{found} at {} degrees", row[0]);
            count += 1;
        }
        for row in rows(ELASTICA).filter(|row| (1.0..85.0).contains(&row[6])) {
            let found = load_of_chord(row[6].to_radians());
            assert!((found / row[0] - 1.0).abs() < 1e-6, "{found} at {} degrees", row[6]);
            count += 1;
        }
        assert!(60 < count, "{count}");
    }

    /// Hardly bent, the tip sinks by Γ / 8 of the length.
    #[test]
    fn a_stiff_strip_sinks_by_an_eighth() {
        let angle: f64 = 0.01;
        let found = load_of_chord(angle);
        assert!((found / (8.0 * angle.tan()) - 1.0).abs() < 1e-3, "{found}");
    }
}

//! A tabulated law.

use super::TensionLaw;
use crate::scene::TensionCurve;

/// Bounds of the tangents at the two ends, relative to the slope of the chord beside them [1].
///
/// Above three a cubic need not be monotone. The lower bound keeps a spring from having no stiffness at rest, which the
/// parabola through three points would give a curve that stiffens by more than three from one chord to the next.
const END_TANGENTS: [f64; 2] = [1.0 / 3.0, 3.0];

/// A law of tension f [N] against strain e = x / L [1] through the points of a table: monotone, with a continuous tangent.
///
/// Between points eᵢ and eᵢ₊₁ with the chord's slope δᵢ and width hᵢ, tension is the cubic with the tangents
///
/// ```text
/// dᵢ = 0                                        where δᵢ₋₁ or δᵢ is 0
/// dᵢ = (w₁ + w₂) / (w₁ / δᵢ₋₁ + w₂ / δᵢ)        else, with w₁ = 2hᵢ + hᵢ₋₁, w₂ = hᵢ + 2hᵢ₋₁
/// ```
///
/// which is a weighted harmonic mean, so at most three times the smaller slope: then the cubic is monotone, as the table
/// is. This interpolant is known as PCHIP. At both ends d is the tangent of the parabola through three points, but from
/// a third of to three times the slope of the first or last chord. Beyond the ends the law goes on along its tangents
/// there: in compression with the tangent at rest, unless the table has strains below zero, and above the last strain
/// with the last tangent.
///
/// ```text
/// f = f(e)    k_t = f'(e) / L    E = L ∫₀ᵉ f ds    M = L² ∫₀ᵉ f s ds
/// ```
///
/// The tension belongs to the spring, whatever its rest length: two springs of the same law have the same tension at the
/// same strain.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveLaw {
    /// Strains of the points [1], ascending.
    strains: Vec<f64>,
    /// One more than points: before the first, from each to the next, after the last.
    pieces: Vec<Cubic>,
}

/// A piece of a [`CurveLaw`], a cubic in t = e − start: f = Σ cₖ tᵏ [N].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    start: f64,
    coefficients: [f64; 4],
    /// ∫ f ds [N] and ∫ f s ds [N] from zero strain to the start.
    energy: f64,
    moment: f64,
}

impl CurveLaw {
    /// The law through the points of `curve`.
    #[must_use]
    pub fn new(curve: &TensionCurve) -> Self {
        let points = curve.points();
        let tangents = tangents(points);
        let mut pieces = Vec::with_capacity(points.len() + 1);
        let end =
            |[strain, tension]: [f64; 2], tangent: f64| Cubic::new(strain, [tension, tangent, 0.0, 0.0]);
        pieces.extend(points.first().zip(tangents.first()).map(|(&point, &tangent)| end(point, tangent)));
        for (pair, slopes) in points.windows(2).zip(tangents.windows(2)) {
            let [[start, tension], [next, next_tension]] = [pair[0], pair[1]];
            let width = next - start;
            let chord = (next_tension - tension) / width;
            let second = (3.0 * chord - 2.0 * slopes[0] - slopes[1]) / width;
            let third = (slopes[0] + slopes[1] - 2.0 * chord) / (width * width);
            pieces.push(Cubic::new(start, [tension, slopes[0], second, third]));
        }
        pieces.extend(points.last().zip(tangents.last()).map(|(&point, &tangent)| end(point, tangent)));
        let strains: Vec<f64> = points.iter().map(|point| point[0]).collect();
        add_integrals(&strains, &mut pieces);
        Self { strains, pieces }
    }

    /// The place of the piece that holds at an `extension` [m] of `rest_length` [m].
    #[inline(always)]
    fn place(&self, extension: f64, rest_length: f64) -> usize {
        let strain = extension / rest_length;
        self.strains.partition_point(|&start| start <= strain)
    }

    /// The piece that holds there.
    #[inline(always)]
    fn cubic(&self, extension: f64, rest_length: f64) -> &Cubic {
        &self.pieces[self.place(extension, rest_length)]
    }
}

impl Cubic {
    fn new(start: f64, coefficients: [f64; 4]) -> Self {
        Self { start, coefficients, energy: 0.0, moment: 0.0 }
    }

    /// Whether it has begun at an `extension` [m] of `rest_length` [m]; meaningless for the first of a law, which has no beginning.
    #[inline(always)]
    pub(crate) fn has_begun(&self, extension: f64, rest_length: f64) -> bool {
        self.start <= extension / rest_length
    }

    /// ∫ f ds [N] from zero strain to `strain`.
    fn energy_to(&self, strain: f64) -> f64 {
        self.energy + self.integral(strain)
    }

    /// ∫ f s ds [N] from zero strain to `strain`: s is t + start.
    fn moment_to(&self, strain: f64) -> f64 {
        let t = strain - self.start;
        let [c0, c1, c2, c3] = self.coefficients;
        let weighted = t * t * (c0 / 2.0 + t * (c1 / 3.0 + t * (c2 / 4.0 + t * (c3 / 5.0))));
        self.moment + self.start * self.integral(strain) + weighted
    }

    /// ∫ f ds [N] from the start to `strain`.
    fn integral(&self, strain: f64) -> f64 {
        let t = strain - self.start;
        let [c0, c1, c2, c3] = self.coefficients;
        t * (c0 + t * (c1 / 2.0 + t * (c2 / 3.0 + t * (c3 / 4.0))))
    }
}

impl TensionLaw for Cubic {
    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        let t = extension / rest_length - self.start;
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    #[inline(always)]
    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        let t = extension / rest_length - self.start;
        let [_, c1, c2, c3] = self.coefficients;
        (c1 + t * (2.0 * c2 + t * (3.0 * c3))) / rest_length
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        rest_length * self.energy_to(extension / rest_length)
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        rest_length * rest_length * self.moment_to(extension / rest_length)
    }
}

impl TensionLaw for CurveLaw {
    const HAS_CUBICS: bool = true;

    fn cubics(&self, extensions: [f64; 2], rest_length: f64) -> &[Cubic] {
        let [first, last] = extensions.map(|extension| self.place(extension, rest_length));
        &self.pieces[first.min(last)..=last]
    }

    #[inline(always)]
    fn tension(&self, extension: f64, rest_length: f64) -> f64 {
        self.cubic(extension, rest_length).tension(extension, rest_length)
    }

    fn tangent(&self, extension: f64, rest_length: f64) -> f64 {
        self.cubic(extension, rest_length).tangent(extension, rest_length)
    }

    #[inline(always)]
    fn tension_and_tangent(&self, extension: f64, rest_length: f64) -> (f64, f64) {
        self.cubic(extension, rest_length).tension_and_tangent(extension, rest_length)
    }

    fn energy(&self, extension: f64, rest_length: f64) -> f64 {
        self.cubic(extension, rest_length).energy(extension, rest_length)
    }

    fn energy_moment(&self, extension: f64, rest_length: f64) -> f64 {
        self.cubic(extension, rest_length).energy_moment(extension, rest_length)
    }
}

/// Tangents [N] at `points`, of which there are at least two.
fn tangents(points: &[[f64; 2]]) -> Vec<f64> {
    let widths: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let slopes: Vec<f64> =
        points.windows(2).zip(&widths).map(|(pair, width)| (pair[1][1] - pair[0][1]) / width).collect();
    let count = slopes.len();
    if count == 1 {
        return vec![slopes[0]; 2];
    }
    let end = |near: usize, far: usize| {
        let [h, g] = [widths[near], widths[far]];
        let parabola = ((2.0 * h + g) * slopes[near] - h * slopes[far]) / (h + g);
        parabola.clamp(END_TANGENTS[0] * slopes[near], END_TANGENTS[1] * slopes[near])
    };
    let inner = |i: usize| {
        let [before, after] = [slopes[i - 1], slopes[i]];
        if before <= 0.0 || after <= 0.0 {
            return 0.0;
        }
        let w1 = 2.0 * widths[i] + widths[i - 1];
        let w2 = widths[i] + 2.0 * widths[i - 1];
        (w1 + w2) / (w1 / before + w2 / after)
    };
    let mut tangents = vec![end(0, 1)];
    tangents.extend((1..count).map(inner));
    tangents.push(end(count - 1, count - 2));
    tangents
}

/// Sets the integrals of `pieces` from zero strain, one of `strains`, outwards.
fn add_integrals(strains: &[f64], pieces: &mut [Cubic]) {
    let rest = strains.partition_point(|&strain| strain < 0.0);
    // Piece i ends at strain i, where piece i + 1 starts.
    for i in rest + 1..strains.len() {
        let (energy, moment) = (pieces[i].energy_to(strains[i]), pieces[i].moment_to(strains[i]));
        (pieces[i + 1].energy, pieces[i + 1].moment) = (energy, moment);
    }
    for i in (1..=rest).rev() {
        let Cubic { energy, moment, start, .. } = pieces[i + 1];
        (pieces[i].energy, pieces[i].moment) = (0.0, 0.0);
        let (to_end, moment_to_end) = (pieces[i].energy_to(start), pieces[i].moment_to(start));
        (pieces[i].energy, pieces[i].moment) = (energy - to_end, moment - moment_to_end);
    }
    // The first piece starts where the second does.
    (pieces[0].energy, pieces[0].moment) = (pieces[1].energy, pieces[1].moment);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(points: &[[f64; 2]]) -> CurveLaw {
        CurveLaw::new(&TensionCurve::new(points).expect("a curve"))
    }

    /// Tables of every kind: stiffening and softening by much, plateaux, strains below zero, two points.
    fn laws() -> Vec<CurveLaw> {
        vec![
            law(&[[0.01, 0.3], [0.03, 1.0], [0.07, 3.0], [0.08, 3.8], [0.2, 20.0]]),
            law(&[[0.1, 0.1], [0.2, 10.0], [0.3, 1000.0]]),
            law(&[[0.0, 0.0], [0.01, 9.0], [0.02, 10.0], [0.5, 10.0], [0.6, 10.0], [0.7, 11.0]]),
            law(&[[-0.5, -2.0], [-0.2, -2.0], [-0.01, -0.5], [0.0, 0.0], [0.02, 3.0], [0.3, 7.0]]),
            law(&[[0.0, 0.0], [0.05, 2.0]]),
            law(&[[1e-9, 1e-9], [5.0, 1e3]]),
        ]
    }

    /// Tension, its derivative by strain, and its integral, as SciPy's `PchipInterpolator` (1.17) has them.
    #[test]
    fn between_points_the_law_is_pchip() {
        let law = law(&[[0.01, 0.3], [0.03, 1.0], [0.07, 3.0], [0.08, 3.8], [0.2, 20.0]]);
        for [strain, tension, tangent, energy] in [
            [0.0, 0.0, 28.33333333333332, 0.0],
            [0.004, 0.11564745762711864, 29.549152542372884, 0.00022967382297551785],
            [0.01, 0.3, 32.03389830508474, 0.0014691619585687381],
            [0.02, 0.6291232073011735, 34.39537157757497, 0.006095099051137186],
            [0.05, 1.8793424317617864, 48.77481389578162, 0.04270455575649671],
            [0.0755, 3.4041001112347047, 81.89098998887654, 0.1085407457467993],
            [0.1, 5.785420410142324, 105.10107384273127, 0.22020434184360205],
            [0.15, 11.884358243489915, 140.5011176948746, 0.6545737990485447],
            [0.2, 19.999999999999996, 185.76923076923063, 1.4422518982453019],
        ] {
            let length = 0.25;
            let found = [
                law.tension(strain * length, length),
                law.tangent(strain * length, length) * length,
                law.energy(strain * length, length) / length,
            ];
            for (found, expected) in found.into_iter().zip([tension, tangent, energy]) {
                assert!(
                    (found - expected).abs() <= 1e-14 * expected.max(1e-3),
                    "{strain}: {found} for {expected}"
                );
            }
        }
    }

    #[test]
    fn the_law_passes_through_its_points_and_beyond_them_along_its_tangents() {
        for law in laws() {
            for (piece, strain) in law.pieces[1..].iter().zip(&law.strains) {
                assert_eq!(law.tension(*strain, 1.0), piece.coefficients[0]);
            }
            let (first, last) = (law.strains[0], law.strains[law.strains.len() - 1]);
            for (end, beyond) in [(first, -0.3), (last, 0.3), (last, 1e3)] {
                let expected = law.tension(end, 1.0) + beyond * law.tangent(end, 1.0);
                assert!((law.tension(end + beyond, 1.0) - expected).abs() <= 1e-14 * expected.abs());
            }
        }
    }

    /// Also between points: a cubic through rising points can fall where its tangents are too large.
    #[test]
    fn tension_never_falls_and_tangents_are_continuous() {
        for law in laws() {
            let (first, last) = (law.strains[0], law.strains[law.strains.len() - 1]);
            let at = |i: u32| first - 0.1 + (last - first + 0.2) * f64::from(i) / 10_000.0;
            for i in 0..10_000 {
                let (tangent, rise) =
                    (law.tangent(at(i), 1.0), law.tension(at(i + 1), 1.0) - law.tension(at(i), 1.0));
                let rounding = 4.0 * f64::EPSILON * law.tension(at(i), 1.0).abs();
                assert!(-rounding <= rise, "{rise} at {}", at(i));
                assert!(-1e-12 * law.tangent(last, 1.0).max(1.0) <= tangent, "{tangent} at {}", at(i));
            }
            for strain in &law.strains {
                let sides = [strain - 1e-15, *strain].map(|strain| law.tangent(strain, 1.0));
                let scale = law.tangent(0.0, 1.0).max(sides[1]);
                // The tangent changes by its derivative times 1e-15 / 1e-9, the narrowest piece.
                assert!((sides[0] - sides[1]).abs() <= 1e-5 * scale, "{sides:?} at {strain}");
            }
            assert!(0.0 < law.tangent(0.0, 1.0));
        }
    }

    /// Of the cubics between any two extensions, the last that begins at or before a strain between them is the law there, to the bit.
    #[test]
    fn cubics_are_the_law() {
        let length = 0.7;
        for law in laws() {
            let mut extensions: Vec<f64> =
                law.strains.iter().flat_map(|strain| [strain * length, strain * length + 1e-3]).collect();
            extensions.extend([-0.6, -1e-4, 0.0, 5.0]);
            extensions.sort_by(f64::total_cmp);
            for (index, &least) in extensions.iter().enumerate() {
                for &most in &extensions[index..] {
                    let cubics = law.cubics([least, most], length);
                    let between =
                        extensions.iter().filter(|&&extension| least <= extension && extension <= most);
                    for &extension in between {
                        let has_begun = |cubic: &&Cubic| cubic.has_begun(extension, length);
                        let cubic = cubics[1..].iter().take_while(has_begun).last().unwrap_or(&cubics[0]);
                        assert_eq!(
                            cubic.tension_and_tangent(extension, length),
                            law.tension_and_tangent(extension, length)
                        );
                    }
                }
            }
        }
        let law = law(&[[0.1, 1.0], [0.2, 3.0]]);
        assert_eq!(law.cubics([f64::INFINITY, f64::NEG_INFINITY], 1.0).len(), 1, "nothing is between");
    }

    /// Midpoint sums of f and f s. Pieces are cubic, so the error is the change of f' over n² / 24 of the interval.
    #[test]
    fn energy_and_moment_are_integrals_of_the_tension() {
        for law in laws() {
            for end in [-0.7, -0.3, -0.005, 0.005, 0.15, 0.55, 6.0] {
                let (length, count) = (0.8, 200_000_u32);
                let h = end / f64::from(count);
                let (mut energy, mut moment) = (0.0, 0.0);
                for i in 0..count {
                    let strain = (f64::from(i) + 0.5) * h;
                    let tension = law.tension(strain * length, length);
                    energy += tension * h * length;
                    moment += tension * strain * h * length * length;
                }
                let found = [law.energy(end * length, length), law.energy_moment(end * length, length)];
                for (found, sum) in found.into_iter().zip([energy, moment]) {
                    assert!((found - sum).abs() < 1e-8 * sum.abs(), "{end}: {found} for {sum}");
                }
            }
        }
    }

    /// A stiffening curve, whose parabola would start with a tangent below zero.
    #[test]
    fn the_tangent_at_rest_is_at_least_a_third_of_the_first_slope() {
        let law = law(&[[0.1, 0.1], [0.2, 10.0], [0.3, 1000.0]]);
        assert!((law.tangent(0.0, 1.0) - 1.0 / 3.0).abs() < 1e-15);
    }
}

//! Frequencies from the spectrum of a motion.

use std::f64::consts::PI;

/// How many samples are turned by a recurrence before sine and cosine are computed anew, which keeps its rounding
/// small.
const TURNS: usize = 32;

/// The Fourier transform of samples under a window that starts and ends smoothly.
///
/// ```text
/// X(φ) = Σ w_n x_n e^(−i φ n)    w_n = (1 + cos π τ_n)⁴    τ_n from −1 to 1
/// ```
///
/// A sum of undamped oscillations gives a peak at each of their frequencies. The others shift it by the window's side
/// lobes, which fall as the ninth power of their distance in bins of 2π / N: an equal one at 20 bins shifts it by 2e-9
/// bins. This is the frequency analysis of Laskar ("The chaotic motion of the solar system", 1990) with a higher
/// window.
pub(crate) struct Spectrum {
    weighted: Vec<f64>,
}

impl Spectrum {
    /// The spectrum of `samples`, which are evenly spaced in time.
    pub(crate) fn new(samples: &[f64]) -> Self {
        let count = samples.len() as f64;
        let weighted = samples.iter().enumerate().map(|(n, sample)| {
            let window = 1.0 + libm::cos(PI * ((2 * n + 1) as f64 / count - 1.0));
            let square = window * window;
            square * square * sample
        });
        Self { weighted: weighted.collect() }
    }

    /// Distance of the frequencies that a transform of as many samples tells apart [rad per sample].
    pub(crate) fn bin(&self) -> f64 {
        2.0 * PI / self.weighted.len() as f64
    }

    /// |X|² and its derivative by φ, at `angle` φ [rad per sample].
    fn power(&self, angle: f64) -> [f64; 2] {
        let (turn_sine, turn_cosine) = libm::sincos(angle);
        // Time counts from the middle, so that the derivative does not lose digits to the phase.
        let middle = 0.5 * (self.weighted.len() as f64 - 1.0);
        let [mut re, mut im, mut re_slope, mut im_slope] = [0.0; 4];
        for (chunk, values) in self.weighted.chunks(TURNS).enumerate() {
            let first = (chunk * TURNS) as f64 - middle;
            let (mut sine, mut cosine) = libm::sincos(angle * first);
            for (n, value) in values.iter().enumerate() {
                let time = first + n as f64;
                let (along, across) = (value * cosine, value * sine);
                re += along;
                im -= across;
                re_slope -= time * across;
                im_slope -= time * along;
                (cosine, sine) =
                    (cosine * turn_cosine - sine * turn_sine, sine * turn_cosine + cosine * turn_sine);
            }
        }
        [re * re + im * im, 2.0 * (re * re_slope + im * im_slope)]
    }

    /// Frequency [rad per sample] of the highest peak between `low` and `high`.
    ///
    /// # Panics
    /// If the spectrum is highest at an end of that range, so that there is no peak.
    pub(crate) fn peak(&self, low: f64, high: f64) -> f64 {
        let count = (2.0 * (high - low) / self.bin()).ceil().max(2.0);
        let spacing = (high - low) / count;
        let powers = (0..=count as usize).map(|i| self.power(low + spacing * i as f64)[0]);
        let (highest, _) =
            powers.enumerate().fold((0, -1.0), |best, found| if best.1 < found.1 { found } else { best });
        assert!(0 < highest && highest < count as usize, "no peak between {low} and {high} rad per sample");
        let middle = low + spacing * highest as f64;
        let (mut below, mut above) = (middle - spacing, middle + spacing);
        // The derivative falls through zero at the peak; halving ends where neighbouring numbers are reached.
        for _ in 0..60 {
            let angle = 0.5 * (below + above);
            if 0.0 < self.power(angle)[1] { below = angle } else { above = angle }
        }
        0.5 * (below + above)
    }
}

//! The estimator of frequencies, on sums of oscillations whose frequencies are known.

use crate::common::spectrum::Spectrum;

/// Neighbours at 20 and 40 bins, up to ten times as strong, shift a peak by less than 1e-8 bins.
#[test]
fn frequencies_of_a_sum_are_found() {
    let bin = 2.0 * std::f64::consts::PI / 4096.0;
    let frequencies = [23.3, 43.4, 83.1, 800.7].map(|bins| bins * bin);
    let amplitudes = [1.0, 0.3, 3.0, 0.2];
    let sample = |n: usize| -> f64 {
        let waves = frequencies.iter().zip(amplitudes);
        waves.map(|(frequency, amplitude)| amplitude * (frequency * n as f64 + amplitude).cos()).sum()
    };
    let spectrum = Spectrum::new(&(0..4096).map(sample).collect::<Vec<f64>>());
    assert_eq!(spectrum.bin(), bin);
    for frequency in frequencies {
        let found = spectrum.peak(frequency - 9.0 * bin, frequency + 7.0 * bin);
        assert!((found - frequency).abs() < 1e-8 * bin, "{found} for {frequency}");
    }
}

#[test]
#[should_panic = "no peak"]
fn a_slope_is_no_peak() {
    let spectrum = Spectrum::new(&(0..256).map(|n| (0.5 * f64::from(n)).cos()).collect::<Vec<f64>>());
    spectrum.peak(0.4, 0.45);
}

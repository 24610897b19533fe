//! Random numbers by seed, name and counter, and the noise that winds make of them.

use std::f64::consts::PI;

/// Values of correlated noise per correlation time; between them it is interpolated.
const VALUES_PER_TIME: f64 = 32.0;

/// Gaussian random numbers that can be had in any order: a function of seed, name and counter.
///
/// Two rounds of the finaliser of SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014)
/// turn key and counter into uniform numbers, and the method of Box and Muller these into Gaussian ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomStream {
    key: u64,
}

impl RandomStream {
    /// The stream of the process `name` under `seed`.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        let key = name.bytes().fold(mixed(seed), |key, byte| mixed(key ^ u64::from(byte)));
        Self { key }
    }

    /// The `counter`-th number, of mean 0 and standard deviation 1.
    #[must_use]
    pub fn gaussian(&self, counter: u64) -> f64 {
        let first = mixed(mixed(counter) ^ self.key);
        let second = mixed(first ^ self.key);
        // 53 bits: above 0 and up to 1, so that the logarithm is finite.
        let [u, v] = [first, second].map(|bits| ((bits >> 11) + 1) as f64 / (1_u64 << 53) as f64);
        libm::sqrt(-2.0 * libm::log(u)) * libm::cos(2.0 * PI * v)
    }
}

/// A bijection of 64 bits in which every bit depends on every other.
fn mixed(value: u64) -> u64 {
    let mut bits = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A random quantity over time, of mean 0; its unit is the owner's.
#[derive(Clone, Debug, PartialEq)]
pub enum Noise {
    /// A new value at each time at which it is asked for, as the paper prints it: the more steps, the less it does.
    White {
        /// Standard deviation.
        deviation: f64,
        /// Where the values come from; the counter is the bits of the time.
        stream: RandomStream,
    },
    /// An Ornstein-Uhlenbeck process, whatever the steps.
    Correlated {
        /// Values at equal intervals from time zero on.
        values: Vec<f64>,
        /// Interval [s].
        interval: f64,
    },
}

impl Noise {
    /// Noise of standard deviation `deviation` and correlation time `time` [s] up to `duration` [s]; white if `time` is
    /// zero.
    ///
    /// The Ornstein-Uhlenbeck process in its stationary state, exact at intervals δ = time / 32:
    ///
    /// ```text
    /// e₀ = σ N₀    eₖ₊₁ = ρ eₖ + σ √(1 − ρ²) Nₖ₊₁    ρ = exp(−δ / time)
    /// ```
    ///
    /// and straight between them. That would take the mean square to σ² (2 + ρ) / 3, so the values are made larger by as
    /// much.
    #[must_use]
    pub fn new(deviation: f64, time: f64, duration: f64, stream: RandomStream) -> Self {
        if time == 0.0 {
            return Self::White { deviation, stream };
        }
        let correlation = libm::exp(-1.0 / VALUES_PER_TIME);
        let scale = deviation / libm::sqrt((2.0 + correlation) / 3.0);
        let innovation = libm::sqrt(1.0 - correlation * correlation);
        let interval = time / VALUES_PER_TIME;
        // Two more than the intervals, so that the end of the run lies between two values however it is rounded.
        let count = libm::ceil(duration / interval) as u64 + 2;
        let mut value = scale * stream.gaussian(0);
        let mut values = vec![value];
        for counter in 1..count {
            value = correlation * value + scale * innovation * stream.gaussian(counter);
            values.push(value);
        }
        Self::Correlated { values, interval }
    }

    /// The longest step [s] that sees the noise change: four of the intervals between its values. White noise has a new
    /// value at each step, however long.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        match self {
            Self::White { .. } => f64::INFINITY,
            Self::Correlated { interval, .. } => 4.0 * interval,
        }
    }

    /// Value at `time` [s], which must not be negative; after the duration the last value.
    #[must_use]
    pub fn value(&self, time: f64) -> f64 {
        match self {
            Self::White { deviation, stream } => deviation * stream.gaussian(time.to_bits()),
            Self::Correlated { values, interval } => {
                let place = time / interval;
                let index = (place as usize).min(values.len() - 2);
                let share = (place - index as f64).min(1.0);
                values[index] + share * (values[index + 1] - values[index])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream() -> RandomStream {
        RandomStream::new(7, "environment.wind.0.noise")
    }

    /// Of n samples the mean is within 4 / √n of 0, the mean square within 4 √2 / √n of 1 and the mean fourth power within
    /// 4 √96 / √n of 3; each but for 6 in 100,000 seeds.
    #[test]
    fn gaussian_numbers_have_gaussian_moments() {
        let n = 200_000_u64;
        let moment = |power: i32| (0..n).map(|k| stream().gaussian(k).powi(power)).sum::<f64>() / n as f64;
        let bound = 4.0 / (n as f64).sqrt();
        assert!(moment(1).abs() < bound, "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < bound * 2.0_f64.sqrt(), "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < bound * 96.0_f64.sqrt(), "{}", moment(4));
        let product: f64 =
            (0..n).map(|k| stream().gaussian(k) * stream().gaussian(k + 1)).sum::<f64>() / n as f64;
        assert!(product.abs() < bound, "{product}");
    }

    #[test]
    fn other_seeds_and_names_give_other_numbers() {
        let numbers = |stream: RandomStream| [0, 1, 2].map(|counter| stream.gaussian(counter));
        let own = numbers(stream());
        assert_ne!(own, numbers(RandomStream::new(8, "environment.wind.0.noise")));
        assert_ne!(own, numbers(RandomStream::new(7, "environment.wind.1.noise")));
        assert_eq!(own, numbers(stream()));
    }

    /// The autocorrelation of the process is σ² exp(−|t| / τ). Over T = 20,000 τ its estimate has a standard deviation of
    /// about σ² √(2 τ / T) = 0.01 σ². Straight lines between the values lift it by up to δ / 6τ = 0.5 % at small lags.
    #[test]
    fn correlated_noise_has_its_deviation_and_correlation_time() {
        let (deviation, time) = (0.3, 0.05);
        let duration = 20_000.0 * time;
        let noise = Noise::new(deviation, time, duration, stream());
        let n = 400_000;
        let sample = |k: usize| noise.value(k as f64 * duration / n as f64);
        for lag in [0, 10, 20, 40] {
            let mean = (0..n - lag).map(|k| sample(k) * sample(k + lag)).sum::<f64>() / (n - lag) as f64;
            let exact = deviation * deviation * (-(lag as f64) * duration / (n as f64 * time)).exp();
            let error = (mean - exact).abs() / (deviation * deviation);
            assert!(error < 0.045, "lag {lag}: {mean} for {exact}");
        }
    }

    #[test]
    fn correlated_noise_is_continuous_and_white_noise_is_not() {
        let correlated = Noise::new(1.0, 0.5, 10.0, stream());
        let white = Noise::new(1.0, 0.0, 10.0, stream());
        let jump = |noise: &Noise| {
            (0..1000)
                .map(|k| f64::from(k) * 0.01)
                .map(|t| (noise.value(t + 1e-9) - noise.value(t)).abs())
                .sum::<f64>()
        };
        assert!(jump(&correlated) < 1e-4, "{}", jump(&correlated));
        assert!(jump(&white) > 500.0, "{}", jump(&white));
        assert!(correlated.value(10.0).is_finite() && correlated.value(20.0).is_finite());
    }
}

//! Times of several competitors, measured side by side.
//!
//! Other work on the machine, and the clock of its processor, change from second to second. So competitors take turns in short
//! rounds, and what is reported is the median of the ratios within a round.

use std::time::{Duration, Instant};

use super::clock::{Clock, Stopwatch};

/// What is measured: something that repeats its work and says how long it took.
pub(crate) struct Competitor<'a> {
    /// Units of work in one repetition, such as steps times particles.
    units: f64,
    repeat: Box<dyn FnMut(u64) -> Duration + 'a>,
}

impl<'a> Competitor<'a> {
    /// `repeat` is called with a number of repetitions, each of `units`, and returns the time that they took.
    pub(crate) fn new(units: f64, repeat: impl FnMut(u64) -> Duration + 'a) -> Self {
        Self { units, repeat: Box::new(repeat) }
    }

    /// The same for `work` on this thread that needs no preparation.
    pub(crate) fn of(units: f64, mut work: impl FnMut(u64) + 'a) -> Self {
        Self::new(units, move |count| {
            let start = Stopwatch::start(Clock::Thread);
            work(count);
            start.elapsed()
        })
    }

    /// Repetitions that take about `turn`, after those that it takes to find out.
    fn calibrate(&mut self, turn: Duration) -> u64 {
        (self.repeat)(1); // warms caches, and makes scratch memory
        let mut count = 1;
        loop {
            let mut time = (self.repeat)(count);
            if time < 8 * turn {
                // The shortest, as one that was interrupted would count for many.
                time = (0..2).fold(time, |shortest, _| shortest.min((self.repeat)(count)));
            }
            if turn <= time * 2 {
                let share = turn.as_secs_f64() / time.as_secs_f64().max(1e-9);
                return ((count as f64 * share).round() as u64).max(1);
            }
            count *= 2;
        }
    }
}

/// How much time measuring may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Of one competitor in one round.
    turn: Duration,
    /// Of all rounds of one comparison.
    total: Duration,
    /// Fewest and most rounds.
    rounds: [usize; 2],
}

impl Budget {
    /// Of the whole table: a few minutes.
    pub(crate) const FULL: Self =
        Self { turn: Duration::from_millis(4), total: Duration::from_millis(1500), rounds: [7, 41] };

    /// Of a first look: half a minute.
    pub(crate) const QUICK: Self =
        Self { turn: Duration::from_millis(1), total: Duration::from_millis(150), rounds: [3, 15] };

    /// The same with turns that are long beside the time that a sleeping thread takes to wake up, a part of a millisecond or more.
    pub(crate) fn with_long_turns(self) -> Self {
        Self { turn: 16 * self.turn, total: 4 * self.total, ..self }
    }

    /// Lets `competitors` take turns.
    pub(crate) fn compare(&self, mut competitors: Vec<Competitor<'_>>) -> Samples {
        let counts: Vec<u64> = competitors.iter_mut().map(|one| one.calibrate(self.turn)).collect();
        let mut nanoseconds = vec![Vec::new(); competitors.len()];
        let start = Instant::now();
        for round in 0..self.rounds[1] {
            if self.rounds[0] <= round && self.total < start.elapsed() {
                break;
            }
            // Each goes first in turn, so that none is always behind the same other.
            for place in 0..competitors.len() {
                let index = (round + place) % competitors.len();
                let competitor = &mut competitors[index];
                let time = (competitor.repeat)(counts[index]);
                let units = competitor.units * counts[index] as f64;
                nanoseconds[index].push(time.as_secs_f64() * 1e9 / units);
            }
        }
        Samples { nanoseconds }
    }
}

/// Times per unit [ns] of every competitor, round by round.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    nanoseconds: Vec<Vec<f64>>,
}

impl Samples {
    /// Times per unit [ns] of competitor `index`.
    pub(crate) fn time(&self, index: usize) -> Spread {
        Spread::of(self.nanoseconds[index].clone())
    }

    /// Times of `index` relative to those of `reference`, round by round.
    pub(crate) fn ratio(&self, index: usize, reference: usize) -> Spread {
        self.ratio_to_largest(index, &[reference])
    }

    /// Times of `index` relative to the largest of those of `references`, round by round.
    pub(crate) fn ratio_to_largest(&self, index: usize, references: &[usize]) -> Spread {
        let rounds = 0..self.nanoseconds[index].len();
        Spread::of(
            rounds
                .map(|round| {
                    let times = references.iter().map(|&reference| self.nanoseconds[reference][round]);
                    self.nanoseconds[index][round] / times.fold(0.0, f64::max)
                })
                .collect(),
        )
    }
}

/// Median and quartiles of a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    pub(crate) median: f64,
    /// A quarter of the sample is below the first, and a quarter above the second.
    pub(crate) quartiles: [f64; 2],
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (values.len() - 1) as f64;
            let (below, above) = (values[place.floor() as usize], values[place.ceil() as usize]);
            below + (above - below) * place.fract()
        };
        Self { median: at(0.5), quartiles: [at(0.25), at(0.75)] }
    }

    /// One over it.
    pub(crate) fn inverse(self) -> Self {
        let [low, high] = self.quartiles;
        Self { median: 1.0 / self.median, quartiles: [1.0 / high, 1.0 / low] }
    }

    /// `factor` times it.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { median: factor * self.median, quartiles: self.quartiles.map(|value| factor * value) }
    }
}

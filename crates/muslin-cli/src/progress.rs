//! Telling how far a run is: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use muslin::observe::Observer;
use muslin::scene::RunSettings;
use muslin::{Model, State};

/// Time between two updates of the bar.
const BAR_INTERVAL: Duration = Duration::from_millis(100);

/// Time between two plain lines at least.
const LINE_INTERVAL: Duration = Duration::from_secs(2);

/// Parts of the bar.
const BAR_PARTS: u64 = 1000;

/// Watches a run and says how far it is.
pub(crate) struct Progress<'a> {
    interrupted: &'a AtomicBool,
    duration: f64,
    bar: Option<ProgressBar>,
    start: Instant,
    start_time: f64,
    next_update: Instant,
}

impl<'a> Progress<'a> {
    /// For a run of `settings` that goes on from `start_time` [s] until `interrupted`.
    pub(crate) fn new(settings: &RunSettings, start_time: f64, interrupted: &'a AtomicBool) -> Self {
        let bar = stderr().is_terminal().then(|| {
            let bar = ProgressBar::with_draw_target(Some(BAR_PARTS), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{wide_bar} {msg}") {
                bar.set_style(style);
            }
            bar
        });
        let start = Instant::now();
        let next_update = start + if bar.is_some() { BAR_INTERVAL } else { LINE_INTERVAL };
        Self { interrupted, duration: settings.duration, bar, start, start_time, next_update }
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Simulated time, step size, speed against real time and time left.
    fn message(&self, state: &State, now: Instant) -> String {
        if self.interrupted.load(Ordering::Relaxed) {
            return "stopping after this frame; Ctrl-C again stops at once".to_owned();
        }
        let elapsed = (now - self.start).as_secs_f64();
        let speed = (state.time - self.start_time) / elapsed;
        let left = (self.duration - state.time) / speed;
        format!(
            "{:.2}/{:.2} s  step {}  {}x real time  {} left",
            state.time,
            self.duration,
            duration_text(state.last_step),
            significant(speed),
            duration_text(left)
        )
    }
}

impl Observer for Progress<'_> {
    fn step(&mut self, _model: &Model, state: &State) {
        let now = Instant::now();
        if now < self.next_update {
            return;
        }
        let message = self.message(state, now);
        match &self.bar {
            Some(bar) => {
                bar.set_position((state.time / self.duration * BAR_PARTS as f64) as u64);
                bar.set_message(message);
                self.next_update = now + BAR_INTERVAL;
            }
            None => {
                // Nobody may be reading; the run goes on all the same.
                let _ = writeln!(stderr(), "{message}");
                self.next_update = now + LINE_INTERVAL;
            }
        }
    }
}

/// A time [s] in the unit that suits it, with three digits.
pub(crate) fn duration_text(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "unknown time".to_owned();
    }
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s if s < 120.0 => (s, "s"),
        s if s < 7200.0 => (s / 60.0, "min"),
        s => (s / 3600.0, "h"),
    };
    format!("{} {unit}", significant(value))
}

/// A number with three significant digits, without exponent where it stays short.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    match exponent {
        -4..=2 => format!("{value:.*}", (2 - exponent).max(0) as usize),
        3..=6 => format!("{value:.0}"),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use muslin::{Points, Scene};

    use super::*;

    /// Half way from 1 s, where the run was resumed, to 3 s, after 2 s at the wall.
    #[test]
    fn a_message_has_time_step_speed_and_time_left() {
        let scene = Scene::parse(include_str!("../../../scenes/hanging.toml")).expect("a scene");
        let interrupted = AtomicBool::new(false);
        let progress = Progress::new(scene.run(), 1.0, &interrupted);
        let now = progress.start + Duration::from_secs(2);
        let mut state = State::at_rest(Points::zeros(1));
        (state.time, state.last_step) = (2.0, 2.5e-4);
        let message = progress.message(&state, now);
        assert_eq!(message, "2.00/3.00 s  step 250 µs  0.500x real time  2.00 s left");
        interrupted.store(true, Ordering::Relaxed);
        let message = progress.message(&state, now);
        assert_eq!(message, "stopping after this frame; Ctrl-C again stops at once");
    }

    #[test]
    fn times_take_the_unit_that_suits_them() {
        let texts = [2.5e-5, 0.002083, 1.5, 150.0, 9000.0, f64::INFINITY].map(duration_text);
        assert_eq!(texts, ["25.0 µs", "2.08 ms", "1.50 s", "2.50 min", "2.50 h", "unknown time"]);
    }

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [0.0, 0.01234, 12.345, 1234.5, 3.2e9, 1.5e-9].map(significant);
        assert_eq!(texts, ["0", "0.0123", "12.3", "1234", "3.20e9", "1.50e-9"]);
    }
}

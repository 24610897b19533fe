//! Telling how far a run is: a bar on a terminal, plain lines elsewhere.

use std::io::{Write, stderr};
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

/// Characters of the bar.
const BAR_LENGTH: usize = 20;

/// Below this duration [s] times are told in smaller units.
const SHORT_DURATION: f64 = 0.1;

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
        let bar = terminal_line();
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
        let progress = if self.duration < SHORT_DURATION {
            format!("{}/{}", duration_text(state.time), duration_text(self.duration))
        } else {
            format!("{:.2}/{:.2} s", state.time, self.duration)
        };
        format!(
            "{progress}  step {}  {}x real time  {} left",
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
                bar.set_message(format!("{message}  {}", bar_text(state.time / self.duration)));
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

/// A line on the terminal that can be replaced, and that is cut off where the terminal ends; none where there is no
/// terminal or it cannot do that.
pub(crate) fn terminal_line() -> Option<ProgressBar> {
    let target = ProgressDrawTarget::stderr();
    if target.is_hidden() {
        return None;
    }
    let line = ProgressBar::with_draw_target(None, target);
    line.set_style(ProgressStyle::with_template("{wide_msg}").ok()?);
    Some(line)
}

/// A bar of which `share`, from 0 to 1, is full.
pub(crate) fn bar_text(share: f64) -> String {
    let full = ((share * BAR_LENGTH as f64) as usize).min(BAR_LENGTH);
    "█".repeat(full) + &"░".repeat(BAR_LENGTH - full)
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
    rounded(value, 3)
}

/// A number with so many significant `digits`, from 1 to 7, without exponent where it stays short.
pub(crate) fn rounded(value: f64, digits: u8) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    let last = i32::from(digits) - 1;
    match exponent {
        -4..=6 => format!("{value:.*}", (last - exponent).max(0) as usize),
        _ => format!("{value:.*e}", last as usize),
    }
}

/// A number with all its digits, without exponent where it stays short.
pub(crate) fn all_digits(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// A strain [1] in per cent.
pub(crate) fn strain_text(strain: f64) -> String {
    if strain.is_finite() { format!("{} %", significant(100.0 * strain)) } else { "unbounded".to_owned() }
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
    fn short_durations_are_told_in_smaller_units() {
        let text = include_str!("../../../scenes/hanging.toml");
        let text = muslin::scene::set_value(text, "run.frame_rate=1000").expect("a frame rate");
        let text = muslin::scene::set_value(&text, "run.duration=0.005").expect("a duration");
        let text = muslin::scene::set_value(&text, "run.step.constant=1e-4").expect("a step");
        let scene = Scene::parse(&text).expect("a scene");
        let interrupted = AtomicBool::new(false);
        let progress = Progress::new(scene.run(), 0.0, &interrupted);
        let mut state = State::at_rest(Points::zeros(1));
        (state.time, state.last_step) = (0.0025, 1e-4);
        let message = progress.message(&state, progress.start + Duration::from_secs(1));
        assert_eq!(message, "2.50 ms/5.00 ms  step 100 µs  0.00250x real time  1.00 s left");
    }

    #[test]
    fn a_bar_fills_from_the_left() {
        assert_eq!(bar_text(0.0), "░".repeat(20));
        assert_eq!(bar_text(0.25), "█".repeat(5) + &"░".repeat(15));
        assert_eq!(bar_text(1.0), "█".repeat(20));
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
        assert_eq!(
            [1.234567, -1.85e-4, 5e-5].map(|value| rounded(value, 4)),
            ["1.235", "-0.0001850", "5.000e-5"]
        );
        assert_eq!(
            [0.0, 0.236, -5e-4, 1e-12, 5e7].map(all_digits),
            ["0", "0.236", "-0.0005", "1e-12", "5e7"]
        );
    }

    #[test]
    fn strains_are_told_in_per_cent() {
        assert_eq!([0.2327, f64::INFINITY].map(strain_text), ["23.3 %", "unbounded"]);
    }
}

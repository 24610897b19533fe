//! Telling how far the reproduction is: a bar on a terminal, plain lines elsewhere.

use std::io::{Write, stderr};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::trial::Trial;
use crate::error::CliError;
use crate::progress::{bar_text, duration_text, terminal_line};

/// Time between two updates of the bar.
const BAR_INTERVAL: Duration = Duration::from_millis(100);

/// Time between two plain lines at least.
const LINE_INTERVAL: Duration = Duration::from_secs(2);

/// Share of the work that must be done before the time left can be told.
const LEAST_SHARE: f64 = 0.02;

/// How far everything is. Parts of the work follow each other, each with a known share of the whole.
pub(crate) struct Progress<'a> {
    interrupted: &'a AtomicBool,
    bar: Option<ProgressBar>,
    start: Instant,
    state: Mutex<Reached>,
}

struct Reached {
    /// Share of the work before the part at hand [1], and of that part.
    before: f64,
    part: f64,
    /// Work of the part, and how much of it is in runs that have ended.
    work: f64,
    ended: f64,
    next_update: Instant,
}

impl<'a> Progress<'a> {
    /// Begins; `interrupted` tells of Ctrl-C.
    pub(crate) fn new(interrupted: &'a AtomicBool) -> Self {
        let (bar, start) = (terminal_line(), Instant::now());
        let next_update = start + if bar.is_some() { BAR_INTERVAL } else { LINE_INTERVAL };
        let state = Reached { before: 0.0, part: 0.0, work: 1.0, ended: 0.0, next_update };
        Self { interrupted, bar, start, state: Mutex::new(state) }
    }

    /// A part begins that has `share` of all work, and consists of runs with so much `work` in the measure of trials.
    pub(crate) fn begin(&self, share: f64, work: f64) {
        let mut state = self.reached_so_far();
        state.before += state.part;
        (state.part, state.work, state.ended) = (share, work, 0.0);
    }

    /// `trial` is `share` through.
    pub(crate) fn reached(&self, trial: &Trial, share: f64) {
        let now = Instant::now();
        let mut state = self.reached_so_far();
        if now < state.next_update {
            return;
        }
        state.next_update = now + if self.bar.is_some() { BAR_INTERVAL } else { LINE_INTERVAL };
        let part = (state.ended + share * trial.work) / state.work;
        let done = state.before + state.part * part.min(1.0);
        let message = message(&trial.name, done, now - self.start);
        match &self.bar {
            Some(bar) => bar.set_message(format!("{message}  {}", bar_text(done))),
            None => {
                // Nobody may be reading; the work goes on all the same.
                let _ = writeln!(stderr(), "{message}");
            }
        }
    }

    /// `trial` has ended.
    pub(crate) fn finished(&self, trial: &Trial) {
        self.reached_so_far().ended += trial.work;
        self.reached(trial, 0.0);
    }

    /// An error after Ctrl-C.
    pub(crate) fn require_going_on(&self) -> Result<(), CliError> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(CliError::failed("stopped; nothing was written", "start it again"));
        }
        Ok(())
    }

    /// Removes the bar; how long it all took.
    pub(crate) fn finish(&self) -> Duration {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.start.elapsed()
    }

    fn reached_so_far(&self) -> std::sync::MutexGuard<'_, Reached> {
        // Numbers for a person are right enough after a panic elsewhere.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

fn message(name: &str, done: f64, elapsed: Duration) -> String {
    let mut message = format!("{:.0} %  computing {name}", 100.0 * done);
    if LEAST_SHARE < done {
        let left = elapsed.as_secs_f64() * (1.0 - done) / done;
        message.push_str(&format!("  {} left", duration_text(left)));
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_has_share_run_and_time_left() {
        assert_eq!(
            message("none on 10 x 10", 0.01, Duration::from_secs(1)),
            "1 %  computing none on 10 x 10"
        );
        let message = message("none on 10 x 10", 0.25, Duration::from_secs(30));
        assert_eq!(message, "25 %  computing none on 10 x 10  90.0 s left");
    }
}

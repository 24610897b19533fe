//! What time is measured with.

use std::time::{Duration, Instant};

/// What counts as time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// Everything: what several threads share, what waits for a disk, and what other programs take.
    Wall,
    /// What the processor gave this thread; where nobody says how much that is, everything.
    Thread,
}

/// A time span that has begun.
pub(crate) struct Stopwatch {
    wall: Instant,
    /// Time of the thread at the start, where that is what counts.
    thread: Option<Duration>,
}

impl Stopwatch {
    /// Begins now.
    pub(crate) fn start(clock: Clock) -> Self {
        let thread = if clock == Clock::Thread { thread_time() } else { None };
        Self { wall: Instant::now(), thread }
    }

    /// What has passed.
    pub(crate) fn elapsed(&self) -> Duration {
        match self.thread.map(|start| (start, thread_time())) {
            Some((start, Some(now))) => now.saturating_sub(start),
            _ => self.wall.elapsed(),
        }
    }
}

/// What the processor gave this thread so far, where the system tells.
fn thread_time() -> Option<Duration> {
    #[cfg(target_os = "linux")]
    return Duration::try_from(rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime)).ok();
    #[cfg(not(target_os = "linux"))]
    None
}

//! Telling which file is being written.

use std::io::{Write, stderr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use crate::progress::terminal_line;

/// Time between two looks at the flag of Ctrl-C.
const INTERVAL: Duration = Duration::from_millis(100);

/// Time without a word off a terminal at least.
const LINE_INTERVAL: Duration = Duration::from_secs(2);

/// Says which file is being written: at once on a terminal, elsewhere if it takes long.
///
/// A file is written in one go, so that another thread has to tell of it.
pub(crate) struct FileProgress {
    names: Option<Sender<&'static str>>,
    thread: Option<JoinHandle<()>>,
}

impl FileProgress {
    /// Begins; `interrupted` tells of Ctrl-C.
    pub(crate) fn new(interrupted: Arc<AtomicBool>) -> Self {
        let (names, receiver) = channel();
        // Where no thread can be started the files are written all the same.
        let thread = thread::Builder::new().spawn(move || Teller::new(interrupted).tell(&receiver)).ok();
        Self { names: Some(names), thread }
    }

    /// The file `name` comes next.
    pub(crate) fn writing(&self, name: &'static str) {
        if let Some(names) = &self.names {
            // Fails if there is no thread.
            let _ = names.send(name);
        }
    }
}

impl Drop for FileProgress {
    /// Clears the line.
    fn drop(&mut self) {
        self.names = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread knows.
struct Teller {
    interrupted: Arc<AtomicBool>,
    /// Whether the run itself was interrupted, which was said then.
    was_interrupted: bool,
    line: Option<ProgressBar>,
    said: String,
    next_line: Instant,
}

impl Teller {
    fn new(interrupted: Arc<AtomicBool>) -> Self {
        let was_interrupted = interrupted.load(Ordering::Relaxed);
        let next_line = Instant::now() + LINE_INTERVAL;
        Self { interrupted, was_interrupted, line: terminal_line(), said: String::new(), next_line }
    }

    /// Tells of `names` until they end.
    fn tell(mut self, names: &Receiver<&'static str>) {
        let mut name = None;
        loop {
            match names.recv_timeout(INTERVAL) {
                Ok(next) => name = Some(next),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if let Some(name) = name {
                self.say(name, Instant::now());
            }
        }
        if let Some(line) = &self.line {
            line.finish_and_clear();
        }
    }

    fn say(&mut self, name: &str, now: Instant) {
        let is_interrupted = self.interrupted.load(Ordering::Relaxed);
        let is_news = is_interrupted && !self.was_interrupted;
        let message = message(name, is_interrupted);
        if let Some(line) = &self.line {
            // Again and again, since the line is not drawn anew when little time has passed.
            line.set_message(message);
        } else if message != self.said && (is_news || self.next_line <= now) {
            // Nobody may be reading; the files are written all the same.
            let _ = writeln!(stderr(), "{message}");
            self.next_line = now + LINE_INTERVAL;
            self.was_interrupted = is_interrupted;
            self.said = message;
        }
    }
}

fn message(name: &str, is_interrupted: bool) -> String {
    if is_interrupted {
        format!("writing {name}: finishing the files; Ctrl-C again stops at once")
    } else {
        format!("writing {name}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_takes_long_is_told_once() {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut teller = Teller { line: None, ..Teller::new(Arc::clone(&interrupted)) };
        let start = teller.next_line - LINE_INTERVAL;
        teller.say("trajectory.npz", start);
        assert_eq!(teller.said, "");
        teller.say("trajectory.npz", start + LINE_INTERVAL);
        assert_eq!(teller.said, "writing trajectory.npz");
        teller.say("cloth.glb", start + LINE_INTERVAL);
        assert_eq!(teller.said, "writing trajectory.npz");
        interrupted.store(true, Ordering::Relaxed);
        teller.say("cloth.glb", start + LINE_INTERVAL);
        assert_eq!(teller.said, "writing cloth.glb: finishing the files; Ctrl-C again stops at once");
    }
}

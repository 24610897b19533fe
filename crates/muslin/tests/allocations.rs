//! What a run allocates: nothing from step to step, and not much for a million particles.

#![allow(unsafe_code, reason = "an allocator that counts has to be one")]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{
    AirNumbers, ClothNumbers, SceneNumbers, SineNumbers, StepNumbers, WindNumbers, simulation, workers,
};
use muslin::observe::{Frame, Observer, Recorder};
use muslin::{Model, State};

/// The system's allocator, and how often and how much it was asked for.
struct Counting;

/// Number of requests for memory.
static REQUESTS: AtomicUsize = AtomicUsize::new(0);
/// Memory in use [B].
static LIVE: AtomicUsize = AtomicUsize::new(0);
/// The most memory in use so far [B].
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn count(size: usize) {
    REQUESTS.fetch_add(1, Ordering::Relaxed);
    let live = LIVE.fetch_add(size, Ordering::Relaxed) + size;
    PEAK.fetch_max(live, Ordering::Relaxed);
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // Old and new memory may exist side by side.
        count(new_size);
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Counts the requests for memory from each step to the next or to the frame. As the first observer it sees those of the
/// others' steps, too, but not those of the record of a frame, which takes memory.
struct StepRequests {
    before: Option<usize>,
    /// Requests of each interval.
    intervals: [usize; 1000],
    count: usize,
}

impl StepRequests {
    fn end_interval(&mut self) {
        let now = REQUESTS.load(Ordering::Relaxed);
        if let Some(before) = self.before.replace(now) {
            self.intervals[self.count] = now - before;
            self.count += 1;
        }
    }
}

impl Observer for StepRequests {
    fn step(&mut self, _model: &Model, _state: &State) {
        self.end_interval();
    }

    fn frame(&mut self, _model: &Model, _frame: &Frame<'_>) {
        self.end_interval();
        self.before = None;
    }
}

const MOTION: SineNumbers =
    SineNumbers { axis: [1.0, 0.0, 0.0], amplitude: 0.01, frequency: 3.0, phase: 0.0 };

const LIMIT: &str = "{ kind = \"cut-off\", strain = 1e-4 }";

fn windy(columns: usize, rows: usize, frame_intervals: u32, steps_per_frame: u32) -> SceneNumbers {
    SceneNumbers {
        frame_intervals,
        frame_rate: 100.0,
        steps_per_frame,
        winds: vec![WindNumbers {
            amplitude: 1e-3,
            angular_frequency: 3.0,
            phase: 0.0,
            direction: [0.0, 0.0, 1.0],
            noise: [0.0; 2],
        }],
        airs: vec![AirNumbers::steady([1.0, 0.0, 2.0], [1.5, 0.05])],
        cloths: vec![
            ClothNumbers {
                columns,
                rows,
                pins: vec![(0, 0)],
                motion: Some(MOTION),
                limit: Some(LIMIT),
                ..ClothNumbers::default()
            },
            ClothNumbers { is_measured: true, ..ClothNumbers::default() },
        ],
        ..SceneNumbers::default()
    }
}

fn assert_no_requests(threads: usize, step_rule: StepNumbers) {
    let workers = workers(threads);
    if 1 < threads {
        // Each thread, once it is up and looks for work, allocates what it needs for that.
        workers.install(|| rayon::broadcast(|_| ()));
    }
    let mut simulation = simulation(&SceneNumbers { step_rule, ..windy(150, 100, 3, 40) }.scene(), workers);
    let (mut requests, mut recorder) =
        (StepRequests { before: None, intervals: [0; 1000], count: 0 }, Recorder::default());
    simulation.observe(&mut [&mut requests, &mut recorder]);
    while !simulation.is_finished() {
        simulation.advance(&mut [&mut requests, &mut recorder]).unwrap_or_else(|error| panic!("{error}"));
    }
    if step_rule == StepNumbers::Constant {
        assert_eq!(requests.count, 3 * 40, "39 steps after the first, and the frame, three times");
    }
    assert!(10 < requests.count, "{} steps", requests.count);
    // The first interval begins where the others see the first step.
    let sum: usize = requests.intervals[1..].iter().sum();
    assert_eq!(sum, 0, "requests for memory on {threads} threads, {step_rule:?}");
}

/// 600 MB is what a million particles may take; seven arrays of vectors, three of them of the wind's work, and five of
/// numbers are 225 MB.
fn assert_memory_of_a_million_particles() {
    let before = LIVE.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let mut simulation = simulation(&windy(1000, 1000, 1, 10).scene(), workers(1));
    let mut recorder = Recorder::default();
    simulation.observe(&mut [&mut recorder]);
    simulation.advance(&mut [&mut recorder]).unwrap_or_else(|error| panic!("{error}"));
    let peak = PEAK.load(Ordering::Relaxed) - before;
    assert!((100_000_000..600_000_000).contains(&peak), "{peak} B at most");
}

/// One test, since tests side by side would count each other's requests.
#[test]
fn steps_allocate_nothing_and_runs_not_much() {
    for step_rule in [StepNumbers::Constant, StepNumbers::Adaptive, StepNumbers::Tolerance(1e-3)] {
        assert_no_requests(1, step_rule);
        assert_no_requests(2, step_rule);
    }
    assert_memory_of_a_million_particles();
}

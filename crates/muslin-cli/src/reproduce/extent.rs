//! How much is computed.

/// Grids and durations of a reproduction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) is_quick: bool,
    /// Particles along each side of the paper's cloth.
    pub(crate) side: usize,
    /// Simulated time [s] of runs that are compared.
    pub(crate) duration: f64,
    /// The same, of those of which step and error are compared: long enough to come nearly to rest.
    pub(crate) long_duration: f64,
    /// The same, of a finer cloth of which step and error are compared.
    pub(crate) fine_side: usize,
    /// Particles along each side, in the table of readings and grids.
    pub(crate) sides: &'static [usize],
    /// The same, in the measurement of time against number of particles.
    pub(crate) cost_sides: &'static [usize],
}

impl Extent {
    /// What the page is meant to show, in a few minutes.
    pub(crate) const FULL: Self = Self {
        is_quick: false,
        side: 10,
        duration: 1.0,
        long_duration: 3.0,
        fine_side: 20,
        sides: &[10, 20, 40, 80],
        cost_sides: &[10, 20, 40, 80, 160, 320],
    };

    /// Coarse grids and short times, in seconds: every part of the page, but not its results.
    pub(crate) const QUICK: Self = Self {
        is_quick: true,
        side: 6,
        duration: 0.25,
        long_duration: 0.25,
        fine_side: 8,
        sides: &[4, 8],
        cost_sides: &[8, 16, 32],
    };
}

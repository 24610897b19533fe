//! The particles' constants.

/// Mass, drag and pins of all particles.
///
/// Invariants: the arrays have the same length; masses are positive and drags not negative.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    masses: Vec<f64>,
    drags: Vec<f64>,
    pinned: Vec<bool>,
}

impl Particles {
    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Whether there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty()
    }

    /// Masses m [kg], one per particle.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Linear drags k_d [kg/s], one per particle.
    #[must_use]
    pub fn drags(&self) -> &[f64] {
        &self.drags
    }

    /// Whether a particle is held, or moved along a path, whatever acts on it; one per particle.
    #[must_use]
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// The pinned particles, ascending.
    pub fn pins(&self) -> impl Iterator<Item = usize> + '_ {
        self.pinned.iter().enumerate().filter_map(|(particle, &pinned)| pinned.then_some(particle))
    }

    /// Appends `count` free particles of `mass` [kg] and `drag` [kg/s].
    pub(crate) fn extend(&mut self, count: usize, mass: f64, drag: f64) {
        let len = self.len() + count;
        self.masses.resize(len, mass);
        self.drags.resize(len, drag);
        self.pinned.resize(len, false);
    }

    /// Pins `particle`; whether it was free.
    pub(crate) fn pin(&mut self, particle: usize) -> bool {
        !std::mem::replace(&mut self.pinned[particle], true)
    }
}

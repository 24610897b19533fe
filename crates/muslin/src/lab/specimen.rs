//! A rectangle of fabric between clamps.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Along, LabError, Record};
use crate::integrate::{Workers, advance_memory};
use crate::model::Grid;
use crate::scene::{
    ClothSettings, Environment, Fabric, GridSettings, MeasuredFabric, MembraneTension, Method, PinPlace,
    PinSettings, Placement, RunSettings, Scene, Start, StepRule,
};
use crate::statics::{Slide, StaticSolver};
use crate::{Model, Points, State};

/// Width of a cell relative to its length at most.
const WIDEST_CELL: f64 = 4.0;

/// How far from the ratios at which springs have no tension left the cells of a specimen stay, if they can.
const RATIO_MARGIN: f64 = 1.25;

/// What a specimen is cut to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// The yarns along its length.
    pub(super) along: Along,
    /// Length and width [m].
    pub(super) size: [f64; 2],
    /// Cells along length and width.
    pub(super) cells: [usize; 2],
}

impl Cut {
    /// A specimen of `cells` along its length of `size` [m], and the fewest of at least `cells_across` along its width that
    /// the `fabric` allows.
    pub(super) fn new(
        fabric: &MeasuredFabric,
        along: Along,
        size: [f64; 2],
        cells: usize,
        cells_across: usize,
    ) -> Result<Self, LabError> {
        let [narrowest, widest] = allowed_ratios(fabric, along)?;
        let [length, width] = size;
        let spacing = length / cells as f64;
        let (low, high) = (RATIO_MARGIN * narrowest, (widest / RATIO_MARGIN).min(WIDEST_CELL));
        let ratio = if low < high { high } else { (narrowest * widest).sqrt() };
        let across = ((width / (spacing * ratio)).ceil() as usize).max(cells_across);
        let is_allowed = |across: usize| {
            let ratio = width / across as f64 / spacing;
            narrowest < ratio && ratio < widest
        };
        // Narrow cells may not be allowed.
        let Some(across) = (1..=across).rev().find(|&across| is_allowed(across)) else {
            return Err(shear_above_stretch(fabric));
        };
        Ok(Self { along, size, cells: [cells, across] })
    }
}

/// The least and largest ratio of a cell's width to its length, along `along`, at which springs have tension left.
fn allowed_ratios(fabric: &MeasuredFabric, along: Along) -> Result<[f64; 2], LabError> {
    let [narrowest, widest] = fabric.cell_ratios();
    if widest <= narrowest {
        return Err(shear_above_stretch(fabric));
    }
    // They are given for the weft as width.
    Ok(match along {
        Along::Warp => [narrowest, widest],
        Along::Weft => [1.0 / widest, 1.0 / narrowest],
    })
}

fn shear_above_stretch(fabric: &MeasuredFabric) -> LabError {
    let [warp, weft] = [&fabric.warp, &fabric.weft].map(MembraneTension::least_modulus);
    LabError::ShearAboveStretch { shear_modulus: fabric.shear_modulus, limit: (warp * weft).sqrt() }
}

/// A specimen in the plane of x and y, or bent from a plane across it, and its way so far.
///
/// Its particles are numbered along the length and across it. Some are held from the start, and moved by the test.
#[derive(Debug)]
pub(super) struct Specimen {
    model: Model,
    grid: Grid,
    along: Along,
    state: State,
    solver: StaticSolver,
    frames: Vec<Points>,
    /// The test's parameter at each frame.
    parameters: Vec<f64>,
    residual: f64,
    relative_residual: f64,
}

impl Specimen {
    /// The specimen that is `cut` from `fabric`, with its length along x, and its width along y or, if it `is_bent`, along z.
    /// The particles that `is_held` is true for, by their numbers along and across, are held.
    pub(super) fn new(
        fabric: &MeasuredFabric,
        cut: Cut,
        is_bent: bool,
        gravity: f64,
        is_held: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let Cut { along, size: [length, width], cells: [cells, cells_across] } = cut;
        let across = if is_bent { DVec3::Z } else { DVec3::Y };
        let (grid, width_axis, height_axis) = match along {
            Along::Warp => ([cells_across, cells, 0], across, DVec3::X),
            Along::Weft => ([cells, cells_across, 1], DVec3::X, across),
        };
        let [columns, rows, _] = grid.map(|cells| cells + 1);
        let [width, height] = if along == Along::Warp { [width, length] } else { [length, width] };
        let place = |along_index: usize, across_index: usize| match along {
            Along::Warp => PinPlace::Particle { column: across_index, row: along_index },
            Along::Weft => PinPlace::Particle { column: along_index, row: across_index },
        };
        let pins = (0..=cells).flat_map(|i| (0..=cells_across).map(move |j| (i, j)));
        let pins = pins.filter(|&(i, j)| is_held(i, j));
        let cloth = ClothSettings {
            name: "specimen".to_owned(),
            fabric: "fabric".to_owned(),
            grid: GridSettings { columns, rows, width, height },
            place: Placement { origin: DVec3::ZERO, width_axis, height_axis },
            pins: pins.map(|(i, j)| PinSettings { place: place(i, j), motion: None }).collect(),
        };
        let scene = scene(fabric, cloth, gravity);
        let model = Model::new(&scene);
        let state = model.initial_state(&scene);
        let (solver, grid) = (StaticSolver::new(&model), model.cloths()[0].grid);
        let (frames, parameters) = (Vec::new(), Vec::new());
        Self { model, grid, along, state, solver, frames, parameters, residual: 0.0, relative_residual: 0.0 }
    }

    /// Goes on with the way of an `earlier` specimen, which has nothing before it.
    pub(super) fn follow(&mut self, earlier: Self) {
        (self.frames, self.parameters) = (earlier.frames, earlier.parameters);
        (self.residual, self.relative_residual) = (earlier.residual, earlier.relative_residual);
    }

    /// The particle at the numbers `along` and `across`.
    pub(super) fn particle(&self, along: usize, across: usize) -> usize {
        match self.along {
            Along::Warp => self.grid.particle(across, along),
            Along::Weft => self.grid.particle(along, across),
        }
    }

    /// Numbers of particles along and across.
    pub(super) fn counts(&self) -> [usize; 2] {
        match self.along {
            Along::Warp => [self.grid.rows, self.grid.columns],
            Along::Weft => [self.grid.columns, self.grid.rows],
        }
    }

    /// All particles at the number `along`.
    pub(super) fn line(&self, along: usize) -> Vec<usize> {
        (0..self.counts()[1]).map(|across| self.particle(along, across)).collect()
    }

    /// Where all particles are [m].
    pub(super) fn positions(&self) -> &Points {
        &self.state.positions
    }

    /// Moves each particle, by its numbers along and across and its place [m], to where `place` says.
    pub(super) fn move_to(&mut self, place: impl Fn(usize, usize, DVec3) -> DVec3) {
        let [count, count_across] = self.counts();
        for i in 0..count {
            for j in 0..count_across {
                let particle = self.particle(i, j);
                let moved = place(i, j, self.state.positions.get(particle));
                self.state.positions.set(particle, moved);
            }
        }
    }

    /// Makes `load` [N], a dead one that keeps its direction, that of `particle`.
    pub(super) fn set_load(&mut self, particle: usize, load: DVec3) {
        self.solver.loads.set(particle, load);
    }

    /// Lets the specimen come to rest from where it is, at a `place` of the test in words. What fabrics remember stays.
    pub(super) fn settle(
        &mut self,
        slides: &[Slide],
        place: impl FnOnce() -> String,
    ) -> Result<(), LabError> {
        let settled = self.solver.settle(&self.model, &mut self.state, slides);
        let rest = settled.map_err(|rest| LabError::NotAtRest { place: place(), rest })?;
        self.residual = self.residual.max(rest.residual);
        if rest.rounding < rest.residual {
            self.relative_residual = self.relative_residual.max(rest.residual / rest.reference);
        }
        Ok(())
    }

    /// Takes the state at rest for the next of the test, at a `parameter` of it; once for each that is read. It becomes a
    /// frame, and from here on a fabric with a memory remembers it.
    pub(super) fn accept(&mut self, parameter: f64) {
        advance_memory(&Workers::single(), &self.model, &mut self.state);
        self.frames.push(self.state.positions.clone());
        self.parameters.push(parameter);
    }

    /// Puts the particles where they were when the test's parameter was the same, if it ever was; whether it was.
    pub(super) fn recall(&mut self, parameter: f64) -> bool {
        let frame = self.parameters.iter().rposition(|&earlier| earlier == parameter);
        if let Some(frame) = frame {
            self.state.positions.clone_from(&self.frames[frame]);
        }
        frame.is_some()
    }

    /// Guesses where the particles are at a `parameter` of the test: where they were when it was the same, or else on a straight
    /// line through the last two frames; whether there are any.
    pub(super) fn guess(&mut self, parameter: f64) -> bool {
        if self.recall(parameter) {
            return true;
        }
        let ([.., before, last], [.., earlier, latest]) = (&self.parameters[..], &self.frames[..]) else {
            return false;
        };
        let share = (parameter - last) / (last - before);
        for particle in 0..latest.len() {
            let (from, to) = (earlier.get(particle), latest.get(particle));
            self.state.positions.set(particle, to + (to - from) * share);
        }
        true
    }

    /// Force [N] that holds `particle` where it is held.
    pub(super) fn holding_force(&self, particle: usize) -> DVec3 {
        -self.solver.forces().get(particle)
    }

    /// Force [N] that holds `particles`.
    pub(super) fn clamp_force(&self, particles: &[usize]) -> DVec3 {
        particles.iter().map(|&particle| self.holding_force(particle)).sum()
    }

    /// The specimen's way.
    pub(super) fn into_record(self) -> Record {
        let Self { model, frames, residual, relative_residual, .. } = self;
        Record { model, frames, residual, relative_residual }
    }
}

/// The scene of one `cloth` of `fabric` in a `gravity` [m/s²] along −y.
fn scene(fabric: &MeasuredFabric, cloth: ClothSettings, gravity: f64) -> Scene {
    Scene {
        title: "specimen".to_owned(),
        // Nothing runs: a test has no time.
        run: RunSettings {
            duration: 1.0,
            frame_rate: 1.0,
            frame_intervals: 1,
            method: Method::CentralDifference,
            step: StepRule::Adaptive { tolerance: None },
            start: Start::Consistent,
            seed: 0,
            allow_unstable: false,
        },
        environment: Environment { gravity: DVec3::new(0.0, -gravity, 0.0), winds: Vec::new() },
        fabrics: BTreeMap::from([(cloth.fabric.clone(), Fabric::Measured(fabric.clone()))]),
        cloths: vec![cloth],
        expectations: Vec::new(),
        data_files: Vec::new(),
    }
}

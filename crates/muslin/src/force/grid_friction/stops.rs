//! The stops of the elements of a segment, which loops go over.

use super::GridFriction;
use super::limit::{LimitVisitor, SlipLimit};
use crate::force::elements::{CHUNK, Chunk};
use crate::force::stop::Stop;

/// Stops of `friction` along the elements of a chunk, as if each stood for a whole width.
///
/// There are as many of all numbers as loops are long, which is more than there are elements.
pub(super) struct Stops<'a> {
    pub(super) friction: &'a GridFriction,
    pub(super) chunk: &'a Chunk,
    pub(super) slips: &'a [f64],
}

impl Stops<'_> {
    /// One of them, with its `limit`: at a clamp it is stiffer, and yields to the same force.
    #[inline(always)]
    fn stop(&self, i: usize, limit: f64) -> Stop {
        let clamp = self.chunk.clamps[i];
        Stop {
            stiffness: self.friction.stiffness * (1.0 + clamp),
            compliance: self.friction.compliance * (1.0 - 0.5 * clamp),
            slip: self.slips[i],
            limit,
        }
    }

    /// Length of the loops.
    #[inline(always)]
    fn padded_len(&self) -> usize {
        // The same, which the compiler cannot know.
        self.chunk.padded_len().min(self.slips.len())
    }

    /// Overwrites `factors` with the negative forces along the coordinates, which gradients have to be multiplied by.
    #[inline(always)]
    pub(super) fn eval_factors(&self, factors: &mut [f64; CHUNK]) {
        self.friction.limit.visit(EvalFactors { stops: self, factors });
    }

    /// Multiplies `factors` by the tangents along the coordinates.
    #[inline(always)]
    pub(super) fn multiply_by_tangents(&self, factors: &mut [f64; CHUNK]) {
        self.friction.limit.visit(MultiplyByTangents { stops: self, factors });
    }

    /// Overwrites `slipped` with the slips once they are up to date, and adds to `losses` what that loses.
    #[inline(always)]
    pub(super) fn slip(&self, slipped: &mut [f64; CHUNK], losses: &mut [f64; CHUNK]) {
        self.friction.limit.visit(Slip { stops: self, slipped, losses });
    }

    /// Adds to `energies` what they hold.
    #[inline(always)]
    pub(super) fn add_energies(&self, energies: &mut [f64; CHUNK]) {
        self.friction.limit.visit(AddEnergies { stops: self, energies });
    }
}

struct EvalFactors<'a> {
    stops: &'a Stops<'a>,
    factors: &'a mut [f64; CHUNK],
}

impl LimitVisitor for EvalFactors<'_> {
    #[inline(always)]
    fn visit<L: SlipLimit>(self, limit: L) {
        let Self { stops, factors } = self;
        for (i, factor) in factors[..stops.padded_len()].iter_mut().enumerate() {
            let coordinate = stops.chunk.coordinates[i];
            let [limit, _] = limit.limit_and_growth(coordinate);
            *factor = -stops.chunk.widths[i] * stops.stop(i, limit).force(coordinate);
        }
    }
}

struct MultiplyByTangents<'a> {
    stops: &'a Stops<'a>,
    factors: &'a mut [f64; CHUNK],
}

impl LimitVisitor for MultiplyByTangents<'_> {
    #[inline(always)]
    fn visit<L: SlipLimit>(self, limit: L) {
        let Self { stops, factors } = self;
        for (i, factor) in factors[..stops.padded_len()].iter_mut().enumerate() {
            let coordinate = stops.chunk.coordinates[i];
            let [limit, growth] = limit.limit_and_growth(coordinate);
            *factor *= stops.chunk.widths[i] * stops.stop(i, limit).tangent(coordinate, growth);
        }
    }
}

struct Slip<'a> {
    stops: &'a Stops<'a>,
    slipped: &'a mut [f64; CHUNK],
    losses: &'a mut [f64; CHUNK],
}

impl LimitVisitor for Slip<'_> {
    #[inline(always)]
    fn visit<L: SlipLimit>(self, limit: L) {
        let Self { stops, slipped, losses } = self;
        for i in 0..stops.padded_len() {
            let coordinate = stops.chunk.coordinates[i];
            let [limit, growth] = limit.limit_and_growth(coordinate);
            let stop = stops.stop(i, limit);
            slipped[i] = stop.slipped(coordinate);
            let loss = if L::GROWS { stop.loss(slipped[i], growth) } else { stop.constant_loss(slipped[i]) };
            losses[i] += stops.chunk.widths[i] * loss;
        }
    }
}

struct AddEnergies<'a> {
    stops: &'a Stops<'a>,
    energies: &'a mut [f64; CHUNK],
}

impl LimitVisitor for AddEnergies<'_> {
    #[inline(always)]
    fn visit<L: SlipLimit>(self, limit: L) {
        let Self { stops, energies } = self;
        for (i, energy) in energies[..stops.padded_len()].iter_mut().enumerate() {
            let coordinate = stops.chunk.coordinates[i];
            let [limit, _] = limit.limit_and_growth(coordinate);
            *energy += stops.chunk.widths[i] * stops.stop(i, limit).energy(coordinate);
        }
    }
}

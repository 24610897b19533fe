//! The springs of a tile, each with a coefficient.

use std::ops::Range;

use super::GridBending;
use super::bending::LineRigidity;
use super::grid_laws::Lines;
use super::grid_springs::GridFamily;
use super::law::{Cubic, LawVisitor, TensionLaw};
use super::row_sums::{ABOVE, FarPulls, PAD};
use super::spring::{Spring, SpringLength};
use super::tile::{Coordinates, Ends, SHAPES, STRIDE, Shape, TILE, Tile, cell};
use crate::model::Grid;
use crate::points::set_all;
use crate::scene::ForceDirection;

/// Something of every spring of a tile: by family in the order of [`Family::ALL`](super::Family::ALL), direction and
/// particle.
type OfSprings = [[OfTile; 2]; 3];

/// Something of the springs of one family and direction.
type OfTile = [f64; ROOM];

/// Not a power of two: what is a page apart, processors confuse.
const ROOM: usize = TILE + 8;

const ZERO: OfSprings = [[[0.0; ROOM]; 2]; 3];

/// The springs of a tile.
///
/// They are found in three passes, whose loops are short enough for a processor to look ahead in them: squared lengths with a
/// first guess of what one divides by, for all springs alike; coefficients, by the law of each family; and the pull along
/// each axis, again for all alike. Arrays come first, so that each begins with a line of the cache.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct TileSprings {
    /// Squared lengths [m²], in whose place come [stiffnesses](Self::stiffnesses).
    squares: OfSprings,
    /// First guesses of the inverse lengths [1/m], in whose place come coefficients c [N/m] of the forces: F = c d with the
    /// vector d from end to end; zero where there is no spring. In the places of bend springs also b_x and b_y of a rigidity
    /// [N/m]. Or those of [tensors](Self::eval_tensors), c [N/m³].
    pub(super) coefficients: OfSprings,
    /// The tile of inner rows, by their number and the columns, whose coefficients of a rigidity are in the places of bend
    /// springs; the next one like it need not set them again.
    rigid_tile: Option<(usize, Range<usize>)>,
}

impl TileSprings {
    pub(super) const ZERO: Self = Self { squares: ZERO, coefficients: ZERO, rigid_tile: None };

    /// Forgets what is of another grid.
    pub(super) fn restart(&mut self) {
        self.rigid_tile = None;
    }

    /// Finds the lengths of all springs of a tile whose coordinates are x, y and z; not of bend springs if there are none.
    #[inline(always)]
    pub(super) fn eval_lengths(
        &mut self,
        [x, y, z]: [Coordinates<'_>; 3],
        has_bend_springs: bool,
        tile: &Tile,
    ) {
        let (squares, guesses) = (&mut self.squares, &mut self.coefficients);
        if has_bend_springs {
            eval_lengths::<true>(squares, guesses, (x, y, z), tile.padded_len());
        } else {
            eval_lengths::<false>(squares, guesses, (x, y, z), tile.padded_len());
        }
    }

    /// Finds the lengths of all springs of a tile of `grid`, which has no bend springs, and the `far` pulls of its `bending`.
    #[inline(always)]
    pub(super) fn eval_lengths_and_bends(
        &mut self,
        [x, y, z]: [Coordinates<'_>; 3],
        bending: &GridBending,
        far: &mut [FarPulls; 3],
        tile: &Tile,
        grid: &Grid,
    ) {
        let rigidities = bending.rigidities();
        let is_inner = 0 < tile.rows.start && tile.rows.end + SHAPES[2][1].rows <= grid.rows;
        let rigid_tile = is_inner.then(|| (tile.rows.len(), tile.columns.clone()));
        if rigid_tile.is_none() || self.rigid_tile != rigid_tile {
            for ((values, rigidity), shape) in self.coefficients[2].iter_mut().zip(rigidities).zip(&SHAPES[2])
            {
                set_all(&mut values[..tile.padded_len()], rigidity.coefficient);
                clear_absent(values, shape, tile, grid);
                halve_edges(values, shape, tile, grid);
            }
            self.rigid_tile = rigid_tile;
        }
        let arrays = (&mut self.squares, &mut self.coefficients);
        eval_lengths_and_bends(arrays, rigidities, far, (x, y, z), tile.padded_len());
    }

    /// Squared lengths [m²] of the springs in a place of a `tile` of `grid`, zero where there is none; a multiple of eight.
    #[inline(always)]
    pub(super) fn squares(&mut self, [index, direction]: [usize; 2], tile: &Tile, grid: &Grid) -> &[f64] {
        let squares = &mut self.squares[index][direction];
        clear_absent(squares, &SHAPES[index][direction], tile, grid);
        squares[tile.len()..tile.padded_len()].fill(0.0);
        &squares[..tile.padded_len()]
    }

    /// Finds the coefficients of the springs of a family, by its `index`, and `direction` in a `tile` of `grid`, under the
    /// law of a `group`, each with that of a `twist` [N/m] beside it, and if they are `bounded` their stiffness, zero where it
    /// never varies; without a group there are none.
    #[inline(always)]
    pub(super) fn eval_coefficients(
        &mut self,
        place: [usize; 2],
        (group, twist): (Option<&GridFamily>, f64),
        bounded: bool,
        tile: &Tile,
        grid: &Grid,
    ) {
        let count = tile.padded_len();
        let Some(Place { group, spring, squares, coefficients }) = self.place(place, group, count) else {
            if twist != 0.0 {
                let [index, direction] = place;
                let lines = if index == 0 { Lines::Inner } else { Lines::All };
                let coefficients = &mut self.coefficients[index][direction];
                set_all(&mut coefficients[..count], twist);
                mend(coefficients, lines, place, tile, grid);
            }
            return;
        };
        let varies = bounded && !group.has_constant_stiffness();
        let arrays = (&mut coefficients[..count], &mut squares[..count]);
        match (varies, twist != 0.0) {
            (false, false) => {
                group.law.visit(EvalCoefficients::<false, false> { spring, twist, arrays });
            }
            (false, true) => {
                group.law.visit(EvalCoefficients::<false, true> { spring, twist, arrays });
            }
            (true, false) => {
                group.law.visit(EvalCoefficients::<true, false> { spring, twist, arrays });
            }
            (true, true) => {
                group.law.visit(EvalCoefficients::<true, true> { spring, twist, arrays });
            }
        }
        mend(coefficients, group.lines, place, tile, grid);
        if varies {
            mend(squares, group.lines, place, tile, grid);
        } else if bounded {
            squares[..count].fill(0.0);
        }
    }

    /// Stiffness [N/m] in place of squared lengths, where it varies; for tensors that across the springs, zero where there is none.
    #[inline(always)]
    pub(super) fn stiffnesses(&self) -> &OfSprings {
        &self.squares
    }

    /// Finds, for the same springs, what their stiffness tensors c d dᵀ + a 1 are made of, times a `weight`: coefficients c, and
    /// stiffnesses a [N/m] across them.
    #[inline(always)]
    pub(super) fn eval_tensors(
        &mut self,
        place: [usize; 2],
        (group, weight): (Option<&GridFamily>, f64),
        tile: &Tile,
        grid: &Grid,
    ) {
        let count = tile.padded_len();
        let Some(Place { group, spring, squares, coefficients }) = self.place(place, group, count) else {
            return;
        };
        let arrays = (&mut coefficients[..count], &mut squares[..count]);
        group.law.visit(EvalTensors { spring, weight, arrays });
        mend(coefficients, group.lines, place, tile, grid);
        mend(squares, group.lines, place, tile, grid);
    }

    /// The springs in a place, of the first `count` particles; without any, all that is kept of them becomes zero.
    #[inline(always)]
    fn place<'a>(
        &'a mut self,
        [index, direction]: [usize; 2],
        group: Option<&'a GridFamily>,
        count: usize,
    ) -> Option<Place<'a>> {
        let squares = &mut self.squares[index][direction];
        let coefficients = &mut self.coefficients[index][direction];
        let spring = group.and_then(|group| Some((group, group.spring_of((), direction)?)));
        let Some((group, spring)) = spring else {
            coefficients[..count].fill(0.0);
            squares[..count].fill(0.0);
            return None;
        };
        Some(Place { group, spring, squares, coefficients })
    }
}

/// The springs of a family and direction in a tile.
struct Place<'a> {
    group: &'a GridFamily,
    /// But for its law.
    spring: Spring<()>,
    squares: &'a mut OfTile,
    coefficients: &'a mut OfTile,
}

/// Clears the `values` of what are no springs, and halves those of springs along edges if these are in other `lines`, and half
/// as stiff.
#[inline(always)]
fn mend(values: &mut OfTile, lines: Lines, [index, direction]: [usize; 2], tile: &Tile, grid: &Grid) {
    let shape = &SHAPES[index][direction];
    clear_absent(values, shape, tile, grid);
    if lines == Lines::Inner {
        halve_edges(values, shape, tile, grid);
    }
}

/// The vector [m] from one point to another.
#[inline(always)]
fn vector(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

#[inline(always)]
fn square([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
}

#[inline(always)]
fn eval_lengths<const BEND: bool>(
    squares: &mut OfSprings,
    guesses: &mut OfSprings,
    (x, y, z): (Coordinates<'_>, Coordinates<'_>, Coordinates<'_>),
    count: usize,
) {
    let count = count.min(TILE);
    let (x, y, z) = (Ends::of(x, count), Ends::of(y, count), Ends::of(z, count));
    let [[across, down], [diagonal, other_diagonal], [far_across, far_down]] = squares;
    let [
        [across_guess, down_guess],
        [diagonal_guess, other_diagonal_guess],
        [far_across_guess, far_down_guess],
    ] = guesses;
    for i in 0..count {
        let [own, right, below, below_right] = cell([x, y, z], i);
        across[i] = square(vector(own, right));
        down[i] = square(vector(own, below));
        diagonal[i] = square(vector(own, below_right));
        other_diagonal[i] = square(vector(right, below));
        across_guess[i] = SpringLength::guess_inverse(across[i]);
        down_guess[i] = SpringLength::guess_inverse(down[i]);
        diagonal_guess[i] = SpringLength::guess_inverse(diagonal[i]);
        other_diagonal_guess[i] = SpringLength::guess_inverse(other_diagonal[i]);
    }
    // In a loop of its own, for which there are registers with the places of all rows.
    if BEND {
        for i in 0..count {
            let own = [x.own[i], y.own[i], z.own[i]];
            far_across[i] = square(vector(own, [x.far_right[i], y.far_right[i], z.far_right[i]]));
            far_down[i] = square(vector(own, [x.far_down[i], y.far_down[i], z.far_down[i]]));
            far_across_guess[i] = SpringLength::guess_inverse(far_across[i]);
            far_down_guess[i] = SpringLength::guess_inverse(far_down[i]);
        }
    }
}

/// The same with first guesses, and what pulls at the next particles but one since lines resist bending, with the coefficients
/// [N/m] in the places of bend springs.
#[inline(always)]
fn eval_lengths_and_bends(
    (squares, guesses): (&mut OfSprings, &mut OfSprings),
    [across_rigidity, along_rigidity]: [LineRigidity; 2],
    [far_x, far_y, far_z]: &mut [FarPulls; 3],
    (x, y, z): (Coordinates<'_>, Coordinates<'_>, Coordinates<'_>),
    count: usize,
) {
    let count = count.min(TILE);
    let (x, y, z) = (Ends::of(x, count), Ends::of(y, count), Ends::of(z, count));
    let [[across, down], [diagonal, other_diagonal], _] = squares;
    let [[across_guess, down_guess], [diagonal_guess, other_diagonal_guess], [across_c, along_c]] = guesses;
    let (right_x, down_x) = (&mut far_x.right[PAD..][..count], &mut far_x.down[ABOVE..][..count]);
    let (right_y, down_y) = (&mut far_y.right[PAD..][..count], &mut far_y.down[ABOVE..][..count]);
    let (right_z, down_z) = (&mut far_z.right[PAD..][..count], &mut far_z.down[ABOVE..][..count]);
    for i in 0..count {
        let [own, right, below, below_right] = cell([x, y, z], i);
        let (to_right, to_below) = (vector(own, right), vector(own, below));
        across[i] = square(to_right);
        down[i] = square(to_below);
        diagonal[i] = square(vector(own, below_right));
        other_diagonal[i] = square(vector(right, below));
        across_guess[i] = SpringLength::guess_inverse(across[i]);
        down_guess[i] = SpringLength::guess_inverse(down[i]);
        diagonal_guess[i] = SpringLength::guess_inverse(diagonal[i]);
        other_diagonal_guess[i] = SpringLength::guess_inverse(other_diagonal[i]);
        let far_right = [x.far_right[i], y.far_right[i], z.far_right[i]];
        let second = vector(to_right, vector(right, far_right));
        let c = across_rigidity.with_coefficient(across_c[i]).force_coefficient(square(second));
        (right_x[i], right_y[i], right_z[i]) = (c * second[0], c * second[1], c * second[2]);
        let far_below = [x.far_down[i], y.far_down[i], z.far_down[i]];
        let second = vector(to_below, vector(below, far_below));
        let c = along_rigidity.with_coefficient(along_c[i]).force_coefficient(square(second));
        (down_x[i], down_y[i], down_z[i]) = (c * second[0], c * second[1], c * second[2]);
    }
}

/// Finds coefficients, if `TWISTED` with that of a twist [N/m], and if `BOUNDED` in place of squared lengths stiffnesses [N/m] of springs
/// under one law.
struct EvalCoefficients<'a, const BOUNDED: bool, const TWISTED: bool> {
    /// But for its law.
    spring: Spring<()>,
    twist: f64,
    /// Of coefficients, and of squared lengths.
    arrays: (&'a mut [f64], &'a mut [f64]),
}

impl<const BOUNDED: bool, const TWISTED: bool> LawVisitor for EvalCoefficients<'_, BOUNDED, TWISTED> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { spring, twist, arrays: (coefficients, squares) } = self;
        let spring = (spring.with_law(law), twist);
        if L::HAS_CUBICS {
            eval_by_eights::<L, BOUNDED, TWISTED>(&spring, squares, coefficients);
        } else {
            eval_by_direction::<L, BOUNDED, TWISTED>(spring, squares, coefficients);
        }
    }
}

/// Eight springs at a time under a law of cubics, most often all at one: each is evaluated for all eight, and those keep it at which it has
/// begun, until the next has.
#[inline(always)]
fn eval_by_eights<L: TensionLaw, const BOUNDED: bool, const TWISTED: bool>(
    (spring, twist): &(Spring<L>, f64),
    squares: &mut [f64],
    coefficients: &mut [f64],
) {
    let &Spring { ref law, rest_length, direction } = spring;
    let (squares, _) = squares.as_chunks_mut::<STRIDE>();
    let (coefficients, _) = coefficients.as_chunks_mut::<STRIDE>();
    for (squares, coefficients) in squares.iter_mut().zip(coefficients) {
        let (known_squares, guesses) = (*squares, *coefficients);
        let mut extensions = [0.0; STRIDE];
        for i in 0..STRIDE {
            extensions[i] = SpringLength::from_guess(known_squares[i], guesses[i]).length - rest_length;
        }
        for (index, &law) in law.cubics(least_and_most(&extensions), rest_length).iter().enumerate() {
            let (mut stiffnesses, mut found) = (known_squares, guesses);
            let spring = (Spring { law, rest_length, direction }, *twist);
            eval_by_direction::<Cubic, BOUNDED, TWISTED>(spring, &mut stiffnesses, &mut found);
            for i in 0..STRIDE {
                let has_begun = index == 0 || law.has_begun(extensions[i], rest_length);
                squares[i] = if has_begun { stiffnesses[i] } else { squares[i] };
                coefficients[i] = if has_begun { found[i] } else { coefficients[i] };
            }
        }
    }
}

/// The least and the most of eight numbers, of those that are numbers.
#[inline(always)]
fn least_and_most(values: &[f64; STRIDE]) -> [f64; 2] {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in values {
        least = if value < least { value } else { least };
        most = if most < value { value } else { most };
    }
    [least, most]
}

/// A loop for each direction of the force.
#[inline(always)]
fn eval_by_direction<L: TensionLaw, const BOUNDED: bool, const TWISTED: bool>(
    spring: (Spring<L>, f64),
    squares: &mut [f64],
    coefficients: &mut [f64],
) {
    match spring.0.direction {
        ForceDirection::CurrentLength => {
            eval_coefficients::<L, BOUNDED, TWISTED, true>(spring, squares, coefficients);
        }
        ForceDirection::RestLength => {
            eval_coefficients::<L, BOUNDED, TWISTED, false>(spring, squares, coefficients);
        }
    }
}

/// The same with a direction that is known: by the length of springs that is `CURRENT` or at rest.
#[inline(always)]
fn eval_coefficients<L: TensionLaw, const BOUNDED: bool, const TWISTED: bool, const CURRENT: bool>(
    (spring, twist): (Spring<L>, f64),
    squares: &mut [f64],
    coefficients: &mut [f64],
) {
    let direction = if CURRENT { ForceDirection::CurrentLength } else { ForceDirection::RestLength };
    let spring = Spring { direction, ..spring };
    let count = coefficients.len();
    let squares = &mut squares[..count];
    for i in 0..count {
        let length = SpringLength::from_guess(squares[i], coefficients[i]);
        let coefficient = if BOUNDED {
            let (coefficient, stiffness) = spring.coefficient_and_stiffness(length);
            squares[i] = stiffness;
            coefficient
        } else {
            spring.coefficient(length)
        };
        coefficients[i] = if TWISTED { coefficient + twist } else { coefficient };
    }
}

/// Finds what the stiffness tensors of springs under one law are made of.
struct EvalTensors<'a> {
    /// But for its law.
    spring: Spring<()>,
    weight: f64,
    /// Of coefficients, and of squared lengths.
    arrays: (&'a mut [f64], &'a mut [f64]),
}

impl LawVisitor for EvalTensors<'_> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { spring, weight, arrays: (coefficients, squares) } = self;
        eval_tensors(&spring.with_law(law), weight, squares, coefficients);
    }
}

#[inline(always)]
fn eval_tensors<L: TensionLaw>(
    spring: &Spring<L>,
    weight: f64,
    squares: &mut [f64],
    coefficients: &mut [f64],
) {
    let count = coefficients.len();
    let squares = &mut squares[..count];
    for i in 0..count {
        let length = SpringLength::from_guess(squares[i], coefficients[i]);
        let [along, across] = spring.stiffnesses(length);
        let inverse = length.inverse;
        coefficients[i] = weight * (along - across) * inverse * inverse;
        squares[i] = weight * across;
    }
}

/// Clears the `values` of what are no springs since they lead out of the grid.
#[inline(always)]
fn clear_absent(values: &mut OfTile, shape: &Shape, tile: &Tile, grid: &Grid) {
    let Tile { rows, columns } = tile;
    let (width, count) = (columns.len(), tile.len().min(TILE));
    // Up to two in a row, which are not worth a call.
    for column in grid.columns.saturating_sub(shape.reach()).max(columns.start)..columns.end {
        let mut at = column - columns.start;
        while at < count {
            values[at] = 0.0;
            at += width;
        }
    }
    let below = grid.rows.saturating_sub(shape.rows).max(rows.start);
    if below < rows.end {
        let first = (below - rows.start) * width;
        let absent = &mut values[first..][..(count - first).next_multiple_of(STRIDE)];
        for eight in absent.as_chunks_mut::<STRIDE>().0 {
            *eight = [0.0; STRIDE];
        }
    }
}

/// Halves the `values` of springs that lie along the edges of a grid: they stand for half as wide a strip of cloth.
#[inline(always)]
fn halve_edges(values: &mut OfTile, shape: &Shape, tile: &Tile, grid: &Grid) {
    let Tile { rows, columns } = tile;
    let count = columns.len();
    if shape.rows > 0 {
        let ends = [(columns.start == 0, 0), (columns.end == grid.columns, count - 1)];
        for (is_edge, column) in ends {
            if is_edge {
                let mut at = column;
                while at < tile.len().min(TILE) {
                    values[at] *= 0.5;
                    at += count;
                }
            }
        }
    } else if rows.start == 0 || rows.end == grid.rows {
        for (row, values) in rows.clone().zip(values[..tile.len()].chunks_exact_mut(count)) {
            if row == 0 || row + 1 == grid.rows {
                values.iter_mut().for_each(|value| *value *= 0.5);
            }
        }
    }
}

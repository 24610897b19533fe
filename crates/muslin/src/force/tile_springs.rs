//! The springs of a tile, each with a coefficient.

use super::grid_laws::Lines;
use super::grid_springs::GridFamily;
use super::law::{LawVisitor, TensionLaw};
use super::spring::{Spring, SpringLength};
use super::tile::{Coordinates, SHAPES, Shape, TILE, Tile};
use crate::model::Grid;
use crate::points::set_all;

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
/// each axis, again for all alike.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct TileSprings {
    /// Squared lengths [m²].
    squares: OfSprings,
    /// First guesses of the inverse lengths [1/m], in whose place come coefficients c [N/m] of the forces: F = c d with the
    /// vector d from end to end; zero where there is no spring. Or those of [tensors](Self::eval_tensors), c [N/m³].
    pub(super) coefficients: OfSprings,
    /// Stiffness [N/m], where it varies; for tensors that across the springs, zero where there is none.
    pub(super) stiffnesses: OfSprings,
    /// Of a rigidity, coefficients [N/m] of the cells that begin at a particle; those of its second differences are in the
    /// places of bend springs.
    pub(super) twists: OfTile,
}

impl TileSprings {
    pub(super) const ZERO: Self =
        Self { squares: ZERO, coefficients: ZERO, stiffnesses: ZERO, twists: [0.0; ROOM] };

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
            eval_lengths::<true, true>(squares, guesses, (x, y, z), tile.padded_len());
        } else {
            eval_lengths::<false, true>(squares, guesses, (x, y, z), tile.padded_len());
        }
    }

    /// Finds squared lengths [m²] alone: of the springs of a family by its index and direction they are then to be had from
    /// [`squares`](Self::squares).
    #[inline(always)]
    pub(super) fn eval_squares(
        &mut self,
        coordinates: [Coordinates<'_>; 3],
        has_bend_springs: bool,
        tile: &Tile,
    ) {
        let [x, y, z] = coordinates;
        if has_bend_springs {
            eval_lengths::<true, false>(
                &mut self.squares,
                &mut self.coefficients,
                (x, y, z),
                tile.padded_len(),
            );
        } else {
            eval_lengths::<false, false>(
                &mut self.squares,
                &mut self.coefficients,
                (x, y, z),
                tile.padded_len(),
            );
        }
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
    /// law of a `group`, and if they are `bounded` their stiffness, zero where it never varies; without a group there are
    /// none.
    #[inline(always)]
    pub(super) fn eval_coefficients(
        &mut self,
        place: [usize; 2],
        group: Option<&GridFamily>,
        bounded: bool,
        tile: &Tile,
        grid: &Grid,
    ) {
        let count = tile.padded_len();
        let Some(Place { group, spring, squares, coefficients, stiffnesses }) =
            self.place(place, group, count)
        else {
            return;
        };
        let varies = bounded && !group.has_constant_stiffness();
        let arrays = (&mut coefficients[..count], &mut stiffnesses[..count]);
        if varies {
            group.law.visit(EvalCoefficients::<true> { spring, squares, arrays });
        } else {
            group.law.visit(EvalCoefficients::<false> { spring, squares, arrays });
            if bounded {
                stiffnesses[..count].fill(0.0);
            }
        }
        mend(coefficients, group, place, tile, grid);
        if varies {
            mend(stiffnesses, group, place, tile, grid);
        }
    }

    /// Sets the coefficients of a rigidity b_x, b_y and d [N/m] in a `tile` of `grid`, in place of those of bend springs.
    #[inline(always)]
    pub(super) fn set_rigidity(&mut self, [across, along, twist]: [f64; 3], tile: &Tile, grid: &Grid) {
        let [_, [_, diagonal], bend] = &SHAPES;
        for ((values, coefficient), shape) in self.coefficients[2].iter_mut().zip([across, along]).zip(bend) {
            set_all(&mut values[..tile.padded_len()], coefficient);
            clear_absent(values, shape, tile, grid);
            halve_edges(values, shape, tile, grid);
        }
        set_all(&mut self.twists[..tile.padded_len()], twist);
        clear_absent(&mut self.twists, diagonal, tile, grid);
    }

    /// Finds, for the same springs, what their stiffness tensors c d dᵀ + a 1 are made of: coefficients c, and stiffnesses
    /// a [N/m] across them.
    #[inline(always)]
    pub(super) fn eval_tensors(
        &mut self,
        place: [usize; 2],
        group: Option<&GridFamily>,
        tile: &Tile,
        grid: &Grid,
    ) {
        let count = tile.padded_len();
        let Some(Place { group, spring, squares, coefficients, stiffnesses }) =
            self.place(place, group, count)
        else {
            return;
        };
        let arrays = (&mut coefficients[..count], &mut stiffnesses[..count]);
        group.law.visit(EvalTensors { spring, squares, arrays });
        mend(coefficients, group, place, tile, grid);
        mend(stiffnesses, group, place, tile, grid);
    }

    /// The springs in a place, of the first `count` particles; without any, all that is kept of them becomes zero.
    #[inline(always)]
    fn place<'a>(
        &'a mut self,
        [index, direction]: [usize; 2],
        group: Option<&'a GridFamily>,
        count: usize,
    ) -> Option<Place<'a>> {
        let squares = &self.squares[index][direction][..count];
        let coefficients = &mut self.coefficients[index][direction];
        let stiffnesses = &mut self.stiffnesses[index][direction];
        let spring = group.and_then(|group| Some((group, group.spring_of((), direction)?)));
        let Some((group, spring)) = spring else {
            coefficients[..count].fill(0.0);
            stiffnesses[..count].fill(0.0);
            return None;
        };
        Some(Place { group, spring, squares, coefficients, stiffnesses })
    }
}

/// The springs of a family and direction in a tile.
struct Place<'a> {
    group: &'a GridFamily,
    /// But for its law.
    spring: Spring<()>,
    squares: &'a [f64],
    coefficients: &'a mut OfTile,
    stiffnesses: &'a mut OfTile,
}

/// Clears the `values` of what are no springs of a `group`, and halves those of springs along edges if these are half as stiff.
#[inline(always)]
fn mend(values: &mut OfTile, group: &GridFamily, [index, direction]: [usize; 2], tile: &Tile, grid: &Grid) {
    let shape = &SHAPES[index][direction];
    clear_absent(values, shape, tile, grid);
    if group.lines == Lines::Inner {
        halve_edges(values, shape, tile, grid);
    }
}

/// One coordinate [m] of the particles that springs begin and end at, one per particle of a tile.
#[derive(Clone, Copy)]
pub(super) struct Ends<'a> {
    pub(super) own: &'a [f64],
    pub(super) right: &'a [f64],
    pub(super) far_right: &'a [f64],
    pub(super) down: &'a [f64],
    pub(super) down_right: &'a [f64],
    pub(super) far_down: &'a [f64],
}

impl<'a> Ends<'a> {
    #[inline(always)]
    pub(super) fn of(Coordinates { rows: [own, next, last] }: Coordinates<'a>, count: usize) -> Self {
        Self {
            own: &own[..count],
            right: &own[1..][..count],
            far_right: &own[2..][..count],
            down: &next[..count],
            down_right: &next[1..][..count],
            far_down: &last[..count],
        }
    }
}

#[inline(always)]
fn eval_lengths<const BEND: bool, const GUESS: bool>(
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
        let square = |from: [f64; 3], to: [f64; 3]| {
            let [dx, dy, dz] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
            dx * dx + dy * dy + dz * dz
        };
        let own = [x.own[i], y.own[i], z.own[i]];
        let right = [x.right[i], y.right[i], z.right[i]];
        let below = [x.down[i], y.down[i], z.down[i]];
        let below_right = [x.down_right[i], y.down_right[i], z.down_right[i]];
        across[i] = square(own, right);
        down[i] = square(own, below);
        diagonal[i] = square(own, below_right);
        other_diagonal[i] = square(right, below);
        if GUESS {
            across_guess[i] = SpringLength::guess_inverse(across[i]);
            down_guess[i] = SpringLength::guess_inverse(down[i]);
            diagonal_guess[i] = SpringLength::guess_inverse(diagonal[i]);
            other_diagonal_guess[i] = SpringLength::guess_inverse(other_diagonal[i]);
        }
        if BEND {
            far_across[i] = square(own, [x.far_right[i], y.far_right[i], z.far_right[i]]);
            far_down[i] = square(own, [x.far_down[i], y.far_down[i], z.far_down[i]]);
        }
        if BEND && GUESS {
            far_across_guess[i] = SpringLength::guess_inverse(far_across[i]);
            far_down_guess[i] = SpringLength::guess_inverse(far_down[i]);
        }
    }
}

/// Finds coefficients and, if `BOUNDED`, stiffnesses [N/m] of springs under one law.
struct EvalCoefficients<'a, const BOUNDED: bool> {
    /// But for its law.
    spring: Spring<()>,
    squares: &'a [f64],
    arrays: (&'a mut [f64], &'a mut [f64]),
}

impl<const BOUNDED: bool> LawVisitor for EvalCoefficients<'_, BOUNDED> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { spring, squares, arrays: (coefficients, stiffnesses) } = self;
        let spring = spring.with_law(law);
        if BOUNDED {
            eval_bounded(&spring, squares, coefficients, stiffnesses);
        } else {
            eval(&spring, squares, coefficients);
        }
    }
}

#[inline(always)]
fn eval<L: TensionLaw>(spring: &Spring<L>, squares: &[f64], coefficients: &mut [f64]) {
    let count = coefficients.len();
    let squares = &squares[..count];
    for i in 0..count {
        coefficients[i] = spring.coefficient(SpringLength::from_guess(squares[i], coefficients[i]));
    }
}

#[inline(always)]
fn eval_bounded<L: TensionLaw>(
    spring: &Spring<L>,
    squares: &[f64],
    coefficients: &mut [f64],
    stiffnesses: &mut [f64],
) {
    let count = coefficients.len();
    let squares = &squares[..count];
    let stiffnesses = &mut stiffnesses[..count];
    for i in 0..count {
        let length = SpringLength::from_guess(squares[i], coefficients[i]);
        (coefficients[i], stiffnesses[i]) = spring.coefficient_and_stiffness(length);
    }
}

/// Finds what the stiffness tensors of springs under one law are made of.
struct EvalTensors<'a> {
    /// But for its law.
    spring: Spring<()>,
    squares: &'a [f64],
    arrays: (&'a mut [f64], &'a mut [f64]),
}

impl LawVisitor for EvalTensors<'_> {
    #[inline(always)]
    fn visit<L: TensionLaw>(self, law: L) {
        let Self { spring, squares, arrays: (coefficients, stiffnesses) } = self;
        eval_tensors(&spring.with_law(law), squares, coefficients, stiffnesses);
    }
}

#[inline(always)]
fn eval_tensors<L: TensionLaw>(
    spring: &Spring<L>,
    squares: &[f64],
    coefficients: &mut [f64],
    stiffnesses: &mut [f64],
) {
    let count = coefficients.len();
    let squares = &squares[..count];
    let stiffnesses = &mut stiffnesses[..count];
    for i in 0..count {
        let length = SpringLength::from_guess(squares[i], coefficients[i]);
        let [along, across] = spring.stiffnesses(length);
        coefficients[i] = (along - across) * length.inverse * length.inverse;
        stiffnesses[i] = across;
    }
}

/// Clears the `values` of what are no springs since they lead out of the grid.
#[inline(always)]
fn clear_absent(values: &mut OfTile, shape: &Shape, tile: &Tile, grid: &Grid) {
    let columns = tile.columns.len();
    // Up to two in a row, which are not worth a call.
    let lacking = (tile.columns.end + shape.reach()).saturating_sub(grid.columns).min(columns);
    for lack in 1..=lacking {
        values[..tile.len()].iter_mut().skip(columns - lack).step_by(columns).for_each(|value| *value = 0.0);
    }
    let below = grid.rows.saturating_sub(shape.rows).clamp(tile.rows.start, tile.rows.end);
    values[(below - tile.rows.start) * columns..tile.len()].fill(0.0);
}

/// Halves the `values` of springs that lie along the edges of a grid: they stand for half as wide a strip of cloth.
#[inline(always)]
fn halve_edges(values: &mut OfTile, shape: &Shape, tile: &Tile, grid: &Grid) {
    let Tile { rows, columns } = tile;
    let count = columns.len();
    let values = &mut values[..tile.len()];
    if shape.rows > 0 {
        let ends = [(columns.start == 0, 0), (columns.end == grid.columns, count - 1)];
        for (is_edge, column) in ends {
            if is_edge {
                values[column..].iter_mut().step_by(count).for_each(|value| *value *= 0.5);
            }
        }
    } else if rows.start == 0 || rows.end == grid.rows {
        for (row, values) in rows.clone().zip(values.chunks_exact_mut(count)) {
            if row == 0 || row + 1 == grid.rows {
                values.iter_mut().for_each(|value| *value *= 0.5);
            }
        }
    }
}

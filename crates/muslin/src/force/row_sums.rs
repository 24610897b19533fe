//! What the springs of a row do to its particles and to later rows, one coordinate at a time.

/// Adds all forces [N] along one axis on the particles of a tile: those from earlier rows, and those of the springs whose own
/// end they are, or whose other end in the same row.
#[inline(always)]
pub(super) fn gather(
    forces: &mut [f64],
    above: &[f64],
    (across, across_before): (&[f64], &[f64]),
    down: &[f64],
    (diagonal, other_diagonal): (&[f64], &[f64]),
    (far_across, far_across_before): (&[f64], &[f64]),
    far_down: &[f64],
) {
    let count = forces.len();
    let (above, across, across_before) = (&above[..count], &across[..count], &across_before[..count]);
    let (down, diagonal, other_diagonal) = (&down[..count], &diagonal[..count], &other_diagonal[..count]);
    let (far_across, far_across_before) = (&far_across[..count], &far_across_before[..count]);
    let far_down = &far_down[..count];
    for i in 0..count {
        let structural = above[i] + (across[i] - across_before[i]) + down[i];
        let shear = diagonal[i] + other_diagonal[i];
        let bend = (far_across[i] - far_across_before[i]) + far_down[i];
        forces[i] += structural + shear + bend;
    }
}

/// What [`gather`] and [`pass_down`] do together, with the same bits, for rows of `columns` from the third of a strip on;
/// the first of its springs has number 2.
#[inline(always)]
pub(super) fn gather_within(forces: &mut [f64], columns: usize, springs: [&[f64]; 6]) {
    let [across, down, diagonal, other_diagonal, far_across, far_down] = springs;
    let (own, above, far_above) = (2 + 2 * columns, 2 + columns, 2);
    let count = forces.len();
    let (down_above, down) = (&down[above..][..count], &down[own..][..count]);
    let (across_before, across) = (&across[own - 1..][..count], &across[own..][..count]);
    let (diagonal_above, diagonal) = (&diagonal[above - 1..][..count], &diagonal[own..][..count]);
    let other_diagonal_above = &other_diagonal[above..][..count];
    let other_diagonal = &other_diagonal[own - 1..][..count];
    let (far_across_before, far_across) = (&far_across[own - 2..][..count], &far_across[own..][..count]);
    let (far_down_above, far_down) = (&far_down[far_above..][..count], &far_down[own..][..count]);
    for i in 0..count {
        let above = -far_down_above[i] - down_above[i] - (diagonal_above[i] + other_diagonal_above[i]);
        let structural = above + (across[i] - across_before[i]) + down[i];
        let shear = diagonal[i] + other_diagonal[i];
        let bend = (far_across[i] - far_across_before[i]) + far_down[i];
        forces[i] += structural + shear + bend;
    }
}

/// Puts into `below` all forces [N] along one axis on the next row from earlier rows and this one, and into `after` those on
/// the row after it.
#[inline(always)]
pub(super) fn pass_down(
    below: &mut [f64],
    after: &mut [f64],
    down: &[f64],
    (diagonal_before, other_diagonal): (&[f64], &[f64]),
    far_down: &[f64],
) {
    let count = below.len();
    let (after, down, far_down) = (&mut after[..count], &down[..count], &far_down[..count]);
    let (diagonal_before, other_diagonal) = (&diagonal_before[..count], &other_diagonal[..count]);
    for i in 0..count {
        below[i] = after[i] - down[i] - (diagonal_before[i] + other_diagonal[i]);
        after[i] = -far_down[i];
    }
}

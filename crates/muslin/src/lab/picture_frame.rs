//! The picture frame.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec3;

use super::friction::shear_stresses;
use super::reading::{Reading, Record, Unit};
use super::specimen::{Cut, Specimen};
use super::{Along, LabError, Resolution};
use crate::scene::MeasuredFabric;

/// Side of the frame [m].
const SIDE: f64 = 0.1;

/// Largest angle [°] and degrees per step.
const LARGEST_ANGLE: i32 = 40;
const DEGREES_PER_STEP: usize = 2;

/// Places in the curve between which G is read: 0° and 2°.
const READ: [usize; 2] = [0, 1];

/// What the picture frame gives.
#[derive(Debug)]
pub struct PictureFrameTest {
    /// Shear angle γ [rad] and force F [N] at the corners, from 0° to 40° and back.
    pub curve: Vec<[f64; 2]>,
    /// Force F [N] that the fabric was given, at the angles of the curve.
    pub input: Vec<f64>,
    /// G: slope [N/m per radian] of the shear force per side up to 2°.
    pub modulus: f64,
    /// What the instrument says beside what the fabric was given.
    pub readings: Vec<Reading>,
    /// The specimen's way.
    pub record: Record,
}

/// Shears `fabric` in a square frame of four hinged sides along its yarns, pulled at two opposite corners until the right
/// angles have changed by 40°, and back.
///
/// The frame holds all edges. The work of the force on the distance of the corners is that on all edges:
///
/// ```text
/// F = Σ F_i · ∂x_i/∂γ / (L sin(¼ π − ½ γ))        τ = F sin(¼ π − ½ γ) / L        F = 2 G L sin ½ γ / sin(¼ π − ½ γ)
/// ```
///
/// the last being the law of a fabric without friction. With friction f along sin γ it is
///
/// ```text
/// F = (2 G_el sin ½ γ + f cos γ) L / sin(¼ π − ½ γ)
/// ```
///
/// # Errors
/// See [`LabError`].
pub fn picture_frame(fabric: &MeasuredFabric, resolution: Resolution) -> Result<PictureFrameTest, LabError> {
    if fabric.shear_modulus == 0.0 {
        return Err(LabError::Nothing { what: "resistance to shear" });
    }
    let cells = resolution.cells();
    let cut = Cut::new(fabric, Along::Warp, [SIDE; 2], cells, cells)?;
    let across = cut.cells[1];
    let is_edge = |i: usize, j: usize| i == 0 || i == cells || j == 0 || j == across;
    let mut specimen = Specimen::new(fabric, cut, false, 0.0, is_edge);
    let spacings = [SIDE / cells as f64, SIDE / across as f64];
    let way = (0..=LARGEST_ANGLE).chain((0..LARGEST_ANGLE).rev()).step_by(DEGREES_PER_STEP);
    let mut curve = Vec::new();
    for degrees in way {
        let angle = f64::from(degrees) * PI / 180.0;
        let place = |i: usize, j: usize, axes: [DVec3; 2]| {
            axes[0] * (i as f64 * spacings[0]) + axes[1] * (j as f64 * spacings[1])
        };
        let sides = sides(angle);
        specimen.move_to(|i, j, _| place(i, j, sides));
        specimen.settle(&[], || format!("a shear angle of {degrees}°"))?;
        specimen.accept(angle);
        let rates = side_rates(angle);
        let edge =
            (0..=cells).flat_map(|i| (0..=across).map(move |j| (i, j))).filter(|&(i, j)| is_edge(i, j));
        let work: f64 =
            edge.map(|(i, j)| specimen.holding_force(specimen.particle(i, j)).dot(place(i, j, rates))).sum();
        curve.push([angle, work / (SIDE * corner_sine(angle))]);
    }
    let input = input(fabric, &curve);
    let modulus = chord(&curve, |place| curve[place][1]);
    // The chord of the law is the modulus, less γ² / 24 of it, where there is no friction.
    let given = fabric.friction.shear.map_or(fabric.shear_modulus, |_| chord(&curve, |place| input[place]));
    let readings = vec![Reading {
        name: "G",
        what: "shear modulus up to 2°",
        unit: Unit::SHEAR,
        measured: modulus,
        input: Some(given),
    }];
    Ok(PictureFrameTest { curve, input, modulus, readings, record: specimen.into_record() })
}

/// Force [N] by the law of `fabric` at the angles of `curve`, on the way from each to the next.
fn input(fabric: &MeasuredFabric, curve: &[[f64; 2]]) -> Vec<f64> {
    let elastic = fabric.elastic_shear_modulus();
    let angles = || curve.iter().map(|point| point[0]);
    let stresses = shear_stresses(fabric.friction.shear, angles());
    let force =
        |(angle, stress)| (2.0 * elastic * libm::sin(0.5 * angle) + stress) * SIDE / corner_sine(angle);
    angles().zip(stresses).map(force).collect()
}

/// Slope [N/m per radian] of the shear force per side up to 2°, with the force at the corners [N] at each place of `curve`.
fn chord(curve: &[[f64; 2]], force: impl Fn(usize) -> f64) -> f64 {
    let [before, after] = READ.map(|place| {
        let angle = curve[place][0];
        [angle, force(place) * corner_sine(angle) / SIDE]
    });
    (after[1] - before[1]) / (after[0] - before[0])
}

/// Directions of the frame's sides, turned by half of the `angle` [rad] towards each other.
fn sides(angle: f64) -> [DVec3; 2] {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    [DVec3::new(cosine, sine, 0.0), DVec3::new(sine, cosine, 0.0)]
}

/// Their derivatives by the angle.
fn side_rates(angle: f64) -> [DVec3; 2] {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    [DVec3::new(-0.5 * sine, 0.5 * cosine, 0.0), DVec3::new(0.5 * cosine, -0.5 * sine, 0.0)]
}

/// sin(¼ π − ½ γ): how much farther, in sides, the corners are per angle.
fn corner_sine(angle: f64) -> f64 {
    libm::sin(FRAC_PI_4 - 0.5 * angle)
}

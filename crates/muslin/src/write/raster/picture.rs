//! From triangles to pixels: visibility at many samples of a pixel, shading, anti-aliasing, encoding.

use glam::DVec3;
use rayon::prelude::*;

use super::Mesh;
use super::camera::{Camera, Projected, shows_front};
use super::fabric::SurfacePoint;
use super::fill::{Barycentric, fill_triangle};
use super::light::{Light, smooth_lights, smooth_normals};
use super::studio::Studio;

/// Samples along each side of a pixel.
const SAMPLES: usize = 4;
/// Rows of pixels that are drawn at a time.
const BAND: usize = 24;
/// The triangle of a sample that shows none.
const NOTHING: u32 = u32::MAX;

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::write) struct Picture {
    /// Red, green and blue of each pixel in sRGB, row by row from the top.
    pub(in crate::write) pixels: Vec<u8>,
    /// Share of the picture that the mesh covers.
    pub(in crate::write) coverage: f64,
}

/// Draws `mesh` as `camera` sees it in a picture of `size` pixels, above a floor at `floor_height`.
///
/// # Panics
/// If the mesh has `u32::MAX` triangles.
pub(in crate::write) fn draw(mesh: &Mesh, camera: Camera, floor_height: f64, size: [u32; 2]) -> Picture {
    assert!(mesh.triangles.len() < NOTHING as usize, "triangles fit the sample's index");
    let (studio, mut lights) = Studio::around(mesh, camera, floor_height);
    smooth_lights(mesh, &mut lights, 2);
    let projected = mesh.points.iter().map(|point| camera.project(*point)).collect();
    let normals = smooth_normals(mesh, 3);
    let view = View { mesh, camera, studio, lights, normals, projected, size };
    let row_bytes = 3 * size[0] as usize;
    let mut pixels = vec![0; row_bytes * size[1] as usize];
    let encoding = Encoding::new();
    let covered: Vec<u64> = pixels
        .par_chunks_mut(row_bytes * BAND)
        .enumerate()
        .map(|(band, pixels)| view.draw_band(band * BAND, pixels, &encoding))
        .collect();
    let samples = f64::from(size[0]) * f64::from(size[1]) * (SAMPLES * SAMPLES) as f64;
    Picture { pixels, coverage: covered.iter().sum::<u64>() as f64 / samples }
}

/// All that shading a pixel needs.
struct View<'a> {
    mesh: &'a Mesh,
    camera: Camera,
    studio: Studio,
    lights: Vec<Light>,
    normals: Vec<DVec3>,
    projected: Vec<Projected>,
    size: [u32; 2],
}

impl View<'_> {
    /// Draws the pixels of whole rows from `first_row`; the result is the number of samples that show the mesh.
    fn draw_band(&self, first_row: usize, pixels: &mut [u8], encoding: &Encoding) -> u64 {
        let width = self.size[0] as usize;
        let shown = self.shown_triangles(first_row, pixels.len() / (3 * width));
        let mut covered = 0;
        for (index, pixel) in pixels.chunks_mut(3).enumerate() {
            let [x, y] = [index % width, index / width];
            let mut groups = Groups::default();
            for row in 0..SAMPLES {
                let start = (y * SAMPLES + row) * width * SAMPLES + x * SAMPLES;
                for (column, triangle) in shown[start..start + SAMPLES].iter().enumerate() {
                    groups.add(*triangle, [column, row]);
                }
            }
            let mut radiance = DVec3::ZERO;
            for (triangle, count, sum) in groups.iter() {
                let share = count as f64 / (SAMPLES * SAMPLES) as f64;
                let offset = |sum: usize| (sum as f64 / count as f64 + 0.5) / SAMPLES as f64;
                let place = [x as f64 + offset(sum[0]), (first_row + y) as f64 + offset(sum[1])];
                if triangle == NOTHING {
                    radiance += self.studio.eval_background(place, self.size) * share;
                } else {
                    covered += count as u64;
                    radiance += self.eval_triangle(triangle as usize, place) * share;
                }
            }
            pixel.copy_from_slice(&encoding.encode(radiance, [x, first_row + y]));
        }
        covered
    }

    /// The triangle nearest to the camera at each sample of `rows` rows of pixels from `first_row`.
    fn shown_triangles(&self, first_row: usize, rows: usize) -> Vec<u32> {
        let width = self.size[0] as usize * SAMPLES;
        let mut nearest = vec![0.0f32; width * rows * SAMPLES];
        let mut shown = vec![NOTHING; nearest.len()];
        for (index, triangle) in self.mesh.triangles.iter().enumerate() {
            let corners = triangle.map(|v| self.projected[v as usize]);
            let top = first_row as f64;
            let bottom = top + rows as f64;
            if corners.iter().all(|corner| corner.place[1] < top)
                || corners.iter().all(|corner| bottom < corner.place[1])
            {
                continue;
            }
            let places = corners.map(|corner| {
                [corner.place[0] * SAMPLES as f64, (corner.place[1] - first_row as f64) * SAMPLES as f64]
            });
            fill_triangle(places, width, 0..rows * SAMPLES, |x, y, weights| {
                let depth: f64 = (0..3).map(|k| weights[k] * corners[k].inverse_depth).sum();
                let sample = y * width + x;
                if nearest[sample] < depth as f32 {
                    nearest[sample] = depth as f32;
                    shown[sample] = index as u32;
                }
            });
        }
        shown
    }

    /// Radiance of a triangle at `place` in the picture.
    fn eval_triangle(&self, triangle: usize, place: [f64; 2]) -> DVec3 {
        let vertices = self.mesh.triangles[triangle].map(|v| v as usize);
        let corners = vertices.map(|v| self.projected[v]);
        let Some(plane) = Barycentric::new(corners.map(|corner| corner.place)) else { return DVec3::ZERO };
        let weights = |place: [f64; 2]| perspective_weights(plane.weights(place), corners);
        let here = weights(place);
        let yarns = |weights: [f64; 3]| {
            let corners = vertices.map(|v| self.mesh.yarns[v]);
            [0, 1].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum::<f64>())
        };
        let [start, right, down] =
            [here, weights([place[0] + 1.0, place[1]]), weights([place[0], place[1] + 1.0])].map(yarns);
        let footprint =
            [0, 1].map(|axis| (right[axis] - start[axis]).abs().max((down[axis] - start[axis]).abs()));
        let front = shows_front(corners.map(|corner| corner.place));
        let blend = |vectors: &[DVec3]| (0..3).map(|k| vectors[vertices[k]] * here[k]).sum::<DVec3>();
        let normal = blend(&self.normals).try_normalize().unwrap_or(DVec3::Y);
        let view = (self.camera.position - blend(&self.mesh.points)).normalize();
        SurfacePoint {
            material: self.mesh.materials[triangle],
            front,
            normal: if front { normal } else { -normal },
            view,
            yarns: start,
            footprint,
            light: Light::blend(vertices.map(|v| &self.lights[v]), here),
        }
        .eval_radiance(self.studio.key)
    }
}

/// Weights of the corners in space of a point whose weights in the picture are `weights`.
fn perspective_weights(weights: [f64; 3], corners: [Projected; 3]) -> [f64; 3] {
    let scaled: [f64; 3] = std::array::from_fn(|k| weights[k] * corners[k].inverse_depth);
    let sum: f64 = scaled.iter().sum();
    scaled.map(|weight| weight / sum)
}

/// The samples of a pixel, grouped by the triangle they show, in the order of their first samples.
#[derive(Default)]
struct Groups {
    triangles: [u32; SAMPLES * SAMPLES],
    counts: [usize; SAMPLES * SAMPLES],
    /// Sums of the columns and rows of the samples.
    sums: [[usize; 2]; SAMPLES * SAMPLES],
    len: usize,
}

impl Groups {
    fn add(&mut self, triangle: u32, sample: [usize; 2]) {
        let known = self.triangles[..self.len].iter().position(|known| *known == triangle);
        let group = known.unwrap_or_else(|| {
            self.triangles[self.len] = triangle;
            self.len += 1;
            self.len - 1
        });
        self.counts[group] += 1;
        self.sums[group][0] += sample[0];
        self.sums[group][1] += sample[1];
    }

    fn iter(&self) -> impl Iterator<Item = (u32, usize, [usize; 2])> + '_ {
        (0..self.len).map(|group| (self.triangles[group], self.counts[group], self.sums[group]))
    }
}

/// From radiance to sRGB bytes.
struct Encoding {
    /// Bytes, not yet whole, of radiances spread evenly over 0 to 1.
    bytes: Vec<f64>,
}

impl Encoding {
    /// Intervals of the table: at the dark end, where sRGB is steepest, a step is 0.8 of a byte.
    const STEPS: usize = 4096;

    fn new() -> Self {
        let byte = |n: usize| {
            let linear = n as f64 / Self::STEPS as f64;
            let encoded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
            };
            255.0 * encoded
        };
        Self { bytes: (0..=Self::STEPS).map(byte).collect() }
    }

    /// Red, green and blue of the pixel at `place`.
    ///
    /// An ordered pattern of less than one byte's step keeps smooth gradients from showing bands.
    fn encode(&self, radiance: DVec3, place: [usize; 2]) -> [u8; 3] {
        let dither = dither(place);
        radiance.to_array().map(|linear| {
            let step = shoulder(linear) * Self::STEPS as f64;
            let below = (step as usize).min(Self::STEPS - 1);
            let share = step - below as f64;
            let byte = self.bytes[below] * (1.0 - share) + self.bytes[below + 1] * share;
            (byte + dither).floor() as u8
        })
    }
}

/// Radiance from 0 to 1: unchanged up to a knee, then bent smoothly so that nothing clips.
fn shoulder(linear: f64) -> f64 {
    let knee = 0.65;
    let room = 1.0 - knee;
    if linear <= knee { linear.max(0.0) } else { 1.0 - room * libm::exp((knee - linear) / room) }
}

/// The 8 x 8 ordered pattern of Bayer at a pixel, between 0 and 1.
fn dither([x, y]: [usize; 2]) -> f64 {
    let mixed = x ^ y;
    let bits = (0..3).fold(0, |bits, k| (bits << 2) | (((mixed >> k) & 1) << 1) | ((y >> k) & 1));
    (bits as f64 + 0.5) / 64.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half-way in the picture between depths 1 and 3 lies, in space, three quarters of the way to the nearer one.
    #[test]
    fn weights_in_space_follow_perspective() {
        let corner = |depth: f64| Projected { place: [0.0; 2], inverse_depth: 1.0 / depth };
        let weights = perspective_weights([0.5, 0.5, 0.0], [corner(1.0), corner(3.0), corner(7.0)]);
        let exact = [0.75, 0.25, 0.0];
        assert!(
            weights.iter().zip(exact).all(|(weight, exact)| (weight - exact).abs() < 1e-15),
            "{weights:?}"
        );
    }

    /// Known pairs of the sRGB transfer function: linear 0.2140 is half the bytes, 0.0031308 is 12.92 times itself.
    #[test]
    fn encoding_is_srgb() {
        let encoding = Encoding::new();
        for (linear, byte) in [(0.0, 0.0), (0.003_130_8, 10.3148), (0.214_041_14, 127.5), (0.5, 187.5160)] {
            // The mean over one period of the dither pattern leaves half a step of 1/64 byte.
            let sum: u32 =
                (0..64).map(|n| u32::from(encoding.encode(DVec3::splat(linear), [n % 8, n / 8])[0])).sum();
            let mean = f64::from(sum) / 64.0;
            assert!((mean - byte).abs() < 0.02, "{linear}: {mean} against {byte}");
        }
        assert_eq!(encoding.encode(DVec3::splat(1e9), [0, 0]), [255; 3]);
        assert_eq!(encoding.encode(DVec3::splat(-1.0), [7, 7]), [0; 3]);
    }

    #[test]
    fn dither_takes_each_level_once() {
        let mut levels: Vec<f64> = (0..64).map(|n| 64.0 * dither([n % 8, n / 8]) - 0.5).collect();
        levels.sort_by(f64::total_cmp);
        assert_eq!(levels, (0..64).map(f64::from).collect::<Vec<_>>());
    }

    #[test]
    fn the_shoulder_has_no_corner_and_no_clipping() {
        let step = 1e-6;
        let slope = (shoulder(0.65 + step) - shoulder(0.65 - step)) / (2.0 * step);
        assert!((slope - 1.0).abs() < 1e-5, "{slope}");
        assert!(shoulder(2.0) < shoulder(3.0) && shoulder(3.0) < 1.0);
    }

    #[test]
    fn samples_group_by_triangle_in_order() {
        let mut groups = Groups::default();
        for (n, triangle) in [7, 7, NOTHING, 7].into_iter().enumerate() {
            groups.add(triangle, [n, 0]);
        }
        assert_eq!(groups.iter().collect::<Vec<_>>(), [(7, 3, [4, 0]), (NOTHING, 1, [2, 0])]);
    }
}

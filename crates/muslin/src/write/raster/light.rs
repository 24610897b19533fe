//! How much of the key light, the sky and the floor each point of a scene sees.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::Mesh;
use super::fill::fill_triangle;

/// Samples of the key light, which is a disc.
const KEY_SAMPLES: usize = 28;
/// Half angle of the key light [rad].
const KEY_HALF_ANGLE: f64 = 0.10;
/// Axes along which the surroundings are sampled, each both ways.
const AXES: usize = 40;
/// Texels along a side of a depth map.
const MAP_SIDE: usize = 512;
/// How far a point is moved along its normal and towards the light before it is compared, in texels.
const BIAS: f64 = 1.6;

/// The light that reaches a point, each share 1 where nothing is in the way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Light {
    /// Share of the key light's disc that the point sees.
    pub(super) key: f64,
    /// Irradiance of the front by a sky of radiance 1/π over the upper half of the surroundings [1].
    pub(super) front_sky: f64,
    /// Irradiance of the front by the lower half of the surroundings.
    pub(super) front_floor: f64,
    /// Irradiance of the back by the sky.
    pub(super) back_sky: f64,
    /// Irradiance of the back by the lower half.
    pub(super) back_floor: f64,
}

impl Light {
    /// The sum of `lights`, each times its weight.
    pub(super) fn blend<const N: usize>(lights: [&Self; N], weights: [f64; N]) -> Self {
        let sum = |share: fn(&Self) -> f64| (0..N).map(|k| weights[k] * share(lights[k])).sum();
        Self {
            key: sum(|light| light.key),
            front_sky: sum(|light| light.front_sky),
            front_floor: sum(|light| light.front_floor),
            back_sky: sum(|light| light.back_sky),
            back_floor: sum(|light| light.back_floor),
        }
    }
}

/// The light at each of `points`, whose fronts are along `normals`, among the triangles of `mesh`.
///
/// The key light is a disc about the unit vector `key`. Each of many directions has a depth map of the mesh, in which
/// the four texels around a point vote; the sums are in a fixed order whatever the number of threads.
pub(super) fn eval_lights(mesh: &Mesh, points: &[DVec3], normals: &[DVec3], key: DVec3) -> Vec<Light> {
    let radius = mesh.points.iter().map(|point| point.length()).fold(0.0, f64::max).max(1e-3);
    let key_directions = disc_directions(key);
    let axes = sphere_axes();
    let receivers = || points.iter().zip(normals);
    let key_seen: Vec<Vec<u8>> = key_directions
        .par_iter()
        .map(|direction| {
            let map = DepthMap::new(mesh, *direction, radius);
            receivers().map(|(point, normal)| map.seen(*point, *normal, 1.0)).collect()
        })
        .collect();
    let axes_seen: Vec<Vec<[u8; 2]>> = axes
        .par_iter()
        .map(|axis| {
            let map = DepthMap::new(mesh, *axis, radius);
            receivers().map(|(point, normal)| [1.0, -1.0].map(|way| map.seen(*point, *normal, way))).collect()
        })
        .collect();
    let mut lights = vec![Light::default(); points.len()];
    for seen in key_seen {
        for (light, seen) in lights.iter_mut().zip(seen) {
            light.key += f64::from(seen) / (255.0 * KEY_SAMPLES as f64);
        }
    }
    for (axis, seen) in axes.iter().zip(&axes_seen) {
        for ((light, seen), normal) in lights.iter_mut().zip(seen).zip(normals) {
            // Each direction stands for 4π / (2 AXES) of solid angle; a uniform half sphere of radiance 1/π gives 1.
            let cosine = normal.dot(*axis);
            let [along, against] =
                seen.map(|seen| cosine.abs() * 2.0 * f64::from(seen) / (255.0 * AXES as f64));
            // The axes point up, so the way along each comes from the sky.
            if 0.0 < cosine {
                light.front_sky += along;
                light.back_floor += against;
            } else {
                light.back_sky += along;
                light.front_floor += against;
            }
        }
    }
    lights
}

/// Replaces the light at each vertex of `mesh` by the mean of itself and its neighbours', `rounds` times.
///
/// The maps see a finite number of directions; this blends the steps between them.
pub(super) fn smooth_lights(mesh: &Mesh, lights: &mut [Light], rounds: usize) {
    for _ in 0..rounds {
        let mut sums: Vec<(Light, f64)> = lights.iter().map(|light| (*light, 1.0)).collect();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| &lights[v as usize]);
            for k in 0..3 {
                let (sum, weight) = &mut sums[triangle[k] as usize];
                *sum = Light::blend([sum, corners[(k + 1) % 3], corners[(k + 2) % 3]], [1.0, 0.5, 0.5]);
                *weight += 1.0;
            }
        }
        for (light, (sum, weight)) in lights.iter_mut().zip(&sums) {
            *light = Light::blend([sum], [1.0 / weight]);
        }
    }
}

/// The normal at each vertex of `mesh`, averaged with its neighbours' `rounds` times.
///
/// Wrinkles as fine as the triangles would tear the border between light and shade.
pub(super) fn smooth_normals(mesh: &Mesh, rounds: usize) -> Vec<DVec3> {
    let mut normals = mesh.normals.clone();
    for _ in 0..rounds {
        let mut sums = normals.clone();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| normals[v as usize]);
            for k in 0..3 {
                sums[triangle[k] as usize] += (corners[(k + 1) % 3] + corners[(k + 2) % 3]) * 0.5;
            }
        }
        for (normal, sum) in normals.iter_mut().zip(sums) {
            *normal = sum.try_normalize().unwrap_or(*normal);
        }
    }
    normals
}

/// Directions spread evenly over the disc of the key light, in the spiral of a sunflower.
fn disc_directions(key: DVec3) -> Vec<DVec3> {
    let (across, up) = key.any_orthonormal_pair();
    let golden_angle = PI * (3.0 - 5.0f64.sqrt());
    (0..KEY_SAMPLES)
        .map(|n| {
            let radius = KEY_HALF_ANGLE * ((n as f64 + 0.5) / KEY_SAMPLES as f64).sqrt();
            let angle = golden_angle * n as f64;
            (key + across * (radius * libm::cos(angle)) + up * (radius * libm::sin(angle))).normalize()
        })
        .collect()
}

/// Unit vectors spread evenly over the upper half sphere, none level.
fn sphere_axes() -> Vec<DVec3> {
    let golden_angle = PI * (3.0 - 5.0f64.sqrt());
    (0..AXES)
        .map(|n| {
            let height = (n as f64 + 0.5) / AXES as f64;
            let radius = (1.0 - height * height).sqrt();
            let angle = golden_angle * n as f64;
            DVec3::new(radius * libm::cos(angle), height, radius * libm::sin(angle))
        })
        .collect()
}

/// How far a mesh reaches along a direction and against it, over a raster across that direction.
struct DepthMap {
    across: DVec3,
    up: DVec3,
    direction: DVec3,
    texels_per_length: f64,
    /// Largest and smallest place along the direction in each texel.
    reach: Vec<[f32; 2]>,
}

impl DepthMap {
    fn new(mesh: &Mesh, direction: DVec3, radius: f64) -> Self {
        let (across, up) = direction.any_orthonormal_pair();
        let texels_per_length = 0.49 * MAP_SIDE as f64 / radius;
        let mut map = Self { across, up, direction, texels_per_length, reach: Vec::new() };
        let mut reach = vec![[f32::NEG_INFINITY, f32::INFINITY]; MAP_SIDE * MAP_SIDE];
        let places: Vec<([f64; 2], f64)> =
            mesh.points.iter().map(|point| (map.place(*point), point.dot(direction))).collect();
        for triangle in &mesh.occluders {
            let corners = triangle.map(|v| places[v as usize]);
            fill_triangle(corners.map(|corner| corner.0), MAP_SIDE, 0..MAP_SIDE, |x, y, weights| {
                let depth: f64 = (0..3).map(|k| weights[k] * corners[k].1).sum();
                let [largest, smallest] = &mut reach[y * MAP_SIDE + x];
                *largest = largest.max(depth as f32);
                *smallest = smallest.min(depth as f32);
            });
        }
        map.reach = reach;
        map
    }

    /// Where `point` falls on the raster [texels].
    fn place(&self, point: DVec3) -> [f64; 2] {
        let middle = 0.5 * MAP_SIDE as f64;
        [self.across, self.up].map(|axis| middle + point.dot(axis) * self.texels_per_length)
    }

    /// How much a point sees of what lies along the direction (`way` 1) or against it (−1), from 0 to 255.
    ///
    /// The point is moved to the side of its surface that faces the way it looks.
    fn seen(&self, point: DVec3, normal: DVec3, way: f64) -> u8 {
        let bias = way * BIAS / self.texels_per_length;
        let side = if 0.0 < normal.dot(self.direction) { normal } else { -normal };
        let point = point + (side + self.direction) * bias;
        let depth = point.dot(self.direction) as f32;
        let [x, y] = self.place(point).map(|place| place - 0.5);
        let last = (MAP_SIDE - 1) as f64;
        // The mesh ends a texel before the map does.
        if !(0.0 <= x && x < last && 0.0 <= y && y < last) {
            return u8::MAX;
        }
        let [left, top] = [x as usize, y as usize];
        let [right_share, bottom_share] = [x - left as f64, y - top as f64];
        let first = top * MAP_SIDE + left;
        let open = |texel: usize| {
            let [largest, smallest] = self.reach[texel];
            let open = if way < 0.0 { depth <= smallest } else { largest <= depth };
            if open { 255.0 } else { 0.0 }
        };
        let upper = open(first) * (1.0 - right_share) + open(first + 1) * right_share;
        let lower = open(first + MAP_SIDE) * (1.0 - right_share) + open(first + MAP_SIDE + 1) * right_share;
        (upper * (1.0 - bottom_share) + lower * bottom_share + 0.5) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::raster::Material;

    /// A plane cloth alone in space sees half the surroundings from each side and all of the key light.
    ///
    /// The cosines of the axes sum to one exactly by their even heights, for a level normal: Σ (n + ½) / N · 2 / N = 1.
    #[test]
    fn a_level_sheet_sees_the_sky_above_and_the_floor_below() {
        let points: Vec<DVec3> =
            (0..4).map(|v| DVec3::new(f64::from(v % 2) - 0.5, 0.0, 0.5 - f64::from(v / 2))).collect();
        let mut mesh = Mesh::default();
        mesh.add_sheet(&points, 2, [1.0, 1.0]);
        let lights = eval_lights(&mesh, &[DVec3::ZERO], &[DVec3::Y], DVec3::new(0.6, 0.8, 0.0));
        let Light { key, front_sky, front_floor, back_sky, back_floor } = lights[0];
        assert!((key - 1.0).abs() < 1e-12 && (front_sky - 1.0).abs() < 1e-12, "{lights:?}");
        assert!((back_floor - 1.0).abs() < 1e-12 && front_floor == 0.0 && back_sky == 0.0, "{lights:?}");
    }

    /// Under a sphere of radius r at distance d, a level point loses (r / d)² of the sky: the form factor of a sphere.
    #[test]
    fn a_sphere_overhead_takes_its_form_factor_of_the_sky() {
        let mut mesh = Mesh::default();
        mesh.add_sphere(DVec3::ZERO, 0.5, 48, Material::Bead);
        let below = DVec3::new(0.0, -1.0, 0.0);
        let light = eval_lights(&mesh, &[below], &[DVec3::Y], DVec3::Y)[0];
        assert_eq!(light.key, 0.0);
        // The blocked cone ends at cos² = 3/4; one axis more or less beside it weighs at most 2 / AXES.
        assert!((light.front_sky - 0.75).abs() < 2.0 / AXES as f64, "{light:?}");
    }

    /// The normals of a plane stay, and a lone one that deviates gives way to its neighbours.
    #[test]
    fn smoothing_keeps_a_plane_and_turns_a_bump() {
        let points: Vec<DVec3> =
            (0..25).map(|v| DVec3::new(f64::from(v % 5), f64::from(v / 5), 0.0) / 4.0).collect();
        let mut mesh = Mesh::default();
        mesh.add_sheet(&points, 5, [0.25, 0.25]);
        let plane = mesh.normals[0];
        assert!(smooth_normals(&mesh, 3).iter().all(|normal| (*normal - plane).length() < 1e-15));
        mesh.normals[12] = DVec3::X;
        let turned = smooth_normals(&mesh, 1)[12];
        // Eight triangles bring two neighbours each, at half weight: 8 n + x, of length √65.
        assert!((turned - (plane * 8.0 + DVec3::X) / 65f64.sqrt()).length() < 1e-15, "{turned}");
    }

    #[test]
    fn smoothing_keeps_an_even_light() {
        let mut mesh = Mesh::default();
        mesh.add_sphere(DVec3::ZERO, 0.5, 8, Material::Bead);
        let even = Light { key: 0.5, front_sky: 0.25, front_floor: 1.0, back_sky: 0.0, back_floor: 0.125 };
        let mut lights = vec![even; mesh.points.len()];
        smooth_lights(&mesh, &mut lights, 2);
        assert!(
            lights
                .iter()
                .all(|light| (light.key - 0.5).abs() < 1e-12 && (light.front_floor - 1.0).abs() < 1e-12)
        );
    }
}

//! The room a picture is taken in: key light, floor and backdrop.

use glam::DVec3;

use super::camera::Camera;
use super::light::{Light, eval_lights};
use super::{Mesh, smooth_step};

/// Radiance of the key light times π, for an albedo of 1.
pub(super) const KEY: DVec3 = DVec3::new(1.12, 1.04, 0.90);
/// Radiance of the sky times π.
pub(super) const SKY: DVec3 = DVec3::new(0.255, 0.275, 0.29);
/// Radiance of the floor times π, as far as it lights the cloth from below.
pub(super) const BOUNCE: DVec3 = DVec3::new(0.10, 0.105, 0.105);
/// Albedo of the floor.
const FLOOR: DVec3 = DVec3::new(0.092, 0.129, 0.155);
/// Colour of the backdrop at the level of the floor, and high above.
const BACKDROP: [DVec3; 2] = [DVec3::new(0.082, 0.112, 0.126), DVec3::new(0.020, 0.030, 0.037)];
/// Angle of the key light above the horizon [rad].
const KEY_HEIGHT: f64 = 0.86;
/// Angles from the camera to the side of the key light [rad]: the usual one, and those that rake a flat cloth.
const KEY_TURNS: [f64; 3] = [0.86, 1.15, 1.4];
/// Mean cosine between the key light and what shows of the shape that models its relief best.
const BEST_COSINE: f64 = 0.62;
/// How much nearer to it another light must be than the one from the left at the usual angle, which is the custom.
const CUSTOM: f64 = 0.03;
/// Share of the light that comes through the shape to the floor.
const THROUGH: f64 = 0.12;
/// Texels along a side of the floor's light.
const FLOOR_SIDE: usize = 192;
/// Half the side of the floor's light; beyond it nothing shades the floor.
const FLOOR_REACH: f64 = 2.0;
/// Distances along the floor from the shape at which it begins to fade, and has faded, into the backdrop.
const FADE: [f64; 2] = [0.7, 5.0];

/// A floor under a shape of size 1 about the origin, before a backdrop without a seam.
pub(in crate::write) struct Studio {
    camera: Camera,
    /// Unit vector to the key light.
    pub(super) key: DVec3,
    floor_height: f64,
    /// Middle of the floor's light, which lies away from the key light.
    floor_centre: [f64; 2],
    floor_lights: Vec<Light>,
}

impl Studio {
    /// The room around `mesh`; also the light at each vertex of the mesh.
    ///
    /// The key light comes from above, from the side and angle to `camera` whence it shows the relief of the mesh better.
    pub(in crate::write) fn around(mesh: &Mesh, camera: Camera, floor_height: f64) -> (Self, Vec<Light>) {
        let key = best_key(mesh, &camera);
        let floor_centre = [-0.6 * key.x, -0.6 * key.z];
        // The floor's texels come after the vertices, so that every map is made once for both.
        let mut points = mesh.points.clone();
        let mut normals = mesh.normals.clone();
        for texel in 0..FLOOR_SIDE * FLOOR_SIDE {
            let [x, z] =
                [texel % FLOOR_SIDE, texel / FLOOR_SIDE].map(|n| (n as f64 + 0.5) / FLOOR_SIDE as f64);
            let [x, z] = [(x, floor_centre[0]), (z, floor_centre[1])]
                .map(|(share, centre)| centre + (2.0 * share - 1.0) * FLOOR_REACH);
            points.push(DVec3::new(x, floor_height, z));
            normals.push(DVec3::Y);
        }
        let mut lights = eval_lights(mesh, &points, &normals, key);
        let floor_lights = softened(&lights.split_off(mesh.points.len()));
        (Self { camera, key, floor_height, floor_centre, floor_lights }, lights)
    }

    /// Radiance of the floor and the backdrop at `place` in a picture of `size` pixels.
    pub(super) fn eval_background(&self, place: [f64; 2], size: [u32; 2]) -> DVec3 {
        let ray = self.camera.ray(place);
        let [across, along] = [(place[0], size[0]), (place[1], size[1])]
            .map(|(place, length)| 2.0 * place / f64::from(length) - 1.0);
        let distance_squared = 0.8 * across * across + 0.9 * along * along;
        // A pool of light in the middle, and corners that fall off.
        let vignette = 1.12 - 0.42 * smooth_step(0.0, 1.9, distance_squared);
        let rise =
            smooth_step(-0.10, 0.34, ray.y - self.camera.ray([place[0], 0.5 * f64::from(size[1])]).y + 0.08);
        let backdrop = BACKDROP[0].lerp(BACKDROP[1], rise);
        let descent = (self.floor_height - self.camera.position.y) / ray.y;
        if !(ray.y < 0.0 && 0.0 < descent) {
            return backdrop * vignette;
        }
        let point = self.camera.position + ray * descent;
        let distance = (point.x * point.x + point.z * point.z).sqrt();
        let fade = smooth_step(FADE[0], FADE[1], distance);
        let light = self.floor_light(point);
        let [key, sky] = [light.key, light.front_sky].map(|open| open + (1.0 - open) * THROUGH);
        let floor = FLOOR * (KEY * (key * self.key.y) + SKY * sky);
        floor.lerp(backdrop, fade) * vignette
    }

    /// Light at a point of the floor, between the four nearest texels.
    fn floor_light(&self, point: DVec3) -> Light {
        let open = Light { key: 1.0, front_sky: 1.0, ..Light::default() };
        let offset = [point.x - self.floor_centre[0], point.z - self.floor_centre[1]];
        let largest = offset[0].abs().max(offset[1].abs()) / FLOOR_REACH;
        if 1.0 <= largest {
            return open;
        }
        let [x, z] = offset.map(|offset| {
            let texel = (0.5 * offset / FLOOR_REACH + 0.5) * FLOOR_SIDE as f64 - 0.5;
            texel.clamp(0.0, FLOOR_SIDE as f64 - 1.001)
        });
        let [left, top] = [x as usize, z as usize];
        let [right_share, bottom_share] = [x - left as f64, z - top as f64];
        let texel = |column: usize, row: usize| &self.floor_lights[row * FLOOR_SIDE + column];
        let shaded = Light::blend(
            [texel(left, top), texel(left + 1, top), texel(left, top + 1), texel(left + 1, top + 1)],
            [
                (1.0 - right_share) * (1.0 - bottom_share),
                right_share * (1.0 - bottom_share),
                (1.0 - right_share) * bottom_share,
                right_share * bottom_share,
            ],
        );
        let edge = smooth_step(0.8, 1.0, largest);
        Light::blend([&shaded, &open], [1.0 - edge, edge])
    }
}

/// The floor's light, each texel blended with its eight neighbours by the weights 1, 2, 1 both ways.
fn softened(lights: &[Light]) -> Vec<Light> {
    let last = FLOOR_SIDE - 1;
    let blend = |lights: &[Light], texel: usize, [before, after]: [usize; 2]| {
        Light::blend([&lights[before], &lights[texel], &lights[after]], [0.25, 0.5, 0.25])
    };
    let texels = 0..FLOOR_SIDE * FLOOR_SIDE;
    let along_rows: Vec<Light> = texels
        .clone()
        .map(|texel| {
            let column = texel % FLOOR_SIDE;
            blend(lights, texel, [texel - usize::from(0 < column), texel + usize::from(column < last)])
        })
        .collect();
    texels
        .map(|texel| {
            let row = texel / FLOOR_SIDE;
            let [up, down] = [usize::from(0 < row), usize::from(row < last)].map(|step| step * FLOOR_SIDE);
            blend(&along_rows, texel, [texel - up, texel + down])
        })
        .collect()
}

/// Unit vector to the key light: of all sides and turns the one whose mean cosine is nearest to [`BEST_COSINE`].
fn best_key(mesh: &Mesh, camera: &Camera) -> DVec3 {
    let error = |key: DVec3| (mean_cosine(mesh, camera, key) - BEST_COSINE).abs();
    let mut best = key_direction(camera, -1.0, KEY_TURNS[0]);
    let mut least = error(best) - CUSTOM;
    for turn in KEY_TURNS {
        for side in [-1.0, 1.0] {
            let key = key_direction(camera, side, turn);
            let error = error(key);
            if error < least {
                (best, least) = (key, error);
            }
        }
    }
    best
}

/// Unit vector to the key light on the left (`side` −1) or the right (1) of `camera`, by the angle `turn` [rad].
fn key_direction(camera: &Camera, side: f64, turn: f64) -> DVec3 {
    let level = DVec3::new(camera.back.x, 0.0, camera.back.z).normalize();
    let aside = level * libm::cos(turn) + camera.right * (side * libm::sin(turn));
    aside * libm::cos(KEY_HEIGHT) + DVec3::Y * libm::sin(KEY_HEIGHT)
}

/// Mean cosine between `key` and the sides of the triangles that face `camera`, weighted with the area they show.
fn mean_cosine(mesh: &Mesh, camera: &Camera, key: DVec3) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
        if let Some(normal) = (b - a).cross(c - a).try_normalize() {
            let facing = normal.dot(camera.back);
            let shown = (b - a).cross(c - a).length() * facing.abs();
            sum += shown * (normal.dot(key) * facing.signum()).max(0.0);
            total += shown;
        }
    }
    if 0.0 < total { sum / total } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A single dark texel spreads by the binomial weights and keeps its sum, also at the border.
    #[test]
    fn softening_keeps_the_sum_of_the_light() {
        let dark = |place: usize| {
            let mut lights = vec![Light { key: 1.0, ..Light::default() }; FLOOR_SIDE * FLOOR_SIDE];
            lights[place].key = 0.0;
            softened(&lights)
        };
        let inside = dark(5 * FLOOR_SIDE + 7);
        assert_eq!(inside[5 * FLOOR_SIDE + 7].key, 0.75);
        assert_eq!(inside[6 * FLOOR_SIDE + 6].key, 1.0 - 1.0 / 16.0);
        for lights in [inside, dark(0), dark(FLOOR_SIDE * FLOOR_SIDE - 1)] {
            let lost: f64 = lights.iter().map(|light| 1.0 - light.key).sum();
            assert_eq!(lost, 1.0);
        }
    }

    /// The light leans to the side and comes from above, on the camera's side of the shape.
    #[test]
    fn key_light_comes_from_the_side_of_the_camera() {
        let mut mesh = Mesh::default();
        mesh.add_sphere(DVec3::ZERO, 0.5, 8, crate::write::raster::Material::Bead);
        let camera = Camera::three_quarter(&mesh, &[], [160, 90]);
        for side in [-1.0, 1.0] {
            let key = key_direction(&camera, side, KEY_TURNS[0]);
            assert!((key.length() - 1.0).abs() < 1e-15);
            assert!((key.y - libm::sin(KEY_HEIGHT)).abs() < 1e-15);
            let aside = side * libm::cos(KEY_HEIGHT) * libm::sin(KEY_TURNS[0]);
            assert!((key.dot(camera.right) - aside).abs() < 1e-15);
        }
    }
}

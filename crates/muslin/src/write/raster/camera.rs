//! From where a shape is seen, and where its points fall in the picture.

use glam::DVec3;

use super::Mesh;
use super::fill::fill_triangle;

/// Focal length as a multiple of the picture's longer side: a moderately long lens.
const FOCAL_LENGTH: f64 = 1.2;
/// Share of the width and the height of the picture that the shape may fill.
const FILLED: [f64; 2] = [0.86, 0.79];
/// Height of the picture's middle row within the frame: a little above the centre, with room for the floor below.
const MIDDLE: f64 = 0.485;
/// Angle between the view and the direction in which the shape shows most area [rad].
const THREE_QUARTER: f64 = 0.55;
/// Height of the view above the horizon for an upright and for a level cloth [rad].
const ELEVATION: [f64; 2] = [0.21, 0.60];

/// A perspective camera with y up.
#[derive(Clone, Copy, Debug)]
pub(in crate::write) struct Camera {
    /// Where the camera is.
    pub(super) position: DVec3,
    /// Unit vector to the right in the picture.
    pub(super) right: DVec3,
    /// Unit vector up in the picture.
    pub(super) up: DVec3,
    /// Unit vector from the scene to the camera along the optical axis.
    pub(super) back: DVec3,
    /// Pixels per unit of length at distance 1.
    focal_length: f64,
    /// Pixel coordinates of the optical axis.
    centre: [f64; 2],
}

/// A point in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Projected {
    /// Pixels from the left and from the top.
    pub(super) place: [f64; 2],
    /// One over the distance along the optical axis: linear in the picture, larger is closer.
    pub(super) inverse_depth: f64,
}

impl Camera {
    /// A camera that looks against `back`, for a picture of `size` pixels, as close to `points` as the margins allow.
    ///
    /// For a point (x, y, z) in the axes of the camera, which stands at (X, Y, Z), with τ the half width of the frame
    /// at distance 1:
    ///
    /// ```text
    /// |x − X| ≤ τ (Z − z) for all points    ⇔    max(x + τ z) ≤ X + τ Z  and  max(−x + τ z) ≤ −X + τ Z
    /// Z = [max(x + τ z) + max(−x + τ z)] / 2τ        X = [max(x + τ z) − max(−x + τ z)] / 2
    /// ```
    ///
    /// and likewise for y; the larger Z holds for both. Without points it stands at distance 1 from the origin.
    fn fit(points: &[DVec3], back: DVec3, size: [u32; 2]) -> Self {
        let [width, height] = size.map(f64::from);
        let focal_length = FOCAL_LENGTH * width.max(height);
        let right = DVec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let half_width = 0.5 * FILLED[0] * width / focal_length;
        let half_height = 0.5 * FILLED[1] * height / focal_length;
        let mut reach = [f64::NEG_INFINITY; 4];
        for point in points {
            let (x, y, z) = (point.dot(right), point.dot(up), point.dot(back));
            let sums = [x + half_width * z, half_width * z - x, y + half_height * z, half_height * z - y];
            for (largest, sum) in reach.iter_mut().zip(sums) {
                *largest = largest.max(sum);
            }
        }
        if points.is_empty() {
            reach = [0.0; 4];
        }
        let across = (reach[0] + reach[1]) / (2.0 * half_width);
        let along = (reach[2] + reach[3]) / (2.0 * half_height);
        // A shape that is a single point to the camera would put it inside.
        let distance = if points.is_empty() { 1.0 } else { across.max(along) };
        let position =
            right * (0.5 * (reach[0] - reach[1])) + up * (0.5 * (reach[2] - reach[3])) + back * distance;
        Self { position, right, up, back, focal_length, centre: [0.5 * width, MIDDLE * height] }
    }

    /// A three-quarter view of `mesh` for a picture of `size` pixels, from the side on which it shows most area.
    ///
    /// `framed` points lie within the margins beside the mesh's own.
    pub(in crate::write) fn three_quarter(mesh: &Mesh, framed: &[DVec3], size: [u32; 2]) -> Self {
        let facing = Facing::of(mesh);
        let elevation = ELEVATION[0] + (ELEVATION[1] - ELEVATION[0]) * facing.levelness;
        let points: Vec<DVec3> = mesh.points.iter().chain(framed).copied().collect();
        let candidates = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(side, turn)| {
            let azimuth = facing.azimuth + turn * THREE_QUARTER;
            let level = DVec3::new(libm::sin(azimuth), 0.0, libm::cos(azimuth)) * side;
            Self::fit(&points, level * libm::cos(elevation) + DVec3::Y * libm::sin(elevation), size)
        });
        let mut best = candidates[0];
        let mut most = 0;
        for camera in candidates {
            let shown = camera.shown(mesh, size);
            if most < shown {
                (best, most) = (camera, shown);
            }
        }
        best
    }

    /// Where `point` falls in the picture; not finite if it is beside the camera, behind it if `inverse_depth` < 0.
    pub(super) fn project(&self, point: DVec3) -> Projected {
        let offset = point - self.position;
        let inverse_depth = -1.0 / offset.dot(self.back);
        let scale = self.focal_length * inverse_depth;
        let place =
            [self.centre[0] + offset.dot(self.right) * scale, self.centre[1] - offset.dot(self.up) * scale];
        Projected { place, inverse_depth }
    }

    /// Unit vector from the camera through `place` in the picture.
    pub(super) fn ray(&self, place: [f64; 2]) -> DVec3 {
        let right = (place[0] - self.centre[0]) / self.focal_length;
        let down = (place[1] - self.centre[1]) / self.focal_length;
        (self.right * right - self.up * down - self.back).normalize()
    }

    /// How much of `mesh` shows in a coarse picture; its front counts a quarter more.
    fn shown(&self, mesh: &Mesh, size: [u32; 2]) -> u64 {
        let longer = size[0].max(size[1]);
        let shrink = longer.div_ceil(192).max(1);
        let [width, height] = size.map(|length| (length / shrink).max(1) as usize);
        let projected: Vec<Projected> = mesh.points.iter().map(|point| self.project(*point)).collect();
        let mut nearest = vec![(0.0f32, 0); width * height];
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| projected[v as usize]);
            let places = corners.map(|corner| corner.place.map(|pixels| pixels / f64::from(shrink)));
            let front = shows_front(places);
            fill_triangle(places, width, 0..height, |x, y, weights| {
                let depth: f64 = (0..3).map(|k| weights[k] * corners[k].inverse_depth).sum();
                let sample = &mut nearest[y * width + x];
                if sample.0 < depth as f32 {
                    *sample = (depth as f32, if front { 5 } else { 4 });
                }
            });
        }
        nearest.iter().map(|sample| sample.1).sum()
    }
}

/// Whether a triangle with corners at `places` in the picture shows its front.
///
/// Pixels count downwards, so that what is counter-clockwise in space has a negative area there.
pub(super) fn shows_front([a, b, c]: [[f64; 2]; 3]) -> bool {
    (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0])
}

/// How a shape lies in space.
#[derive(Clone, Copy, Debug)]
struct Facing {
    /// Angle of the horizontal direction in which it shows most area, from z towards x [rad].
    azimuth: f64,
    /// Share of its area that is level: 0 upright, 1 level.
    levelness: f64,
}

impl Facing {
    /// The principal horizontal direction of the normals of a mesh, weighted with area.
    ///
    /// Where the normals have no preference (a level sheet), the shape is seen across its longer side; where that has
    /// none either, from +z.
    fn of(mesh: &Mesh) -> Self {
        let (mut xx, mut xz, mut yy, mut zz) = (0.0, 0.0, 0.0, 0.0);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
            let area_vector = (b - a).cross(c - a);
            let area = area_vector.length();
            if 0.0 < area {
                xx += area_vector.x * area_vector.x / area;
                xz += area_vector.x * area_vector.z / area;
                yy += area_vector.y * area_vector.y / area;
                zz += area_vector.z * area_vector.z / area;
            }
        }
        let total = xx + yy + zz;
        if total == 0.0 {
            return Self { azimuth: 0.0, levelness: 0.0 };
        }
        // A slight weight of the places: a view along −x looks across whatever extends along z, and so on.
        let count = mesh.points.len() as f64;
        let mean = mesh.points.iter().sum::<DVec3>() / count;
        let (mut extent_xx, mut extent_xz, mut extent_zz) = (0.0, 0.0, 0.0);
        for offset in mesh.points.iter().map(|point| point - mean) {
            extent_xx += offset.x * offset.x / count;
            extent_xz += offset.x * offset.z / count;
            extent_zz += offset.z * offset.z / count;
        }
        let slight = 0.1;
        let difference = (zz - xx) / total + slight * (extent_xx - extent_zz) + 1e-9;
        let product = 2.0 * (xz / total - slight * extent_xz);
        Self { azimuth: 0.5 * libm::atan2(product, difference), levelness: yy / total }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [640, 360];

    fn sheet(across: DVec3, up: DVec3) -> Mesh {
        let points: Vec<DVec3> =
            (0..9).map(|v| across * (f64::from(v % 3) - 1.0) + up * (f64::from(v / 3) - 1.0)).collect();
        let mut mesh = Mesh::default();
        mesh.add_sheet(&points, 3, [1.0, 1.0]);
        mesh
    }

    #[test]
    fn known_points_project_where_they_must() {
        let camera = Camera {
            position: DVec3::new(0.0, 0.0, 2.0),
            right: DVec3::X,
            up: DVec3::Y,
            back: DVec3::Z,
            focal_length: 100.0,
            centre: [320.0, 180.0],
        };
        let origin = camera.project(DVec3::ZERO);
        assert_eq!(origin, Projected { place: [320.0, 180.0], inverse_depth: 0.5 });
        let point = DVec3::new(1.0, 0.5, -2.0);
        assert_eq!(camera.project(point), Projected { place: [345.0, 167.5], inverse_depth: 0.25 });
        let ray = camera.ray([345.0, 167.5]);
        assert!((ray - (point - camera.position).normalize()).length() < 1e-15, "{ray}");
    }

    /// The fit is exact: every point within the margins, and one pair of opposite margins reached.
    #[test]
    fn fit_reaches_the_margins() {
        let points = [DVec3::new(0.3, -0.5, 0.5), DVec3::new(-0.5, 0.4, 0.1), DVec3::new(0.2, 0.5, -0.5)];
        for back in [DVec3::Z, DVec3::new(0.6, 0.48, 0.64), DVec3::new(-0.8, 0.6, 0.0)] {
            let camera = Camera::fit(&points, back, SIZE);
            let places = points.map(|point| camera.project(point).place);
            let share = |axis: usize| {
                let centre = camera.centre[axis];
                let largest = places.iter().map(|place| (place[axis] - centre).abs()).fold(0.0, f64::max);
                2.0 * largest / f64::from(SIZE[axis])
            };
            let [across, along] = [share(0) / FILLED[0], share(1) / FILLED[1]];
            assert!(across < 1.0 + 1e-12 && along < 1.0 + 1e-12, "{back}: {across} {along}");
            assert!(1.0 - 1e-12 < across.max(along), "{back}: {across} {along}");
        }
    }

    #[test]
    fn an_upright_sheet_is_seen_three_quarter_from_its_front() {
        for angle in [0.0, 0.7, 2.0, 3.0, 4.5] {
            let normal = DVec3::new(libm::sin(angle), 0.0, libm::cos(angle));
            let mesh = sheet(DVec3::Y.cross(normal), DVec3::Y);
            let camera = Camera::three_quarter(&mesh, &[], SIZE);
            let cosine = camera.back.dot(normal);
            let exact = libm::cos(ELEVATION[0]) * libm::cos(THREE_QUARTER);
            assert!((cosine - exact).abs() < 1e-6, "at {angle}: {cosine} against {exact}");
        }
    }

    #[test]
    fn a_level_sheet_is_seen_from_higher_up() {
        let camera = Camera::three_quarter(&sheet(DVec3::Z, DVec3::X), &[], SIZE);
        assert!((camera.back.y - libm::sin(ELEVATION[1])).abs() < 1e-12, "{}", camera.back);
    }
}

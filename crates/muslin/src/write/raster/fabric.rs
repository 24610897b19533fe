//! How materials return light.

use glam::DVec3;

use super::light::Light;
use super::studio::{BOUNCE, KEY, SKY};
use super::{Material, smooth_step};

/// Albedo of unbleached cotton, on its front and its back.
const CLOTH: [DVec3; 2] = [DVec3::new(0.80, 0.715, 0.585), DVec3::new(0.72, 0.615, 0.475)];
/// Share of the light on one side that comes through to the other.
const TRANSMITTED: DVec3 = DVec3::new(0.26, 0.205, 0.135);
/// Strength of the sheen of fibres that stand off the cloth.
const SHEEN: f64 = 0.30;
/// Albedo of a bead: beech wood.
const BEAD: DVec3 = DVec3::new(0.50, 0.33, 0.19);
/// Albedo of the head of a pin: red clay.
const PIN: DVec3 = DVec3::new(0.52, 0.125, 0.07);
/// Yarns per length of 1, the size of the drawn shape: few enough that a picture shows them.
const YARNS: f64 = 170.0;

/// A point of a surface, as a picture sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    /// Material of its triangle.
    pub(super) material: Material,
    /// Whether the front is seen.
    pub(super) front: bool,
    /// Unit normal on the side that is seen.
    pub(super) normal: DVec3,
    /// Unit vector to the camera.
    pub(super) view: DVec3,
    /// Place along the weft and the warp, in lengths.
    pub(super) yarns: [f64; 2],
    /// How far `yarns` change over one pixel.
    pub(super) footprint: [f64; 2],
    /// Light that reaches the point.
    pub(super) light: Light,
}

impl SurfacePoint {
    /// Radiance towards the camera, times π, with the key light along the unit vector `key`.
    pub(super) fn eval_radiance(&self, key: DVec3) -> DVec3 {
        let cosine = self.normal.dot(key);
        let Light { key: key_share, front_sky, front_floor, back_sky, back_floor } = self.light;
        let front = SKY * front_sky + BOUNCE * front_floor;
        let back = SKY * back_sky + BOUNCE * back_floor;
        let [near, far] = if self.front { [front, back] } else { [back, front] };
        let direct = KEY * (key_share * cosine.max(0.0));
        match self.material {
            Material::Cloth => {
                let albedo = CLOTH[usize::from(!self.front)] * weave(self.yarns, self.footprint);
                let behind = KEY * (key_share * (-cosine).max(0.0)) + far;
                let grazing = 1.0 - self.normal.dot(self.view).clamp(0.0, 1.0);
                let sheen = SHEEN * grazing * grazing * grazing;
                let lit = direct + near;
                lit * albedo + behind * TRANSMITTED + (direct * 0.5 + near) * sheen
            }
            Material::Thread => (direct + near) * CLOTH[0],
            Material::Bead => (direct + near) * BEAD + self.gloss(key, 40) * (0.35 * key_share),
            Material::Pin => (direct + near) * PIN + self.gloss(key, 40) * (0.45 * key_share),
        }
    }

    /// A soft highlight of the key light: the cosine to the half vector raised to a whole power; none in its lee.
    fn gloss(&self, key: DVec3, power: u32) -> DVec3 {
        if self.normal.dot(key) <= 0.0 {
            return DVec3::ZERO;
        }
        let half = (key + self.view).try_normalize().unwrap_or(self.normal);
        let cosine = half.dot(self.normal).max(0.0);
        KEY * (0..power).fold(1.0, |product, _| product * cosine)
    }
}

/// Brightness of a plain weave at a place along the weft and the warp, about 1.
///
/// Two sets of round yarns cross; each yarn is a little thicker or thinner than its neighbours. What is finer than a
/// pixel fades to its mean, so that the weave never flickers into moiré.
fn weave(place: [f64; 2], footprint: [f64; 2]) -> f64 {
    let [across, along] = place.map(|length| length * YARNS);
    let [across_fade, along_fade] = footprint.map(|length| 1.0 - smooth_step(0.22, 0.55, length * YARNS));
    let turn = |yarns: f64| libm::cos(2.0 * std::f64::consts::PI * yarns);
    let round = 0.5 * (across_fade * turn(across) + along_fade * turn(along));
    let over = across_fade * along_fade * turn(0.5 * across) * turn(0.5 * along);
    let slubs = across_fade * slub(across, along, 1) + along_fade * slub(along, across, 2);
    1.0 + 0.04 * round + 0.02 * over + 0.04 * slubs
}

/// How much a yarn deviates from the mean, from −1 to 1, at a place across the yarns and along it.
fn slub(across: f64, along: f64, set: u32) -> f64 {
    let yarn = across.round();
    let stretch = along / 24.0 + noise(yarn, set) * 16.0;
    let cell = stretch.floor();
    let share = smooth_step(0.0, 1.0, stretch - cell);
    let value = |cell: f64| noise(cell * 3.0 + yarn * 131.0, set + 2);
    value(cell) * (1.0 - share) + value(cell + 1.0) * share
}

/// A number from −1 to 1 that looks random, the same for the same whole number `cell` and `set`.
fn noise(cell: f64, set: u32) -> f64 {
    let mut bits = (cell as i64 as u32).wrapping_mul(0x9e37_79b9) ^ set.wrapping_mul(0x85eb_ca6b);
    for shift in [16, 15, 16] {
        bits = (bits ^ (bits >> shift)).wrapping_mul(0x7feb_352d);
    }
    f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const DARK: Light = Light { key: 0.0, front_sky: 0.0, front_floor: 0.0, back_sky: 0.0, back_floor: 0.0 };
    /// Seen head on, from the front, with yarns too fine to show.
    const HEAD_ON: SurfacePoint = SurfacePoint {
        material: Material::Cloth,
        front: true,
        normal: DVec3::Z,
        view: DVec3::Z,
        yarns: [0.3, 0.7],
        footprint: [1.0, 1.0],
        light: DARK,
    };

    fn assert_close(radiance: DVec3, exact: DVec3) {
        assert!((radiance - exact).length() < 1e-14, "{radiance} against {exact}");
    }

    /// Head on there is no sheen, and cloth returns albedo times cosine of the key light: Lambert's law.
    #[test]
    fn lit_cloth_follows_lambert() {
        let lit = SurfacePoint { light: Light { key: 1.0, ..DARK }, ..HEAD_ON };
        for cosine in [1.0, 0.6, 0.0] {
            let key = DVec3::new(f64::sqrt(1.0 - cosine * cosine), 0.0, cosine);
            assert_close(lit.eval_radiance(key), KEY * CLOTH[0] * cosine);
            let half = SurfacePoint { light: Light { key: 0.5, ..DARK }, ..lit };
            assert_close(half.eval_radiance(key), KEY * CLOTH[0] * (0.5 * cosine));
        }
    }

    #[test]
    fn cloth_lit_from_behind_glows_and_a_pin_does_not() {
        let lit = SurfacePoint { light: Light { key: 1.0, ..DARK }, ..HEAD_ON };
        assert_close(lit.eval_radiance(-DVec3::Z), KEY * TRANSMITTED);
        let pin = SurfacePoint { material: Material::Pin, ..lit };
        assert_close(pin.eval_radiance(-DVec3::Z), DVec3::ZERO);
    }

    /// Each side takes its own irradiance, has its own colour, and passes on the other side's light.
    #[test]
    fn the_two_sides_have_their_own_light_and_colour() {
        let light = Light { front_sky: 1.0, back_floor: 1.0, ..DARK };
        let front = SurfacePoint { light, ..HEAD_ON };
        assert_close(front.eval_radiance(DVec3::Z), SKY * CLOTH[0] + BOUNCE * TRANSMITTED);
        let back = SurfacePoint { front: false, ..front };
        assert_close(back.eval_radiance(DVec3::Z), BOUNCE * CLOTH[1] + SKY * TRANSMITTED);
    }

    #[test]
    fn sheen_brightens_grazing_views() {
        let light = Light { front_sky: 1.0, ..DARK };
        let grazing = SurfacePoint { light, view: DVec3::X, ..HEAD_ON };
        assert_close(grazing.eval_radiance(DVec3::Z), SKY * (CLOTH[0] + SHEEN));
    }

    /// The weave is 1 on average, and exactly 1 where a pixel is coarser than a yarn.
    #[test]
    fn weave_keeps_the_brightness_of_the_cloth() {
        assert_eq!(weave([0.123, 0.456], [1.0, 1.0]), 1.0);
        let side = 400;
        let place = |n: usize| (n as f64 + 0.5) * 8.0 / side as f64;
        let sum: f64 = (0..side * side).map(|n| weave([place(n % side), place(n / side)], [0.0; 2])).sum();
        let mean = sum / (side * side) as f64;
        // Slubs of 0.04 on 2 x 1360 yarns of 57 cells each; their mean deviates by 0.04 / sqrt(2 * 1360 * 57) at most.
        assert!((mean - 1.0).abs() < 4.0 * 0.04 / f64::sqrt(2.0 * 1360.0 * 57.0), "{mean}");
    }
}

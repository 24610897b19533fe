//! Measured fabrics of tests: that which has the stiffnesses of given springs inside of a grid.

use super::{CURVE, CURVE_POINTS, ClothNumbers, LINEAR};

/// Constants of a fabric of kind `"measured"`.
struct Constants {
    areal_density: f64,
    drag: f64,
    /// Moduli along warp and weft [N/m].
    moduli: [f64; 2],
    shear: f64,
    /// Rigidities along warp and weft, and at 45° [N m].
    rigidities: [f64; 3],
}

/// Of what springs of a family resist, bending has this share: its force goes further than that of one spring.
const BENDING_SHARE: f64 = 0.1;

impl ClothNumbers {
    /// The fabric whose particles and springs inside of the grid have the cloth's mass, drag and stiffnesses.
    fn constants(&self) -> Constants {
        let [hx, hy] = [self.width / (self.columns - 1) as f64, self.height / (self.rows - 1) as f64];
        let [structural, shear, bend] = self.stiffnesses;
        let shear = shear * 2.0 * hx * hy / (hx * hx + hy * hy);
        let (square_x, square_y) = (hx * hx, hy * hy);
        let warp = BENDING_SHARE * bend * square_y * hy / hx;
        let weft = BENDING_SHARE * bend * square_x * hx / hy;
        Constants {
            areal_density: self.mass / (hx * hy),
            drag: self.drag / (hx * hy),
            moduli: [
                structural * hy / hx + shear * square_y / square_x,
                structural * hx / hy + shear * square_x / square_y,
            ],
            shear,
            rigidities: [warp, weft, 0.25 * (warp + weft) + 0.25 * BENDING_SHARE * bend * hx * hy],
        }
    }

    /// The fabric's table but for its name, as in a scene file. The first law is that of the yarns; other families are linear.
    pub(super) fn measured_text(&self, index: usize) -> String {
        let Constants { areal_density, drag, moduli, shear, rigidities: [warp, weft, bias] } =
            self.constants();
        let tension = |yarns: usize| match self.laws[0] {
            CURVE => format!("curve = \"{}\"", curve_name(index, yarns)),
            law => match law.split_once("strain_scale") {
                Some((_, scale)) => format!("modulus = {:?}, strain_scale{scale}", moduli[yarns]),
                None => format!("modulus = {:?}", moduli[yarns]),
            },
        };
        // c = τ k of the springs inside of the grid.
        let times = [0, 1, 2].map(|family| match self.dampings[family] {
            0.0 => String::new(),
            damping => format!(", damping_time = {:?}", damping / self.stiffnesses[family]),
        });
        let friction = |text: String| if self.has_friction { text } else { String::new() };
        let along_yarns =
            friction(if self.laws[0] == LINEAR { ", rt = 0.8".to_owned() } else { String::new() });
        let in_shear = friction(format!(", 2hg = {:?}, 2hg5 = {:?}", 0.02 * shear, 0.04 * shear));
        let [warp, weft] = [warp, weft].map(|rigidity| {
            // What holds is as rigid as the fabric; in gf cm/cm no moment is too large.
            let hysteresis = 20.0 * rigidity / 9.80665e-3;
            format!(
                "{{ rigidity = {rigidity:?}{} }}",
                friction(format!(", 2hb_gf_cm_per_cm = {hysteresis:?}"))
            )
        });
        format!(
            "kind = \"measured\"\nareal_density = {areal_density:?}\ndrag = {drag:?}\n\
             warp = {{ {}{along_yarns}{} }}\nweft = {{ {}{along_yarns}{} }}\n\
             shear = {{ modulus = {shear:?}{in_shear}{} }}\n\
             bend = {{ warp = {warp}, weft = {weft}, bias = {bias:?}{} }}\n",
            tension(0),
            times[0],
            tension(1),
            times[0],
            times[1],
            times[2],
        )
    }

    /// The data file that the fabric's table calls `name`.
    pub(super) fn measured_file(&self, index: usize, name: &str) -> Option<Vec<u8>> {
        let yarns = (0..2).find(|&yarns| curve_name(index, yarns) == name)?;
        let modulus = self.constants().moduli[yarns];
        let lines = CURVE_POINTS.map(|[strain, tension]| format!("{strain:?},{:?}\n", modulus * tension));
        Some(format!("strain [1],tension [N/m]\n{}", lines.concat()).into_bytes())
    }
}

fn curve_name(cloth: usize, yarns: usize) -> String {
    format!("cloth{cloth}-{}.csv", ["warp", "weft"][yarns])
}

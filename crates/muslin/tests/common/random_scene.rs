//! Scenes with random numbers.

use proptest::prelude::*;

use super::{
    AirNumbers, CURVE, ClothNumbers, LINEAR, Random, SceneNumbers, SineNumbers, StepNumbers, WindNumbers,
};

/// Half a second of one cloth: any grid up to 8 x 8, any place, pins, motion of pins, wind, gravity, start and force direction.
///
/// The time scales are those of cloth: structural springs of 10 to 300 rad/s alone, drag of up to 20/s. The step is 0.4
/// of what is stable for the flat cloth, which leaves room for as-printed springs to stiffen.
pub(crate) fn random_scene() -> impl Strategy<Value = SceneNumbers> {
    (1..=8_usize, 1..=8_usize, any::<u64>()).prop_map(|(columns, rows, seed)| {
        let mut random = Random::new(seed);
        let mut cloth = random_cloth(columns, rows, &mut random);
        if random.below(3) == 0 {
            let spacing = (cloth.width / columns as f64).min(cloth.height / rows as f64);
            cloth.motion = Some(random_sine(0.05 * spacing, &mut random));
        }
        let winds = (0..random.below(3)).map(|_| random_wind(cloth.mass, &mut random)).collect();
        if random.below(3) == 0 {
            cloth.drag = 0.0;
        }
        // Gershgorin: ω² ≤ 2/m Σ k over the twelve springs of a particle.
        let stiffness: f64 = cloth.stiffnesses.iter().map(|stiffness| 4.0 * stiffness).sum();
        let rate = (2.0 * stiffness / cloth.mass).sqrt();
        // What holds in friction along yarns is twice as stiff as they are.
        let stable = if cloth.has_friction { 1.0 } else { 2.0 } / rate;
        // Dashpots of τ ω < 0.2 shorten the stable step to 2 / 1.4 ω.
        let time = if random.below(3) == 0 { random.between(0.01, 0.2) / rate } else { 0.0 };
        cloth.dampings = cloth.stiffnesses.map(|stiffness| time * stiffness);
        let frame_rate = 20.0;
        SceneNumbers {
            frame_intervals: 10,
            frame_rate,
            steps_per_frame: (1.0 / (frame_rate * 0.4 * stable)).ceil() as u32,
            step_rule: StepNumbers::Constant,
            as_printed_start: random.below(2) == 0,
            allow_unstable: true,
            gravity: if random.below(4) == 0 { [0.0; 3] } else { random.vector(10.0) },
            winds,
            airs: Vec::new(),
            cloths: vec![cloth],
        }
    })
}

/// The same with any laws of tension and any air. Strain scales are so large that springs stiffen by a few times, not without bound.
pub(crate) fn random_law_scene() -> impl Strategy<Value = SceneNumbers> {
    const LAWS: [&str; 4] =
        [LINEAR, "law = \"tangent\", strain_scale = 0.9", "law = \"arctangent-force\"", CURVE];
    let laws = [0..LAWS.len(), 0..LAWS.len(), 0..LAWS.len()];
    (random_scene(), laws, any::<u64>()).prop_map(|(mut numbers, laws, seed)| {
        numbers.airs = random_airs(&numbers.cloths[0], &mut Random::new(seed));
        numbers.cloths[0].laws = laws.map(|law| LAWS[law]);
        numbers
    })
}

/// The same, with any limit or none, which act where forces stretch the cloth.
pub(crate) fn random_limit_scene() -> impl Strategy<Value = SceneNumbers> {
    const LIMITS: [Option<&str>; 4] = [
        None,
        Some("{ kind = \"arctangent-projection\" }"),
        Some("{ kind = \"cut-off\", strain = 0.02, passes = 3 }"),
        Some("{ kind = \"cut-off\", strain = 0.01, shear_strain = 0.02 }"),
    ];
    (random_law_scene(), 0..LIMITS.len()).prop_map(|(mut numbers, limit)| {
        let cloth = &mut numbers.cloths[0];
        // Only springs that exist can have a limit, and none of a measured fabric.
        let limit = if cloth.is_measured { 0 } else { limit };
        cloth.limit = LIMITS[if cloth.stiffnesses[1] > 0.0 { limit } else { limit.min(2) }];
        numbers
    })
}

fn random_cloth(columns: usize, rows: usize, random: &mut Random) -> ClothNumbers {
    let mass = 10.0_f64.powf(-2.0 + 1.5 * random.next());
    let frequency = 10.0_f64.powf(1.7 + 0.7 * random.next());
    let structural = mass * frequency * frequency;
    let mut share = || if random.below(4) == 0 { 0.0 } else { random.between(0.01, 1.0) };
    let stiffnesses = [structural, structural * share(), structural * share()];
    let u = glam::DVec3::from_array(random.vector(1.0)).normalize_or(glam::DVec3::X);
    let v = u.cross(glam::DVec3::from_array(random.vector(1.0))).normalize_or(u.any_orthonormal_vector());
    let mut pins = Vec::new();
    for column in 0..columns {
        pins.extend((0..rows).filter(|_| random.below(12) == 0).map(|row| (column, row)));
    }
    let is_measured = 1 < columns.min(rows) && random.below(3) == 0;
    // No cloth has more than 10 kg/m²; with all in proportion the motion is the same.
    let share = if is_measured { 2.0_f64.powi(-12) } else { 1.0 };
    let mass = mass * share;
    let stiffnesses = stiffnesses.map(|stiffness| stiffness * share);
    let has_friction = is_measured && random.below(2) == 0;
    ClothNumbers {
        columns,
        rows,
        width: random.between(0.2, 2.0),
        height: random.between(0.2, 2.0),
        origin: random.vector(1.0),
        width_axis: (u * random.between(0.1, 3.0)).to_array(),
        height_axis: (v * random.between(0.1, 3.0)).to_array(),
        pins,
        motion: None,
        mass,
        drag: mass * random.between(0.0, 20.0),
        rest_length_direction: random.below(2) == 0,
        stiffnesses,
        laws: [LINEAR; 3],
        limit: None,
        dampings: [0.0; 3],
        has_friction,
        is_measured,
    }
}

/// At time zero a pin is displaced already: by so little that springs stay far from where the tangent law is stiff.
fn random_sine(largest_amplitude: f64, random: &mut Random) -> SineNumbers {
    SineNumbers {
        axis: random.vector(1.0),
        amplitude: random.between(0.0, largest_amplitude),
        frequency: random.between(0.0, 10.0),
        phase: random.between(-3.0, 3.0),
    }
}

fn random_wind(mass: f64, random: &mut Random) -> WindNumbers {
    WindNumbers {
        amplitude: mass * random.between(0.0, 10.0),
        angular_frequency: random.between(0.0, 20.0),
        phase: random.between(-3.0, 3.0),
        direction: random.vector(1.0),
        noise: [0.0; 2],
    }
}

/// Up to two aerodynamic winds of one air, whose damping of a particle is at most as fast as the drag: 30/s.
fn random_airs(cloth: &ClothNumbers, random: &mut Random) -> Vec<AirNumbers> {
    let cells = cloth.columns.max(2) * cloth.rows.max(2);
    // ρ A (C_N + C_T) |u| of a particle, with 30 m/s at most of wind, gusts and cloth.
    let rate = random.between(1.0, 30.0);
    let coefficients = [random.between(0.0, 2.0), random.between(0.0, 0.5)];
    let area = 4.0 * cloth.width * cloth.height / cells as f64;
    let density = rate * cloth.mass / (area * 2.5 * 30.0);
    let mut air = || AirNumbers {
        velocity: random.vector(5.0),
        gust: WindNumbers {
            amplitude: random.between(0.0, 3.0),
            angular_frequency: random.between(0.0, 20.0),
            phase: random.between(-3.0, 3.0),
            direction: random.vector(1.0),
            noise: [random.between(0.0, 1.0), random.between(0.02, 0.5)],
        },
        density,
        coefficients,
    };
    let count = [0, 1, 1, 2][(rate as usize) % 4];
    (0..count).map(|_| air()).collect()
}

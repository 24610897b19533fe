//! A scene with every key that this version knows, and every value that comes out of it.

use glam::DVec3;
use muslin::scene::{
    AirSettings, BendingFriction, BendingModel, BendingRigidity, Expectation, ExpectedQuantity,
    ExpectedRange, Fabric, ForceDirection, GridSettings, GustSettings, InternalFriction, KesTensile,
    LibraryFabric, LimitSettings, MeasuredFabric, MembraneTension, Method, NoiseSettings, PinMotionSettings,
    PinPlace, PinSettings, RetardationTimes, Scene, ShearFriction, SpringLawSettings, SpringSettings, Start,
    StepRule, TensionFriction, WindSettings, rigidity_from_bending_length,
};

const COMPLETE: &str = include_str!("scenes/complete.toml");

#[test]
fn every_value_of_a_complete_scene_is_read() {
    let scene =
        Scene::parse(COMPLETE).unwrap_or_else(|error| panic!("{}", error.render("complete", COMPLETE)));
    assert_eq!(scene.title(), "Hanging cloth");

    let run = scene.run();
    assert_eq!((run.duration, run.frame_rate, run.frame_intervals), (3.0, 50.0, 150));
    assert_eq!(run.method, Method::CentralDifference);
    assert_eq!(run.step, StepRule::Constant { steps_per_frame: 20 });
    assert_eq!((run.start, run.seed, run.allow_unstable), (Start::AsPrinted, 7, true));

    assert_eq!(scene.environment().gravity, DVec3::new(0.0, -9.81, 0.0));
    assert_eq!(
        scene.environment().winds,
        [
            WindSettings::ParticleForce(GustSettings {
                amplitude: 0.002,
                angular_frequency: 6.0,
                phase: -0.5,
                direction: DVec3::Z,
                noise: Some(NoiseSettings { deviation: 0.0005, time: 0.05 }),
            }),
            WindSettings::Aerodynamic(AirSettings {
                velocity: DVec3::new(3.0, 0.0, -4.0),
                gust: Some(GustSettings {
                    amplitude: 0.5,
                    angular_frequency: 2.0,
                    phase: 0.25,
                    direction: DVec3::Y,
                    noise: Some(NoiseSettings { deviation: 0.4, time: 0.3 }),
                }),
                air_density: 1.2,
                normal_coefficient: 1.5,
                tangential_coefficient: 0.05,
            }),
            WindSettings::ParticleForce(GustSettings {
                amplitude: 1.0,
                angular_frequency: 0.0,
                phase: 1.5,
                direction: DVec3::new(0.6, 0.0, -0.8),
                noise: None,
            }),
        ]
    );

    let springs = |stiffness| SpringSettings { stiffness, law: SpringLawSettings::Linear, damping: 0.0 };
    let damped = SpringSettings { damping: 0.01, ..springs(20.0) };
    assert_eq!(scene.fabrics().keys().collect::<Vec<_>>(), ["cotton", "paper", "stiff paper", "wool"]);
    let Fabric::Measured(cotton) = &scene.fabrics()["cotton"] else { panic!("measured") };
    let rigidity = rigidity_from_bending_length(0.124, 0.02);
    let test = KesTensile { extension: 0.1275, linearity: 0.55, force: 490.3325 };
    assert_eq!(
        *cotton,
        MeasuredFabric {
            areal_density: 0.124,
            drag: 0.01,
            warp: MembraneTension::Tangent { modulus: 3600.0, strain_scale: 0.036 },
            weft: test.tension().expect("a law"),
            shear_modulus: 40.0,
            bending: BendingRigidity {
                warp: 9.80665e-6,
                weft: rigidity,
                twist: 8e-6 - 0.25 * (9.80665e-6 + rigidity)
            },
            bending_model: BendingModel::SecondDifferences,
            friction: InternalFriction {
                weft: TensionFriction::from_kes(&test.tension().expect("a law"), 0.1275, 0.7),
                shear: ShearFriction::from_kes(0.5, Some(0.980665)).ok(),
                warp_bend: Some(BendingFriction::from_kes(1e-3)),
                ..InternalFriction::default()
            },
            damping: RetardationTimes { warp: 0.0, weft: 1e-3, shear: 2e-3, bend: 3e-3 },
        }
    );
    let wool = LibraryFabric::find("typical-wool-tropical").expect("it is in the library").fabric();
    assert_eq!(scene.fabrics()["wool"], Fabric::Measured(wool));
    let Fabric::Springs(paper) = &scene.fabrics()["paper"] else { panic!("springs") };
    assert_eq!((paper.particle_mass, paper.drag), (0.002, 0.003));
    assert_eq!(paper.force_direction, ForceDirection::RestLength);
    assert_eq!([&paper.structural, &paper.shear, &paper.bend], [&springs(60.0), &damped, &springs(0.0)]);
    let cut_off = LimitSettings::CutOff { strain: 0.1, shear_strain: Some(0.3), passes: 4 };
    assert_eq!(paper.limit, Some(cut_off));
    let Fabric::Springs(stiff) = &scene.fabrics()["stiff paper"] else { panic!("springs") };
    assert_eq!((stiff.particle_mass, stiff.drag), (1.0, 0.0));
    assert_eq!(stiff.force_direction, ForceDirection::CurrentLength);
    assert_eq!(stiff.limit, Some(LimitSettings::ArctangentProjection));
    assert_eq!([&stiff.structural, &stiff.shear, &stiff.bend], [600.0, 200.0, 20.0].map(springs).each_ref());

    let held = |place| PinSettings { place, motion: None };
    let [sheet, thread] = scene.cloths() else { panic!("two cloths") };
    assert_eq!((sheet.name.as_str(), sheet.fabric.as_str()), ("sheet", "paper"));
    assert_eq!(sheet.grid, GridSettings { columns: 10, rows: 20, width: 1.0, height: 2.5 });
    assert_eq!(sheet.place.origin, DVec3::new(-0.5, 1.0, 0.0));
    assert_eq!((sheet.place.width_axis, sheet.place.height_axis), (DVec3::X, DVec3::Z));
    assert_eq!(
        sheet.pins,
        [
            held(PinPlace::Particle { column: 0, row: 0 }),
            held(PinPlace::Particle { column: 9, row: 0 }),
            held(PinPlace::Row(19)),
            held(PinPlace::Column(0)),
        ]
    );
    assert_eq!((thread.name.as_str(), thread.fabric.as_str()), ("糸", "stiff paper"));
    assert_eq!(thread.grid, GridSettings { columns: 1, rows: 5, width: 0.0, height: 0.4 });
    assert_eq!(thread.place.width_axis, DVec3::new(1.0, 1.0, 0.0) / 2.0_f64.sqrt());
    assert_eq!(thread.place.height_axis, DVec3::NEG_Z);
    let motion = PinMotionSettings::Sine { axis: DVec3::Z, amplitude: 0.1, frequency: 3.0, phase: 0.5 };
    let moving = PinSettings { place: PinPlace::Row(4), motion: Some(motion) };
    assert_eq!(thread.pins, [held(PinPlace::Row(0)), moving]);

    let expectation = |quantity, range| Expectation { quantity, range };
    assert_eq!(
        scene.expectations(),
        [
            expectation(ExpectedQuantity::LowestPoint, ExpectedRange::Between(-0.02, 0.01)),
            expectation(ExpectedQuantity::MaxStrain, ExpectedRange::Below(0.0943)),
            expectation(ExpectedQuantity::EnergyResidual, ExpectedRange::Above(0.0)),
        ]
    );
}

#[test]
fn a_scene_warns_of_what_its_reader_must_know() {
    let scene = Scene::parse(COMPLETE).expect("a good scene");
    assert_eq!(
        scene.warnings(),
        [
            "the cloth `糸` has one row or column and so no faces, on which alone an aerodynamic wind acts",
            "`fabric.paper.limit` shortens springs that are too long after each step, so where it acts the motion \
             depends on the step",
            "`fabric.\"stiff paper\".limit` shortens every stretched spring after each step, so the motion depends \
             strongly on the step: the smaller it is, the stiffer the cloth",
        ]
    );
}

/// A tolerance of more than a tenth of the distance of neighbours, here 0.1 m, is most likely one in millimetres.
#[test]
fn a_scene_warns_of_a_loose_tolerance() {
    let warnings = |step: &str| {
        let text = COMPLETE.replace("{ constant = 1e-3 }", step);
        assert_ne!(text, COMPLETE);
        Scene::parse(&text).expect("a good scene").warnings()
    };
    let usual = Scene::parse(COMPLETE).expect("a good scene").warnings();
    assert_eq!(warnings("\"adaptive\""), usual);
    assert_eq!(warnings("{ tolerance = 1e-4 }"), usual);
    let loose = warnings("{ tolerance = 0.1 }");
    assert_eq!(loose[..usual.len()], usual);
    assert_eq!(
        loose[usual.len()..],
        [
            "`run.step.tolerance` is 0.1 m, more than a tenth of the 0.1 m between neighbours, so it hardly asks for \
          anything"
        ]
    );
}

/// What a scene may leave out has the value that the reference states.
#[test]
fn a_short_scene_has_the_stated_defaults() {
    let text = include_str!("scenes/short.toml");
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{}", error.render("short", text)));
    let run = scene.run();
    assert_eq!((run.frame_rate, run.frame_intervals), (60.0, 30));
    assert_eq!(run.step, StepRule::Constant { steps_per_frame: 1 });
    assert_eq!(run.method, Method::CentralDifference);
    assert_eq!((run.start, run.seed, run.allow_unstable), (Start::Consistent, 0, false));
    assert!(scene.environment().winds.is_empty() && scene.expectations().is_empty());
    let Fabric::Springs(fabric) = &scene.fabrics()["f"] else { panic!("springs") };
    assert_eq!((fabric.force_direction, fabric.limit), (ForceDirection::CurrentLength, None));
    assert_eq!(scene.cloths()[0].grid, GridSettings { columns: 1, rows: 1, width: 0.0, height: 0.0 });
    assert!(scene.cloths()[0].pins.is_empty());
}

/// An aerodynamic wind has sine and noise along its mean velocity unless it says otherwise; and needs neither.
#[test]
fn a_steady_wind_and_the_direction_of_a_gust() {
    let gust = |keys: &str| {
        let wind = format!(
            "wind = [{{ law = 'aerodynamic', air_density = 1.2, normal_coefficient = 1.5, tangential_coefficient = 0, {keys} }}]"
        );
        let gravity = "gravity = [0, 0, 0]";
        let text = include_str!("scenes/short.toml").replace(gravity, &format!("{gravity}, {wind}"));
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}", error.render("wind", &text)));
        let [WindSettings::Aerodynamic(air)] = scene.environment().winds[..] else { panic!("one wind") };
        air.gust
    };
    let sine = "amplitude = 1, angular_frequency = 2, phase = 0";
    assert_eq!(gust("velocity = [0, 0, 0]"), None);
    assert_eq!(gust("velocity = [0, 3, 4], noise = 0, noise_time = 0"), None);
    assert_eq!(gust("velocity = [0, 3, 4], direction = [1, 0, 0]"), None);
    let direction = |keys: &str| gust(keys).map(|gust| gust.direction);
    assert_eq!(direction(&format!("velocity = [0, 3, 4], {sine}")), Some(DVec3::new(0.0, 0.6, 0.8)));
    assert_eq!(
        direction(&format!("velocity = [0, 0, 0], {sine}, direction = [0, 0, -2]")),
        Some(DVec3::NEG_Z)
    );
    assert_eq!(direction("velocity = [5, 0, 0], noise = 0.1, noise_time = 1"), Some(DVec3::X));
}

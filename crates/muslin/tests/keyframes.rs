//! Pins that follow keyframes from a file: what is read, what a person is told, and the motion that it gives.

mod common;

use common::{Random, finish, max_distance};
use glam::{DQuat, DVec3};
use muslin::integrate::Workers;
use muslin::observe::{Recorder, StateHash, relative_residual};
use muslin::scene::{Keyframe, PinMotionSettings, Scene, SceneError};
use muslin::{Points, Simulation};

const BASE: &str = include_str!("scenes/base.toml");

/// The base scene, its corners moved along the file `hand.csv`, without wind.
fn text() -> String {
    let [from, to] = ["[[environment.wind]]", "[fabric.paper]"].map(|mark| BASE.find(mark).expect("a mark"));
    let still = format!("{}{}", &BASE[..from], &BASE[to..]);
    let motion = "motion = { kind = \"keyframes\", file = \"hand.csv\" }";
    still.replace("row = 0 }", &format!("row = 0, {motion} }}"))
}

fn parse(text: &str, file: &str) -> Result<Scene, SceneError> {
    Scene::parse_with(text, &mut |name| {
        assert_eq!(name, "hand.csv");
        Ok(file.as_bytes().to_vec())
    })
}

const HAND: &str = "time [s],x [m],y [m],z [m]\n0,0,0,0\n0.1,0.02,0,0.05\n0.2,0.02,0,0.05\n0.35,0,-0.03,0\n";

#[test]
fn keys_are_read_once_for_all_pins() {
    let mut loads = 0;
    let scene = Scene::parse_with(&text(), &mut |_| {
        loads += 1;
        Ok(HAND.as_bytes().to_vec())
    });
    let scene = scene.expect("a good scene");
    assert_eq!((loads, scene.data_files().len()), (1, 1));
    for pin in &scene.cloths()[0].pins {
        let Some(PinMotionSettings::Keyframes(keyframes)) = &pin.motion else { panic!("keyframes") };
        assert_eq!(keyframes.keys().len(), 4);
        let last = Keyframe { time: 0.35, displacement: DVec3::new(0.0, -0.03, 0.0) };
        assert_eq!(keyframes.keys()[3], last);
    }
}

/// Lines below a good header and first key, the message, and the way out.
const BAD_ROWS: [(&str, &str, &str); 6] = [
    ("", "line 2: time is the only one, but must be followed by a later one", "add a line for each time"),
    ("0.1,0,0", "line 3: has 3 cells, but the header has 4", "write decimal points"),
    ("0.1,0,0,nan", "line 3: z is \"nan\", but must be a finite number", "leave out lines"),
    ("0.1,0,0,1\n0.1,0,0,2", "line 4: time is 0.1 s, but must be above the 0.1 s before it", "sort the rows"),
    ("-1,0,0,1", "line 3: time is -1.0 s, but must be above the 0.0 s before it", "sort the rows"),
    ("1,0,2e30,1", "line 3: y is 2e30 m, but must be at most 1e30 in size", "write it in metres"),
];

#[test]
fn bad_keys_have_their_message() {
    let header = "time [s],x [m],y [m],z [m]\n";
    let rows = BAD_ROWS.map(|(rows, message, help)| (format!("{header}0,0,0,0\n{rows}\n"), message, help));
    let whole = [
        (
            format!("{header}0.5,0,0,0\n1,0,0,1\n"),
            "line 2: time is 0.5 s, but must be 0 in the first row",
            "begin with",
        ),
        (
            format!("{header}0,0,0.2,0\n1,0,0,1\n"),
            "line 2: y is 0.2 m, but must be 0 at time 0",
            "take the first",
        ),
        ("time [s],x [m],y [m]\n0,0,0\n".to_owned(), "line 1: has no column \"z\"", "write the header"),
        (
            "time [ms],x [m],y [m],z [m]\n0,0,0,0\n".to_owned(),
            "line 1: has the unit \"ms\" at the column \"time\", but must have `time [s]`",
            "times are in seconds",
        ),
    ];
    for (file, message, help) in rows.into_iter().chain(whole) {
        let error = parse(&text(), &file).expect_err(&file);
        assert!(error.to_string().starts_with(&format!("`hand.csv` {message}")), "{error}");
        assert!(error.help().is_some_and(|found| found.starts_with(help)), "{:?}", error.help());
    }
    let far = parse(&text(), &format!("{header}0,0,0,0\n1,0,0,1e12\n")).expect_err("too far");
    assert!(
        far.to_string().contains("which goes 1000000000000.0 m far, where positions are known to"),
        "{far}"
    );
}

/// Half a second of the scene with so many steps per frame of 0.02 s, its pins moved along `file`.
fn simulation(text: &str, file: &str, steps_per_frame: u32) -> Simulation {
    let step = format!("constant = {:?}", 0.02 / f64::from(steps_per_frame));
    let text = text.replace("constant = 1e-3", &step);
    let scene = parse(&text, file).unwrap_or_else(|error| panic!("{}", error.render("test", &text)));
    common::simulation(&scene, Workers::single())
}

fn last_positions(mut simulation: Simulation) -> Points {
    finish(&mut simulation, &mut Recorder::default());
    simulation.frame().state.positions.clone()
}

/// Accelerations jump at keys, velocities do not: the method keeps its second order, and so does the ledger. Keys are at
/// frames here.
#[test]
fn a_motion_by_keyframes_is_of_second_order() {
    let file = HAND.replace("0.35", "0.36");
    let runs = [20, 40, 80].map(|steps| {
        let (mut simulation, mut recorder) = (simulation(&text(), &file, steps), Recorder::default());
        finish(&mut simulation, &mut recorder);
        let residual = relative_residual(recorder.frames().iter().map(|frame| &frame.energies));
        (simulation.frame().state.positions.clone(), residual)
    });
    let [a, b, c] = &runs;
    let order = (max_distance(&a.0, &b.0) / max_distance(&b.0, &c.0)).log2();
    assert!((order - 2.0).abs() < 0.05, "{order}");
    for pair in runs.windows(2) {
        let order = (pair[0].1 / pair[1].1).log2();
        assert!((order - 2.0).abs() < 0.05, "{order} of the residual");
    }
}

/// Between frames, too: a jump within a step costs that step, not the order.
#[test]
fn keys_within_a_step_cost_little() {
    let file = HAND.replace("0.35", "0.3512345").replace("0.1,", "0.1034567,");
    let [a, b, c] = [20, 40, 80].map(|steps| last_positions(simulation(&text(), &file, steps)));
    let order = (max_distance(&a, &b) / max_distance(&b, &c)).log2();
    // Where in its step a key falls changes with the step, and with it the size of the error.
    assert!((order - 2.0).abs() < 0.5, "{order}");
}

/// A turned scene with turned keys has the turned motion.
#[test]
fn turned_keys_give_the_turned_motion() {
    let mut random = Random::new(12);
    let axis = DVec3::from_array(random.vector(1.0)).normalize();
    let rotation = DQuat::from_axis_angle(axis, 1.0);
    let turn = |v: [f64; 3]| (rotation * DVec3::from_array(v)).to_array();
    let mut turned = text();
    for (key, vector) in [
        ("gravity", [0.0, -9.81, 0.0]),
        ("origin", [-0.5, 1.0, 0.0]),
        ("width_axis", [1.0, 0.0, 0.0]),
        ("height_axis", [0.0, 0.0, 1.0]),
    ] {
        let start = turned.find(&format!("{key} = [")).expect("the key");
        let end = start + turned[start..].find(']').expect("the end of the vector") + 1;
        turned.replace_range(start..end, &format!("{key} = {:?}", turn(vector)));
    }
    let (header, rows) = HAND.split_once('\n').expect("a header");
    let rows: Vec<String> = rows
        .lines()
        .map(|line| {
            let [t, x, y, z]: [f64; 4] =
                line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<_>>().try_into().unwrap();
            let [x, y, z] = turn([x, y, z]);
            format!("{t:?},{x:?},{y:?},{z:?}")
        })
        .collect();
    let found = last_positions(simulation(&turned, &format!("{header}\n{}\n", rows.join("\n")), 20));
    let expected: Points =
        last_positions(simulation(&text(), HAND, 20)).iter().map(|x| rotation * x).collect();
    // 500 steps carry roundings of 1e-15 m on to 500^1.5 times as much, and neighbouring motions part by ten.
    let error = max_distance(&found, &expected);
    assert!(error < 1e-9, "{error:e} m");
}

#[test]
fn a_motion_by_keyframes_has_the_recorded_bits() {
    let mut run = simulation(&text(), HAND, 20);
    finish(&mut run, &mut Recorder::default());
    let hash = StateHash::new(&run.frame().state.positions, run.frame().velocities);
    common::assert_golden("inline-keyframes", hash);
}

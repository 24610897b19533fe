//! The page holds what went in.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use glam::DVec3;

use super::*;

/// Strain of a particle, made up from its place; a pure function of the positions, as the contract asks.
fn strains_of(positions: &Points, strains: &mut Vec<f32>) {
    strains.clear();
    strains.extend(positions.iter().map(|point| (0.3 * (7.0 * point.x + 3.0 * point.z).sin()) as f32));
}

/// A waving, falling cloth of `columns` x `rows` particles.
fn frames(columns: usize, rows: usize, count: usize) -> Vec<Points> {
    let point = |p: usize, t: f64| {
        let (u, v) = ((p % columns) as f64 * 0.1, (p / columns) as f64 * 0.1);
        DVec3::new(u + 0.05 * (9.0 * t).sin(), 20.0 - 4.9 * t * t, v + 0.2 * (5.0 * u + 8.0 * t).cos())
    };
    (0..count).map(|n| (0..columns * rows).map(|p| point(p, n as f64 / 60.0)).collect()).collect()
}

fn grid(columns: usize, rows: usize) -> Surface {
    let mut surface = Surface::default();
    surface.add_grid(0, columns, rows, usize::MAX);
    surface
}

fn info(title: &str) -> ViewInfo {
    ViewInfo {
        title: title.to_owned(),
        notice: None,
        frame_rate: 60.0,
        facts: vec![("step".to_owned(), "1 ms".to_owned())],
        times: vec![0.0, 1.0 / 60.0],
        energies: vec![ViewSeries { name: "kinetic".to_owned(), values: vec![0.0, f64::NAN] }],
        strains: vec![ViewSeries { name: "structural max".to_owned(), values: vec![0.0, 0.25] }],
    }
}

fn page(info: &ViewInfo, surface: &Surface, pins: &[u32], frames: &mut [Points]) -> io::Result<String> {
    let mut out = Vec::new();
    write_view(&mut out, info, surface, pins, &mut strains_of, frames)?;
    Ok(String::from_utf8(out).unwrap())
}

/// The text of the element with this id, up to the first thing that an HTML parser takes for its end.
fn element<'a>(page: &'a str, id: &str) -> &'a str {
    let start = page.find(&format!("<script id=\"{id}\"")).unwrap();
    let content = start + page[start..].find('>').unwrap() + 1;
    &page[content..content + page[content..].to_lowercase().find("</script").unwrap()]
}

fn description(page: &str) -> Value {
    serde_json::from_str(element(page, "run")).unwrap()
}

/// What a reader finds in the payload.
struct Decoded {
    indices: Vec<u32>,
    /// Per shown frame and vertex.
    positions: Vec<Vec<DVec3>>,
    strains: Vec<Vec<f64>>,
}

/// Reads the payload by its description alone, modulo 2¹⁶ as the page's script does.
fn decode(page: &str) -> Decoded {
    let run = description(page);
    let count = |name: &str| run["counts"][name].as_u64().unwrap() as usize;
    let mut bytes = Vec::new();
    ZlibDecoder::new(&STANDARD.decode(element(page, "frames")).unwrap()[..]).read_to_end(&mut bytes).unwrap();
    let mut rest = &bytes[..];
    let mut take = |length: usize| {
        let (taken, after) = rest.split_at(length);
        rest = after;
        taken.to_vec()
    };
    let index_count = 3 * count("triangles") + 2 * count("lines") + count("points") + count("pins");
    let word = |four: &[u8]| u32::from_le_bytes(four.try_into().unwrap());
    let indices = take(4 * index_count).chunks(4).map(word).collect();
    let vertices = count("vertices");
    let number = |value: &Value| value.as_f64().unwrap();
    let low = DVec3::from_array([0, 1, 2].map(|axis| number(&run["low"][axis])));
    let (quantum, largest) = (number(&run["quantum"]), number(&run["largestStrain"]));
    let frame_intervals = run["frameCount"].as_u64().unwrap() - 1;
    let shown = frame_intervals.div_ceil(run["frameStride"].as_u64().unwrap()) + 1;

    let mut decoded = Decoded { indices, positions: Vec::new(), strains: Vec::new() };
    let mut history = vec![[[0u16; 2]; 3]; vertices];
    let mut steps = vec![0i8; vertices];
    for frame in 0..shown {
        let origin = take(12).chunks(4).map(|four| word(four).cast_signed()).collect::<Vec<_>>();
        let mut points = vec![DVec3::ZERO; vertices];
        for axis in 0..3 {
            let (low_bytes, high_bytes) = (take(vertices), take(vertices));
            let mut drift = if frame == 0 { origin[axis] as u16 } else { 0 };
            for vertex in 0..vertices {
                let folded = u16::from_le_bytes([low_bytes[vertex], high_bytes[vertex]]);
                drift = drift.wrapping_add((folded >> 1) ^ (folded & 1).wrapping_neg());
                let [before, two_before] = history[vertex][axis];
                let predicted = match frame {
                    0 => 0,
                    1 => before,
                    _ => before.wrapping_mul(2).wrapping_sub(two_before),
                };
                let coordinate = predicted.wrapping_add(drift);
                history[vertex][axis] = [coordinate, before];
                let above_origin = coordinate.wrapping_sub(origin[axis] as u16);
                points[vertex][axis] = f64::from(origin[axis]) + f64::from(above_origin);
            }
        }
        decoded.positions.push(points.into_iter().map(|point| low + point * quantum).collect());
        for (step, byte) in steps.iter_mut().zip(take(vertices)) {
            *step = step.wrapping_add(byte.cast_signed());
        }
        let strain = |step: &i8| f64::from(step.signum()) * largest * (f64::from(*step) / 127.0).powi(2);
        decoded.strains.push(steps.iter().map(strain).collect());
    }
    assert!(rest.is_empty(), "{} bytes too many", rest.len());
    decoded
}

/// Writes, reads back, and compares every position and strain of the frames `shown`.
fn round_trip(surface: &Surface, pins: &[u32], frames: &mut [Points], shown: &[usize]) -> Decoded {
    let page = page(&info("round trip"), surface, pins, frames).unwrap();
    let decoded = decode(&page);
    assert_eq!(decoded.positions.len(), shown.len());
    let vertex_points = |n: usize| surface.vertices.iter().map(move |&p| (p, n));
    let extent_of = |axis: usize, frames: &[Points]| {
        let values = || {
            frames.iter().flat_map(|frame| surface.vertices.iter().map(move |&p| frame.get(p as usize)[axis]))
        };
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let largest = |frames: &[Points]| (0..3).map(|axis| extent_of(axis, frames)).fold(0.0, f64::max);
    let frame_extent = frames.iter().map(|frame| largest(std::slice::from_ref(frame))).fold(0.0, f64::max);
    // Half a quantum by rounding; the conversions add some ulps of the largest coordinate, here below 32 m.
    let quantum = (frame_extent / 65534.0).max(largest(frames) / 2f64.powi(30));
    let bound = 0.5 * quantum + 32.0 * 8.0 * f64::EPSILON;
    let mut strains = Vec::new();
    let strain_of = |frame: &Points, strains: &mut Vec<f32>| {
        strains_of(frame, strains);
        surface.vertices.iter().map(|&p| f64::from(strains[p as usize])).collect::<Vec<_>>()
    };
    let largest_strain = shown
        .iter()
        .flat_map(|&n| strain_of(&frames[n], &mut strains))
        .fold(0.0, |largest: f64, strain| largest.max(strain.abs()));
    for (index, &n) in shown.iter().enumerate() {
        let expected_strains = strain_of(&frames[n], &mut strains);
        for (vertex, (particle, frame)) in vertex_points(n).enumerate() {
            let expected = frames[frame].get(particle as usize);
            let error = (decoded.positions[index][vertex] - expected).abs().max_element();
            assert!(error <= bound, "frame {n}, vertex {vertex}: {error:e} m is over {bound:e} m");
            // The root u of the strain is off by at most h, half of 1/127: |(u ± h)² - u²| <= 2 u h + h².
            let (strain, half) = (expected_strains[vertex], 0.5 / 127.0);
            let root = (strain.abs() / largest_strain).sqrt();
            let strain_bound = largest_strain * (2.0 * root * half + half * half) * (1.0 + 1e-9);
            let strain_error = (decoded.strains[index][vertex] - strain).abs();
            assert!(
                strain_error <= strain_bound,
                "frame {n}, vertex {vertex}: strain off by {strain_error:e}"
            );
        }
    }
    decoded
}

fn all(frames: &[Points]) -> Vec<usize> {
    (0..frames.len()).collect()
}

#[test]
fn a_sheet_comes_back_within_half_a_quantum() {
    let (surface, mut frames) = (grid(12, 9), frames(12, 9, 120));
    let shown = all(&frames);
    let decoded = round_trip(&surface, &[0, 11], &mut frames, &shown);
    let triangles = surface.triangles.as_flattened();
    assert_eq!(decoded.indices[..triangles.len()], *triangles);
    assert_eq!(decoded.indices[triangles.len()..], [0, 11]);
}

#[test]
fn jumps_of_the_whole_range_come_back() {
    let mut jumping: Vec<Points> = vec![Points::zeros(9); 6];
    for (n, frame) in jumping.iter_mut().enumerate() {
        for particle in 0..9 {
            let sign = if (n * 7 + particle * 5) % 3 == 0 { -1.0 } else { 1.0 };
            frame.set(particle, DVec3::new(sign * 10.0, -sign * 10.0, sign * (particle as f64)));
        }
    }
    let shown = all(&jumping);
    round_trip(&grid(3, 3), &[], &mut jumping, &shown);
}

#[test]
fn lines_points_and_left_out_particles_come_back() {
    let mut surface = Surface::default();
    surface.add_grid(0, 1, 5, usize::MAX);
    surface.add_grid(7, 1, 1, usize::MAX);
    let mut frames = frames(4, 3, 8);
    let shown = all(&frames);
    let decoded = round_trip(&surface, &[0, 6, 7], &mut frames, &shown);
    // Lines, points, and the pins among the vertices: particle 6 is not drawn, particle 7 is vertex 5.
    assert_eq!(decoded.indices, [0, 1, 1, 2, 2, 3, 3, 4, 5, 0, 5]);
}

#[test]
fn a_lone_particle_and_a_single_frame_come_back() {
    let surface = grid(1, 1);
    let mut falling = frames(1, 1, 40);
    let shown = all(&falling);
    round_trip(&surface, &[], &mut falling, &shown);
    round_trip(&surface, &[], &mut falling[..1], &[0]);
    round_trip(&grid(4, 3), &[], &mut frames(4, 3, 1), &[0]);
}

#[test]
fn a_run_over_the_budget_shows_every_nth_frame_and_the_last() {
    // 8192 vertices leave room for 256 of the 300 frames: every second one gives 150, and the last.
    let (columns, rows) = (128, 64);
    let mut frames = frames(columns, rows, 300);
    let page = page(&info("long"), &grid(columns, rows), &[], &mut frames).unwrap();
    assert_eq!(description(&page)["frameStride"], 2);
    let decoded = decode(&page);
    assert_eq!(decoded.positions.len(), 151);
    let (shown, expected) = (decoded.positions[150][0], frames[299].get(0));
    assert!((shown - expected).length() < 1e-3, "the last frame is {shown}, not {expected}");
}

#[test]
fn a_stride_is_the_smallest_that_fits() {
    for (frame_count, vertex_count, budget) in
        [(1, 5, 10), (2, 100, 10), (181, 100, 18_100), (182, 100, 18_100), (1000, 7, 999), (5, 1, 4)]
    {
        let stride = frame_stride(frame_count, vertex_count, budget);
        let shown = shown_frames(frame_count, stride);
        let fits = |stride| shown_frames(frame_count, stride).len() * vertex_count <= budget;
        assert!(fits(stride) || shown.len() <= 2, "{frame_count} frames: {} are shown", shown.len());
        assert!(stride == 1 || !fits(stride - 1), "{frame_count} frames: {stride} is not the smallest");
        assert_eq!((shown.first(), shown.last()), (Some(&0), Some(&(frame_count - 1))));
    }
}

#[test]
fn no_title_becomes_markup() {
    let title = "</script><b>&amp; <!-- <script> ]]> \" ' \\ \u{2028} @@RUN@@ @@FRAMES@@ $& Fahne 布 \u{0}";
    let mut info = info(title);
    info.facts = vec![(title.to_owned(), title.to_owned())];
    info.energies[0].name = title.to_owned();
    let surface = grid(2, 2);
    let hostile = page(&info, &surface, &[], &mut frames(2, 2, 2)).unwrap();
    let run = description(&hostile);
    assert_eq!(run["title"], title);
    assert_eq!(run["facts"][0], json!([title, title]));
    assert_eq!(run["energies"][0]["name"], title);
    // Apart from the places for content, the page is the template's, so it has as many tags as a page without.
    let harmless =
        page(&ViewInfo { title: "x".to_owned(), ..info }, &surface, &[], &mut frames(2, 2, 2)).unwrap();
    assert_eq!(hostile.matches('<').count(), harmless.matches('<').count());
    assert!(hostile.contains("<h1 id=\"title\" dir=\"auto\">&lt;/script&gt;&lt;b&gt;&amp;amp; "));
    assert_eq!(decode(&hostile).positions.len(), 2);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let write = || page(&info("twice"), &grid(9, 7), &[3], &mut frames(9, 7, 30)).unwrap();
    assert!(write() == write());
}

#[test]
fn values_that_are_not_finite_leave_gaps() {
    let page = page(&info("gap"), &grid(2, 2), &[], &mut frames(2, 2, 2)).unwrap();
    assert_eq!(description(&page)["energies"][0]["values"], json!([0.0, null]));
}

#[test]
fn series_end_with_the_last_frame() {
    let unstable = ViewInfo {
        times: vec![0.0, 1.0 / 60.0, 2.0 / 60.0],
        energies: vec![ViewSeries { name: "kinetic".to_owned(), values: vec![0.0, 1.0, 1e300] }],
        strains: Vec::new(),
        ..info("unstable")
    };
    let page = page(&unstable, &grid(2, 2), &[], &mut frames(2, 2, 2)).unwrap();
    assert_eq!(description(&page)["times"], json!([0.0, 1.0 / 60.0]));
    assert_eq!(description(&page)["energies"][0]["values"], json!([0.0, 1.0]));
}

#[test]
fn a_notice_is_escaped_and_a_blank_title_replaced() {
    let notice = "Stopped at 1.2 s: </script> particle 12 has no finite position";
    let stopped = ViewInfo { notice: Some(notice.to_owned()), ..info(" \t") };
    let stopped = page(&stopped, &grid(2, 2), &[], &mut frames(2, 2, 2)).unwrap();
    assert_eq!(description(&stopped)["notice"], notice);
    assert!(stopped.contains("<title>muslin</title>"));
    let done = page(&info("done"), &grid(2, 2), &[], &mut frames(2, 2, 2)).unwrap();
    assert_eq!(description(&done)["notice"], Value::Null);
}

#[test]
fn bad_input_is_an_error_that_says_so() {
    let message = |info: &ViewInfo, surface: &Surface, frames: &mut [Points]| {
        page(info, surface, &[], frames).map(|_| ()).unwrap_err().to_string()
    };
    let (good, surface) = (info("bad"), grid(2, 2));
    assert_eq!(message(&good, &surface, &mut []), "a page needs at least one frame");
    assert_eq!(message(&good, &Surface::default(), &mut frames(2, 2, 2)), "a page needs at least one vertex");
    let mut broken = frames(2, 2, 2);
    broken[1].y[3] = f64::NAN;
    assert_eq!(message(&good, &surface, &mut broken), "frame 1: the position of particle 3 is not finite");
    (broken[1].y[3], broken[1].y[2]) = (f64::MAX, f64::MIN);
    assert_eq!(message(&good, &surface, &mut broken), "the extent of the run is too large for a number");
    let rate = ViewInfo { frame_rate: 0.0, ..good.clone() };
    assert_eq!(
        message(&rate, &surface, &mut frames(2, 2, 2)),
        "the frame rate is 0 1/s, but must be positive and finite"
    );
    let short = ViewInfo { times: vec![0.0], ..good };
    assert_eq!(
        message(&short, &surface, &mut frames(2, 2, 2)),
        "the series `kinetic` has 2 values, but there are 1 times"
    );
}

#[test]
fn infinite_strains_count_as_the_largest_and_nan_is_an_error() {
    let surface = grid(2, 1);
    let written = |values: [f32; 2]| {
        let mut out = Vec::new();
        let mut strains = |_: &Points, strains: &mut Vec<f32>| *strains = values.to_vec();
        write_view(&mut out, &info("strain"), &surface, &[], &mut strains, &mut frames(2, 1, 1)[..])
            .map(|()| String::from_utf8(out).unwrap())
    };
    // Without a finite strain there is nothing to count an infinite one as.
    assert_eq!(decode(&written([f32::INFINITY, 0.0]).unwrap()).strains[0], [0.0, 0.0]);
    assert_eq!(decode(&written([f32::NEG_INFINITY, 0.5]).unwrap()).strains[0], [-0.5, 0.5]);
    let error = written([0.0, f32::NAN]).unwrap_err().to_string();
    assert_eq!(error, "frame 0: the strain of particle 1 is not a number");
}

#[test]
fn a_far_flung_run_comes_back() {
    let mut far = frames(2, 2, 3);
    far[2].set(3, DVec3::new(1e300, -1e300, 1e300));
    let decoded = decode(&page(&info("far"), &grid(2, 2), &[], &mut far).unwrap());
    // Half a quantum of 1e300 m / 65534, and round-off.
    let bound = 1e300 / 65534.0 * 0.5 * (1.0 + 1e-9);
    let errors = (decoded.positions[2][3] - far[2].get(3)).abs();
    assert!(errors.max_element() <= bound, "{errors}");
}

//! Files read back with nothing but the container's rules and its own JSON.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use serde_json::Value;

use super::*;

/// The two chunks of a file, its lengths checked.
struct Glb {
    json: Value,
    binary: Vec<u8>,
}

impl Glb {
    fn parse(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let text = word(12);
        assert_eq!((&bytes[16..20], text % 4), (&b"JSON"[..], 0));
        let binary = 20 + text;
        assert_eq!((&bytes[binary + 4..binary + 8], word(binary) % 4), (&b"BIN\0"[..], 0));
        assert_eq!(binary + 8 + word(binary), bytes.len());
        let json: Value = serde_json::from_slice(&bytes[20..binary]).unwrap();
        assert_eq!(json["buffers"][0]["byteLength"], word(binary));
        Self { json, binary: bytes[binary + 8..].to_vec() }
    }

    /// The words of an accessor, `width` at a time; that it lies in its view and the view in the chunk is checked.
    fn words(&self, accessor: &Value) -> Vec<Vec<u32>> {
        let accessor = &self.json["accessors"][number(accessor)];
        let view = &self.json["bufferViews"][number(&accessor["bufferView"])];
        let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
        assert!(start % 4 == 0 && 0 < length && start + length <= self.binary.len(), "{view}");
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            other => panic!("{other}"),
        };
        if !view["byteStride"].is_null() {
            assert_eq!(number(&view["byteStride"]), width * 4);
        }
        let (offset, size) = (number(&accessor["byteOffset"]), number(&accessor["count"]) * width * 4);
        assert!(offset % 4 == 0 && 0 < size && offset + size <= length, "{accessor} in {view}");
        let (words, _) = self.binary[start + offset..][..size].as_chunks::<4>();
        words
            .chunks(width)
            .map(|words| words.iter().map(|&word| u32::from_le_bytes(word)).collect())
            .collect()
    }

    fn vectors(&self, accessor: &Value) -> Vec<Vec3> {
        let vector = |words: &Vec<u32>| Vec3::from_array([0, 1, 2].map(|n| f32::from_bits(words[n])));
        self.words(accessor).iter().map(vector).collect()
    }

    fn scalars(&self, accessor: &Value) -> Vec<f32> {
        self.words(accessor).iter().map(|words| f32::from_bits(words[0])).collect()
    }

    /// Positions, after comparing them with the accessor's own bounds, bit for bit.
    fn positions(&self, accessor: &Value) -> Vec<Vec3> {
        let positions = self.vectors(accessor);
        let min = positions.iter().copied().reduce(Vec3::min).unwrap();
        let max = positions.iter().copied().reduce(Vec3::max).unwrap();
        let accessor = &self.json["accessors"][number(accessor)];
        for axis in 0..3 {
            assert_eq!(accessor["min"][axis].as_f64(), Some(f64::from(min[axis])));
            assert_eq!(accessor["max"][axis].as_f64(), Some(f64::from(max[axis])));
        }
        positions
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no number")) as usize
}

/// A sheet of 5 x 4 that waves, a string of 3 and a bead, at `frame` of 60 per second.
fn frame(frame: usize) -> Points {
    let phase = TAU * frame as f64 / 60.0;
    let sheet = (0..20).map(|p| {
        let (u, v) = ((p % 5) as f64 / 4.0, (p / 5) as f64 / 3.0);
        DVec3::new(u, 1.0 - v, 0.3 * v * (phase + 4.0 * u).sin())
    });
    let string = (0..3).map(|n| DVec3::new(2.0, 1.0 - 0.1 * f64::from(n), 0.01 * phase));
    sheet.chain(string).chain([DVec3::new(1e3 / 3.0, -phase, 1e-9)]).collect()
}

fn surface() -> Surface {
    let mut surface = Surface::default();
    surface.add_grid(0, 5, 4, usize::MAX);
    surface.add_grid(20, 1, 3, usize::MAX);
    surface.add_grid(23, 1, 1, usize::MAX);
    surface
}

const INFO: GlbInfo = GlbInfo {
    title: "Tuch \"weiß\" \\ 布 \u{1F9F5}\n",
    cloth_names: &["sheet", "a \"string\"", "珠"],
    frame_rate: 60.0,
};

fn written(info: &GlbInfo, surface: &Surface, frames: &mut [Points]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_glb(&mut bytes, info, surface, frames).unwrap();
    bytes
}

/// Every frame, rebuilt as a viewer does from the first and its target, is the frame that went in.
#[test]
fn every_frame_is_there() {
    let mut frames: Vec<Points> = (0..31).map(frame).collect();
    let bytes = written(&INFO, &surface(), &mut frames);
    assert_eq!(bytes, written(&INFO, &surface(), &mut frames), "the same input gives the same bytes");
    let glb = Glb::parse(&bytes);
    assert_eq!(glb.json["scenes"][0]["name"], INFO.title);
    let mut drawn = Surface::default();
    drawn.add_grid(0, 5, 4, usize::MAX);
    for (number, (first, count, mode)) in [(0, 20, 4), (20, 3, 1), (23, 1, 0)].into_iter().enumerate() {
        let mesh = &glb.json["meshes"][number];
        let primitive = &mesh["primitives"][0];
        assert_eq!(glb.json["nodes"][number]["name"], INFO.cloth_names[number]);
        assert_eq!(
            (&mesh["extras"]["targetNames"][29], &primitive["mode"]),
            (&"frame 30".into(), &mode.into())
        );
        let base = glb.positions(&primitive["attributes"]["POSITION"]);
        assert_eq!((base.len(), primitive["targets"].as_array().unwrap().len()), (count, 30));
        for (n, points) in frames.iter().enumerate() {
            let differences = match n {
                0 => vec![Vec3::ZERO; count],
                _ => glb.positions(&primitive["targets"][n - 1]["POSITION"]),
            };
            for vertex in 0..count {
                let expected = points.get(first + vertex);
                let found = (base[vertex] + differences[vertex]).as_dvec3();
                // Rounding of the difference and of the sum: half a unit in the last place each.
                let scale =
                    expected.abs() + differences[vertex].as_dvec3().abs() + base[vertex].as_dvec3().abs();
                let error = (found - expected).abs();
                assert!(
                    error.cmple(scale * f64::from(f32::EPSILON)).all(),
                    "frame {n}, vertex {vertex}: {error}"
                );
            }
        }
    }
    let primitive = &glb.json["meshes"][0]["primitives"][0];
    let base = glb.vectors(&primitive["attributes"]["NORMAL"]);
    let mut expected = Vec::new();
    for (n, points) in frames.iter().enumerate().skip(1) {
        drawn.eval_normals(points, &mut expected);
        let differences = glb.vectors(&primitive["targets"][n - 1]["NORMAL"]);
        for vertex in 0..20 {
            let error = (base[vertex] + differences[vertex] - Vec3::from_array(expected[vertex])).abs();
            // Coordinates up to 1 and differences up to 2, each rounded by at most half a unit in the last place.
            assert!(error.max_element() <= 2.0 * f32::EPSILON, "frame {n}, vertex {vertex}: {error}");
        }
    }
}

#[test]
fn a_sheet_has_triangles_within_its_mesh_and_texture_coordinates_from_zero_to_one() {
    let mut two = Surface::default();
    two.add_grid(0, 2, 2, usize::MAX);
    two.add_grid(4, 4, 4, usize::MAX);
    let info = GlbInfo { cloth_names: &["a", "b"], ..INFO };
    let glb = Glb::parse(&written(&info, &two, &mut [frame(0), frame(1)]));
    for (mesh, count) in [(0, 4), (1, 16)] {
        let primitive = &glb.json["meshes"][mesh]["primitives"][0];
        let indices = glb.words(&primitive["indices"]);
        assert_eq!(indices.iter().flatten().max(), Some(&(count - 1)));
        let texture = glb.words(&primitive["attributes"]["TEXCOORD_0"]);
        let ends: [Vec<f32>; 2] = [texture.first(), texture.last()]
            .map(|uv| uv.unwrap().iter().map(|&w| f32::from_bits(w)).collect());
        assert_eq!(ends, [vec![0.0, 0.0], vec![1.0, 1.0]]);
        assert_eq!(f32::from_bits(texture[1][0]), if mesh == 0 { 1.0 } else { 1.0 / 3.0 });
        assert!(glb.vectors(&primitive["attributes"]["NORMAL"]).iter().all(|normal| normal.is_normalized()));
    }
}

#[test]
fn each_key_shows_its_frame_at_its_time() {
    let mut frames: Vec<Points> = (0..5).map(frame).collect();
    let glb = Glb::parse(&written(&INFO, &surface(), &mut frames));
    let animation = &glb.json["animations"][0];
    let sampler = &animation["samplers"][0];
    assert_eq!(
        (&sampler["interpolation"], animation["channels"].as_array().unwrap().len()),
        (&"LINEAR".into(), 3)
    );
    let times = glb.scalars(&sampler["input"]);
    assert_eq!(times, [0.0, 1.0 / 60.0, 2.0 / 60.0, 3.0 / 60.0, 4.0 / 60.0].map(|time: f64| time as f32));
    let input = &glb.json["accessors"][number(&sampler["input"])];
    assert_eq!((input["min"][0].as_f64(), input["max"][0].as_f64()), (Some(0.0), Some(f64::from(times[4]))));
    let weights = glb.scalars(&sampler["output"]);
    for (key, row) in weights.chunks(4).enumerate() {
        let expected: Vec<f32> = (1..5).map(|target| if target == key { 1.0 } else { 0.0 }).collect();
        assert_eq!(row, expected);
    }
    assert_eq!(weights.len(), 20);
}

#[test]
fn a_single_frame_is_a_still() {
    let glb = Glb::parse(&written(&INFO, &surface(), &mut [frame(7)]));
    assert!(glb.json["animations"].is_null() && glb.json["meshes"][0]["primitives"][0]["targets"].is_null());
    assert_eq!(glb.positions(&glb.json["meshes"][2]["primitives"][0]["attributes"]["POSITION"]).len(), 1);
}

#[test]
fn lines_and_points_alone_have_no_normals() {
    let mut surface = Surface::default();
    surface.add_grid(20, 1, 3, usize::MAX);
    surface.add_grid(23, 1, 1, usize::MAX);
    let info = GlbInfo { cloth_names: &["string", "bead"], ..INFO };
    let glb = Glb::parse(&written(&info, &surface, &mut [frame(0), frame(9)]));
    for mesh in 0..2 {
        let primitive = &glb.json["meshes"][mesh]["primitives"][0];
        assert_eq!(primitive["attributes"].as_object().unwrap().keys().collect::<Vec<_>>(), ["POSITION"]);
        assert_eq!(primitive["targets"][0].as_object().unwrap().keys().collect::<Vec<_>>(), ["POSITION"]);
        assert!(glb.words(&primitive["indices"]).len() <= 4);
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let error = |info: &GlbInfo, surface: &Surface, frames: &mut [Points]| {
        write_glb(Vec::new(), info, surface, frames).unwrap_err().to_string()
    };
    let still = || [frame(0)];
    assert_eq!(error(&INFO, &surface(), &mut []), "there is no frame to write");
    assert_eq!(error(&INFO, &Surface::default(), &mut still()), "there is nothing to draw");
    let two_names = GlbInfo { cloth_names: &["a", "b"], ..INFO };
    assert_eq!(error(&two_names, &surface(), &mut still()), "2 names for 3 cloths");
    for frame_rate in [0.0, -60.0, f64::NAN, f64::INFINITY, 1e-300] {
        let info = GlbInfo { frame_rate, ..INFO };
        let message = format!("{frame_rate} frames per second give no ascending times");
        assert_eq!(error(&info, &surface(), &mut [frame(0), frame(1)]), message);
    }
    let mut frames = [frame(0), frame(1)];
    frames[1].set(21, DVec3::new(0.0, 1e39, 0.0));
    let message = error(&INFO, &surface(), &mut frames);
    assert!(message.starts_with("particle 21 of frame 1 is at [0, 1000"), "{message}");
    frames[1].set(21, DVec3::NAN);
    assert_eq!(
        error(&INFO, &surface(), &mut frames),
        "particle 21 of frame 1 is at [NaN, NaN, NaN] m, which 32 bits do not hold"
    );
    frames[1] = Points::zeros(20);
    assert_eq!(
        error(&INFO, &surface(), &mut frames),
        "frame 1 has 20 particles, but the surface needs particle 20"
    );
}

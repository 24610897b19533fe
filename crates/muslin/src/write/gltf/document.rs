//! The JSON chunk: what the arrays in the binary chunk mean.

use serde_json::{Value, json};

use super::GlbInfo;
use super::layout::{Layout, frame_places, has_area, indices};
use crate::model::Surface;

/// Smallest and largest coordinates of an array of positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    pub(super) fn include(&mut self, point: [f32; 3]) {
        for (axis, coordinate) in point.into_iter().enumerate() {
            self.min[axis] = self.min[axis].min(coordinate);
            self.max[axis] = self.max[axis].max(coordinate);
        }
    }
}

/// Component types and buffer targets, numbered as in OpenGL.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Accessors and buffer views, numbered as they are added.
#[derive(Default)]
struct Arrays {
    accessors: Vec<Value>,
    views: Vec<Value>,
}

impl Arrays {
    fn add_view(&mut self, view: Value) -> usize {
        self.views.push(view);
        self.views.len() - 1
    }

    fn add(&mut self, view: usize, offset: u64, component: u32, count: usize, shape: &str) -> usize {
        self.accessors.push(json!({
            "bufferView": view, "byteOffset": offset, "componentType": component, "count": count, "type": shape
        }));
        self.accessors.len() - 1
    }

    fn add_positions(&mut self, view: usize, offset: u64, count: usize, bounds: Bounds) -> usize {
        let accessor = self.add(view, offset, FLOAT, count, "VEC3");
        self.accessors[accessor]["min"] = json!(bounds.min.map(f64::from));
        self.accessors[accessor]["max"] = json!(bounds.max.map(f64::from));
        accessor
    }
}

/// The whole document. `bounds` are per key, then per grid: of the positions for key 0, then of their differences.
pub(super) fn document(
    info: &GlbInfo,
    surface: &Surface,
    layout: &Layout,
    keys: &[usize],
    times: &[f32],
    bounds: &[Vec<Bounds>],
) -> Value {
    let mut arrays = Arrays::default();
    let mut meshes = meshes(&mut arrays, surface, layout, bounds);
    let mut document = json!({
        "asset": { "version": "2.0", "generator": concat!("muslin ", env!("CARGO_PKG_VERSION")) },
        "extensionsUsed": ["KHR_materials_sheen"],
        "scene": 0,
        "scenes": [{ "name": info.title, "nodes": (0..meshes.len()).collect::<Vec<_>>() }],
        "nodes": info.cloth_names.iter().enumerate()
            .map(|(mesh, name)| json!({ "name": name, "mesh": mesh })).collect::<Vec<_>>(),
        "materials": [material()],
        "meshes": [],
    });
    let target_names: Vec<String> = keys[1..].iter().map(|frame| format!("frame {frame}")).collect();
    for (mesh, name) in meshes.iter_mut().zip(info.cloth_names) {
        mesh["name"] = json!(name);
        if !target_names.is_empty() {
            mesh["extras"] = json!({ "targetNames": target_names });
        }
    }
    document["meshes"] = Value::Array(meshes);
    if !target_names.is_empty() {
        document["animations"] = json!([animation(&mut arrays, info, layout, times)]);
    }
    document["accessors"] = Value::Array(arrays.accessors);
    document["bufferViews"] = Value::Array(arrays.views);
    document["buffers"] = json!([{ "byteLength": layout.length() }]);
    document
}

/// A mesh per grid, without its name.
fn meshes(arrays: &mut Arrays, surface: &Surface, layout: &Layout, bounds: &[Vec<Bounds>]) -> Vec<Value> {
    let vertex_view = |section: &std::ops::Range<u64>, stride: u32| {
        json!({ "buffer": 0, "byteOffset": section.start, "byteLength": section.end - section.start,
            "byteStride": stride, "target": ARRAY_BUFFER })
    };
    let base = arrays.add_view(vertex_view(&layout.base, 12));
    let index = arrays.add_view(json!({ "buffer": 0, "byteOffset": layout.indices.start,
        "byteLength": layout.indices.end - layout.indices.start, "target": ELEMENT_ARRAY_BUFFER }));
    let texture = (!layout.texture.is_empty()).then(|| arrays.add_view(vertex_view(&layout.texture, 8)));
    let target = (!layout.targets.is_empty()).then(|| arrays.add_view(vertex_view(&layout.targets, 12)));

    let (mut texture_offset, mut index_offset) = (0, 0);
    let frame_length = layout.base.end - layout.base.start;
    let mut meshes = Vec::new();
    for (number, (grid, (positions, normals))) in surface.grids.iter().zip(frame_places(surface)).enumerate()
    {
        let count = grid.vertices.len();
        let mut attributes =
            json!({ "POSITION": arrays.add_positions(base, positions, count, bounds[0][number]) });
        if let (Some(normals), Some(texture)) = (normals, texture) {
            attributes["NORMAL"] = json!(arrays.add(base, normals, FLOAT, count, "VEC3"));
            attributes["TEXCOORD_0"] = json!(arrays.add(texture, texture_offset, FLOAT, count, "VEC2"));
            texture_offset += count as u64 * 8;
        }
        let (mode, vertices) = indices(surface, grid);
        let mut primitive = json!({
            "attributes": attributes,
            "indices": arrays.add(index, index_offset, UNSIGNED_INT, vertices.len(), "SCALAR"),
            "material": 0,
            "mode": mode as u32,
        });
        index_offset += vertices.len() as u64 * 4;
        if let Some(target) = target {
            let targets = bounds[1..].iter().zip(0..).map(|(bounds, key)| {
                let start = key * frame_length;
                let mut attributes =
                    json!({ "POSITION": arrays.add_positions(target, start + positions, count, bounds[number]) });
                if let Some(normals) = normals {
                    attributes["NORMAL"] = json!(arrays.add(target, start + normals, FLOAT, count, "VEC3"));
                }
                attributes
            });
            primitive["targets"] = targets.collect();
        }
        debug_assert_eq!(normals.is_some(), has_area(grid));
        meshes.push(json!({ "primitives": [primitive] }));
    }
    meshes
}

/// Every mesh follows the same weights: at each key, one for its target and zero for all others.
fn animation(arrays: &mut Arrays, info: &GlbInfo, layout: &Layout, times: &[f32]) -> Value {
    let view = arrays.add_view(json!({ "buffer": 0, "byteOffset": layout.animation.start,
        "byteLength": layout.animation.end - layout.animation.start }));
    let input = arrays.add(view, 0, FLOAT, times.len(), "SCALAR");
    arrays.accessors[input]["min"] = json!([times.first().copied().map(f64::from)]);
    arrays.accessors[input]["max"] = json!([times.last().copied().map(f64::from)]);
    let weights = times.len() * (times.len() - 1);
    let output = arrays.add(view, times.len() as u64 * 4, FLOAT, weights, "SCALAR");
    let channels: Vec<Value> = (0..info.cloth_names.len())
        .map(|node| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } }))
        .collect();
    json!({
        "name": info.title,
        "samplers": [{ "input": input, "output": output, "interpolation": "LINEAR" }],
        "channels": channels,
    })
}

/// Unbleached cotton: warm off-white, rough, with a little sheen; colours are linear.
fn material() -> Value {
    json!({
        "name": "muslin",
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.85, 0.775, 0.65, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9
        },
        "extensions": {
            "KHR_materials_sheen": { "sheenColorFactor": [0.12, 0.11, 0.1], "sheenRoughnessFactor": 0.6 }
        }
    })
}

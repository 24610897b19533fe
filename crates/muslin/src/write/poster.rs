//! `poster.png`: a picture of the cloth for a README.

use std::io::{self, Write};

use glam::DVec3;

use super::raster::{
    BEAD_RADIUS, Camera, LONE_BEAD_RADIUS, Material, Mesh, Picture, add_lone_particle, add_pins, add_shape,
    draw,
};
use crate::Points;
use crate::model::Surface;

/// Distance from the lowest point to the floor below an upright and a level shape, as a share of its size.
const FLOOR_GAPS: [f64; 2] = [0.07, 0.22];

/// Writes a PNG picture of a cloth in a studio: `size` pixels wide and high, RGB, 8 bits, sRGB.
///
/// `positions` [m] are those of all particles of the model, y up, of which `surface` names the ones to draw; `pins` are
/// particles that are held. The view is chosen so that the cloth fills the picture and shows most of its area, whatever
/// its size and place. Grids are drawn as smooth surfaces through their particles, grids of one column or row as
/// threads with beads, lone particles as spheres, and pins as pin heads, a few along an edge that is pinned as a whole.
/// The picture depends on nothing but the arguments: same bytes on every machine.
///
/// What has a non-finite position is left out. A shape without extent is drawn as a lone particle.
///
/// # Errors
/// If `out` fails, or a side of `size` is zero.
///
/// # Panics
/// If a particle of `surface` or `pins` is not in `positions`.
pub fn write_poster(
    out: impl Write,
    surface: &Surface,
    positions: &Points,
    pins: &[u32],
    size: [u32; 2],
) -> io::Result<()> {
    if size.contains(&0) {
        let message = format!("a picture of {} x {} pixels is empty", size[0], size[1]);
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let picture = draw_poster(surface, positions, pins, size);
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.pixels)?;
    writer.finish()?;
    Ok(())
}

/// The picture that [`write_poster`] writes.
fn draw_poster(surface: &Surface, positions: &Points, pins: &[u32], size: [u32; 2]) -> Picture {
    let frame = Frame::around(surface, positions);
    let points: Vec<DVec3> =
        surface.vertices.iter().map(|particle| frame.place(positions.get(*particle as usize))).collect();
    let is_lone = |pin: &u32| surface.points.iter().any(|v| surface.vertices[*v as usize] == *pin);
    let (lone_pins, pins): (Vec<u32>, Vec<u32>) = pins.iter().partition(|pin| is_lone(pin));
    let [lone_pins, pins] = [lone_pins, pins].map(|pins| -> Vec<DVec3> {
        pins.iter().map(|pin| frame.place(positions.get(*pin as usize))).collect()
    });
    let mut mesh = Mesh::default();
    let mut framed = Vec::new();
    if frame.has_extent() {
        add_shape(&mut mesh, surface, &points, size);
        let bead = if surface.lines.is_empty() { 0.0 } else { BEAD_RADIUS };
        add_pins(&mut mesh, &pins, bead);
        add_pins(&mut mesh, &lone_pins, LONE_BEAD_RADIUS);
    } else {
        let pinned = pins.iter().chain(&lone_pins).any(|pin| pin.is_finite());
        add_lone_particle(&mut mesh, &points, if pinned { Material::Pin } else { Material::Bead });
        // A sphere alone would fill the picture.
        framed.extend([-0.5, 0.5].map(|height| DVec3::new(0.0, height, 0.0)));
    }
    let heights = || mesh.points.iter().map(|point| point.y);
    let (lowest, highest) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
    let levelness = 1.0 - (highest - lowest).min(1.0);
    let floor_height = lowest - FLOOR_GAPS[0] - (FLOOR_GAPS[1] - FLOOR_GAPS[0]) * levelness;
    let camera = Camera::three_quarter(&mesh, &framed, size);
    draw(&mesh, camera, floor_height, size)
}

/// Takes positions to a frame in which the drawn shape has size 1 about the origin.
struct Frame {
    half_centre: DVec3,
    half_extent: f64,
}

impl Frame {
    /// The frame of the finite points of `surface`.
    fn around(surface: &Surface, positions: &Points) -> Self {
        let mut least = DVec3::INFINITY;
        let mut most = DVec3::NEG_INFINITY;
        for point in surface.vertices.iter().map(|particle| positions.get(*particle as usize)) {
            if point.is_finite() {
                least = least.min(point);
                most = most.max(point);
            }
        }
        // Halves, so that the largest numbers do not overflow.
        let (least, most) = (0.5 * least, 0.5 * most);
        let half_extent = (most - least).max_element();
        if 0.0 < half_extent {
            Self { half_centre: 0.5 * (least + most), half_extent }
        } else {
            let half_centre = if least.is_finite() { least } else { DVec3::ZERO };
            Self { half_centre, half_extent: 0.0 }
        }
    }

    fn has_extent(&self) -> bool {
        0.0 < self.half_extent
    }

    /// `point` in the frame; its coordinates are not finite if they are not in `point`.
    fn place(&self, point: DVec3) -> DVec3 {
        let offset = 0.5 * point - self.half_centre;
        if self.has_extent() { offset / self.half_extent } else { offset }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const SIZE: [u32; 2] = [320, 180];

    fn grid(columns: usize, rows: usize) -> Surface {
        let mut surface = Surface::default();
        surface.add_grid(0, columns, rows, usize::MAX);
        surface
    }

    /// A grid of `columns` x `rows` points at `place(u, v)` with u and v from 0 to 1.
    fn points(columns: usize, rows: usize, place: impl Fn(f64, f64) -> DVec3) -> Points {
        let share = |n: usize, count: usize| n as f64 / (count - 1).max(1) as f64;
        (0..columns * rows).map(|p| place(share(p % columns, columns), share(p / columns, rows))).collect()
    }

    fn sag(u: f64, v: f64) -> DVec3 {
        DVec3::new(
            0.9 * (u - 0.5),
            -v - 0.15 * libm::sin(PI * u) * (1.0 - 0.5 * v),
            0.2 * libm::sin(PI * u) * v,
        )
    }

    fn flag(u: f64, v: f64) -> DVec3 {
        DVec3::new(1.5 * u, 1.0 - v, 0.15 * u * libm::sin(8.0 * u - v))
    }

    fn fall(u: f64, v: f64) -> DVec3 {
        DVec3::new(u, 0.03 * libm::cos(5.0 * u + 3.0 * v), v)
    }

    fn coverage(columns: usize, rows: usize, place: impl Fn(f64, f64) -> DVec3) -> f64 {
        draw_poster(&grid(columns, rows), &points(columns, rows, place), &[0], SIZE).coverage
    }

    #[test]
    fn png_has_the_size_and_the_pixels() {
        let (surface, positions) = (grid(10, 10), points(10, 10, sag));
        let mut bytes = Vec::new();
        write_poster(&mut bytes, &surface, &positions, &[0, 9], SIZE).expect("a vector takes all bytes");
        let decoder = png::Decoder::new(io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().expect("the header is right");
        let mut pixels = vec![0; reader.output_buffer_size().expect("the picture is small")];
        let info = reader.next_frame(&mut pixels).expect("the picture is whole");
        assert_eq!(([info.width, info.height], info.color_type), (SIZE, png::ColorType::Rgb));
        assert_eq!(pixels, draw_poster(&surface, &positions, &[0, 9], SIZE).pixels);
        let mut again = Vec::new();
        write_poster(&mut again, &surface, &positions, &[0, 9], SIZE).expect("a vector takes all bytes");
        assert!(bytes == again, "the same picture has the same bytes");
    }

    /// A square that fills 79 % of the height covers 35 % of a 16:9 picture head on, and 0.85 of that turned by 0.55 rad;
    /// what sags or is seen at an angle covers less, so each shape has its own share.
    #[test]
    fn the_cloth_fills_the_picture() {
        for (name, least, coverage) in [
            ("sag", 0.20, coverage(10, 10, sag)),
            ("flag", 0.25, coverage(30, 20, flag)),
            (
                "flag along z",
                0.25,
                coverage(30, 20, |u, v| DVec3::Y.cross(flag(u, v)) + DVec3::Y * flag(u, v).y),
            ),
            ("fall", 0.25, coverage(20, 20, fall)),
            ("level", 0.25, coverage(5, 5, |u, v| DVec3::new(u, 0.0, v))),
            ("millimetre", 0.20, coverage(10, 10, |u, v| 1e-3 * sag(u, v))),
            ("kilometre", 0.20, coverage(10, 10, |u, v| 1e3 * sag(u, v) + DVec3::splat(1e6))),
            ("huge", 0.20, coverage(10, 10, |u, v| 1e308 * sag(u, v))),
        ] {
            assert!(least < coverage && coverage < 0.86 * 0.79, "{name} covers {coverage}");
        }
    }

    /// A thread of width 2 r over 79 % of the height, and its beads, cover little but do cover.
    #[test]
    fn a_thread_covers_its_length_times_its_width() {
        let coverage = coverage(1, 20, |_, v| DVec3::new(0.0, -v, 0.0));
        let thread = 2.0 * 0.0045 * 0.79 * 0.79 * 9.0 / 16.0;
        assert!((1.0..4.0).contains(&(coverage / thread)), "{coverage} against {thread}");
    }

    /// The picture of a shape does not depend on the unit of length: powers of two scale without rounding.
    #[test]
    fn the_picture_does_not_depend_on_the_size_of_the_cloth() {
        let surface = grid(6, 6);
        let [one, large] = [1.0, 1024.0]
            .map(|size| draw_poster(&surface, &points(6, 6, |u, v| size * sag(u, v)), &[5], SIZE));
        assert!(one == large, "coverage {} and {}", one.coverage, large.coverage);
    }

    #[test]
    fn a_shape_without_extent_is_a_sphere() {
        let lone = draw_poster(&grid(1, 1), &points(1, 1, |_, _| DVec3::X), &[0], SIZE);
        let collapsed = draw_poster(&grid(4, 4), &points(4, 4, |_, _| DVec3::X), &[3], SIZE);
        assert!(lone == collapsed && 0.005 < lone.coverage, "{} and {}", lone.coverage, collapsed.coverage);
        let free = draw_poster(&grid(1, 1), &points(1, 1, |_, _| DVec3::X), &[], SIZE);
        assert!(free.coverage == lone.coverage && free.pixels != lone.pixels, "a pin has its own colour");
    }

    #[test]
    fn a_sheet_on_a_line_is_drawn_as_its_border() {
        assert!(0.001 < coverage(4, 4, |u, _| DVec3::new(u, 0.0, 0.0)));
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let whole = coverage(10, 10, sag);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut positions = points(10, 10, sag);
            positions.set(44, DVec3::new(0.0, value, 0.0));
            let holed = draw_poster(&grid(10, 10), &positions, &[44], SIZE).coverage;
            // Of 81 cells the triangles of four around the particle are missing, of them at most all eight.
            assert!(0.93 * whole < holed && holed < whole, "{value}: {holed} of {whole}");
            positions.fill(value);
            assert_eq!(draw_poster(&grid(10, 10), &positions, &[0], SIZE).coverage, 0.0);
        }
        assert_eq!(draw_poster(&Surface::default(), &Points::default(), &[], SIZE).coverage, 0.0);
    }

    #[test]
    fn any_size_but_an_empty_one_is_drawn() {
        let (surface, positions) = (grid(3, 3), points(3, 3, sag));
        for size in [[1, 1], [1, 300], [300, 1], [37, 91]] {
            let mut bytes = Vec::new();
            write_poster(&mut bytes, &surface, &positions, &[], size).expect("a vector takes all bytes");
        }
        let error = write_poster(io::sink(), &surface, &positions, &[], [0, 5]).expect_err("it is empty");
        assert_eq!(error.to_string(), "a picture of 0 x 5 pixels is empty");
    }
}

//! `trajectory.npz`: how every particle moved.

use std::io::{self, Read, Seek, Write};

use super::FrameSource;
use super::npz::{Dtype, NpzError, NpzReader, NpzWriter};
use super::raw::{read_points, write_points};
use crate::Points;

/// Frames with velocities.
pub trait MotionSource: FrameSource {
    /// Overwrites `velocities` with the velocities [m/s] of all particles in frame `frame`.
    ///
    /// # Errors
    /// If the frame cannot be read.
    fn read_velocities(&mut self, frame: usize, velocities: &mut Points) -> io::Result<()>;
}

/// Writes `trajectory.npz`: `time` (F,) [s], `positions` (F, P, 3) [m], `velocities` (F, P, 3) [m/s], all 64-bit
/// floating point, and `triangles` (T, 3), particle indices of 32 bits.
///
/// `times` are those of the frames. Frames are read one at a time, each twice. The same input gives the same bytes.
///
/// # Errors
/// If `out` or `frames` fails, the number of times is not the number of frames, or frames differ in their number of
/// particles.
pub fn write_trajectory(
    out: impl Write + Seek,
    times: &[f64],
    triangles: &[[u32; 3]],
    frames: &mut (impl MotionSource + ?Sized),
) -> io::Result<()> {
    let frame_count = frames.frame_count();
    if times.len() != frame_count {
        let message = format!("{} times for {frame_count} frames", times.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let mut points = Points::default();
    if 0 < frame_count {
        frames.read_positions(0, &mut points)?;
    }
    let particle_count = points.len();
    let shape = [frame_count as u64, particle_count as u64, 3];

    let mut npz = NpzWriter::new(out);
    npz.write_array("time", Dtype::F64, &shape[..1], |out| {
        times.iter().try_for_each(|time| out.write_all(&time.to_le_bytes()))
    })?;
    npz.write_array("positions", Dtype::F64, &shape, |out| {
        (0..frame_count).try_for_each(|frame| {
            frames.read_positions(frame, &mut points)?;
            write_frame(out, frame, &points, particle_count)
        })
    })?;
    npz.write_array("velocities", Dtype::F64, &shape, |out| {
        (0..frame_count).try_for_each(|frame| {
            frames.read_velocities(frame, &mut points)?;
            write_frame(out, frame, &points, particle_count)
        })
    })?;
    npz.write_array("triangles", Dtype::U32, &[triangles.len() as u64, 3], |out| {
        triangles.as_flattened().iter().try_for_each(|vertex| out.write_all(&vertex.to_le_bytes()))
    })?;
    npz.finish()
}

/// Writes a frame's points, which must be as many as in the first frame.
fn write_frame(out: &mut dyn Write, frame: usize, points: &Points, particle_count: usize) -> io::Result<()> {
    if points.len() != particle_count {
        let message =
            format!("frame {frame} has {} particles, but frame 0 has {particle_count}", points.len());
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    write_points(out, points)
}

/// Reads `trajectory.npz`, any frame alone: [`FrameSource`] and [`MotionSource`] over a file.
pub struct TrajectoryReader<R> {
    npz: NpzReader<R>,
    times: Vec<f64>,
    particle_count: usize,
}

impl<R: Read + Seek> TrajectoryReader<R> {
    /// Reads everything but the frames and the triangles.
    ///
    /// # Errors
    /// If `input` is not such a file.
    pub fn new(input: R) -> Result<Self, NpzError> {
        let mut npz = NpzReader::new(input)?;
        let [frame_count] = shape(&npz, "time", Dtype::F64)?;
        let [position_frames, particle_count, position_axes] = shape(&npz, "positions", Dtype::F64)?;
        let velocities = shape(&npz, "velocities", Dtype::F64)?;
        let [_, corners] = shape(&npz, "triangles", Dtype::U32)?;
        let expected = [frame_count, particle_count, 3];
        for (name, found) in
            [("positions", [position_frames, particle_count, position_axes]), ("velocities", velocities)]
        {
            if found != expected {
                let reason = format!("is of shape {found:?}, but must be of shape {expected:?}");
                return Err(NpzError::array(name, reason));
            }
        }
        if corners != 3 {
            return Err(NpzError::array("triangles", format!("has {corners} corners per triangle")));
        }
        let mut times = vec![0.0; frame_count];
        let mut data = npz.data("time", 0)?;
        for time in &mut times {
            *time = f64::from_le_bytes(read_bytes(&mut data)?);
        }
        Ok(Self { npz, times, particle_count })
    }

    /// Time of each frame [s].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Number of particles.
    #[must_use]
    pub fn particle_count(&self) -> usize {
        self.particle_count
    }

    /// Reads the triangles, particle indices.
    ///
    /// # Errors
    /// If `input` fails or an index is not below [`particle_count`](Self::particle_count).
    pub fn read_triangles(&mut self) -> Result<Vec<[u32; 3]>, NpzError> {
        let [count, _] = shape(&self.npz, "triangles", Dtype::U32)?;
        let mut data = io::BufReader::new(self.npz.data("triangles", 0)?);
        let mut triangles = vec![[0; 3]; count];
        for vertex in triangles.as_flattened_mut() {
            *vertex = u32::from_le_bytes(read_bytes(&mut data)?);
            if self.particle_count <= *vertex as usize {
                let reason = format!("names particle {vertex}, but there are {}", self.particle_count);
                return Err(NpzError::array("triangles", reason));
            }
        }
        Ok(triangles)
    }

    fn read_points(&mut self, name: &str, frame: usize, points: &mut Points) -> Result<(), NpzError> {
        if self.times.len() <= frame {
            return Err(NpzError::array(name, format!("has {} frames, no frame {frame}", self.times.len())));
        }
        // No overflow: all elements of the array fit the file.
        let mut data = self.npz.data(name, frame as u64 * self.particle_count as u64 * 3)?;
        Ok(read_points(&mut data, self.particle_count, points)?)
    }
}

impl<R: Read + Seek> FrameSource for TrajectoryReader<R> {
    fn frame_count(&self) -> usize {
        self.times.len()
    }

    fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
        Ok(self.read_points("positions", frame, positions)?)
    }
}

impl<R: Read + Seek> MotionSource for TrajectoryReader<R> {
    fn read_velocities(&mut self, frame: usize, velocities: &mut Points) -> io::Result<()> {
        Ok(self.read_points("velocities", frame, velocities)?)
    }
}

/// The shape of array `name`, which must have type `dtype` and `N` dimensions.
fn shape<R: Read + Seek, const N: usize>(
    npz: &NpzReader<R>,
    name: &str,
    dtype: Dtype,
) -> Result<[usize; N], NpzError> {
    let array = npz.array(name)?;
    if array.dtype != dtype {
        let reason = format!("holds elements of type {}, but must hold {}", array.dtype.name(), dtype.name());
        return Err(NpzError::array(name, reason));
    }
    let lengths: Result<Vec<usize>, _> = array.shape.iter().map(|&length| usize::try_from(length)).collect();
    lengths.ok().and_then(|lengths| lengths.try_into().ok()).ok_or_else(|| {
        NpzError::array(name, format!("is of shape {:?}, but must have {N} dimensions", array.shape))
    })
}

fn read_bytes<const N: usize>(input: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::super::raw::CHUNK;
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;
    use std::io::Cursor;

    /// A run in memory: positions and velocities, frame by frame.
    struct Run(Vec<(Points, Points)>);

    impl FrameSource for Run {
        fn frame_count(&self) -> usize {
            self.0.len()
        }

        fn read_positions(&mut self, frame: usize, positions: &mut Points) -> io::Result<()> {
            positions.clone_from(&self.0[frame].0);
            Ok(())
        }
    }

    impl MotionSource for Run {
        fn read_velocities(&mut self, frame: usize, velocities: &mut Points) -> io::Result<()> {
            velocities.clone_from(&self.0[frame].1);
            Ok(())
        }
    }

    /// Coordinates that are all different, so that a mistaken place shows.
    fn run(frame_count: usize, particle_count: usize) -> (Vec<f64>, Run) {
        let points = |seed: usize| -> Points {
            (0..particle_count)
                .map(|p| DVec3::new(p as f64, seed as f64 + 0.1, 1.0 / (p + seed + 1) as f64))
                .collect()
        };
        let frames = (0..frame_count).map(|frame| (points(2 * frame), points(2 * frame + 1))).collect();
        ((0..frame_count).map(|frame| frame as f64 / 60.0).collect(), Run(frames))
    }

    fn written(times: &[f64], triangles: &[[u32; 3]], run: &mut Run) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        write_trajectory(&mut bytes, times, triangles, run).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_frame_is_read_back_alone_and_in_any_order() {
        // One more particle than fits two chunks.
        for (frame_count, particle_count) in [(3, 2 * CHUNK + 1), (4, 1), (1, 4), (2, 0), (0, 0)] {
            let (times, mut run) = run(frame_count, particle_count);
            let triangles = if particle_count < 3 { vec![] } else { vec![[0, 1, 2], [2, 1, 3]] };
            let bytes = written(&times, &triangles, &mut run);
            assert_eq!(bytes, written(&times, &triangles, &mut run));
            let mut reader = TrajectoryReader::new(Cursor::new(&bytes)).unwrap();
            assert_eq!((reader.times(), reader.particle_count()), (&times[..], particle_count));
            assert_eq!(reader.read_triangles().unwrap(), triangles);
            let mut points = Points::default();
            for frame in (0..frame_count).rev() {
                reader.read_velocities(frame, &mut points).unwrap();
                assert_eq!(points, run.0[frame].1);
                reader.read_positions(frame, &mut points).unwrap();
                assert_eq!(points, run.0[frame].0);
            }
            let error = reader.read_positions(frame_count, &mut points).unwrap_err().to_string();
            assert_eq!(error, format!("array `positions` has {frame_count} frames, no frame {frame_count}"));
        }
    }

    #[test]
    fn frames_that_do_not_agree_are_refused() {
        let (times, mut run) = run(3, 4);
        let write = |times: &[f64], run: &mut Run| {
            write_trajectory(Cursor::new(Vec::new()), times, &[], run).unwrap_err().to_string()
        };
        assert_eq!(write(&times[1..], &mut run), "2 times for 3 frames");
        run.0[1].1.x = run.0[1].1.x[1..].into();
        assert_eq!(write(&times, &mut run), "frame 1 has 3 particles, but frame 0 has 4");
    }

    #[test]
    fn another_archive_is_refused() {
        let mut bytes = Cursor::new(Vec::new());
        let mut npz = NpzWriter::new(&mut bytes);
        for (name, shape) in [("time", &[2][..]), ("positions", &[2, 1, 3]), ("velocities", &[2, 2, 3])] {
            let length = shape.iter().product::<u64>() * 8;
            npz.write_array(name, Dtype::F64, shape, |out| out.write_all(&vec![0; length as usize])).unwrap();
        }
        npz.write_array("triangles", Dtype::U32, &[0, 3], |_| Ok(())).unwrap();
        npz.finish().unwrap();
        let error = TrajectoryReader::new(bytes).err().unwrap();
        assert_eq!(
            error.to_string(),
            "array `velocities` is of shape [2, 2, 3], but must be of shape [2, 1, 3]"
        );
        let (times, mut run) = run(1, 2);
        let bytes = written(&times, &[[0, 1, 2]], &mut run);
        let error = TrajectoryReader::new(Cursor::new(bytes)).unwrap().read_triangles().unwrap_err();
        assert_eq!(error.to_string(), "array `triangles` names particle 2, but there are 2");
    }

    proptest! {
        #[test]
        fn damage_does_not_panic(
            damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        ) {
            let (times, mut run) = run(2, 3);
            let mut bytes = written(&times, &[[0, 1, 2]], &mut run);
            for (index, value) in damage {
                let index = index.index(bytes.len());
                bytes[index] = value;
            }
            if let Ok(mut reader) = TrajectoryReader::new(Cursor::new(bytes)) {
                let _ = reader.read_triangles();
                for frame in 0..reader.frame_count() {
                    let _ = reader.read_velocities(frame, &mut Points::default());
                }
            }
        }
    }
}

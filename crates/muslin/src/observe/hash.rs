//! Hashes of all bits of a state.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sha2::{Digest, Sha256};

use crate::Points;

/// SHA-256 of the positions and velocities of all particles at one time.
///
/// Hashed are `x y z` of each particle's position [m], then of each particle's velocity [m/s], as little-endian IEEE 754
/// doubles, with −0 replaced by 0. From the arrays of a trajectory in NumPy:
/// `sha256((positions[f] + 0.0).tobytes() + (velocities[f] + 0.0).tobytes())`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash([u8; 32]);

impl StateHash {
    /// Hash of `positions` [m] and `velocities` [m/s].
    #[must_use]
    pub fn new(positions: &Points, velocities: &Points) -> Self {
        let mut hasher = Sha256::new();
        let mut buffer = [0; 24 * 256];
        for points in [positions, velocities] {
            for start in (0..points.len()).step_by(256) {
                let end = points.len().min(start + 256);
                for (bytes, index) in buffer.chunks_exact_mut(24).zip(start..end) {
                    for (bytes, value) in bytes.chunks_exact_mut(8).zip(points.get(index).to_array()) {
                        // −0 + 0 is 0; every other number stays as it is.
                        bytes.copy_from_slice(&(value + 0.0).to_le_bytes());
                    }
                }
                hasher.update(&buffer[..24 * (end - start)]);
            }
        }
        Self(hasher.finalize().into())
    }

    /// The hash that `text`, 64 hexadecimal digits, stands for.
    #[must_use]
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.as_bytes();
        if digits.len() != 64 || !digits.iter().all(u8::is_ascii_hexdigit) {
            return None;
        }
        let mut bytes = [0; 32];
        for (byte, pair) in bytes.iter_mut().zip(text.as_bytes().chunks_exact(2)) {
            *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
        }
        Some(Self(bytes))
    }
}

impl fmt::Display for StateHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl Serialize for StateHash {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for StateHash {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::from_hex(&text).ok_or_else(|| serde::de::Error::custom("a hash has 64 hexadecimal digits"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Against `hashlib.sha256(struct.pack("<6d", 1.0, 2.0, 3.0, 0.0, -0.5, 1e-300))`.
    #[test]
    fn hash_is_sha256_of_little_endian_doubles() {
        let positions: Points = [DVec3::new(1.0, 2.0, 3.0)].into_iter().collect();
        let velocities: Points = [DVec3::new(-0.0, -0.5, 1e-300)].into_iter().collect();
        let hash = StateHash::new(&positions, &velocities);
        assert_eq!(hash.to_string(), "a2264ef484c94ee250d4ce252dc97b70ac173668ea1640420dfb783962e0bc12");
        assert_eq!(StateHash::from_hex(&hash.to_string()), Some(hash));
    }

    #[test]
    fn one_bit_changes_the_hash() {
        let points: Points = (0..1000).map(|i| DVec3::splat(f64::from(i))).collect();
        let mut other = points.clone();
        other.z[999] = 999.0_f64.next_up();
        assert_ne!(StateHash::new(&points, &points), StateHash::new(&points, &other));
    }
}

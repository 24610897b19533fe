//! Fabrics that come with muslin.

use super::MeasuredFabric;
use super::read::read_library_fabric;

/// A measured fabric that comes with muslin, with where its values are from.
///
/// One that has any value that is typical of its kind, rather than measured on it, has a name that begins with `typical`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LibraryFabric {
    name: &'static str,
    text: &'static str,
}

/// The fabric of the file of that name.
macro_rules! fabric {
    ($name:literal) => {
        Self { name: $name, text: include_str!(concat!("../../fabrics/", $name, ".toml")) }
    };
}

impl LibraryFabric {
    /// All fabrics, by name.
    pub const ALL: [Self; 14] = [
        fabric!("nylon-heat-bondable"),
        fabric!("typical-cotton-broadcloth"),
        fabric!("typical-cotton-shirting"),
        fabric!("typical-denim"),
        fabric!("typical-polyester-cotton-twill"),
        fabric!("typical-polyester-faille"),
        fabric!("typical-polyester-plain"),
        fabric!("typical-polyester-tropical"),
        fabric!("typical-silk"),
        fabric!("typical-stretch-twill"),
        fabric!("typical-suiting"),
        fabric!("typical-wool-lycra"),
        fabric!("typical-wool-plain"),
        fabric!("typical-wool-tropical"),
    ];

    /// The fabric called `name`, if there is one.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fabric| fabric.name == name)
    }

    /// Its name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    /// What it is, in a line.
    #[must_use]
    pub fn title(self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }

    /// Its keys, as they stand in a table `[fabric.NAME]` of a scene, with comments that say where each value is from.
    #[must_use]
    pub fn text(self) -> &'static str {
        self.text
    }

    /// Its values.
    ///
    /// # Panics
    /// If a fabric of this version is wrong, which tests exclude.
    #[must_use]
    pub fn fabric(self) -> MeasuredFabric {
        read_library_fabric(self.text).unwrap_or_else(|error| panic!("fabric {}: {error}", self.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fabric_is_read_and_says_where_it_is_from() {
        let names = LibraryFabric::ALL.map(LibraryFabric::name);
        assert!(names.is_sorted());
        for fabric in LibraryFabric::ALL {
            let (name, text) = (fabric.name(), fabric.text());
            assert_eq!(LibraryFabric::find(name), Some(fabric));
            assert!(!fabric.title().is_empty() && text.contains("# Source"), "{name}");
            // Whoever quotes a typical value says so in the name.
            let is_typical = text.lines().skip(1).any(|line| line.contains("typical"));
            assert_eq!(name.starts_with("typical-"), is_typical, "{name}");
            let MeasuredFabric { areal_density, warp, weft, shear_modulus, .. } = fabric.fabric();
            assert!((0.01..1.0).contains(&areal_density), "{name}: {areal_density} kg/m²");
            // Square cells have springs for it.
            assert!(shear_modulus < warp.least_modulus().min(weft.least_modulus()), "{name}");
        }
        assert_eq!(LibraryFabric::find("typical"), None);
    }
}

//! Virtual instruments: what a measured fabric gives on the instruments that its values come from.
//!
//! Each instrument builds its standard specimen from a [`MeasuredFabric`](crate::scene::MeasuredFabric), moves its clamps or loads from one position to
//! the next, lets the specimen come to rest at each, and reads forces where the instrument does. What is read is compared
//! with what went in: [`Reading`].
//!
//! | instrument | specimen | what is read |
//! |---|---|---|
//! | [`tensile()`] | KES-FB1, 20 cm wide, 5 cm between clamps | EMT, LT, WT, RT |
//! | [`shear()`] | the same under 10 gf/cm, sheared to ±8° | G, 2HG, 2HG5 |
//! | [`bend()`] | KES-FB2, 1 cm between clamps, bent to ±2.5 /cm | B, 2HB |
//! | [`cantilever()`] | ASTM D1388, a strip pushed over an edge | bending length c, B |
//! | [`bias()`] | FAST-3, pulled at 45° to the yarns by 5 gf/cm | EB5, G |
//! | [`picture_frame()`] | a hinged square frame pulled at its corners | G |
//!
//! ```
//! use muslin::lab::{self, Along, Resolution};
//! use muslin::scene::LibraryFabric;
//!
//! let suiting = LibraryFabric::find("typical-suiting").expect("a fabric of the library").fabric();
//! let test = lab::tensile(&suiting, Along::Warp, Resolution::new(10)?)?;
//! assert!((test.extension / 0.047 - 1.0).abs() < 0.01, "EMT is 4.7 %");
//! # Ok::<(), lab::LabError>(())
//! ```
//!
//! At rest means that no free particle has a force above [`EQUILIBRIUM_TOLERANCE`] of the largest force on a clamp or of a
//! load. Specimens stay in a plane, as instruments keep them: they are pulled and sheared flat, and bent like a cylinder.

mod bend;
mod bias;
mod cantilever;
mod elastica;
mod error;
mod friction;
mod instrument;
mod picture_frame;
mod reading;
mod shear;
mod specimen;
mod tensile;

pub use bend::{BendTest, bend};
pub use bias::{BiasTest, bias};
pub use cantilever::{CantileverTest, Tip, cantilever, hang};
pub use error::LabError;
pub use instrument::{Instrument, Measurement};
pub use picture_frame::{PictureFrameTest, picture_frame};
pub use reading::{Column, Reading, Record, Unit};
pub use shear::{ShearTest, shear};
pub use tensile::{TensileTest, tensile};

pub use crate::statics::{EQUILIBRIUM_TOLERANCE, Rest};

/// The yarns along which a specimen is cut, and its longer or pulled side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The warp, the height of a cloth.
    Warp,
    /// The weft, its width.
    Weft,
}

impl Along {
    /// Both, the warp first.
    pub const ALL: [Self; 2] = [Self::Warp, Self::Weft];

    /// Its name in files and messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Warp => "warp",
            Self::Weft => "weft",
        }
    }

    /// The other yarns.
    #[must_use]
    pub fn across(self) -> Self {
        match self {
            Self::Warp => Self::Weft,
            Self::Weft => Self::Warp,
        }
    }
}

/// How many cells a specimen has between its clamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution(usize);

impl Resolution {
    /// The fewest and the most cells of a specimen.
    pub const RANGE: [usize; 2] = [4, 100];

    /// `cells` between the clamps.
    ///
    /// # Errors
    /// If there are fewer or more than [`RANGE`](Self::RANGE) allows.
    pub fn new(cells: usize) -> Result<Self, LabError> {
        let [fewest, most] = Self::RANGE;
        if (fewest..=most).contains(&cells) { Ok(Self(cells)) } else { Err(LabError::Resolution { cells }) }
    }

    /// Cells between the clamps.
    #[must_use]
    pub fn cells(self) -> usize {
        self.0
    }
}

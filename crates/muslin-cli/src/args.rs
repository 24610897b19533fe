//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue};
use clap::{Parser, Subcommand, ValueEnum};

use crate::report::shell_word;

/// Simulate cloth: from a scene file to pictures, pages and arrays.
#[derive(Debug, Parser)]
#[command(name = "muslin", version, arg_required_else_help = true, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Arguments {
    /// The arguments of this process; it ends with a message if there is none such command.
    pub(crate) fn parse_or_exit() -> Self {
        Self::try_parse().unwrap_or_else(|mut error| {
            let name = error.get(ContextKind::InvalidSubcommand).map(ToString::to_string);
            if let Some(name) = name.filter(|name| name.ends_with(".toml")) {
                let tip = format!("to simulate a scene, write `muslin run {}`", shell_word(&name));
                error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
            }
            error.exit()
        })
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a scene and write what comes out into a folder
    Run(RunArguments),
    /// Parse and build a scene only: particles, springs, masses, stable step, estimated cost
    Check(CheckArguments),
    /// Run again from what a folder records and compare every hash
    Verify(VerifyArguments),
    /// Open a folder's page in the browser
    View {
        /// Folder that a run wrote
        dir: PathBuf,
    },
    /// Print a commented scene to start from
    New {
        /// Name of the scene; leave it out for the list
        name: Option<String>,
    },
    /// Print the JSON Schema of the scene file
    Schema,
    /// List the fabrics that come with muslin, show one, or import one
    #[command(subcommand)]
    Fabric(FabricCommand),
    /// Identify a measured fabric from the data of textile instruments
    Fit(FitArguments),
    /// Measure a fabric on a virtual instrument: what goes in must come out
    Lab(LabArguments),
    /// Measure two fabrics on all virtual instruments, side by side, on a page
    Compare(CompareArguments),
    /// Recompute the figures and claims of the paper behind muslin, on a page
    Reproduce(ReproduceArguments),
}

#[derive(Debug, Subcommand)]
pub(crate) enum FabricCommand {
    /// List the fabrics that come with muslin
    List,
    /// Print a fabric's table for a scene, with where its values are from and what follows from them
    Show {
        /// Name of the fabric, as `muslin fabric list` has it
        name: String,
    },
    /// Print a table for a scene from a material file of ARCSim of your own
    ///
    /// The file is JSON with `density` [kg/m^2], `stretching` (6 rows of c11, c12, c22, c33) and `bending` (3 rows of 5). What its
    /// numbers become, what of it is uncertain and what is lost stands in the table's comments. Mind the licence of the file.
    Import {
        /// Material file (JSON)
        file: PathBuf,
        /// Name of the fabric; that of the file if left out
        #[arg(long, value_name = "NAME")]
        name: Option<String>,
    },
}

#[derive(Debug, clap::Args)]
pub(crate) struct RunArguments {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Folder to write; `out/NAME` for a scene file NAME.toml if left out
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Threads of the steps; chosen by the size of the cloth if left out. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Go on with the interrupted run in the folder
    #[arg(long, conflicts_with = "force")]
    pub(crate) resume: bool,
    /// Replace what an earlier run wrote into the folder
    #[arg(long)]
    pub(crate) force: bool,
    /// Change a value of the scene, as in `--set run.duration=1.0`; may be given again
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) assignments: Vec<String>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct CheckArguments {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Change a value of the scene, as in `--set run.duration=1.0`; may be given again
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) assignments: Vec<String>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct VerifyArguments {
    /// Folder that a run wrote
    pub(crate) dir: PathBuf,
    /// Threads of the steps; chosen by the size of the cloth if left out. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ReproduceArguments {
    /// Folder to write
    pub(crate) dir: PathBuf,
    /// Take coarse grids and short times: every part of the page in seconds, but not its results
    #[arg(long)]
    pub(crate) quick: bool,
    /// Replace what an earlier reproduction wrote into the folder
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct FitArguments {
    /// CSV files of tests, each with what it is along: warp=FILE, weft=FILE, bias=FILE, shear=FILE
    #[arg(required = true, value_name = "LABEL=FILE")]
    pub(crate) data: Vec<String>,
    /// Name of the fabric
    #[arg(long, value_name = "NAME")]
    pub(crate) fabric: String,
    /// Mass per area with its unit, as in "162.9 g/m2"
    #[arg(long, value_name = "MASS")]
    pub(crate) areal_density: String,
    /// Folder to write: the fabric, plots of data and residuals, all numbers; if left out, the fabric is printed
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace what an earlier fit wrote into the folder
    #[arg(long, requires = "out")]
    pub(crate) force: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct LabArguments {
    /// Instrument
    pub(crate) instrument: InstrumentName,
    /// Fabric of the library, as `muslin fabric list` has it, or a TOML file with a measured fabric
    pub(crate) fabric: String,
    /// Yarns along which the specimen is cut; the warp if left out. Of no effect on `bias` and `picture-frame`
    #[arg(long, value_name = "YARNS")]
    pub(crate) along: Option<YarnName>,
    /// The same as `--along warp`
    #[arg(long, conflicts_with_all = ["along", "weft"])]
    pub(crate) warp: bool,
    /// The same as `--along weft`
    #[arg(long, conflicts_with = "along")]
    pub(crate) weft: bool,
    /// Cells of the specimen between its clamps
    #[arg(long, value_name = "N", default_value_t = 20)]
    pub(crate) cells: usize,
    /// Folder to write; `out/lab-INSTRUMENT-FABRIC-YARNS` if left out
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace what an earlier test wrote into the folder
    #[arg(long)]
    pub(crate) force: bool,
}

impl LabArguments {
    /// The yarns along which the specimen is cut.
    pub(crate) fn along(&self) -> YarnName {
        match self.along {
            Some(along) => along,
            None if self.weft => YarnName::Weft,
            None => YarnName::Warp,
        }
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct CompareArguments {
    /// Fabric of the library, as `muslin fabric list` has it, or a TOML file with a measured fabric
    #[arg(value_name = "A")]
    pub(crate) first: String,
    /// The fabric to compare with it, named the same way
    #[arg(value_name = "B")]
    pub(crate) second: String,
    /// Yarns along which specimens are cut; both if left out. Of no effect on `bias` and `picture-frame`
    #[arg(long, value_name = "YARNS")]
    pub(crate) along: Option<YarnName>,
    /// Cells of the specimens between their clamps
    #[arg(long, value_name = "N", default_value_t = 20)]
    pub(crate) cells: usize,
    /// Folder to write; `out/compare-A-B` if left out
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace what an earlier comparison wrote into the folder
    #[arg(long)]
    pub(crate) force: bool,
}

/// Name of a virtual instrument.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum InstrumentName {
    /// KES-FB1: EMT, LT, WT, RT
    Tensile,
    /// KES-FB1: G, 2HG, 2HG5
    Shear,
    /// KES-FB2: B, 2HB
    Bend,
    /// ASTM D1388: bending length
    Cantilever,
    /// FAST-3: EB5, G
    Bias,
    /// Hinged square frame: G
    PictureFrame,
}

/// Name of a fabric's yarns.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum YarnName {
    /// Along the height of a cloth
    Warp,
    /// Along its width
    Weft,
}

/// More threads than any machine has cores cost time and gain nothing.
const MOST_THREADS: usize = 1024;

fn parse_threads(text: &str) -> Result<NonZeroUsize, String> {
    let threads = text.parse().ok().filter(|threads: &NonZeroUsize| threads.get() <= MOST_THREADS);
    threads.ok_or_else(|| format!("must be a whole number from 1 to {MOST_THREADS}"))
}

//! `muslin fabric import`: a measured fabric from a material file of ARCSim.
//!
//! The file is JSON with a `density` [kg/m²], a table `stretching` of 6 rows and one `bending` of 3. What its numbers mean was
//! read in the program that they are for:
//!
//! ```text
//! stretching: c11, c12, c22, c33   row 0 without strain, rows 1 to 5 stretched to 7/6 at 0, 22.5, 45, 67.5, 90 degrees to u
//!             C11 = 2 c11    C12 = 2 c12    C22 = 2 c22    G = c33
//! bending:    k_e, edges at 0, 45, 90 degrees to u   columns at curvatures of 0, 10, 20, 30, 40 /m
//!             energy k_e l² θ² / (8 (A1 + A2)) of an edge of length l between triangles    B = k_e / 4
//! ```
//!
//! An edge along u is bent across it, so that the first row is the rigidity along v.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use muslin::Scene;
use muslin::scene::Fabric;
use serde_json::Value;

use crate::error::CliError;
use crate::fabric::properties;
use crate::print_text;
use crate::progress::significant;

/// Greatest size [B] of a file that is read: one of these has a few hundred.
const MOST_BYTES: u64 = 1 << 20;

/// Strain of the rows of `stretching` after the first [1].
const STRAIN: f64 = 1.0 / 6.0;

/// What a material file holds, in its own numbers.
#[derive(Debug, PartialEq)]
struct Material {
    density: f64,
    stretching: [[f64; 4]; 6],
    bending: [[f64; 5]; 3],
}

/// Prints the fabric of the material `file` as a table for a scene, called `name` or as the file is.
pub(crate) fn import(file: &Path, name: Option<&str>) -> Result<(), CliError> {
    let help = "give it a material file of ARCSim, in JSON";
    let size = fs::metadata(file).map_err(|error| CliError::read(file, &error, help))?.len();
    if MOST_BYTES < size {
        return Err(CliError::input(format_args!("{} has {size} bytes", file.display()), help));
    }
    let bytes = fs::read(file).map_err(|error| CliError::read(file, &error, help))?;
    let fault = |fault: String| {
        let name = file.display();
        CliError::input(
            format_args!("{name}: {fault}"),
            "see `muslin fabric import --help` for what it must have",
        )
    };
    let json = serde_json::from_slice(&bytes).map_err(|error| fault(format!("is not JSON: {error}")))?;
    let material = Material::read(&json).map_err(fault)?;
    let stem = file.file_stem().map_or_else(|| "imported".into(), |stem| stem.to_string_lossy());
    let name = name.unwrap_or(&stem);
    let text = material.fabric_text(name);
    print_text(&format!("{text}\n{}", followed(name, &text)?))
}

/// What follows from the values of the fabric `name` in `text`, as comments; an error if no scene can have it.
fn followed(name: &str, text: &str) -> Result<String, CliError> {
    let scene = format!(
        "title = \"sheet\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n{text}\n\
         [[cloth]]\nname = \"sheet\"\nfabric = {}\ngrid = {{ columns = 2, rows = 2, width = 0.01, height = 0.01 }}\n\
         place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
        quoted(name)
    );
    let parsed =
        Scene::parse(&scene).map_err(|error| CliError::BadInput(error.render("the fabric", &scene)))?;
    Ok(match parsed.fabrics().get(name) {
        Some(Fabric::Measured(fabric)) => properties(fabric),
        _ => String::new(),
    })
}

impl Material {
    /// The material of `json`, or which rule it breaks where.
    fn read(json: &Value) -> Result<Self, String> {
        let object = json.as_object().ok_or("must be an object `{ \"density\": ... }`")?;
        let entry = |key: &str| object.get(key).ok_or_else(|| format!("`{key}` is missing"));
        let material = Self {
            density: number(entry("density")?, "density", "kg/m^2")?,
            stretching: table(entry("stretching")?, "stretching")?,
            bending: table(entry("bending")?, "bending")?,
        };
        if material.density <= 0.0 {
            return Err(format!("`density` is {} kg/m^2, but must be positive", material.density));
        }
        for (column, name) in [(0, "c11"), (2, "c22")] {
            if material.stretching[0][column] <= 0.0 {
                return Err(format!("`stretching` row 0 has {name} = 0, but must have a positive one"));
            }
        }
        Ok(material)
    }

    /// Rigidities [N m] along v, at 45° and along u.
    fn rigidities(&self, column: usize) -> [f64; 3] {
        [0, 1, 2].map(|row: usize| self.bending[row][column] / 4.0)
    }

    /// The table `[fabric.NAME]` of a scene, with what is uncertain and what is lost as comments.
    fn fabric_text(&self, name: &str) -> String {
        let [rest, along_u, .., along_v] = &self.stretching;
        let [c11, c12, c22, c33] = *rest;
        let [warp, bias, weft] = self.rigidities(0);
        let twist_part = if bias < 0.25 * (warp + weft) {
            format!(
                "# Its rigidity at 45 degrees, {} N m, is below a quarter of warp and weft together: left out.\n",
                significant(bias)
            )
        } else {
            String::new()
        };
        let bias_key = if twist_part.is_empty() { format!(", bias = {bias:?}") } else { String::new() };
        let at_strain = |row: &[f64; 4], column: usize| significant(2.0 * row[column]);
        let last = self.rigidities(4).map(significant);
        let mut text = format!("[fabric.{}]\n", bare_or_quoted(name));
        let _ = write!(
            text,
            "# Imported from a material file of ARCSim. See its licence before you pass these values on.\n\
             #\n\
             # Moduli are C11 = 2 c11, C22 = 2 c22, G = c33, as ARCSim's force has them; its energy has half of the shear. Comments\n\
             # in its files count neither 2, so that they are uncertain by a factor of 2. Rigidities are k_e / 4, as its force has\n\
             # them, uncertain by up to 4. u is the weft here and v the warp: the file does not say.\n\
             # Lost: C12 = {} N/m, which is G here; stiffening to secant moduli of {} N/m along the warp and {} along the weft at a\n\
             # strain of {} %; rigidities of {}, {} and {} N m along warp, at 45 degrees and along weft at a curvature of 40 /m.\n\
             {twist_part}\
             kind = \"measured\"\n",
            significant(2.0 * c12),
            at_strain(along_v, 2),
            at_strain(along_u, 0),
            significant(100.0 * STRAIN),
            last[0],
            last[1],
            last[2],
        );
        for (value, comment) in [
            (format!("areal_density = {:?}", self.density), "[kg/m^2]"),
            ("drag = 0.0".to_owned(), "none: air acts as wind"),
            (format!("warp = {{ modulus = {:?} }}", 2.0 * c22), "[N/m], row 0 of `stretching`"),
            (format!("weft = {{ modulus = {:?} }}", 2.0 * c11), "[N/m]"),
            (format!("shear = {{ modulus = {c33:?} }}"), "[N/m]"),
            (
                format!("bend = {{ warp = {warp:?}, weft = {weft:?}{bias_key} }}"),
                "[N m], column 0 of `bending`",
            ),
        ] {
            let _ = writeln!(text, "{value:<50} # {comment}");
        }
        text
    }
}

/// The rows of a table of numbers that are not negative.
fn table<const COLUMNS: usize, const ROWS: usize>(
    value: &Value,
    key: &str,
) -> Result<[[f64; COLUMNS]; ROWS], String> {
    let rows = list(value, key, ROWS, "rows")?;
    let mut table = [[0.0; COLUMNS]; ROWS];
    for (index, (row, numbers)) in rows.iter().zip(&mut table).enumerate() {
        let path = format!("{key}[{index}]");
        for (column, (cell, found)) in list(row, &path, COLUMNS, "numbers")?.iter().zip(numbers).enumerate() {
            let path = format!("{path}[{column}]");
            *found = number(cell, &path, "N/m")?;
            if *found < 0.0 {
                return Err(format!("`{path}` is {found:?}, but must not be negative"));
            }
        }
    }
    Ok(table)
}

fn list<'a>(value: &'a Value, path: &str, count: usize, what: &str) -> Result<&'a [Value], String> {
    let list = value.as_array().ok_or_else(|| format!("`{path}` must be a list of {count} {what}"))?;
    if list.len() != count {
        return Err(format!("`{path}` has {} {what}, but must have {count}", list.len()));
    }
    Ok(list)
}

fn number(value: &Value, path: &str, unit: &str) -> Result<f64, String> {
    let number = value.as_f64().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("`{path}` is {value}, but must be a number [{unit}]"))
}

/// `name` as a key of TOML.
fn bare_or_quoted(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

/// `name` as a string of TOML, which JSON's strings are.
fn quoted(name: &str) -> String {
    Value::from(name).to_string()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Invented numbers, no two alike.
    fn invented() -> Value {
        json!({
            "density": 0.2,
            "stretching": [
                [100.0, 5.0, 300.0, 40.0], [150.0, 6.0, 310.0, 41.0], [110.0, 6.0, 320.0, 42.0],
                [120.0, 6.0, 330.0, 43.0], [130.0, 6.0, 340.0, 44.0], [140.0, 6.0, 450.0, 45.0]
            ],
            "bending": [
                [8e-5, 7e-5, 6e-5, 5e-5, 4.4e-5], [9e-5, 8e-5, 7e-5, 6e-5, 5.2e-5], [4e-5, 3e-5, 2e-5, 1e-5, 0.8e-5]
            ]
        })
    }

    fn fabric(json: &Value, name: &str) -> (String, muslin::scene::MeasuredFabric) {
        let text = Material::read(json).expect("a material").fabric_text(name);
        let scene = format!(
            "title = \"s\"\nrun = {{ duration = 1.0 }}\nenvironment = {{ gravity = [0, 0, 0] }}\n{text}\n\
             [[cloth]]\nname = \"s\"\nfabric = {}\ngrid = {{ columns = 2, rows = 2, width = 1.0, height = 1.0 }}\n\
             place = {{ origin = [0, 0, 0], width_axis = [1, 0, 0], height_axis = [0, 1, 0] }}\n",
            quoted(name)
        );
        let parsed = Scene::parse(&scene).unwrap_or_else(|error| panic!("{}", error.render("scene", &scene)));
        let Some(Fabric::Measured(fabric)) = parsed.fabrics().get(name) else { panic!("{scene}") };
        (text, fabric.clone())
    }

    #[test]
    fn factors_are_those_of_the_force() {
        let (text, fabric) = fabric(&invented(), "a \"cloth\"");
        assert_eq!(fabric.areal_density, 0.2);
        assert_eq!((fabric.warp.least_modulus(), fabric.weft.least_modulus()), (600.0, 200.0));
        assert_eq!(fabric.shear_modulus, 40.0);
        assert_eq!((fabric.bending.warp, fabric.bending.weft), (2e-5, 1e-5));
        assert!((fabric.bending.bias() - 2.25e-5).abs() < 1e-19);
        // Secant moduli at a strain of 1/6 along either side, and rigidities at 40 /m.
        for lost in [
            "C12 = 10.0 N/m",
            "900 N/m along the warp and 300 along the weft",
            "1.10e-5, 1.30e-5 and 2.00e-6 N m",
        ] {
            assert!(text.contains(lost), "{lost} in {text}");
        }
    }

    #[test]
    fn a_rigidity_at_45_degrees_that_no_sheet_has_is_left_out() {
        let mut json = invented();
        json["bending"][1][0] = json!(2.9e-5);
        let (text, fabric) = fabric(&json, "cloth");
        assert!(text.contains("left out") && !text.contains("bias ="), "{text}");
        // The mean of warp and weft, as where none is given.
        assert!((fabric.bending.bias() - 1.5e-5).abs() < 1e-19);
    }

    #[test]
    fn faults_are_named() {
        let with = |pointer: &str, value: Value| {
            let mut json = invented();
            *json.pointer_mut(pointer).expect("it is there") = value;
            Material::read(&json).expect_err("a fault")
        };
        let without = |key: &str| {
            let mut json = invented();
            json.as_object_mut().expect("an object").remove(key);
            Material::read(&json).expect_err("a fault")
        };
        for (found, expected) in [
            (without("density"), "`density` is missing"),
            (without("bending"), "`bending` is missing"),
            (with("/density", json!("light")), "`density` is \"light\", but must be a number [kg/m^2]"),
            (with("/density", json!(0.0)), "`density` is 0 kg/m^2, but must be positive"),
            (with("/stretching", json!(7)), "`stretching` must be a list of 6 rows"),
            (with("/stretching", json!([[1, 2, 3, 4]])), "`stretching` has 1 rows, but must have 6"),
            (with("/bending/2", json!([1, 2, 3, 4])), "`bending[2]` has 4 numbers, but must have 5"),
            (with("/bending/2/1", json!(-1e-5)), "`bending[2][1]` is -1e-5, but must not be negative"),
            (
                with("/stretching/0/0", json!(0)),
                "`stretching` row 0 has c11 = 0, but must have a positive one",
            ),
        ] {
            assert_eq!(found, expected);
        }
        assert_eq!(Material::read(&json!([])), Err("must be an object `{ \"density\": ... }`".to_owned()));
    }
}

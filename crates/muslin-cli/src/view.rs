//! `muslin view`.

use std::io::{Write, stdout};
use std::path::Path;

use crate::error::CliError;

/// Opens the page of the folder `dir` in the browser.
pub(crate) fn view(dir: &Path) -> Result<(), CliError> {
    let page = dir.join("view.html");
    if !page.is_file() {
        return Err(CliError::input(
            format_args!("{} has no view.html", dir.display()),
            "name a folder that `muslin run` wrote",
        ));
    }
    let page = page.canonicalize().map_err(|error| CliError::read(&page, &error, "check the folder"))?;
    open::that_detached(&page).map_err(|error| {
        CliError::failed(
            format_args!("no browser could be started: {}", crate::error::reason(&error)),
            format_args!("open {} yourself", page.display()),
        )
    })?;
    let _ = writeln!(stdout(), "opened {}", page.display());
    Ok(())
}

//! `muslin view`.

use std::path::Path;

use crate::error::CliError;
use crate::output::require_ended;
use crate::print_text;

/// Opens the page of the folder `dir` in the browser.
pub(crate) fn view(dir: &Path) -> Result<(), CliError> {
    require_ended(dir, "view.html")?;
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
    print_text(&format!("opened {}\n", page.display()))
}

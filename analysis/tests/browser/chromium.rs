//! A headless browser, which shows pages as a reader's browser does.

use analysis::browser::NAME;
use analysis::toolchain::set_up_tool;

/// Makes sure that a browser is installed.
///
/// # Errors
/// Where it cannot be installed, with the package to install.
pub fn set_up() -> Result<(), String> {
    set_up_tool(NAME)
}

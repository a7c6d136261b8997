//! Tables that a command prints.

use comfy_table::{CellAlignment, Table, presets};

/// An empty table with this header; the columns of numbers are set to the right.
pub fn markdown_table<'h>(
    header: impl IntoIterator<Item = &'h str>,
    numbers: impl IntoIterator<Item = usize>,
) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(header);
    for column in numbers {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

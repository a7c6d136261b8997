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

/// A column: its name, whether it has numbers, and its cell in a row.
pub type Column<R> = (&'static str, bool, fn(&R) -> String);

/// The table of some rows.
pub fn table_of<R>(rows: &[R], columns: &[Column<R>]) -> Table {
    let numbers = columns.iter().enumerate().filter(|(_, (_, has_numbers, _))| *has_numbers);
    let mut table =
        markdown_table(columns.iter().map(|column| column.0), numbers.map(|(index, _)| index));
    for row in rows {
        table.add_row(columns.iter().map(|(_, _, cell)| cell(row)));
    }
    table
}

//! Tables that a command prints.

use comfy_table::{CellAlignment, Table, presets};

/// A column: its name, whether it has numbers, and its cell in a row.
pub type Column<R> = (&'static str, bool, fn(&R) -> String);

/// The table of some rows as Markdown; the columns of numbers are set to the right.
pub fn table_of<R>(rows: &[R], columns: &[Column<R>]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(columns.iter().map(|column| column.0));
    for (index, (_, has_numbers, _)) in columns.iter().enumerate() {
        if let Some(column) = table.column_mut(index).filter(|_| *has_numbers) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    for row in rows {
        table.add_row(columns.iter().map(|(_, _, cell)| cell(row)));
    }
    table
}

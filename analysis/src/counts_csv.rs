//! Recorded encoder counts, one a tick.

use std::io::Read;
use std::path::Path;

use crate::table::{Column, Table, TableError};

const COUNT: Column =
    Column { names: &["count", "counts"], bound: "a whole number from -2147483648 to 2147483647" };

/// Reads the column `count` of a CSV file with a header; other columns are passed over.
///
/// # Errors
/// Where the file cannot be read, has no such column or no row, or has a field that is not a count.
pub fn load(path: &Path) -> Result<Vec<i32>, TableError> {
    counts(Table::open(path)?)
}

fn counts<R: Read>(mut table: Table<R>) -> Result<Vec<i32>, TableError> {
    let column = table.column(COUNT)?;
    let mut counts = Vec::new();
    while let Some(row) = table.row()? {
        counts.push(row.number(column, |_| true)?);
    }
    table.at_least(1)?;
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<i32>, String> {
        Table::new("x.csv", text).and_then(counts).map_err(|error| error.to_string())
    }

    #[test]
    fn counts_are_found_by_name() {
        assert_eq!(read(b"time_s,count\n0.0,-3\n0.1, 7\n"), Ok(vec![-3, 7]));
        assert_eq!(read(b"\xef\xbb\xbfCOUNTS\r\n1\r\n2\r\n"), Ok(vec![1, 2]));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let bad = read(b"count\n1\n2.5\n").unwrap_err();
        assert!(bad.starts_with("x.csv:3: column 1, `count`: `2.5` is out of bounds"), "{bad}");
        let bad = read(b"count\n1\n99999999999\n").unwrap_err();
        let bounds = format!("from {} to {}", i32::MIN, i32::MAX);
        assert!(bad.contains("x.csv:3") && bad.contains(&bounds), "{bad}");
        assert!(read(b"a,b\n1,2\n").unwrap_err().contains("the columns are a, b"));
        assert!(read(b"a,count\n1,2\n1\n").unwrap_err().starts_with("x.csv:3: 1 fields"));
        assert!(read(b"count\n\xff\n").unwrap_err().starts_with("x.csv:2: not UTF-8"));
        assert!(read(b"").is_err() && read(b"count\n").is_err());
    }

    #[test]
    fn a_folder_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let message = load(folder.path()).unwrap_err().to_string();
        assert!(message.contains("cannot be read"), "{message}");
        let message = load(&folder.path().join("none.csv")).unwrap_err().to_string();
        assert!(message.contains("none.csv: cannot be read"), "{message}");
    }
}

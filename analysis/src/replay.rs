//! Recorded encoder counts, one a tick.

use std::path::Path;

use thiserror::Error;

/// Why a recording cannot be replayed. Lines are counted from 1, the header being the first.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The file cannot be opened.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// Why.
        source: csv::Error,
    },
    /// There is no column of counts.
    #[error("{file}:1: there is no column `count`; the columns are {columns}")]
    NoCounts {
        /// The file.
        file: String,
        /// The columns that there are.
        columns: String,
    },
    /// A row is not valid CSV, or has another number of fields than the header.
    #[error("{file}:{line}: {message}")]
    BadRow {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A count is no count.
    #[error(
        "{file}:{line}: column `count`: `{value}` is out of bounds; a count is a whole number \
         from {} to {}",
        i32::MIN,
        i32::MAX
    )]
    BadCount {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What stands there.
        value: String,
    },
    /// There are no rows.
    #[error("{file}: there is no row below the header")]
    Empty {
        /// The file.
        file: String,
    },
}

/// Reads the column `count` of a CSV file with a header; other columns are passed over.
pub fn load(path: &Path) -> Result<Vec<i32>, ReplayError> {
    let file = path.display().to_string();
    match csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path) {
        Ok(mut reader) => counts(&file, &mut reader),
        Err(source) => Err(ReplayError::Unreadable { file, source }),
    }
}

fn counts<R: std::io::Read>(
    file: &str,
    reader: &mut csv::Reader<R>,
) -> Result<Vec<i32>, ReplayError> {
    let file = file.to_owned();
    let header = reader.headers().map_err(|error| bad_row(&file, 1, &error))?;
    let Some(column) = header.iter().position(|name| name == "count") else {
        let columns = header.iter().map(crate::file::excerpt).collect::<Vec<_>>().join(", ");
        return Err(ReplayError::NoCounts { file, columns: crate::file::excerpt(&columns) });
    };
    let mut counts = Vec::new();
    let mut row = csv::StringRecord::new();
    loop {
        let line = reader.position().line();
        match reader.read_record(&mut row) {
            Ok(false) => break,
            Ok(true) => {}
            Err(error) => return Err(bad_row(&file, line, &error)),
        }
        let value = row.get(column).unwrap_or_default();
        let line = row.position().map_or(line, csv::Position::line);
        let count = value.parse().map_err(|_| ReplayError::BadCount {
            file: file.clone(),
            line,
            value: crate::file::excerpt(value),
        })?;
        counts.push(count);
    }
    if counts.is_empty() { Err(ReplayError::Empty { file }) } else { Ok(counts) }
}

fn bad_row(file: &str, line: u64, error: &csv::Error) -> ReplayError {
    let line = error.position().map_or(line, csv::Position::line);
    ReplayError::BadRow { file: file.to_owned(), line, message: row_message(error) }
}

/// What is wrong with a row, without its place.
pub(crate) fn row_message(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields; the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => crate::file::excerpt(&error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<i32>, String> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text);
        counts("x.csv", &mut reader).map_err(|error| error.to_string())
    }

    #[test]
    fn counts_are_found_by_name() {
        assert_eq!(read(b"time_s,count\n0.0,-3\n0.1, 7\n"), Ok(vec![-3, 7]));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let bad = read(b"count\n1\n2.5\n").unwrap_err();
        assert!(bad.starts_with("x.csv:3: column `count`: `2.5` is out of bounds"), "{bad}");
        let bad = read(b"count\n1\n99999999999\n").unwrap_err();
        assert!(bad.contains("x.csv:3") && bad.contains("2147483647"), "{bad}");
        assert!(read(b"a,b\n1,2\n").unwrap_err().contains("the columns are a, b"));
        assert!(read(b"a,count\n1,2\n1\n").unwrap_err().starts_with("x.csv:3: 1 fields"));
        assert!(read(b"count\n\xff\n").unwrap_err().starts_with("x.csv:2: not UTF-8"));
        assert!(read(b"").is_err() && read(b"count\n").is_err());
    }
}

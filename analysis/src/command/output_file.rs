//! The files that a command writes, checked before it begins: that none is lost, and that each can be written.

use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};

use super::status::CommandError;

/// A file of a command.
#[derive(Clone, Copy, Debug)]
pub struct FileArgument<'a> {
    /// The argument that names it.
    pub name: &'static str,
    pub path: &'a Path,
}

impl<'a> FileArgument<'a> {
    /// The file of an argument that is given; standard input is none.
    pub fn of(name: &'static str, path: Option<&'a Path>) -> Option<Self> {
        path.filter(|path| *path != Path::new("-")).map(|path| Self { name, path })
    }
}

/// Refuses outputs that are an input of the command, or another output.
pub fn refuse_overwriting(
    inputs: &[Option<FileArgument<'_>>],
    outputs: &[Option<FileArgument<'_>>],
) -> Result<(), CommandError> {
    let all: Vec<_> = inputs.iter().chain(outputs).collect();
    for (index, output) in all.iter().enumerate().skip(inputs.len()) {
        let Some(output) = output else { continue };
        let is_same = |other: &&FileArgument<'_>| location(other.path) == location(output.path);
        if let Some(other) = all[..index].iter().copied().flatten().find(is_same) {
            let (output, path) = (output.name, output.path.to_owned());
            return Err(CommandError::Overwrites { output, other: other.name, path });
        }
    }
    Ok(())
}

/// Refuses a file that cannot be written. It is as before afterwards.
pub fn check_writable(path: &Path) -> Result<(), CommandError> {
    let is_new = path.symlink_metadata().is_err();
    let open = || -> io::Result<()> {
        OpenOptions::new().append(true).create(true).open(path)?;
        if is_new { std::fs::remove_file(path) } else { Ok(()) }
    };
    open().map_err(|source| CommandError::Unwritable { path: path.to_owned(), source })
}

/// The place of a file, which may not be there yet; `None` for a folder, a device, or a place that is not there.
fn location(path: &Path) -> Option<PathBuf> {
    match path.canonicalize() {
        Ok(there) => there.is_file().then_some(there),
        Err(_) => {
            let folder = std::path::absolute(path).ok()?.parent()?.canonicalize().ok()?;
            Some(folder.join(path.file_name()?))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_one_location_however_it_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let [file, new] = ["file", "new"].map(|name| folder.path().join(name));
        std::fs::write(&file, "kept").unwrap();
        let again = |name: &str| folder.path().join(".").join(name);
        fn of<'a>(name: &'static str, path: &'a Path) -> Option<FileArgument<'a>> {
            FileArgument::of(name, Some(path))
        }
        let refused = |input: &Path, output: &Path| {
            refuse_overwriting(&[of("FILE", input)], &[of("-o", output)]).is_err()
        };
        assert!(refused(&file, &again("file")) && refused(&new, &again("new")));
        assert!(!refused(&file, &new));
        assert!(refuse_overwriting(&[], &[of("--record", &new), None, of("-o", &new)]).is_err());
        check_writable(&file).unwrap();
        check_writable(&new).unwrap();
        assert!(!new.exists() && std::fs::read_to_string(&file).unwrap() == "kept");
        assert!(check_writable(&new.join("below")).is_err());
        assert!(check_writable(folder.path()).is_err());
    }
}

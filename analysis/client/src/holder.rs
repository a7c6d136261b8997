//! The other programs that have a serial port open.

use std::path::Path;

/// The other programs that have this port open, as far as the system shows them: the end of a sentence, or
/// empty. Linux shows the open files of one's own programs in `/proc`.
pub fn holders(port: &str) -> String {
    let Ok(port) = Path::new(port).canonicalize() else { return String::new() };
    let Ok(processes) = std::fs::read_dir("/proc") else { return String::new() };
    let holds = |process: &Path| {
        let files = std::fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        files.filter_map(|file| file.path().read_link().ok()).any(|file| file == port)
    };
    let named = processes.flatten().filter_map(|entry| {
        let number: u32 = entry.file_name().to_str()?.parse().ok()?;
        let process = entry.path();
        (number != std::process::id() && holds(&process)).then(|| {
            let name = std::fs::read_to_string(process.join("comm")).unwrap_or_default();
            format!("{} (process {number})", name.trim())
        })
    });
    match &named.collect::<Vec<_>>()[..] {
        [] => String::new(),
        names => format!("; the port is in use by {}", names.join(", ")),
    }
}

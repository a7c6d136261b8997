//! Tests that need a tool: where it is missing, and cannot be installed, they report this and count as
//! ignored.

use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Completion, Trial};

/// Runs tests, each with its name. All but the first `always` are ignored unless they are asked for by a part of
/// a name or `--include-ignored`. `kind` is shown for tests without their tool, and `what` is what they do with
/// it.
pub fn run<T: FnOnce() + Send + 'static>(
    kind: &str,
    what: &str,
    always: usize,
    tests: Vec<(&str, T)>,
    set_up: impl FnOnce() -> Result<(), String>,
) -> ExitCode {
    let arguments = Arguments::from_args();
    let asks_for_all = arguments.ignored || arguments.include_ignored;
    // A list of the tests, or other tests, need no tool.
    let is_wanted = |(number, (name, _)): (usize, &(&str, T))| match &arguments.filter {
        Some(part) => name.contains(part),
        None => asks_for_all || number < always,
    };
    let looks = !arguments.list && tests.iter().enumerate().any(is_wanted);
    let missing = looks.then(set_up).and_then(Result::err);
    if let Some(why) = &missing {
        eprintln!("skipped: {what}: {why}");
    }
    let is_missing = missing.is_some();
    let trial = |(number, (name, test)): (usize, (&str, T))| {
        let run = move || {
            if is_missing {
                return Ok(Completion::ignored());
            }
            test();
            Ok(Completion::Completed)
        };
        let is_left_out = arguments.filter.is_none() && number >= always;
        let trial = Trial::ignorable_test(name, run).with_ignored_flag(is_missing || is_left_out);
        if is_missing { trial.with_kind(kind) } else { trial }
    };
    let trials = tests.into_iter().enumerate().map(trial).collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// They do not count as passed: runs this program again, with a path that has no programs.
pub fn assert_ignored_without_tools(kind: &str, count: usize, package: &str) {
    let this = std::env::current_exe().unwrap();
    let run = Command::new(this).arg("--include-ignored").env("PATH", "/nowhere").output().unwrap();
    assert!(run.status.success(), "{run:?}");
    let [shown, said] = [run.stdout, run.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(shown.matches(&format!("test [{kind}] ")).count(), count, "{shown}");
    assert!(shown.contains(&format!("0 passed; 0 failed; {count} ignored")), "{shown}");
    assert!(
        said.contains("skipped: ") && said.contains(&format!("apt install {package}")),
        "{said}"
    );
}

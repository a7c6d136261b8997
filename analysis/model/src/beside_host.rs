//! The verdict on a scene with a host that adds torques.

use haptic_servo::host::{HostError, HostResponse, HostTorque, Sampling};

use crate::file::SceneFile;
use crate::quantity::{rounded_down, significant};
use crate::verdict::{Verdict, VerdictReport};

/// Takes the host's share from the margin of a certified scene, or rejects the scene.
pub fn add(report: &mut VerdictReport, file: &SceneFile, host: &HostTorque) {
    if report.verdict != Verdict::Certified {
        return;
    }
    match check(report, file, host) {
        Ok(()) => certify(report, host),
        Err(error) => reject(report, &error),
    }
}

fn check(report: &VerdictReport, file: &SceneFile, host: &HostTorque) -> Result<(), HostError> {
    host.check()?;
    host.check_share(report.margin.filter(|_| report.is_margin_known))?;
    if report.is_for_a_board && report.margin_on_board.is_some() {
        let on_board = report.margin_on_board.filter(|_| report.is_margin_known_on_board);
        host.check_share(on_board)?;
    }
    let count = file.encoder_step.unwrap_or(0.0);
    let sampling = Sampling::simultaneous(&file.scene.timing, count);
    HostResponse::of(host, &file.scene.latency, &sampling).map(drop)
}

fn certify(report: &mut VerdictReport, host: &HostTorque) {
    let HostTorque { energy, power, damping, torque, timeout } = host;
    let budget = format!("{energy} J at once and {power} W on average, whatever it sends");
    let left = |margin: f64| (margin - damping).next_down();
    report.margin = report.margin.map(left);
    report.margin_on_board = report.margin_on_board.map(|margin| left(margin).max(0.0));
    report.delta -= damping;
    report.message += &format!(
        "; a host may give {budget}, for which it has {damping} N m s/rad of that damping"
    );
    report.assumptions.push(format!(
        "a host's torque of at most {torque} N m is scaled down to what its budget pays for, {budget}, and fades \
         to zero within {timeout} s if it is not renewed; its share of {damping} N m s/rad is taken from delta, \
         which leaves {} N m s/rad for the scene",
        rounded_down(report.delta, 12)
    ));
    report.host = Some(format!("may give {budget}"));
}

fn reject(report: &mut VerdictReport, error: &HostError) {
    report.verdict = Verdict::Rejected;
    report.reason = "host";
    report.on_board = Some(Verdict::Rejected);
    report.summary = error.to_string();
    report.message = format!("rejected: {error}");
    if let HostError::Share { margin, .. } = error {
        let bound = significant(*margin, 3);
        report.remedies = vec![format!("host damping below {bound} N m s/rad")];
    }
}

//! `pcs-sim calibrate-ipsc2 SCENE`, or `pcs-sim calibrate SCENE --on ipsc2`: a node's times, fitted to what an image took.

use std::io::Write;
use std::path::Path;

use pcs_sim::machine::Ipsc2File;
use pcs_sim::report::summary::{Rows, text};
use pcs_sim::run::{Calibrated, CubeSpec, Known, moot, read_text};

use super::args::Typed;
use super::ipsc2_args::CalibrateIpsc2Args;
use super::run::workers;
use super::{Failure, outputs, print, progress};

/// Writes the machine file with the times that come nearest to those that are known.
pub fn calibrate(args: &CalibrateIpsc2Args, typed: &Typed) -> Result<(), Failure> {
    let named = [args.output.as_ref()];
    outputs::check_distinct(&named, &[args.machine.as_deref(), Some(Path::new(&args.scene))])?;
    let options = args.options(typed);
    let spec = CubeSpec::new(&options, None)?;
    moot::check_cube(&options, &spec)?;
    let output = outputs::open(args.output.as_deref(), args.force)?;
    let known = Known { one_node: args.seconds, geometry: args.geometry, others: args.times.clone() };
    let spinner = progress::waiting("fitting");
    let calibrated =
        outputs::reading(&named, || spec.calibrate(&known, &workers(args.threads)).map_err(Failure::from))?;
    spinner.finish_and_clear();
    let path = args.machine.as_deref().unwrap_or(Path::new("ipsc2.ron"));
    let standing = match &args.machine {
        Some(path) => read_text(path)?,
        None => Ipsc2File::STANDARD_TEXT.to_owned(),
    };
    let new = calibrated.machine.retold(path, &standing)?;
    if output.is_none() {
        return print(&new);
    }
    let mut written = Vec::new();
    outputs::finish(output, &mut written, |file| file.write_all(new.as_bytes()))?;
    print(&format!("{}{}", told(&calibrated), outputs::list(&written)))
}

/// What the fit makes of the times that are known.
fn told(calibrated: &Calibrated) -> String {
    let rows = calibrated.fitted.iter().map(|(known, seconds)| {
        vec![
            known.nodes.to_string(),
            format!("{:.1}", known.seconds),
            format!("{seconds:.1}"),
            format!("{:+.2} %", 100.0 * (seconds / known.seconds - 1.0)),
        ]
    });
    let header = ["nodes", "known, s", "fitted, s", "difference"].map(str::to_owned).to_vec();
    let factor = calibrated.factor;
    format!("the nodes' times are {factor:.3} times Figure 7's\n\n{}\n", text(Rows { header, rows: rows.collect() }))
}

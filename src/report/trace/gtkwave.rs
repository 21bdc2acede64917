//! A save file for GTKWave: which signals of a dump it shows, and how.

use std::fmt::Write;
use std::path::Path;

use super::signals::{Kind, Signals, StateNames};
use super::{Format, Trace};

/// How GTKWave shows a signal, by the numbers of its save files: a comment, a right-justified text, a right-justified decimal number.
const COMMENT: &str = "@200";
const TEXT: &str = "@820";
const DECIMAL: &str = "@24";

/// Pixels that waves have across in a window of the usual size.
const PIXELS: f64 = 500.0;

/// The save file for a dump of that name, which lies beside it.
pub fn save_file(trace: &Trace<'_>, dump: &Path) -> String {
    let names = StateNames::new(&trace.recording.topology.states);
    let signals = Signals::new(trace, &names);
    let scale = Format::Vcd.time_scale(trace.clock);
    let machine = &trace.recording.topology.names.machine;
    let file = dump.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!("[*] pcs-sim {}\n", env!("CARGO_PKG_VERSION"));
    let window = &trace.recording.window;
    let [start, end] = [window.start, window.end].map(|cycle| scale.start_of(cycle));
    // The whole window at first: it wants the logarithm of how much of the time a pixel has, and no marker.
    let zoom = (end.saturating_sub(start).max(1) as f64 / PIXELS).log2();
    let _ = writeln!(text, "[dumpfile] \"{file}\"\n[timestart] {start}\n*{:.6} -1", -zoom);
    for scope in &signals.scopes {
        let _ = writeln!(text, "{COMMENT}\n-{}", scope.title);
        for signal in &scope.signals {
            let path = format!("{machine}.{}.{}", scope.name, signal.name);
            let _ = match signal.kind {
                Kind::Text => writeln!(text, "{TEXT}\n{path}"),
                // It gives a range to what has several bits.
                Kind::Number(1) => writeln!(text, "{DECIMAL}\n{path}"),
                Kind::Number(bits) => writeln!(text, "{DECIMAL}\n{path}[{}:0]", bits - 1),
            };
        }
    }
    text
}

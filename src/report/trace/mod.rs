//! A run cycle by cycle, for viewers that people have.

mod fst;
mod gtkwave;
mod perfetto;
mod signals;
mod time_scale;
mod vcd;

use std::io::Write;
use std::path::{Path, PathBuf};

use super::plot::Caption;
use super::summary::grouped;
use crate::error::InputError;
use crate::input::is_stream;
use crate::measure::{Clock, Recording};
use time_scale::TimeScale;

/// A trace format, by the name of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `.pftrace` or `.perfetto-trace`: for Perfetto.
    Perfetto,
    /// `.vcd`, value change dump: for GTKWave, Surfer and most waveform viewers.
    Vcd,
    /// `.fst`, fast signal trace: the same in less space.
    Fst,
}

impl Format {
    /// The format of a file with that name.
    pub fn of(path: &Path) -> Result<Format, InputError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("pftrace" | "perfetto-trace") => Ok(Format::Perfetto),
            Some("vcd") => Ok(Format::Vcd),
            Some("fst") => Ok(Format::Fst),
            _ => {
                let help = "traces end in .pftrace (or .perfetto-trace) for Perfetto, in .vcd or .fst for GTKWave and Surfer; \
                            -.vcd is standard output";
                Err(InputError::in_file(path, "is no name of a trace").help(help))
            }
        }
    }

    /// How it counts a machine's time.
    fn time_scale(self, clock: Clock) -> TimeScale {
        match self {
            Format::Perfetto => TimeScale::new(clock.cycle_ns, &[-9]),
            Format::Vcd | Format::Fst => TimeScale::new(clock.cycle_ns, &[-9, -12, -15]),
        }
    }
}

/// What a trace tells.
#[derive(Clone, Copy, Debug)]
pub struct Trace<'a> {
    /// What ran.
    pub caption: &'a Caption,
    /// The machine's clock.
    pub clock: Clock,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    /// What happened.
    pub recording: &'a Recording,
}

impl Trace<'_> {
    /// Writes the trace.
    pub fn write(&self, format: Format, out: &mut impl Write) -> std::io::Result<()> {
        let scale = format.time_scale(self.clock);
        match format {
            Format::Perfetto => perfetto::write(self, scale, out),
            Format::Vcd => vcd::write(self, scale, out),
            Format::Fst => fst::write(self, scale, out),
        }
    }

    /// Where the save file of a dump lies that GTKWave reads: which signals it shows, and how. `None` for what it does not read.
    /// It has the dump's whole name, as a dump of another format may lie beside it.
    pub fn save_path(format: Format, dump: &Path) -> Option<PathBuf> {
        let mut name = dump.as_os_str().to_owned();
        name.push(".gtkw");
        (format != Format::Perfetto && !is_stream(dump)).then(|| name.into())
    }

    /// The save file of a dump of that name.
    pub fn save_file(&self, dump: &Path) -> String {
        gtkwave::save_file(self, dump)
    }

    /// What its reader should know: where it was cut, and what could not be written exactly.
    pub fn notes(&self, format: Format) -> Vec<String> {
        let Recording { window, cycles, cut, .. } = self.recording;
        let mut notes = Vec::new();
        if window.is_empty() {
            notes.push(format!(
                "the trace is empty: the run ended before its window, after {} cycles",
                grouped(cycles.0)
            ));
        } else if *cut {
            notes.push(format!(
                "the trace holds as much as viewers open with ease, and ends before cycle {end} of {}; \
                 --trace-window {end}.. shows what comes next",
                cycles.0,
                end = window.end.0,
            ));
        }
        if !format.time_scale(self.clock).is_exact() {
            let unit = if format == Format::Perfetto { "ns" } else { "fs" };
            let cycle = self.clock.cycle_ns;
            notes.push(format!(
                "a cycle of {cycle} ns is no whole number of {unit}: the trace's times are rounded to {unit}"
            ));
        }
        notes
    }

    /// The name of a station, and what it runs.
    fn station_name(&self, index: usize) -> String {
        let station = self.recording.topology.station(index);
        self.cell_names.get(index).map_or_else(|| station.clone(), |name| format!("{station} {name}"))
    }
}

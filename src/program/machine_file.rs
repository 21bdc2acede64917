//! The machine file: the array's parameters and Figure 7's times.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::kernel::{HostTimes, KernelTimes, Times};
use crate::error::InputError;
use crate::input::fields::{self, Fault};
use crate::isa::{Class, InstructionCycles};
use crate::machine::{Cycles, MachineSpec, RateCounts, Words};

/// A machine as a file describes it, in the units that people use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineFile {
    /// Length of a cycle, in ns.
    pub clock_ns: f64,
    /// Size of a word, in bytes.
    pub word_bytes: u32,
    /// Words that each of a cell's two input FIFOs holds.
    pub fifo_words: u64,
    /// Rate of a link, in 10^6 bytes a second.
    pub link_mb_s: f64,
    /// Whether that rate counts both channels of a link together or each by itself.
    pub rate_counts: RateCounts,
    /// Cycles from the write of a word to the first in which it can be read.
    pub latency_cycles: u64,
    /// Words of memory of a cell; `None` for as many as it needs.
    #[serde(default)]
    pub memory_words: Option<u64>,
    /// What the host spends on each ray before it sends it, in µs; 0 for a host that is never the bottleneck.
    #[serde(default)]
    pub host_ray_us: f64,
    /// What the host spends on shading a hit, in µs.
    #[serde(default)]
    pub host_hit_us: f64,
    /// Figure 7.
    pub times_us: TimesUs,
    /// What instructions cost, for cells that run programs; `None` for a machine that is only told Figure 7.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instruction_cycles: Option<InstructionCycles>,
}

/// Figure 7, in µs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimesUs {
    /// The grid's start, once a ray.
    pub grid_start: f64,
    /// The grid's work, a voxel.
    pub grid_voxel: f64,
    /// The slabs' start.
    pub slabs_start: f64,
    /// The slabs' work, a polygon.
    pub slabs_polygon: f64,
    /// The intersection's start.
    pub intersection_start: f64,
    /// The intersection's work, a polygon.
    pub intersection_polygon: f64,
}

/// A machine in cycles.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// The array.
    pub spec: MachineSpec,
    /// What the kernels cost.
    pub times: KernelTimes,
    /// What instructions cost, if the machine file says.
    pub instructions: Option<InstructionCycles>,
    /// What had to be rounded, one sentence each.
    pub notes: Vec<String>,
}

/// No link may be slower, in cycles a word, so that no clock leaves 64 bits.
const LONGEST_WORD_CYCLES: f64 = 1e6;

/// No kernel time may be longer, so that no sum of cycles leaves 64 bits.
const LONGEST_TIME_CYCLES: u64 = 1_000_000_000;

impl MachineFile {
    /// The text of the standard machine file.
    pub const STANDARD_TEXT: &str = include_str!("../../pcs-programs/pcs.ron");

    /// PCS, as the paper and the standard machine file have it.
    pub fn standard() -> Result<MachineFile, InputError> {
        MachineFile::parse(Path::new("pcs.ron"), Self::STANDARD_TEXT)
    }

    /// Reads the file of a machine, which must be a possible one.
    pub fn read(path: &Path) -> Result<MachineFile, InputError> {
        MachineFile::parse(path, &fields::read_text(path)?)
    }

    /// Reads the text of a machine file; `path` is for the errors.
    pub fn parse(path: &Path, text: &str) -> Result<MachineFile, InputError> {
        let file: MachineFile = fields::parse(path, text)?;
        file.convert().map_err(|fault| fault.in_text(path, text))?;
        Ok(file)
    }

    /// The machine in cycles, or why it is impossible.
    pub fn build(&self) -> Result<Machine, InputError> {
        self.convert().map_err(Fault::in_flags)
    }

    fn convert(&self) -> Result<Machine, Fault> {
        self.check()?;
        let spec = MachineSpec {
            clock_ns: self.clock_ns,
            word_bytes: self.word_bytes,
            fifo_words: Words(self.fifo_words),
            link_mb_s: self.link_mb_s,
            rate_counts: self.rate_counts,
            latency: Cycles(self.latency_cycles),
            memory_words: self.memory_words.map(Words),
        };
        let mut notes = Vec::new();
        if spec.rounds_link_rate() {
            notes.push(format!(
                "{} Mbyte/s are {:.3} cycles a word; rounded up to {}",
                self.link_mb_s,
                spec.exact_cycles_per_word(),
                spec.link_rate().cycles_per_word,
            ));
        }
        if spec.exact_cycles_per_word() > LONGEST_WORD_CYCLES {
            return Err(impossible("link_mb_s", self.link_mb_s, "at least a word in a million cycles"));
        }
        let times = self.times(&spec, &mut notes)?;
        Ok(Machine { spec, times, instructions: self.instruction_cycles, notes })
    }

    fn check(&self) -> Result<(), Fault> {
        let positive = |name: &'static str, value: f64, most: f64| {
            let possible = value.is_finite() && value > 0.0 && value <= most;
            if possible { Ok(()) } else { Err(impossible(name, value, format!("above 0 and at most {most}"))) }
        };
        let within = |name: &'static str, value: u64, most: u64| {
            let possible = (1..=most).contains(&value);
            if possible { Ok(()) } else { Err(impossible(name, value, format!("from 1 to {most}"))) }
        };
        positive("clock_ns", self.clock_ns, 1e9)?;
        positive("link_mb_s", self.link_mb_s, 1e9)?;
        for class in Class::ALL {
            if let Some(cycles) = self.instruction_cycles {
                within(class.name(), cycles.of(class) as u64, InstructionCycles::MOST as u64)?;
            }
        }
        within("word_bytes", self.word_bytes as u64, 1024)?;
        within("fifo_words", self.fifo_words, MachineSpec::MAX_FIFO_WORDS)?;
        within("latency_cycles", self.latency_cycles, 1_000_000)?;
        self.memory_words.map_or(Ok(()), |words| within("memory_words", words, u64::MAX))
    }

    fn times(&self, spec: &MachineSpec, notes: &mut Vec<String>) -> Result<KernelTimes, Fault> {
        let us = &self.times_us;
        let mut convert = |name: &'static str, us: f64| {
            if !(us.is_finite() && us >= 0.0) {
                return Err(impossible(name, us, "0 or more"));
            }
            let (cycles, rounded) = spec.cycles_of_us(us);
            if cycles.0 > LONGEST_TIME_CYCLES {
                return Err(impossible(name, us, format!("at most {LONGEST_TIME_CYCLES} cycles long")));
            }
            if rounded {
                notes.push(format!("{name}: {us} µs are no whole number of cycles; rounded up to {cycles}"));
            }
            Ok(cycles)
        };
        Ok(KernelTimes {
            grid: Times { start: convert("grid_start", us.grid_start)?, each: convert("grid_voxel", us.grid_voxel)? },
            slabs: Times {
                start: convert("slabs_start", us.slabs_start)?,
                each: convert("slabs_polygon", us.slabs_polygon)?,
            },
            intersection: Times {
                start: convert("intersection_start", us.intersection_start)?,
                each: convert("intersection_polygon", us.intersection_polygon)?,
            },
            host: HostTimes {
                ray: convert("host_ray_us", self.host_ray_us)?,
                hit: convert("host_hit_us", self.host_hit_us)?,
            },
        })
    }
}

fn impossible(name: &'static str, value: impl std::fmt::Display, range: impl std::fmt::Display) -> Fault {
    Fault::new(name, format!("impossible machine: {name} is {value}, it must be {range}"))
}

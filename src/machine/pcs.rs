//! The machine file: the array's parameters and Figure 7's times.

use std::collections::BTreeMap;
use std::path::Path;

use super::file::{base_of, impossible, machine_parameters, within};
use super::{Cycles, FifoName, HostTimes, KernelTimes, MachineSpec, RateCounts, Words};
use crate::error::InputError;
use crate::input::fields::{self, Fault};
use crate::isa::{Class, InstructionCycles};

machine_parameters! {
    /// A machine as a file describes it, in the units that people use.
    pub struct MachineFile;
    /// Figure 7, in µs.
    pub struct TimesUs;
    /// Changes to a machine file.
    pub struct MachineOptions;
    values {
        /// Length of a cycle, in ns.
        clock_ns: f64, "NS", Number, "length of a cycle (ns)";
        /// Size of a word, in bytes.
        word_bytes: u32, "N", Whole, "size of a word (bytes)";
        /// Words that each of a cell's two input FIFOs holds.
        fifo_words: u64, "N", Whole, "depth of each FIFO (words)";
        /// Rate of a link, in 10^6 bytes a second.
        link_mb_s: f64, "RATE", Number, "rate of a link (Mbyte/s)";
        /// Whether the rate counts both channels of a link together or each by itself: link or channel.
        rate_counts: RateCounts, "WHAT", Text, "what the rate of a link counts";
        /// Cycles from the write of a word until it can be read.
        latency_cycles: u64, "N", Whole, "latency of a link (cycles)";
    }
    optional {
        /// Words of memory of a cell.
        memory_words: u64, "N", Whole, "memory of a cell (words)";
        /// Words that each FIFO of the X channel holds.
        x_fifo_words: u64, "N", Whole, "depth of each FIFO of X (words)";
        /// Words that each FIFO of the Y channel holds.
        y_fifo_words: u64, "N", Whole, "depth of each FIFO of Y (words)";
        /// Words that each FIFO of the Z channel holds.
        z_fifo_words: u64, "N", Whole, "depth of each FIFO of Z (words)";
        /// What a cell, or the host, spends on each message that it sends or takes, in µs.
        message_us: f64, "US", Number, "sending or taking a message (µs)";
        /// What the host spends on a sample of the picture to tell, by rectangles, whether it can hit anything, in µs.
        host_filter_us: f64, "US", Number, "host's time for testing a sample (µs)";
        /// What the host spends on telling whether a ray meets a sub-volume, in µs.
        host_mask_us: f64, "US", Number, "host's time for testing a sub-volume (µs)";
    }
    host {
        /// What the host spends on each ray before it sends it, in µs.
        host_ray_us: "host's time for sending a ray (µs)";
        /// What the host spends on shading a hit, in µs.
        host_hit_us: "host's time for shading a hit (µs)";
    }
    times_us {
        /// Figure 7: the grid's start, in µs a ray.
        grid_start: "grid: start of a ray (µs)";
        /// Figure 7: the grid's work, in µs a voxel.
        grid_voxel: "grid: step to a voxel (µs)";
        /// Figure 7: the slabs' start, in µs a ray.
        slabs_start: "slabs: start of a ray (µs)";
        /// Figure 7: the slabs' work, in µs a polygon.
        slabs_polygon: "slabs: test of a polygon (µs)";
        /// Figure 7: the intersection's start, in µs a ray.
        intersection_start: "intersection: start of a ray (µs)";
        /// Figure 7: the intersection's work, in µs a polygon.
        intersection_polygon: "intersection: test of a polygon (µs)";
    }
    beside {
        /// Words that single FIFOs hold, by their names (`X0`, `Y3`, `Yhost`, `Z1`), whatever all the others do.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        fifo_words_of: BTreeMap<FifoName, u64>;
        /// What instructions cost, for cells that run programs; `None` for a machine that is only told Figure 7.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        instruction_cycles: Option<InstructionCycles>;
    }
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

/// No kernel time may be longer, so that no sum of cycles leaves 64 bits.
const LONGEST_TIME_CYCLES: u64 = 1_000_000_000;

impl Machine {
    /// What instructions cost, which a machine file need not say.
    pub fn instruction_cycles(&self) -> Result<InstructionCycles, InputError> {
        self.instructions.ok_or_else(|| {
            let error =
                InputError::new("the machine file does not say what instructions cost: instruction_cycles is missing");
            error.help("`pcs-sim calibrate --machine FILE` adds it")
        })
    }
}

impl MachineFile {
    /// The text of the standard machine file.
    pub const STANDARD_TEXT: &str = include_str!("../../pcs-programs/pcs.ron");

    /// PCS, as the paper and the standard machine file have it.
    pub fn standard() -> Result<MachineFile, InputError> {
        fields::parse(Path::new("pcs.ron"), Self::STANDARD_TEXT)
    }

    /// The nodes of an iPSC/2 as a row of cells.
    pub fn ipsc2_line() -> Result<MachineFile, InputError> {
        fields::parse(Path::new("ipsc2-line.ron"), include_str!("../../pcs-programs/ipsc2-line.ron"))
    }

    /// The text of such a file.
    ///
    /// Fails if it cannot be written, which no machine that can be built does.
    pub fn to_ron(&self) -> ron::Result<String> {
        let text = ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::new())?;
        Ok(text + "\n")
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
            channel_words: [self.x_fifo_words, self.y_fifo_words, self.z_fifo_words].map(|words| words.map(Words)),
            own_words: self.fifo_words_of.iter().map(|(&fifo, &words)| (fifo, Words(words))).collect(),
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
        if spec.exact_cycles_per_word() > MachineSpec::MAX_WORD_CYCLES as f64 {
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
        positive("clock_ns", self.clock_ns, 1e9)?;
        positive("link_mb_s", self.link_mb_s, 1e9)?;
        if let Some(cycles) = self.instruction_cycles {
            for class in Class::ALL {
                within(class.name(), cycles.of(class) as u64, 1..=InstructionCycles::MOST as u64)?;
            }
            within("float_latency", cycles.float_latency.unwrap_or(0).into(), 0..=InstructionCycles::MOST as u64)?;
        }
        within("word_bytes", self.word_bytes as u64, 1..=1024)?;
        within("fifo_words", self.fifo_words, 1..=MachineSpec::MAX_FIFO_WORDS)?;
        within("latency_cycles", self.latency_cycles, 1..=MachineSpec::MAX_LATENCY_CYCLES)?;
        let maybe_within = |name, value: Option<u64>, most| value.map_or(Ok(()), |value| within(name, value, 1..=most));
        maybe_within("x_fifo_words", self.x_fifo_words, MachineSpec::MAX_FIFO_WORDS)?;
        maybe_within("y_fifo_words", self.y_fifo_words, MachineSpec::MAX_FIFO_WORDS)?;
        maybe_within("z_fifo_words", self.z_fifo_words, MachineSpec::MAX_FIFO_WORDS)?;
        for (fifo, &words) in &self.fifo_words_of {
            if !(1..=MachineSpec::MAX_FIFO_WORDS).contains(&words) {
                let range = format!("from 1 to {}", MachineSpec::MAX_FIFO_WORDS);
                return Err(impossible("fifo_words_of", format!("{words} for {fifo}"), range));
            }
        }
        maybe_within("memory_words", self.memory_words, u64::MAX)
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
        let kernels = us.kernels(&mut convert)?;
        let host = HostTimes {
            ray: convert("host_ray_us", self.host_ray_us)?,
            hit: convert("host_hit_us", self.host_hit_us)?,
            filter: convert("host_filter_us", self.host_filter_us.unwrap_or(0.0))?,
            mask: convert("host_mask_us", self.host_mask_us.unwrap_or(0.0))?,
        };
        let message = self.message_us.map(|us| convert("message_us", us)).transpose()?;
        // Messages that take nothing are none that are taken and sent as a whole.
        let message = message.filter(|&cycles| cycles > Cycles(0));
        Ok(KernelTimes { host, message, ..kernels })
    }
}

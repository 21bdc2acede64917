//! CAPITAN, the machine of the second kind: processors on two ring buses (J. Argence's thesis, 1988, chapter 5 and annex B).
//! Its file, and what it comes to in nanoseconds, which are the cycles of its clock.

use std::path::Path;

use super::events::Buses;
use super::file::{TimeUnit, base_of, impossible, machine_parameters, rounded, time, within};
use super::{Cycles, HostTimes, KernelTimes};
use crate::error::InputError;
use crate::input::fields::{self, Fault};
use crate::measure::Clock;

machine_parameters! {
    /// A machine as a file describes it, in the units that people use.
    pub struct CapitanFile;
    /// What a processor takes for the work on a scene of polygons, in µs.
    pub struct ProcessorTimesUs;
    /// Changes to the file of such a machine.
    pub struct CapitanOptions;
    values {
        /// Processors, one of which is the master's.
        processors: u32, "N", Whole, "processors";
        /// Memory of a processor, in 1024 bytes.
        memory_kbyte: u64, "N", Whole, "memory of a processor (kbyte)";
        /// Buses, which all processors share.
        buses: u32, "N", Whole, "buses";
        /// Rate of a bus, in 10^6 bytes a second.
        bus_mb_s: f64, "RATE", Number, "rate of a bus (Mbyte/s)";
        /// Bytes of a message beside what is in it.
        header_bytes: u32, "N", Whole, "header of a message (bytes)";
        /// What is spent once, whatever the number of tasks, in ms: reading, counting, each worker's own set-up.
        fixed_ms: f64, "MS", Number, "spent once (ms)";
        /// What it takes to copy the scene to one processor, beside the bus, in ms.
        per_cap_ms: f64, "MS", Number, "copy of the scene to one processor (ms)";
        /// What a task spends on sending a message between master and worker, in ms.
        message_ms: f64, "MS", Number, "sending a message (ms)";
        /// What a worker spends on setting up a work item, in ms.
        segment_ms: f64, "MS", Number, "set-up of a work item (ms)";
        /// What a worker spends on a pixel of the made-up scene on average, in ms.
        pixel_ms: f64, "MS", Number, "pixel of the made-up scene (ms)";
        /// What the station spends on taking and filing the colour of a pixel, in ms.
        color_ms: f64, "MS", Number, "taking a colour (ms)";
    }
    optional {}
    host {}
    times_us {
        /// The grid's start, in µs a ray.
        grid_start: "grid: start of a ray (µs)";
        /// The grid's work, in µs a voxel.
        grid_voxel: "grid: step to a voxel (µs)";
        /// The slabs' start, in µs a ray.
        slabs_start: "slabs: start of a ray (µs)";
        /// The slabs' work, in µs a polygon.
        slabs_polygon: "slabs: test of a polygon (µs)";
        /// The intersection's start, in µs a ray.
        intersection_start: "intersection: start of a ray (µs)";
        /// The intersection's work, in µs a polygon.
        intersection_polygon: "intersection: test of a polygon (µs)";
        /// What shading a hit takes, in µs.
        shade_hit: "shading a hit (µs)";
    }
    beside {}
}

/// A machine in nanoseconds, which are the cycles of its clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Capitan {
    /// Processors, one of which is the master's.
    pub processors: usize,
    /// Memory of a processor, in bytes.
    pub memory_bytes: u64,
    /// The buses.
    pub buses: Buses,
    /// Bytes of a message beside what is in it.
    pub header_bytes: u64,
    /// What tasks spend.
    pub costs: TaskCosts,
    /// What the work on a scene of polygons takes. The host's time for a hit is what a worker takes to shade it.
    pub times: KernelTimes,
    /// What had to be rounded, one sentence each.
    pub notes: Vec<String>,
}

/// What the tasks of a farm spend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaskCosts {
    /// Once, whatever the number of tasks.
    pub fixed: Cycles,
    /// On a copy of the scene for one processor.
    pub per_cap: Cycles,
    /// On sending a message between master and worker.
    pub message: Cycles,
    /// On setting up a work item.
    pub segment: Cycles,
    /// On a pixel of the made-up scene, on average.
    pub pixel: Cycles,
    /// On taking and filing the colour of a pixel.
    pub color: Cycles,
}

/// Milliseconds in ns.
const MS: TimeUnit = TimeUnit { name: "ms", ticks: 1e6, tick: "ns" };
/// Microseconds in ns.
const US: TimeUnit = TimeUnit { name: "µs", ticks: 1e3, tick: "ns" };

/// No time may be longer, in ns, but for the two that are spent but once or once a task: no sum of them leaves 64 bits unseen.
const LONGEST: u64 = 1_000_000_000;
/// The longest of those.
const LONGEST_ONCE: u64 = 1_000_000_000_000_000;

impl CapitanFile {
    /// The text of the standard file.
    pub const STANDARD_TEXT: &str = include_str!("../../pcs-programs/capitan.ron");

    /// CAPITAN, as the thesis has it and as it was fitted.
    pub fn standard() -> Result<CapitanFile, InputError> {
        fields::parse(Path::new("capitan.ron"), Self::STANDARD_TEXT)
    }

    /// The machine in nanoseconds, or why it is impossible.
    pub fn build(&self) -> Result<Capitan, InputError> {
        self.convert().map_err(Fault::in_flags)
    }

    fn convert(&self) -> Result<Capitan, Fault> {
        within("processors", self.processors.into(), 2..=MOST_PROCESSORS)?;
        within("memory_kbyte", self.memory_kbyte, 1..=1 << 40)?;
        within("buses", self.buses.into(), 1..=64)?;
        within("header_bytes", self.header_bytes.into(), 0..=1 << 20)?;
        let mut notes = Vec::new();
        let times = self.times(&mut notes)?;
        let buses = Buses::new(self.buses as usize, self.byte_ps(&mut notes)?);
        Ok(Capitan {
            processors: self.processors as usize,
            memory_bytes: self.memory_kbyte * 1024,
            buses,
            header_bytes: self.header_bytes.into(),
            costs: self.costs(&mut notes)?,
            times,
            notes,
        })
    }

    /// What a byte takes on a bus, in ps.
    fn byte_ps(&self, notes: &mut Vec<String>) -> Result<u64, Fault> {
        let rate = self.bus_mb_s;
        if !(rate.is_finite() && (1e-3..=1e6).contains(&rate)) {
            return Err(impossible("bus_mb_s", rate, "from 0.001 to 1000000"));
        }
        let (ps, is_rounded) = rounded(1e6 / rate);
        if is_rounded {
            notes.push(format!("{rate} Mbyte/s are {:.3} ps a byte; rounded up to {ps}", 1e6 / rate));
        }
        Ok(ps)
    }

    fn costs(&self, notes: &mut Vec<String>) -> Result<TaskCosts, Fault> {
        let mut ns = |name, ms: f64, most| time(name, ms, (MS, most), notes);
        Ok(TaskCosts {
            fixed: ns("fixed_ms", self.fixed_ms, LONGEST_ONCE)?,
            per_cap: ns("per_cap_ms", self.per_cap_ms, LONGEST_ONCE)?,
            message: ns("message_ms", self.message_ms, LONGEST)?,
            segment: ns("segment_ms", self.segment_ms, LONGEST)?,
            pixel: ns("pixel_ms", self.pixel_ms, LONGEST)?,
            color: ns("color_ms", self.color_ms, LONGEST)?,
        })
    }

    fn times(&self, notes: &mut Vec<String>) -> Result<KernelTimes, Fault> {
        let us = &self.times_us;
        let mut ns = |name, us: f64| time(name, us, (US, LONGEST), notes);
        let kernels = us.kernels(&mut ns)?;
        Ok(KernelTimes { host: HostTimes { hit: ns("shade_hit", us.shade_hit)?, ..HostTimes::default() }, ..kernels })
    }
}

impl Capitan {
    /// The clock, whose cycles are nanoseconds.
    pub const CLOCK: Clock = Clock { cycle_ns: 1.0 };
}

/// More would be another kind of machine.
const MOST_PROCESSORS: u64 = 4096;

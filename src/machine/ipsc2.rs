//! The iPSC/2, the machine of the third kind: a hypercube of nodes with processor and memory, a host at node 0 (RR-0992, §4.1). Its file,
//! and what it comes to in cycles.

use std::path::Path;

use super::events::{Cube, WireTimes};
use super::file::{TimeUnit, base_of, impossible, machine_parameters, rounded, time, within};
use super::{Cycles, HostTimes, KernelTimes};
use crate::error::InputError;
use crate::input::fields::{self, Fault};
use crate::measure::Clock;

machine_parameters! {
    /// A machine as a file describes it, in the units that people use.
    pub struct Ipsc2File;
    /// What a node takes for the work on a scene of polygons, in µs.
    pub struct NodeTimesUs;
    /// Changes to the file of such a machine.
    pub struct Ipsc2Options;
    values {
        /// Nodes, each with a processor and its memory.
        nodes: u32, "N", Whole, "nodes";
        /// Length of a cycle, in ns.
        clock_ns: f64, "NS", Number, "length of a cycle (ns)";
        /// Memory of a node, in 1024 bytes.
        node_kbyte: u64, "N", Whole, "memory of a node (kbyte)";
        /// What the program takes of it, in 1024 bytes.
        program_kbyte: u64, "N", Whole, "program of a node (kbyte)";
        /// The most bytes of a short message.
        short_bytes: u64, "N", Whole, "most bytes of a short message";
        /// What a short message without bytes takes from one program to the next node's, in µs.
        short_us: f64, "US", Number, "short message (µs)";
        /// What of that it is under way, in µs: of the rest each of the two processors has half.
        short_wire_us: f64, "US", Number, "short message under way (µs)";
        /// The same of a long message, in µs.
        long_us: f64, "US", Number, "long message (µs)";
        /// What of that it is under way, in µs.
        long_wire_us: f64, "US", Number, "long message under way (µs)";
        /// What each further link of a message's way takes, in µs.
        hop_us: f64, "US", Number, "further link of a message's way (µs)";
        /// What a byte of a message takes, in µs.
        byte_us: f64, "US", Number, "byte of a message (µs)";
        /// What a node spends on beginning a pixel, in µs.
        pixel_us: f64, "US", Number, "beginning a pixel (µs)";
        /// What a node spends on a result that another has sent it, in µs.
        result_us: f64, "US", Number, "taking a result (µs)";
        /// What a node spends on each reference to a polygon in its voxels' lists when it makes them, in µs.
        fill_us: f64, "US", Number, "making a list: a reference (µs)";
        /// What an access to a page of the shared memory takes that is not at home on the node, in µs.
        lookup_us: f64, "US", Number, "access to another's page (µs)";
        /// What a node is interrupted for by another that wants a page of it, in µs.
        serve_us: f64, "US", Number, "serving a page (µs)";
    }
    optional {}
    host {}
    times_us {
        /// The grid's start, in µs a ray and region.
        grid_start: "grid: start of a ray (µs)";
        /// The grid's work, in µs a voxel.
        grid_voxel: "grid: step to a voxel (µs)";
        /// The slabs' start, in µs a ray and region.
        slabs_start: "slabs: start of a ray (µs)";
        /// The slabs' work, in µs a polygon.
        slabs_polygon: "slabs: test of a polygon (µs)";
        /// The intersection's start, in µs a ray and region.
        intersection_start: "intersection: start of a ray (µs)";
        /// The intersection's work, in µs a polygon.
        intersection_polygon: "intersection: test of a polygon (µs)";
        /// What shading a hit takes, in µs.
        shade_hit: "shading a hit (µs)";
    }
    beside {}
}

/// A machine in cycles.
#[derive(Clone, Debug, PartialEq)]
pub struct Ipsc2 {
    /// Nodes.
    pub nodes: usize,
    /// Length of a cycle.
    pub clock: Clock,
    /// What a node's memory has beside the program, in bytes.
    pub memory_bytes: u64,
    /// What the way of a message takes.
    pub wires: WireTimes,
    /// What either processor spends on a message.
    pub messages: MessageTimes,
    /// What else a node spends time on.
    pub costs: NodeCosts,
    /// What the work on a scene of polygons takes. The host's time for a hit is what a node takes to shade it.
    pub times: KernelTimes,
    /// What had to be rounded, one sentence each.
    pub notes: Vec<String>,
}

/// What the processor of either end spends on a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageTimes {
    /// The most bytes of a short message.
    pub short_bytes: u64,
    /// On a short one.
    pub short: Cycles,
    /// On a long one.
    pub long: Cycles,
}

/// What a node spends on what is no kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeCosts {
    /// On beginning a pixel.
    pub pixel: Cycles,
    /// On a result that another has sent it.
    pub result: Cycles,
    /// On a reference when it makes its voxels' lists.
    pub fill: Cycles,
    /// On an access to another's page.
    pub lookup: Cycles,
    /// On serving a page.
    pub serve: Cycles,
}

/// No time may be longer, in cycles, so that no sum of them leaves 64 bits unseen.
const LONGEST: u64 = 1_000_000_000;

/// More nodes would be another kind of machine.
const MOST_NODES: u64 = 128;

impl Ipsc2File {
    /// The text of the standard file.
    pub const STANDARD_TEXT: &str = include_str!("../../pcs-programs/ipsc2.ron");

    /// The iPSC/2, as far as it is known and as it was fitted.
    pub fn standard() -> Result<Ipsc2File, InputError> {
        fields::parse(Path::new("ipsc2.ron"), Self::STANDARD_TEXT)
    }

    /// The text of a machine file with this machine's fitted times in place of its own, all else as it stands there.
    ///
    /// Fails if the file does not name each of them.
    pub fn retold(&self, path: &Path, text: &str) -> Result<String, InputError> {
        let us = &self.times_us;
        let fitted = [
            ("lookup_us", self.lookup_us),
            ("grid_start", us.grid_start),
            ("grid_voxel", us.grid_voxel),
            ("slabs_start", us.slabs_start),
            ("slabs_polygon", us.slabs_polygon),
            ("intersection_start", us.intersection_start),
            ("intersection_polygon", us.intersection_polygon),
            ("shade_hit", us.shade_hit),
        ];
        let line = |line: &str| {
            let body = line.trim_start();
            let found =
                fitted.iter().find(|(name, _)| body.strip_prefix(name).is_some_and(|rest| rest.starts_with(':')));
            let indent = &line[..line.len() - body.len()];
            found.map_or_else(|| format!("{line}\n"), |(name, value)| format!("{indent}{name}: {value:?},\n"))
        };
        let new: String = text.lines().map(line).collect();
        match Ipsc2File::parse(path, &new) {
            Ok(file) if file == *self => Ok(new),
            _ => {
                let error = InputError::in_file(path, "the fitted times cannot be put into this file");
                Err(error.help("let it have lookup_us and each of times_us on a line of its own"))
            }
        }
    }

    /// The machine in cycles, or why it is impossible.
    pub fn build(&self) -> Result<Ipsc2, InputError> {
        self.convert().map_err(Fault::in_flags)
    }

    fn convert(&self) -> Result<Ipsc2, Fault> {
        within("nodes", self.nodes.into(), 1..=MOST_NODES)?;
        within("node_kbyte", self.node_kbyte, 1..=1 << 40)?;
        within("program_kbyte", self.program_kbyte, 0..=self.node_kbyte)?;
        within("short_bytes", self.short_bytes, 0..=1 << 20)?;
        if !(self.clock_ns.is_finite() && (0.001..=1e6).contains(&self.clock_ns)) {
            return Err(impossible("clock_ns", self.clock_ns, "from 0.001 to 1000000"));
        }
        let mut notes = Vec::new();
        let (messages, wires) = self.message_times(&mut notes)?;
        Ok(Ipsc2 {
            nodes: self.nodes as usize,
            clock: Clock { cycle_ns: self.clock_ns },
            memory_bytes: (self.node_kbyte - self.program_kbyte) * 1024,
            wires,
            messages,
            costs: self.costs(&mut notes)?,
            times: self.times(&mut notes)?,
            notes,
        })
    }

    /// Microseconds in cycles.
    fn us(&self) -> TimeUnit {
        TimeUnit { name: "µs", ticks: 1e3 / self.clock_ns, tick: "cycles" }
    }

    fn message_times(&self, notes: &mut Vec<String>) -> Result<(MessageTimes, WireTimes), Fault> {
        let mut cycles = |name, us| time(name, us, (self.us(), LONGEST), notes);
        let (short, short_wire) = (cycles("short_us", self.short_us)?, cycles("short_wire_us", self.short_wire_us)?);
        let (long, long_wire) = (cycles("long_us", self.long_us)?, cycles("long_wire_us", self.long_wire_us)?);
        let hop = cycles("hop_us", self.hop_us)?;
        let wires = [
            ("short_wire_us", short_wire <= short, self.short_wire_us, self.short_us),
            ("long_wire_us", long_wire <= long, self.long_wire_us, self.long_us),
        ];
        if let Some((name, _, wire, whole)) = wires.into_iter().find(|(_, fits, ..)| !fits) {
            return Err(impossible(name, wire, format!("from 0 to {whole}")));
        }
        let half = |whole: Cycles, wire: Cycles| Cycles((whole.0 - wire.0).div_ceil(2));
        let short_bytes = self.short_bytes;
        let (short, long) = (half(short, short_wire), half(long, long_wire));
        let wires = WireTimes {
            short_bytes,
            short: short_wire,
            long: long_wire,
            hop,
            byte_millicycles: self.byte_millicycles(notes)?,
        };
        Ok((MessageTimes { short_bytes, short, long }, wires))
    }

    fn byte_millicycles(&self, notes: &mut Vec<String>) -> Result<u64, Fault> {
        if !(self.byte_us.is_finite() && (0.0..=1e3).contains(&self.byte_us)) {
            return Err(impossible("byte_us", self.byte_us, "from 0 to 1000"));
        }
        let exact = self.byte_us * 1e6 / self.clock_ns;
        let (thousandths, is_rounded) = rounded(exact);
        if is_rounded {
            notes.push(format!("byte_us: {} µs are {exact:.3} thousandths of a cycle; rounded up", self.byte_us));
        }
        Ok(thousandths)
    }

    fn costs(&self, notes: &mut Vec<String>) -> Result<NodeCosts, Fault> {
        let mut cycles = |name, us| time(name, us, (self.us(), LONGEST), notes);
        Ok(NodeCosts {
            pixel: cycles("pixel_us", self.pixel_us)?,
            result: cycles("result_us", self.result_us)?,
            fill: cycles("fill_us", self.fill_us)?,
            lookup: cycles("lookup_us", self.lookup_us)?,
            serve: cycles("serve_us", self.serve_us)?,
        })
    }

    fn times(&self, notes: &mut Vec<String>) -> Result<KernelTimes, Fault> {
        let us = &self.times_us;
        let mut cycles = |name, us: f64| time(name, us, (self.us(), LONGEST), notes);
        let kernels = us.kernels(&mut cycles)?;
        Ok(KernelTimes {
            host: HostTimes { hit: cycles("shade_hit", us.shade_hit)?, ..HostTimes::default() },
            ..kernels
        })
    }
}

impl Ipsc2 {
    /// The nodes' network.
    pub fn cube(&self) -> Cube {
        Cube::new(self.nodes, self.wires)
    }
}

impl MessageTimes {
    /// What either processor spends on a message of so many bytes.
    #[inline]
    pub fn of(&self, bytes: u64) -> Cycles {
        if bytes > self.short_bytes { self.long } else { self.short }
    }
}

//! What an array has to do: an array program on a scene that is laid out for it.

use std::sync::Arc;

use crate::error::InputError;
use crate::geometry::{Bounds, Grid, Polygons, Ray, slabs};
use crate::isa::Executable;
use crate::machine::{FifoName, HostTimes, KernelTimes, MachineSpec};
use crate::measure::Actor;
use crate::quantities::Words;
use crate::scene::Camera;
use crate::seam::{Channel, Costs, OpBatch, OpKind, OpStream, Unit};

use super::array_program::{ArrayProgram, Kernel, Stages};
use super::cells::{CellOptions, CellPrograms, InstructionStep, ProgramTracer};
use super::layout::Layout;
use super::masks::Screening;
use super::messages::{HIT_WORDS, Messaging, OWN_WORDS, RAY_WORDS};
use super::stop_words::StopWords;
use super::work;

/// A scene laid out, with what an array program's cells do with it.
#[derive(Clone, Debug)]
pub struct Workload {
    pub(super) layout: Arc<Layout>,
    pub(super) stages: Stages,
    pub(super) times: KernelTimes,
    /// What units of work cost on the machine that it was laid out for.
    pub(super) costs: Costs,
    pub(super) stop_words: Option<StopWords>,
    /// What it was laid out for.
    pub(super) program: ArrayProgram,
    /// The cells' programs, if they run any instead of Figure 7's times.
    pub(super) programs: Option<CellPrograms>,
    /// What tells the host which sub-volumes rays can meet, if it tells them.
    pub(super) screening: Option<Screening>,
    /// Whether rays name the polygon that they start on and do not hit.
    pub(super) names_own: bool,
    /// If the host tests samples before it sends their rays, how many for each ray of a run, its own the last of them.
    pub(super) tested: Option<Arc<Vec<u32>>>,
}

/// What a cell's memory holds, in words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellMemory {
    /// Voxel table and index lists (equation 4).
    pub grid: Words,
    /// Slabs (equation 6).
    pub slabs: Words,
    /// Planes and vertices.
    pub polygons: Words,
    /// What a cell that runs a program needs beside: the program, its own data, planes between voxels, addresses of records.
    pub program: Words,
    /// Rays that have been passed on and wait for their turn.
    pub rays: Words,
}

/// What of the messages begins and ends with a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shares {
    /// So many rays a cell reads before it begins it.
    pub read: u64,
    /// So many hits it sends when it has done it.
    pub answered: u64,
}

impl Shares {
    /// One of each.
    pub const OWN: Shares = Shares { read: 1, answered: 1 };
}

impl CellMemory {
    /// All of it.
    pub fn total(&self) -> Words {
        self.grid + self.slabs + self.polygons + self.program + self.rays
    }
}

impl Workload {
    /// What the cells of an array program do with a scene that was laid out for it.
    pub fn of(layout: Arc<Layout>, program: &ArrayProgram, times: KernelTimes) -> Workload {
        Workload {
            layout,
            stages: program.placement(),
            times,
            costs: work::costs(&work::vocabulary(false), &times, None),
            stop_words: program.stop_words.map(|ahead| StopWords { ahead, last: program.stages.len() - 1 }),
            program: program.clone(),
            programs: None,
            screening: Screening::new(program.masks),
            names_own: false,
            tested: None,
        }
        .priced()
    }

    /// The same for rays from a camera's eye: masks by rectangles are those that it sees. Without a camera they let all rays meet all
    /// sub-volumes.
    pub fn seen_by(self, camera: &Camera) -> Workload {
        let grids = self.layout.groups.iter().map(|group| &group.grid);
        let polygons = self.layout.surfaces.polygons();
        let screening = self.screening.map(|screening| screening.seen_by(camera, polygons, grids));
        Workload { screening, ..self }
    }

    /// The same for a host that tests samples before it sends their rays: so many for each ray of a run, its own the last of them. For
    /// an image, whose host finds that out by itself, none.
    pub fn with_samples_tested(self, tested: Arc<Vec<u32>>) -> Workload {
        Workload { tested: Some(tested), ..self }.priced()
    }

    /// The same for some of the rays of the run, those in these places.
    pub fn of_some(&self, places: &[usize]) -> Workload {
        let tested =
            |all: &Arc<Vec<u32>>| Arc::new(places.iter().filter_map(|&place| all.get(place).copied()).collect());
        Workload { tested: self.tested.as_ref().map(tested), ..self.clone() }
    }

    /// The same whose rays name, in a word more, the polygon that they start on and do not hit.
    pub fn naming_own(self) -> Workload {
        Workload { names_own: true, ..self }
    }

    /// The same with the prices of what is done.
    fn priced(self) -> Workload {
        let instructions = self.programs.as_ref().map(|programs| programs.options.cycles);
        let beside = [
            (self.tested.is_some(), work::HOST_FILTER),
            (self.screening.is_some(), work::HOST_MASK),
            (self.messaging().takes_time, work::MESSAGE),
            (instructions.is_some_and(|cycles| cycles.counts_waits()), work::FLOAT_WAIT),
        ];
        let more: Vec<Unit> = beside.into_iter().filter(|(is_done, _)| *is_done).map(|(_, unit)| unit).collect();
        let vocabulary = work::vocabulary_with(instructions.is_some(), &more);
        Workload { costs: work::costs(&vocabulary, &self.times, instructions.as_ref()), ..self }
    }

    /// What messages take.
    pub(super) fn messaging(&self) -> Messaging {
        Messaging { takes_time: self.times.message.is_some() }
    }

    /// Which messages begin and end with ray number `id` of `count` that are sent one after the other.
    pub(super) fn shares(&self, id: u32, count: usize) -> Shares {
        let (id, count) = (u64::from(id), count as u64);
        let bundle = u64::from(self.program.rays_per_message);
        let ahead = u64::from(self.program.forward_ahead);
        if bundle > 1 {
            let (place, left) = (id % bundle, count - id);
            return Shares {
                read: if place == 0 { bundle.min(left) } else { 0 },
                answered: if place + 1 == bundle || left == 1 { place + 1 } else { 0 },
            };
        }
        let known_before = if id == 0 { 0 } else { id + ahead };
        Shares { read: (id + 1 + ahead).min(count).saturating_sub(known_before), answered: 1 }
    }

    /// Words of a RAY.
    pub(super) fn ray_words(&self) -> u64 {
        let own = if self.names_own { OWN_WORDS } else { 0 };
        RAY_WORDS + own + self.program.masks.words(self.groups())
    }

    /// Against how many sub-volumes the host tests a ray, to tell it which it can meet.
    pub fn mask_tests(&self, ray: &Ray) -> u64 {
        self.screening.as_ref().map_or(0, |screening| screening.tests(ray, self.groups()))
    }

    /// Whether a ray can meet a group's sub-volume, as far as it is told.
    pub(super) fn admits(&self, ray: &Ray, group: usize) -> bool {
        let of = (group, &self.layout.groups[group].grid);
        self.screening.as_ref().is_none_or(|screening| screening.admits(ray, self.polygons(), of))
    }

    /// Ends the host's line with ray number `id`: the host's work on it, then the words of so many rays, of which it is the last.
    pub fn send_ray(&self, host: &mut OpStream, id: u32, mask_tests: u64, rays: u64) {
        if let Some(&tested) = self.tested.as_ref().and_then(|tested| tested.get(id as usize)) {
            host.push(OpKind::Work(work::HOST_FILTER), tested.into());
        }
        host.push(OpKind::Work(work::HOST_RAY), 1);
        if mask_tests > 0 {
            host.push(OpKind::Work(work::HOST_MASK), mask_tests);
        }
        if rays > 0 {
            self.messaging().send(host, OpKind::WriteX, rays * self.ray_words());
        }
        host.end_line(id);
    }

    /// Lets the cells run programs instead of taking Figure 7's times: assembles them and loads every cell's memory.
    ///
    /// Fails if a program has a mistake, or wants something of the loader that it does not have; or if the array program
    /// goes beyond the paper.
    pub fn with_programs(self, options: &CellOptions) -> Result<Workload, InputError> {
        let beyond = [
            (self.stop_words.is_some(), "stop words"),
            (self.program.forward_ahead > 0, "rays forwarded ahead"),
            (self.program.rays_per_message > 1, "messages of several rays"),
            (self.messaging().takes_time, "what a message takes (message_us)"),
            (self.screening.is_some(), "masks"),
            (self.names_own, "polygons that rays start on"),
        ];
        if let Some((_, what)) = beyond.into_iter().find(|(is_asked, _)| *is_asked) {
            let error = InputError::new(format!("the cells' programs know nothing of {what}"));
            return Err(error.help("leave them out, or let the cells run timings"));
        }
        let programs = CellPrograms::new(&self.layout, &self.program, options)?;
        Ok(Workload { programs: Some(programs), ..self }.priced())
    }

    /// How the cells run programs, if they do.
    pub fn cell_options(&self) -> Option<&CellOptions> {
        self.programs.as_ref().map(|programs| &programs.options)
    }

    /// The program of a cell, if cells run programs.
    pub fn executable(&self, cell: usize) -> Option<&Executable> {
        self.programs.as_ref().filter(|_| cell < self.cells()).map(|programs| programs.executable(cell))
    }

    /// The instructions that a cell executes for ray number `id`, one after the other, as far as `most`. None at all if cells run no
    /// programs.
    pub fn instructions(&self, cell: usize, id: u32, ray: &Ray, most: usize) -> Vec<InstructionStep> {
        let tracer = self.programs.as_ref().map(|programs| ProgramTracer::new(programs, self.polygons().len()));
        tracer.map_or(Vec::new(), |mut tracer| tracer.steps(cell, id, ray, most))
    }

    /// What units of work cost on the machine that it was laid out for. The ops do not depend on it.
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// What the host spends.
    pub fn host_times(&self) -> HostTimes {
        self.times.host
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.groups() * self.stages.count()
    }

    /// Number of groups.
    pub fn groups(&self) -> usize {
        self.layout.groups.len()
    }

    /// The polygons.
    pub fn polygons(&self) -> &Polygons {
        self.layout.surfaces.polygons()
    }

    /// How many polygons the groups hold together: one that reaches into several sub-volumes is held in each.
    pub fn placed_polygons(&self) -> usize {
        self.layout.groups.iter().map(|group| group.members.len()).sum()
    }

    /// Each group's grid.
    pub fn grids(&self) -> impl ExactSizeIterator<Item = &Grid> {
        self.layout.groups.iter().map(|group| &group.grid)
    }

    /// Each group's part of the scene's box, and the polygons that reach into it.
    pub fn sub_volumes(&self) -> impl ExactSizeIterator<Item = (Bounds, &[u32])> {
        self.layout.groups.iter().map(|group| (group.volume, &group.members[..]))
    }

    /// The kernels that a cell runs.
    pub fn kernels_of(&self, cell: usize) -> &[Kernel] {
        &self.program.stages[cell % self.stages.count()]
    }

    /// What a cell's memory must hold.
    pub fn memory_of(&self, cell: usize) -> CellMemory {
        let group = &self.layout.groups[cell / self.stages.count()];
        let words = |kernel, words: u64| Words(if self.kernels_of(cell).contains(&kernel) { words } else { 0 });
        let mut memory = CellMemory {
            grid: words(Kernel::Grid, group.grid.memory_words()),
            slabs: words(Kernel::Slabs, slabs::WORDS * group.members.len() as u64),
            polygons: words(Kernel::Intersection, self.polygons().memory_words(&group.members)),
            program: Words(0),
            rays: Words(self.waiting_words()),
        };
        if let Some(programs) = &self.programs {
            memory.program = Words(programs.words(cell).0 - memory.total().0);
        }
        memory
    }

    /// Words of the rays that a cell has before their turn, and of the hits that wait for the last of their message.
    fn waiting_words(&self) -> u64 {
        let more = u64::from(self.program.rays_per_message) - 1;
        self.ray_words() * (u64::from(self.program.forward_ahead) + more) + HIT_WORDS * more
    }

    /// A batch without a ray: what the cells do before the first one.
    pub fn opening(&self) -> OpBatch {
        let mut batch = OpBatch::new(self.cells());
        if let Some(words) = self.stop_words {
            batch.cells.chunks_mut(self.stages.count()).for_each(|group| words.begin(group));
        }
        batch
    }

    /// Fails if the cells want rays before the hits of others have left the array, for a host that sends some only after.
    pub fn check_closed_loop(&self) -> Result<(), InputError> {
        let message = match (self.program.forward_ahead, self.program.rays_per_message) {
            (0, 1) => return Ok(()),
            (0, bundle) => format!(
                "a cell would begin a ray only when the {bundle} of its message have come, and the host of an image may send \
                 the others only after that ray's hit"
            ),
            (ahead, _) => format!(
                "a cell would begin a ray only when the next {ahead} have come, and the host of an image may send those \
                 only after that ray's hit"
            ),
        };
        let help = match self.program.forward_ahead {
            0 => "send one ray a message: more are for primary rays alone, which the host sends without waiting",
            _ => "forward no rays ahead: that is for primary rays alone, which the host sends without waiting",
        };
        Err(InputError::new(message).help(help))
    }

    /// Fails if a machine cannot run this: for want of memory in some cell, or of room for stop words. Whatever runs or
    /// replays a workload begins with it.
    pub fn check(&self, spec: &MachineSpec) -> Result<(), InputError> {
        self.check_memory(spec.memory_words)?;
        spec.check_fifos(self.cells())?;
        self.check_stop_words(spec)
    }

    /// What each FIFO of Z must hold at the least, for stop words to find room.
    pub fn least_z_words(&self) -> Words {
        Words(self.stop_words.map_or(1, |words| words.least_fifo_words()))
    }

    /// Fails if the FIFOs are too shallow for the stop words that are on their way at the end of a run.
    fn check_stop_words(&self, spec: &MachineSpec) -> Result<(), InputError> {
        let Some(StopWords { ahead, .. }) = self.stop_words else { return Ok(()) };
        // A group's last cell reads no stop words.
        let readers = (0..self.cells()).filter(|cell| (cell + 1) % self.stages.count() > 0).map(Actor::Station);
        let words = readers.map(|reader| spec.fifo_words_of(FifoName { channel: Channel::Z, reader })).min();
        let least = self.least_z_words().0;
        let Some(fifo_words) = words.filter(|words| words.0 < least) else { return Ok(()) };
        let message = format!("stop words {ahead} voxels ahead need FIFOs of {least} words, these hold {fifo_words}");
        Err(InputError::new(message).help("use deeper FIFOs, or fewer voxels ahead"))
    }

    /// Fails if some cell needs more memory than it has.
    fn check_memory(&self, memory: Option<Words>) -> Result<(), InputError> {
        let Some(memory) = memory else { return Ok(()) };
        let largest = (0..self.cells()).max_by_key(|&cell| (self.memory_of(cell).total(), std::cmp::Reverse(cell)));
        let Some((cell, need)) = largest.map(|cell| (cell, self.memory_of(cell))).filter(|l| l.1.total() > memory)
        else {
            return Ok(());
        };
        let message = format!(
            "the scene does not fit: cell {cell} needs {} (grid {}, slabs {}, planes and vertices {}, program {}, rays ahead {}) and has {memory}",
            need.total(),
            need.grid.0,
            need.slabs.0,
            need.polygons.0,
            need.program.0,
            need.rays.0,
        );
        Err(InputError::new(message).help("use more cells, a smaller grid coefficient, or more memory_words"))
    }
}

//! What the cells do for a ray when they run programs.

use crate::geometry::{Hit, Ray};
use crate::isa::{Fault, FaultKind, Processor, Queues, Register, Stop};
use crate::program::Counts;
use crate::program::messages::HIT_WORDS;
use crate::seam::{OpKind, OpStream};

use super::{CellPrograms, InstructionStep};

/// Runs the cells' programs on rays. Each thread has its own.
#[derive(Debug)]
pub struct ProgramTracer<'a> {
    cells: Vec<Processor<'a>>,
    /// For each cell, where each of its counters goes.
    events: Vec<Vec<Option<Event>>>,
    queues: Queues,
    polygons: usize,
}

/// An event that programs count.
#[derive(Clone, Copy, Debug)]
enum Event {
    Voxel,
    SlabTest,
    IntersectionTest,
}

impl Event {
    fn named(name: &str) -> Option<Event> {
        match name {
            "voxels" => Some(Event::Voxel),
            "slab_tests" => Some(Event::SlabTest),
            "intersection_tests" => Some(Event::IntersectionTest),
            _ => None,
        }
    }
}

impl<'a> ProgramTracer<'a> {
    /// Cells that have seen no ray yet, for a scene of so many polygons.
    pub fn new(programs: &'a CellPrograms, polygons: usize) -> ProgramTracer<'a> {
        let executable = |index: usize| &programs.executables[programs.cells[index].executable];
        let processor = |index: usize| {
            let cell = &programs.cells[index];
            Processor::new(executable(index), &cell.data, &cell.scene, programs.options.instruction_limit)
        };
        let events = |index| executable(index).counters().iter().map(|name| Event::named(name)).collect();
        let cells = 0..programs.cells.len();
        ProgramTracer {
            cells: cells.clone().map(processor).collect(),
            events: cells.map(events).collect(),
            queues: Queues::default(),
            polygons,
        }
    }

    /// Instructions that all cells have executed.
    pub fn executed(&self) -> u64 {
        self.cells.iter().map(Processor::executed).sum()
    }

    /// Sends ray number `id` through all cells: adds what each does to its ops, and returns what comes out of the last.
    pub fn trace(&mut self, id: u32, ray: &Ray, ops: &mut [OpStream], counts: &mut Counts) -> Result<Hit, Fault> {
        self.queues.restart(&ray_words(id, ray));
        for (index, ops) in ops.iter_mut().enumerate() {
            self.run(index, ops, counts).map_err(|fault| Fault { cell: index, message: id as u64, ..fault })?;
            self.queues.hand_on();
        }
        self.answer().map_err(|kind| {
            let last = self.cells.len() - 1;
            Fault { cell: last, message: id as u64, ..self.cells[last].fault(kind) }
        })
    }

    /// What a cell that has seen no ray yet executes for one, as far as `most` instructions: those of the cells before it are run
    /// through. Ends where a program fails.
    pub fn steps(&mut self, cell: usize, id: u32, ray: &Ray, most: usize) -> Vec<InstructionStep> {
        let (mut ops, mut counts) = (OpStream::default(), Counts::default());
        self.queues.restart(&ray_words(id, ray));
        for before in 0..cell {
            ops.clear();
            if self.run(before, &mut ops, &mut counts).is_err() {
                return Vec::new();
            }
            self.queues.hand_on();
        }
        let Some(processor) = self.cells.get_mut(cell) else { return Vec::new() };
        let mut steps = Vec::new();
        while steps.len() < most {
            ops.clear();
            let (address, before) = (processor.address(), registers(processor));
            let stop = processor.step(&mut self.queues, &mut ops);
            if matches!(stop, Err(_) | Ok(Some(Stop::Waiting(_)))) {
                break;
            }
            let changed = registers(processor).into_iter().zip(before).find(|(after, before)| after != before);
            steps.push(InstructionStep { address, changed: changed.map(|(after, _)| after) });
            if stop.is_ok_and(|stop| stop.is_some()) {
                break;
            }
        }
        steps
    }

    /// Runs one cell on the words that have come to it.
    fn run(&mut self, index: usize, ops: &mut OpStream, counts: &mut Counts) -> Result<(), Fault> {
        let cell = &mut self.cells[index];
        match cell.run(&mut self.queues, ops)? {
            Stop::Done => {}
            Stop::Waiting(queue) => return Err(cell.fault(FaultKind::Starved(queue))),
            Stop::Halted => return Err(cell.fault(FaultKind::Halted)),
        }
        if let Some((queue, words)) = self.queues.unread() {
            return Err(cell.fault(FaultKind::Unread(queue, words)));
        }
        // Else a cell could be at work when the host has read its last word, with which the statistics end.
        if ops.ops().last().map(|op| op.kind()) != Some(OpKind::WriteY) {
            return Err(cell.fault(FaultKind::LateWork));
        }
        for (counter, event) in self.events[index].iter().enumerate() {
            let count = cell.take_count(counter);
            match event {
                Some(Event::Voxel) => counts.voxels += count,
                Some(Event::SlabTest) => counts.slab_tests += count,
                Some(Event::IntersectionTest) => counts.intersection_tests += count,
                None => {}
            }
        }
        Ok(())
    }

    /// The HIT that has come out of the last cell.
    fn answer(&self) -> Result<Hit, FaultKind> {
        let words = self.queues.y.as_slice();
        let &[_, polygon, t, alpha, beta] = words else {
            return Err(FaultKind::AnswerLength { words: words.len(), expected: HIT_WORDS as usize });
        };
        if polygon != Hit::NO_POLYGON && polygon as usize >= self.polygons {
            return Err(FaultKind::AnswerPolygon(polygon));
        }
        let [t, alpha, beta] = [t, alpha, beta].map(f32::from_bits);
        Ok(Hit { t, polygon, alpha, beta })
    }
}

/// All registers, and what they hold.
fn registers(cell: &Processor<'_>) -> Vec<(Register, u32)> {
    Register::all().map(|register| (register, cell.register(register))).collect()
}

/// The words of a RAY message.
fn ray_words(id: u32, ray: &Ray) -> [u32; 8] {
    let [ox, oy, oz] = ray.origin.to_array().map(f32::to_bits);
    let [dx, dy, dz] = ray.direction.to_array().map(f32::to_bits);
    [id, ox, oy, oz, dx, dy, dz, ray.t_max.to_bits()]
}

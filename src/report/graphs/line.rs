//! The graphs of an array: cells in a row, each group of them with a part of the scene, and all rays sent to all.

use std::collections::BTreeMap;

use super::classes::{Way, classification};
use super::graph::{Attributes, Graph, number, text, whole};
use super::labels::HOST;
use super::rays::{self, RayNote};
use super::real::{Contact, Objects, contiguous, of_box};
use super::{Asked, Graphs};
use crate::error::InputError;
use crate::geometry::{Bounds, Hit, Partition, Ray};
use crate::host::shading::RayKind;
use crate::measure::{Actor, JobSpan, Measured, Observed, State, StateKind, StateTimes};
use crate::program::messages::{Carried, CarriedByKind, MessageKind};
use crate::report::account::cell_names;
use crate::run::{Setup, TracedBatch, TreeBatch, computing};
use crate::seam::{Channel, Costs};

/// Bytes of a word of a cell's memory.
const WORD_BYTES: u64 = 4;

/// The rays of a run as they are traced, for its graphs.
#[derive(Clone, Debug)]
pub struct Gathered {
    contacts: Vec<Contact>,
    costs: Costs,
    groups: u32,
    rays: Vec<RayNote>,
    /// The places among them of all rays that were grown; of those that are not sent, of the next.
    grown: Vec<u32>,
    /// The rays in the order in which they were sent.
    sent: Vec<u32>,
}

impl Gathered {
    /// None so far.
    pub fn new(setup: &Setup) -> Gathered {
        let boxes: Vec<Bounds> = setup.workload.sub_volumes().map(|(volume, _)| volume).collect();
        let (costs, groups) = (setup.workload.costs().clone(), boxes.len() as u32);
        Gathered {
            contacts: Contact::between(&boxes),
            costs,
            groups,
            rays: Vec::new(),
            grown: Vec::new(),
            sent: Vec::new(),
        }
    }

    /// Takes the next primary rays of a run of these.
    pub fn take_batch(&mut self, batch: &TracedBatch, setup: &Setup) {
        for (line, hit) in batch.hits.iter().enumerate() {
            let place = self.rays.len();
            self.sent.push(place as u32);
            let cycles = computing(&batch.ops.cells, line, &self.costs);
            let pixel = setup.prepared.number(place) as u32;
            self.take((pixel, RayKind::Primary, 0, None), (&setup.prepared.rays[place], hit), cycles);
        }
    }

    /// Takes the next trees of an image, which are of samples of these pixels.
    pub fn take_trees(&mut self, trees: &TreeBatch, pixels: &[usize]) {
        let first = self.rays.len() as u32;
        let mut parents = vec![None; trees.rays.len()];
        for (number, ray) in (first..).zip(trees.rays.iter().filter(|ray| ray.is_sent)) {
            let (child, count) = ray.children;
            (child..child + count).for_each(|child| parents[child as usize] = Some(number));
        }
        let all = trees.rays.iter().zip(&trees.traced.hits).zip(parents);
        for ((ray, hit), parent) in all {
            self.grown.push(self.rays.len() as u32);
            if ray.is_sent {
                let pixel = pixels[ray.tree as usize] as u32;
                self.take((pixel, ray.kind, ray.generation, parent), (&ray.ray, hit), ray.busy);
            }
        }
    }

    /// A ray of these trees is sent, by its number among all of their rays.
    pub fn take_sent(&mut self, ray: u32) {
        self.sent.push(self.grown[ray as usize]);
    }

    fn take(
        &mut self,
        (pixel, kind, generation, parent): (u32, RayKind, u8, Option<u32>),
        (ray, hit): (&Ray, &Hit),
        cycles: u64,
    ) {
        self.contacts.iter_mut().for_each(|contact| contact.count(ray, hit));
        let legs = self.groups;
        let span = None;
        self.rays.push(RayNote { pixel, kind, generation, parent, hit: *hit, region: None, legs, cycles, span });
    }

    /// The rays with their spans, which were told in the order in which they were sent.
    fn timed(&self, spans: &[JobSpan]) -> Vec<RayNote> {
        let mut rays = self.rays.clone();
        self.sent.iter().zip(spans).for_each(|(&ray, span)| rays[ray as usize].span = Some(*span));
        rays
    }
}

/// The graphs of a run of primary rays, or of a whole image.
///
/// # Errors
///
/// If a graph would have too many vertices, and if single rays are asked for of what is no picture.
pub fn of_line(
    setup: &Setup,
    gathered: &Gathered,
    (stats, observed): (&Measured, &Observed),
    asked: &Asked,
) -> Result<Graphs, InputError> {
    let objects = Objects::new(&setup.scene, setup.workload.polygons());
    let rays = match &asked.pixels {
        None => rays::graph(&gathered.rays, &objects),
        Some(_) if setup.spec.rays.is_some() => {
            let error = InputError::new("--graph-pixels is about pixels of a camera, and the rays are a file's");
            return Err(error.help("leave it out"));
        }
        Some(window) => rays::graph_of_pixels(&gathered.timed(&observed.spans), &objects, (window, setup.spec.size))?,
    };
    let (real, processes) = (real(setup, gathered, stats, &objects, asked)?, processes(setup, stats));
    let classification = classification(way(setup), [&real, &rays, &processes]);
    Ok(Graphs { real, rays, processes, classification })
}

fn way(setup: &Setup) -> Way {
    let program = &setup.spec.program;
    let by_work = matches!(program.partition, Partition::Work | Partition::Measured);
    match (setup.workload.cells(), setup.workload.groups()) {
        (1, _) => Way::OneCell,
        (_, 1) => Way::Pipeline,
        _ => Way::Groups { by_work },
    }
}

/// G_r: the sub-volumes.
fn real(
    setup: &Setup,
    gathered: &Gathered,
    stats: &Measured,
    objects: &Objects<'_>,
    asked: &Asked,
) -> Result<Graph, InputError> {
    let workload = &setup.workload;
    let stages = workload.cells() / workload.groups();
    let mut graph = Graph::new("G_r");
    let mut held = Vec::new();
    for (group, ((volume, members), grid)) in workload.sub_volumes().zip(workload.grids()).enumerate() {
        let cells = &stats.stations[group * stages..(group + 1) * stages];
        let states = &stats.topology.states;
        // What messages take is no work on the objects.
        let is_kernel = |state: &State| state.kind == StateKind::Works && state.name != "other";
        let work = states.sum(&StateTimes::sum(cells), is_kernel);
        let mut attributes = vec![text("label", format!("sub-volume {group}")), text("kind", "region")];
        attributes.extend(of_box(&volume));
        attributes.extend([
            whole("polygons", members.len() as u64),
            whole("references", grid.reference_count() as u64),
            whole("work_cycles", work.0),
        ]);
        held.push((graph.add_vertex(format!("region{group}"), attributes), members.to_vec()));
    }
    for contact in &gathered.contacts {
        let [low, high] = contact.parts;
        graph.add_edge(low, high, contiguous(contact.area(), contact.rays[0]));
        graph.add_edge(high, low, contiguous(contact.area(), contact.rays[1]));
    }
    objects.add_contents(&mut graph, asked.of, &held)?;
    Ok(graph)
}

/// What a channel, or several side by side, carried.
#[derive(Default)]
struct Arc {
    channels: Vec<String>,
    words: u64,
    most: u64,
    carried: CarriedByKind,
}

/// G_p: host and cells.
fn processes(setup: &Setup, stats: &Measured) -> Graph {
    let (workload, topology) = (&setup.workload, &stats.topology);
    let names = cell_names(workload);
    let mut graph = Graph::new("G_p");
    graph.add_vertex(HOST.to_owned(), vec![text("label", HOST), text("kind", HOST)]);
    for (cell, times) in stats.stations.iter().enumerate() {
        let queues = topology.inputs_of(Actor::Station(cell)).map(|fifo| stats.fifos[fifo].max.0).max().unwrap_or(0);
        let mut attributes =
            vec![text("label", topology.station(cell)), text("kind", "cell"), text("kernels", names[cell].as_str())];
        attributes.extend(states_of(stats, times));
        attributes.extend([
            whole("queue_max_words", queues),
            whole("bytes_held", WORD_BYTES * workload.memory_of(cell).total().0),
        ]);
        graph.add_vertex(format!("cell{cell}"), attributes);
    }
    let mut arcs: BTreeMap<(Actor, Actor), Arc> = BTreeMap::new();
    for (fifo, held) in topology.fifos.iter().zip(&stats.fifos) {
        let arc = arcs.entry((fifo.from, fifo.to)).or_default();
        let channel = Channel::ALL.into_iter().find(|channel| channel.to_string() == fifo.group);
        let carried = channel.map(|channel| workload.carried(stats, channel, fifo.to)).unwrap_or_default();
        arc.channels.push(fifo.group.clone());
        arc.words += held.words.0;
        arc.most = arc.most.max(held.max.0);
        for (sum, more) in arc.carried.iter_mut().zip(carried) {
            *sum = Carried { sent: sum.sent + more.sent, words: sum.words + more.words };
        }
    }
    // Z leads to the left between all cells, whether a program needs it or not.
    for cell in 1..stats.stations.len() {
        let arc = arcs.entry((Actor::Station(cell), Actor::Station(cell - 1))).or_default();
        if arc.channels.is_empty() {
            arc.channels.push(Channel::Z.to_string());
        }
    }
    let place = |actor: Actor| match actor {
        Actor::Host => 0,
        Actor::Station(cell) => cell + 1,
    };
    for ((from, to), arc) in arcs {
        let label = match (from, to) {
            (Actor::Host, _) => "in",
            (_, Actor::Host) => "out",
            _ if from < to => "east",
            _ => "west",
        };
        let mut attributes = vec![
            text("label", label),
            text("channels", arc.channels.join("+")),
            whole("words", arc.words),
            whole("queue_max_words", arc.most),
        ];
        for kind in MessageKind::ALL {
            let Carried { sent, words } = arc.carried[kind as usize];
            attributes.extend([
                whole(format!("{}_messages", kind.key()), sent),
                whole(format!("{}_words", kind.key()), words),
            ]);
        }
        graph.add_edge(place(from), place(to), attributes);
    }
    graph
}

/// A station's cycles by state, and the share in which it did something.
pub fn states_of(stats: &Measured, times: &StateTimes) -> Attributes {
    let states = &stats.topology.states;
    let shown = states.all().iter().filter(|state| state.used || state.kind == StateKind::Works);
    let cycles = shown.map(|state| whole(format!("{}_cycles", state.key()), times.of(state.id).0));
    cycles.chain([number("busy", stats.share(states.works(times)))]).collect()
}

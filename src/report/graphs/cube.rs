//! The graphs of an image on a hypercube: nodes with a region each, or with a shared memory.

use std::collections::BTreeMap;

use super::classes::{Way, classification};
use super::graph::{Attributes, Graph, text, whole};
use super::labels::HOST;
use super::line::states_of;
use super::rays::{self, RayNote};
use super::real::{Contact, Objects, contiguous, of_box};
use super::{Asked, Graphs, Of};
use crate::error::InputError;
use crate::geometry::partition::assign;
use crate::program::cube::{MessageKind, Sent};
use crate::run::{CubeOutcome, CubeSetup, Found, Grids};

/// The graphs of an image whose rays' hits were kept.
///
/// # Errors
///
/// If a graph would have too many vertices, or what was found was not kept; if objects are asked for that no node has.
pub fn of_cube(setup: &CubeSetup, outcome: &CubeOutcome, asked: &Asked) -> Result<Graphs, InputError> {
    let Some(found) = &setup.scene.found else {
        let error = InputError::new("graphs are about a scene and its hits, and recorded tasks go without");
        return Err(error.help("name the scene"));
    };
    let objects = Objects::new(&found.scene, found.workload.polygons());
    let notes = notes(setup, outcome, found);
    let rays = match &asked.pixels {
        None => rays::graph(&notes, &objects),
        Some(window) => rays::graph_of_pixels(&notes, &objects, (window, setup.spec.size))?,
    };
    let real = match setup.spec.regions {
        Some(_) => regions(setup, (outcome, found), &objects, asked.of)?,
        None => memories(outcome, asked.of)?,
    };
    let processes = processes(setup, outcome);
    let way = if setup.spec.regions.is_some() { Way::Regions } else { Way::SharedMemory };
    let classification = classification(way, [&real, &rays, &processes]);
    Ok(Graphs { real, rays, processes, classification })
}

/// The rays, tree by tree.
fn notes(setup: &CubeSetup, outcome: &CubeOutcome, found: &Found) -> Vec<RayNote> {
    let (graph, per_pixel) = (&setup.scene.graph, setup.spec.rays.samples.pow(2));
    let times = &setup.machine.times;
    let mut notes: Vec<RayNote> = Vec::with_capacity(graph.rays.len());
    let mut parents: Vec<Option<u32>> = vec![None; graph.rays.len()];
    for (number, task) in (0..).zip(&graph.rays) {
        let (child, count) = task.children;
        (child..child + count).for_each(|child| parents[child as usize] = Some(number));
        let parent = parents[number as usize];
        let legs = task.first_leg..graph.legs_end(number);
        notes.push(RayNote {
            pixel: task.tree / per_pixel,
            kind: task.kind,
            generation: parent.map_or(0, |parent| notes[parent as usize].generation.saturating_add(1)),
            parent,
            hit: found.hits[number as usize],
            region: setup.spec.regions.map(|_| graph.start_of(number)),
            legs: legs.len() as u32,
            cycles: legs.map(|leg| graph.time(number, leg, times).all().0).sum(),
            span: None,
        });
    }
    for span in &outcome.observed.spans {
        notes[span.job as usize].span = Some(*span);
    }
    notes
}

/// G_r where each node has a region.
fn regions(
    setup: &CubeSetup,
    (outcome, found): (&CubeOutcome, &Found),
    objects: &Objects<'_>,
    of: Of,
) -> Result<Graph, InputError> {
    let (cut, stats) = (&setup.scene.cut, &outcome.stats);
    let volumes = found.workload.grids().next().map(|grid| cut.regions.volumes(grid)).unwrap_or_default();
    let mut graph = Graph::new("G_r");
    let predicted = cut.predicted();
    for (region, volume) in volumes.iter().enumerate() {
        let (node, part) = (outcome.node_of[region], &cut.parts[region]);
        let work = stats.topology.states.by_activity(&stats.stations[usize::from(node)]);
        let mut attributes = vec![text("label", format!("region {region}")), text("kind", "region")];
        attributes.extend(of_box(volume));
        attributes.extend([
            whole("node", node.into()),
            whole("polygons", part.polygons as u64),
            whole("references", part.references),
            whole("sampled_work_cycles", predicted[region]),
            whole("work_cycles", work.map(|(_, time)| time.0).sum()),
        ]);
        graph.add_vertex(format!("region{region}"), attributes);
    }
    // The rays from each region to each; a ray that has strayed goes to all, whether they touch or not.
    let mut between: BTreeMap<(usize, usize), (f64, u64)> = BTreeMap::new();
    for contact in Contact::between(&volumes) {
        let [low, high] = contact.parts;
        between.insert((low, high), (contact.area(), 0));
        between.insert((high, low), (contact.area(), 0));
    }
    let tasks = &setup.scene.graph;
    for ray in 0..tasks.rays.len() as u32 {
        for pair in tasks.legs_of(ray).windows(2) {
            between.entry((pair[0].region.into(), pair[1].region.into())).or_default().1 += 1;
        }
    }
    for ((from, to), (area, rays)) in between {
        graph.add_edge(from, to, contiguous(area, rays));
    }
    let held: Vec<(usize, Vec<u32>)> = held(setup, found).into_iter().enumerate().collect();
    objects.add_contents(&mut graph, of, &held)?;
    Ok(graph)
}

/// The polygons of each region.
fn held(setup: &CubeSetup, found: &Found) -> Vec<Vec<u32>> {
    let (regions, workload) = (&setup.scene.cut.regions, &found.workload);
    let Some(grid) = workload.grids().next() else { return Vec::new() };
    if setup.spec.regions.is_some_and(|spec| spec.grids == Grids::Own) {
        return assign(workload.polygons(), &regions.volumes(grid)).into_iter().map(|part| part.members).collect();
    }
    let mut held = vec![Vec::new(); regions.count()];
    for (voxel, list) in grid.lists().enumerate() {
        held[usize::from(regions.of_voxel(voxel))].extend_from_slice(list);
    }
    for polygons in &mut held {
        polygons.sort_unstable();
        polygons.dedup();
    }
    held
}

/// G_r where the nodes share a memory: its pages are dealt out, and sent to who reads them.
fn memories(outcome: &CubeOutcome, of: Of) -> Result<Graph, InputError> {
    if of != Of::Regions {
        let error = InputError::new(
            "--graph-of is about parts of the scene, and these nodes share pages that hold parts of polygons",
        );
        return Err(error.help("leave it out, or ask for --mode regions"));
    }
    let mut graph = Graph::new("G_r");
    for (node, part) in outcome.parts.iter().enumerate() {
        let attributes =
            vec![text("label", format!("memory {node}")), text("kind", "memory"), whole("bytes_held", part.holds)];
        graph.add_vertex(format!("memory{node}"), attributes);
    }
    for (from, to, sent) in pairs(outcome) {
        let Sent { messages, bytes } = sent[MessageKind::RealObject as usize];
        if messages > 0 {
            let attributes = vec![text("relation", "sends pages to"), whole("pages", messages), whole("bytes", bytes)];
            graph.add_edge(from, to, attributes);
        }
    }
    Ok(graph)
}

/// What was sent from each node or the host to each.
fn pairs(outcome: &CubeOutcome) -> impl Iterator<Item = (usize, usize, &[Sent; MessageKind::ALL.len()])> {
    let places = outcome.parts.len() + 1;
    outcome.seen.pairs.iter().enumerate().map(move |(pair, sent)| (pair / places, pair % places, sent))
}

/// G_p: the nodes and the host, which hangs on node 0. Where they are no power of two, the cube has routers beside.
fn processes(setup: &CubeSetup, outcome: &CubeOutcome) -> Graph {
    let (stats, nodes) = (&outcome.stats, outcome.parts.len());
    let bits = nodes.next_power_of_two().ilog2() as usize;
    let mut graph = Graph::new("G_p");
    for place in 0..1 << bits {
        if place >= nodes {
            let attributes = vec![text("label", format!("router {place}")), text("kind", "router")];
            graph.add_vertex(format!("router{place}"), attributes);
            continue;
        }
        let (seen, part) = (&outcome.seen.nodes[place], &outcome.parts[place]);
        let mut attributes = vec![text("label", stats.topology.station(place)), text("kind", "node")];
        attributes.extend(states_of(stats, &stats.stations[place]));
        attributes.extend([
            whole("queue_max_rays", stats.fifos.get(place).map_or(0, |queue| queue.max.0)),
            whole("pixels", seen.pixels as u64),
            whole("legs", seen.legs),
            whole("bytes_held", part.holds),
        ]);
        graph.add_vertex(format!("node{place}"), attributes);
    }
    let mut attributes = vec![text("label", HOST), text("kind", HOST)];
    attributes.extend(stats.stations.get(nodes).map(|times| states_of(stats, times)).unwrap_or_default());
    let host = graph.add_vertex(HOST.to_owned(), attributes);

    let cube = setup.machine.cube();
    let mut carried = vec![[Sent::default(); MessageKind::ALL.len()]; stats.links.len()];
    for (from, to, sent) in pairs(outcome) {
        for link in cube.links_between(from, to) {
            for (sum, more) in carried[link].iter_mut().zip(sent) {
                sum.messages += more.messages;
                sum.bytes += more.bytes;
            }
        }
    }
    let between = bits << bits;
    for (link, (times, carried)) in stats.links.iter().zip(&carried).enumerate() {
        let (from, to, label) = match link {
            link if link < between => {
                let (from, bit) = (link / bits, link % bits);
                let sign = if from >> bit & 1 == 0 { '+' } else { '-' };
                (from, from ^ 1 << bit, format!("{bit}{sign}"))
            }
            link if link == between => (host, 0, "in".to_owned()),
            _ => (0, host, "out".to_owned()),
        };
        let mut attributes: Attributes = vec![text("label", label), whole("busy_cycles", times.busy.0)];
        for kind in MessageKind::ALL {
            let Sent { messages, bytes } = carried[kind as usize];
            attributes.extend([
                whole(format!("{}_messages", kind.key()), messages),
                whole(format!("{}_bytes", kind.key()), bytes),
            ]);
        }
        graph.add_edge(from, to, attributes);
    }
    graph
}

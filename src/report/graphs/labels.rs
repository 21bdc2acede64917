//! What the chapter on graphs asks of the labels of G_p, its topological directions (I.1.c), and how regular it is.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::graph::Graph;

/// How a graph of processes is labelled, and how regular it is. The host hangs on it from outside: only its labels count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Labels {
    /// The labels.
    pub labels: BTreeSet<String>,
    /// Whether no vertex has two edges in, or two out, of one label.
    pub one_edge_a_label: bool,
    /// Whether no way along edges of one label comes back to where it began.
    pub no_cycle_of_a_label: bool,
    /// Whether each edge between stations has one back.
    pub both_directions: bool,
    /// D, the largest number of neighbours of a station.
    pub degree: usize,
    /// Whether the stations with D neighbours, G'_p, are connected by edges between them.
    pub totally_regular: bool,
    /// The stations with fewer.
    pub border: Vec<String>,
}

impl Labels {
    /// Those of a graph of processes, whose edges have an attribute `label`.
    pub fn of(graph: &Graph) -> Labels {
        let mut by_label: BTreeMap<&str, Vec<(usize, usize)>> = BTreeMap::new();
        for edge in &graph.edges {
            by_label.entry(edge.text("label").unwrap_or_default()).or_default().push((edge.from, edge.to));
        }
        let is_host = |place: usize| graph.vertices[place].id == HOST;
        let arcs: BTreeSet<(usize, usize)> = graph.edges.iter().map(|edge| (edge.from, edge.to)).collect();
        let between: BTreeSet<(usize, usize)> =
            arcs.iter().copied().filter(|&(from, to)| !is_host(from) && !is_host(to)).collect();
        let neighbours = Neighbours::new(&between);
        let stations = || (0..graph.vertices.len()).filter(|&place| !is_host(place));
        let degree = stations().map(|place| neighbours.of(place).len()).max().unwrap_or(0);
        let (inside, border): (BTreeSet<usize>, BTreeSet<usize>) =
            stations().partition(|&place| neighbours.of(place).len() == degree);
        Labels {
            one_edge_a_label: by_label.values().all(|arcs| is_single(arcs)),
            no_cycle_of_a_label: by_label.values().all(|arcs| !has_cycle(arcs)),
            labels: by_label.into_keys().map(str::to_owned).collect(),
            both_directions: between.iter().all(|&(from, to)| between.contains(&(to, from))),
            degree,
            totally_regular: neighbours.connect(&inside),
            border: border.into_iter().map(|place| graph.vertices[place].id.clone()).collect(),
        }
    }
}

/// The id of the host.
pub const HOST: &str = "host";

/// Whether no vertex is at the start of two, or at the end of two.
fn is_single(arcs: &[(usize, usize)]) -> bool {
    let distinct = |ends: BTreeSet<usize>| ends.len() == arcs.len();
    distinct(arcs.iter().map(|arc| arc.0).collect()) && distinct(arcs.iter().map(|arc| arc.1).collect())
}

/// Whether some way comes back: arcs that lead to where none goes on are taken away as long as there are any.
fn has_cycle(arcs: &[(usize, usize)]) -> bool {
    let mut left = arcs.to_vec();
    loop {
        let starts: BTreeSet<usize> = left.iter().map(|arc| arc.0).collect();
        let before = left.len();
        left.retain(|arc| starts.contains(&arc.1));
        if left.len() == before {
            return !left.is_empty();
        }
    }
}

/// The neighbours of each vertex, in whichever direction.
struct Neighbours(BTreeMap<usize, BTreeSet<usize>>);

impl Neighbours {
    fn new(arcs: &BTreeSet<(usize, usize)>) -> Neighbours {
        let mut all: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for &(from, to) in arcs {
            all.entry(from).or_default().insert(to);
            all.entry(to).or_default().insert(from);
        }
        Neighbours(all)
    }

    fn of(&self, place: usize) -> Vec<usize> {
        self.0.get(&place).into_iter().flatten().copied().collect()
    }

    /// Whether all of some vertices can be reached from the first without leaving them.
    fn connect(&self, inside: &BTreeSet<usize>) -> bool {
        let mut reached: BTreeSet<usize> = inside.iter().take(1).copied().collect();
        let mut todo: Vec<usize> = reached.iter().copied().collect();
        while let Some(place) = todo.pop() {
            for other in self.of(place).into_iter().filter(|other| inside.contains(other)) {
                if reached.insert(other) {
                    todo.push(other);
                }
            }
        }
        reached.len() == inside.len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::graph::text;
    use super::*;

    fn graph(stations: usize, arcs: &[(usize, usize, &str)]) -> Graph {
        let mut graph = Graph::new("G_p");
        for place in 0..stations {
            graph.add_vertex(format!("cell{place}"), Vec::new());
        }
        arcs.iter().for_each(|&(from, to, label)| graph.add_edge(from, to, vec![text("label", label)]));
        graph
    }

    #[test]
    fn a_ring_of_one_label_has_a_cycle_and_no_border() {
        let labels = Labels::of(&graph(3, &[(0, 1, "east"), (1, 2, "east"), (2, 0, "east")]));
        assert!(labels.one_edge_a_label && !labels.no_cycle_of_a_label && !labels.both_directions);
        assert!(labels.totally_regular && labels.border.is_empty() && labels.degree == 2);
    }

    #[test]
    fn two_edges_out_of_one_label_are_found() {
        let labels = Labels::of(&graph(3, &[(0, 1, "east"), (0, 2, "east")]));
        assert!(!labels.one_edge_a_label && labels.no_cycle_of_a_label);
    }

    /// Two squares on one line: what has most neighbours are two vertices far apart.
    #[test]
    fn what_has_most_neighbours_need_not_be_connected() {
        let star = |at: usize| [(at, at + 1, "a"), (at, at + 2, "b"), (at, at + 3, "c")];
        let arcs = [&star(0)[..], &star(4)[..], &[(3, 7, "d")]].concat();
        let labels = Labels::of(&graph(8, &arcs));
        assert!(!labels.totally_regular && labels.degree == 3 && labels.border.len() == 6);
    }
}

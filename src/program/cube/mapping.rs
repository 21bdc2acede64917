//! Which region is on which node of a hypercube.

/// The nodes of a cube in an order in which neighbours are one link apart, as far as all of its nodes are there (Gray's code).
pub fn gray_order(nodes: usize) -> Vec<u16> {
    let all = 0..nodes.next_power_of_two();
    all.map(|number| (number ^ (number >> 1)) as u16).filter(|&node| usize::from(node) < nodes).collect()
}

/// Times through all pairs at the most.
const ROUNDS: usize = 20;

/// Swaps the nodes of pairs of regions while the links that rays pass get fewer: `rays` are those between each two regions, row by row.
pub fn swapped(mut nodes: Vec<u16>, rays: &[u64]) -> Vec<u16> {
    let count = nodes.len();
    let between = |a: usize, b: usize| rays[a * count + b] + rays[b * count + a];
    let distance = |a: u16, b: u16| u64::from((a ^ b).count_ones());
    for _ in 0..ROUNDS {
        let mut changed = false;
        for a in 0..count {
            for b in a + 1..count {
                let cost = |nodes: &[u16], region: usize, node: u16, but: usize| {
                    let others = (0..count).filter(|&other| other != region && other != but);
                    others.map(|other| between(region, other) * distance(node, nodes[other])).sum::<u64>()
                };
                let now = cost(&nodes, a, nodes[a], b) + cost(&nodes, b, nodes[b], a);
                if cost(&nodes, a, nodes[b], b) + cost(&nodes, b, nodes[a], a) < now {
                    nodes.swap(a, b);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    nodes
}

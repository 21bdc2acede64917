//! The channels of a link.

/// The channels between neighbours: X and Y lead to the right (§4.2: "two input FIFOs"), Z leads to the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Carries the rays.
    X,
    /// Carries candidates and hits.
    Y,
    /// Leads from a cell to its left neighbour, on a wire of its own, for programs that need it. Beyond the paper.
    Z,
}

impl Channel {
    /// All of them.
    pub const ALL: [Channel; 3] = [Channel::X, Channel::Y, Channel::Z];
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Channel::X => "X",
            Channel::Y => "Y",
            Channel::Z => "Z",
        })
    }
}

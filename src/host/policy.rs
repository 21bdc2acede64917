//! What a host that makes an image sends next, and how much it may have under way.

use super::order::Order;

/// What the host sends next when it can choose.
///
/// Rays that hits asked for are sent in the order in which the hits came back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Policy {
    /// Rays that a hit asked for before primary ones.
    #[default]
    #[serde(rename = "secondaries")]
    #[cfg_attr(feature = "cli", value(name = "secondaries"))]
    SecondariesFirst,
    /// Primary rays before all others.
    #[serde(rename = "primaries")]
    #[cfg_attr(feature = "cli", value(name = "primaries"))]
    PrimariesFirst,
    /// The ray with the fewest rays between it and the eye.
    #[serde(rename = "generation")]
    #[cfg_attr(feature = "cli", value(name = "generation"))]
    ByGeneration,
}

/// What the host may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostRules {
    /// In which order it begins the pixels.
    pub order: Order,
    /// What it sends next.
    pub policy: Policy,
    /// How many rays may be on their way, at least 1; `None` for as many as the array takes.
    pub in_flight: Option<u64>,
    /// How many samples may be begun and not yet done, at least 1: what the host keeps in mind.
    pub open_samples: usize,
}

impl Default for HostRules {
    fn default() -> Self {
        HostRules { order: Order::default(), policy: Policy::default(), in_flight: None, open_samples: 1024 }
    }
}

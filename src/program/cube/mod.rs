//! Ray tracing on the nodes of a hypercube, each with its own memory (RR-0992, §4.1; Ray Tracing News 3(1)).
//!
//! In one program a node has a region of the scene, and rays are sent from node to node ([`RegionNodes`]). In the other all nodes have the
//! scene together, as the pages of a shared memory, and trace whole pixels ([`MemoryNodes`]).
//!
//! What each ray makes each region do does not depend on the clock: that is worked out before, as a [`TaskGraph`]. Who does it when is what
//! the nodes find out as they run in [`events`](crate::machine::events).

mod causes;
mod graph;
mod lru;
mod mapping;
mod memory;
mod messages;
mod phases;
mod pool;
mod regions;
mod seen;
mod states;
mod stuck;
mod token;
mod walker;

pub use graph::{Leg, PageUses, RayTask, Share, TaskGraph, WorkTimes};
pub use mapping::{gray_order, swapped};
pub use memory::{Dealt, MemoryNodes, PageNote};
pub use messages::{
    BLOCK_BYTES, MessageCounts, MessageKind, Messages, PACKET_PIXELS, RAY_BYTES, RESULT_BYTES, Sent, packet_bytes,
};
pub use phases::{Part, Phases, Preparation};
pub use pool::Flow;
pub use regions::{Ends, Note, RegionNodes, Rules, Visit, highest_rank};
pub use seen::{NodeSeen, Seen};
pub use states::topology;
pub use stuck::{Stuck, Waiting};
pub use token::{Account, Token};
pub use walker::{Leaving, PageMap, Space, Walker};

//! Tasks that act in the order of time: what each does next may depend on whose message came first.
//!
//! A machine hands over a function that lets a task act whose [`Turn`] it is: what it does are [`Act`]s. [`Events`] knows tasks by their numbers, and neither what they are for nor what is in their messages.
//!
//! # Guarantees
//!
//! - **One order.** Time is whole cycles of the machine's clock. What happens earlier is done earlier; at one time the task
//!   with the lowest number that can do something does it first, and goes on until it has to spend time or to wait.
//! - **First come, first taken.** A task that waits for a message of anyone takes the one that arrived first; of those that
//!   arrived together, that of the sender with the lowest number; of one sender's, the one that it sent first.
//! - **Deterministic.** There are no threads, no random numbers, no tables without order, and no fractions.
//! - **Accounted for.** Each cycle of a task is in one state, and its states sum to the run.
//! - **Explained**, if that is asked for: each cycle of the run has one cause, on a chain from what is done last back to time 0.

mod agenda;
mod buses;
mod causes;
mod cube;
mod engine;
mod lanes;
mod mailbox;
mod network;
mod queues;
mod recorder;

pub use buses::Buses;
pub use cube::{Cube, WireTimes};
pub use engine::{
    Act, Acting, Delivery, Events, Explanation, MOST_SPELLS, Message, PIECE_UNITS, Standstill, Turn, Waits, Work,
};
pub use mailbox::Sender;
pub use network::Network;
pub use queues::Queues;

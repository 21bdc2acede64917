//! A farm of workers, as SKY ran on CAPITAN (J. Argence's thesis, 1988, chapter 5, section 3): a *station* reads the scene,
//! gives it out and files the colours; a *master* (Maitre) hands out work items; *workers* (CAP) compute their pixels.
//!
//! What is to be done for each pixel does not depend on the clock, and is known before: counted by the functional half for a
//! scene of polygons, made up for one of [rectangles](Rectangles). Who does it depends on who comes first; that is what the
//! tasks find out as they run in [`events`](crate::machine::events).

mod items;
mod pixels;
mod rectangles;
mod tasks;

pub use items::{ItemKind, Items};
pub use pixels::{Counts, PixelWork, Pixels, UNITS};
pub use rectangles::Rectangles;
pub use tasks::{Farm, HandOut, Letter, SceneBy, states};

//! What the points of a sweep have in common whose scene is laid out once for all machines that it does not depend on.

use super::effective::Effective;
use crate::cancel::Cancel;
use crate::run::{Key, Workers};

/// A point of a sweep: a farm, or an image on a hypercube.
pub trait LaidOut: Sized + Sync {
    /// What points of the same key share.
    type Scene: Sync;
    /// What they differ in.
    type Machine: 'static;
    /// What the machine makes of values that are no whole number of its cycles.
    const EFFECTIVE: &'static [Effective<Self::Machine>];

    /// The point whose parameters have these values.
    fn new(values: impl Iterator<Item = (&'static str, String)>) -> Result<Self, String>;
    /// What its scene, laid out, depends on.
    fn work_key(&self) -> Key;
    /// Its machine.
    fn machine(&self) -> &Self::Machine;
    /// What had to be rounded for it.
    fn notes(&self) -> &[String];
    /// Its scene, and what there is to be done.
    fn lay_out(&self, workers: &Workers) -> Result<Self::Scene, String>;
    /// The scene's name, and what reading it changed.
    fn told(scene: &Self::Scene) -> (&str, &[String]);
    /// Runs it: a cell for each of its kind's columns.
    fn run(&self, scene: &Self::Scene, cancel: &Cancel) -> Result<Vec<String>, String>;
}

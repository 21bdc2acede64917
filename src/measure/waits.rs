//! Who waits for whom, as a recording has it.

use std::collections::HashMap;

use super::moment::StationMoment;
use super::recording::Recording;
use super::state::StateKind;
use super::topology::Actor;
use crate::quantities::{Cycles, Words};

/// The chains of waits in a recording.
#[derive(Debug)]
pub struct Waits<'a> {
    recording: &'a Recording,
    /// The FIFOs by who reads them and who writes to them, and by their group.
    read: HashMap<(Actor, &'a str), usize>,
    written: HashMap<(Actor, &'a str), usize>,
}

/// Somebody in such a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// Who it is.
    pub actor: Actor,
    /// What it does, and for which job.
    pub moment: StationMoment,
    /// What it waits for; nothing at the end of a chain that ends with somebody who does something.
    pub wait: Option<WaitAt>,
}

/// What somebody waits for. FIFOs are told by their places in the topology.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaitAt {
    /// For a word: the FIFO is empty.
    Empty(usize),
    /// For a word that is on its way to the FIFO.
    OnItsWay(usize),
    /// For a place: the FIFO is full.
    Full(usize),
    /// For the wire to the FIFO, which has room.
    Wire(usize),
}

impl<'a> Waits<'a> {
    /// Those of a recording.
    pub fn new(recording: &'a Recording) -> Waits<'a> {
        let by = |end: fn(&super::topology::FifoInfo) -> Actor| {
            let fifos = recording.topology.fifos.iter().enumerate();
            fifos.map(|(place, info)| ((end(info), info.group.as_str()), place)).collect()
        };
        Waits { recording, read: by(|fifo| fifo.to), written: by(|fifo| fifo.from) }
    }

    /// What somebody does in cycle `at`, then what the one does that it waits for, and so on, down to one that does not wait for
    /// another. Nothing outside the recording.
    pub fn chain(&self, actor: Actor, at: Cycles) -> Vec<Waiting> {
        let mut chain: Vec<Waiting> = Vec::new();
        let mut next = Some(actor);
        // In a run that ends nobody waits for itself; whatever it is, it is told once.
        while let Some(actor) = next.filter(|actor| chain.iter().all(|told| told.actor != *actor)) {
            let Some(moment) = self.moment(actor, at) else { break };
            let wait = self.wait(actor, moment, at);
            next = wait.and_then(|wait| self.waits_for(wait));
            chain.push(Waiting { actor, moment, wait });
        }
        chain
    }

    fn moment(&self, actor: Actor, at: Cycles) -> Option<StationMoment> {
        match actor {
            Actor::Host => self.recording.host.as_ref()?.moment(at),
            Actor::Station(station) => self.recording.stations.get(station)?.moment(at),
        }
    }

    fn wait(&self, actor: Actor, moment: StationMoment, at: Cycles) -> Option<WaitAt> {
        let Recording { topology, fifos, .. } = self.recording;
        let state = topology.states.get(moment.stretch.state)?;
        let (group, _) = state.stands_at.as_ref()?;
        let ends = if state.kind == StateKind::Waits { &self.read } else { &self.written };
        let &fifo = ends.get(&(actor, group.as_str()))?;
        let held = fifos[fifo].level(at).unwrap_or_default();
        match state.kind {
            StateKind::Waits if held > Words(0) => Some(WaitAt::OnItsWay(fifo)),
            StateKind::Waits => Some(WaitAt::Empty(fifo)),
            StateKind::Blocked if topology.fifos[fifo].is_full(held) => Some(WaitAt::Full(fifo)),
            StateKind::Blocked => Some(WaitAt::Wire(fifo)),
            _ => None,
        }
    }

    /// Whom somebody waits for. The host reads each word as soon as it has come.
    fn waits_for(&self, wait: WaitAt) -> Option<Actor> {
        let fifos = &self.recording.topology.fifos;
        match wait {
            WaitAt::Empty(fifo) => Some(fifos[fifo].from),
            WaitAt::Full(fifo) => Some(fifos[fifo].to).filter(|&reader| reader != Actor::Host),
            WaitAt::OnItsWay(_) | WaitAt::Wire(_) => None,
        }
    }
}

//! The states of a station, and the times spent in them.

use crate::quantities::Cycles;

/// A state, by its place in [`StateTimes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StateId(pub u8);

/// What sort of state it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateKind {
    /// The station does work.
    Works,
    /// It moves a word.
    Moves,
    /// It needs a word that is not there.
    Waits,
    /// It has a word that finds no room, or no free wire.
    Blocked,
    /// It has done all that it has to.
    Idle,
}

/// On which side of a station the one is that it waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Toward {
    /// Where the jobs come from.
    Upstream,
    /// Where they go.
    Downstream,
}

/// What a station can be in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// Its place in [`StateTimes`].
    pub id: StateId,
    /// Its name in reports.
    pub name: String,
    /// Its letter where there is room for no more.
    pub letter: char,
    /// What sort it is.
    pub kind: StateKind,
    /// The group of FIFOs at which the station then stands, and where the one is that it waits for.
    pub stands_at: Option<(String, Toward)>,
    /// Whether reports name it: not if it is about FIFOs that nobody uses.
    pub used: bool,
}

/// The states that the stations of a machine can be in, in the order in which reports name them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct States(Vec<State>);

/// The cycles that a station spent in each state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateTimes([Cycles; StateTimes::MOST_STATES]);

impl StateTimes {
    /// No machine has more states.
    pub const MOST_STATES: usize = 16;

    /// The cycles spent in a state.
    #[inline]
    pub fn of(&self, state: StateId) -> Cycles {
        self.0[state.0 as usize % StateTimes::MOST_STATES]
    }

    /// Where the cycles spent in a state are counted.
    #[inline(always)]
    pub fn of_mut(&mut self, state: StateId) -> &mut Cycles {
        &mut self.0[state.0 as usize % StateTimes::MOST_STATES]
    }

    /// All cycles.
    pub fn total(&self) -> Cycles {
        self.0.iter().copied().sum()
    }

    /// Takes in the cycles of another station, or of another time.
    pub fn add(&mut self, other: &StateTimes) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, more)| *sum += more);
    }

    /// The cycles of some stations together.
    pub fn sum(stations: &[StateTimes]) -> StateTimes {
        let mut sum = StateTimes::default();
        stations.iter().for_each(|station| sum.add(station));
        sum
    }

    /// What was spent since `before`, which was seen earlier.
    pub fn since(&self, before: &StateTimes) -> StateTimes {
        let passed = |state: usize| Cycles(self.0[state].0.saturating_sub(before.0[state].0));
        StateTimes(std::array::from_fn(passed))
    }
}

impl State {
    /// Its name as a key of JSON or a column: `waiting_x`.
    pub fn key(&self) -> String {
        self.name.to_lowercase().replace(' ', "_")
    }
}

impl States {
    /// Some states, in the order of reports.
    pub fn new(states: impl Iterator<Item = State>) -> States {
        States(states.collect())
    }

    /// All of them, used or not.
    pub fn all(&self) -> &[State] {
        &self.0
    }

    /// Those that reports name.
    pub fn used(&self) -> impl Iterator<Item = &State> + Clone {
        self.0.iter().filter(|state| state.used)
    }

    /// The state with that place in the times.
    pub fn get(&self, id: StateId) -> Option<&State> {
        self.0.iter().find(|state| state.id == id)
    }

    /// Whether a state is of a kind.
    pub fn is(&self, id: StateId, kind: StateKind) -> bool {
        self.get(id).is_some_and(|state| state.kind == kind)
    }

    /// The cycles spent in some of the states.
    pub fn sum(&self, times: &StateTimes, which: impl Fn(&State) -> bool) -> Cycles {
        self.0.iter().filter(|state| which(state)).map(|state| times.of(state.id)).sum()
    }

    /// The cycles in which a station did something: worked or moved words.
    pub fn works(&self, times: &StateTimes) -> Cycles {
        self.sum(times, |state| matches!(state.kind, StateKind::Works | StateKind::Moves))
    }

    /// The cycles in which it waited for words.
    pub fn waits(&self, times: &StateTimes) -> Cycles {
        self.sum(times, |state| state.kind == StateKind::Waits)
    }

    /// The cycles in which it found no room for words.
    pub fn blocked(&self, times: &StateTimes) -> Cycles {
        self.sum(times, |state| state.kind == StateKind::Blocked)
    }

    /// The cycles of its work by the name of what it worked on, in the order of reports.
    pub fn by_activity<'a>(&'a self, times: &StateTimes) -> impl Iterator<Item = (&'a str, Cycles)> {
        let work = self.0.iter().filter(|state| state.kind == StateKind::Works);
        work.map(|state| (state.name.as_str(), times.of(state.id)))
    }
}

//! What ops are about: the units of work of a program, and what a station that does them is busy with.

/// A unit of work, by its place in a [`Vocabulary`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Unit(pub u8);

/// What a station is busy with when it works, by its place in a [`Vocabulary`]: reports tell times by activity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Activity(pub u8);

/// A unit of work, as a vocabulary describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitOfWork {
    /// Its code in activity traces: small letters, none that begins an op of another kind.
    pub code: String,
    /// Its name, by which a machine file prices it: `grid_start`.
    pub name: String,
    /// What a station is busy with that does it.
    pub activity: Activity,
    /// Whether the program has it: what it does without has a number, but no place in activity traces.
    pub used: bool,
}

/// The units of work of a program, what they belong to, and how long the array's answers are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vocabulary {
    /// The activities, each with its letter in activity traces that are priced, at most [`Vocabulary::MOST_ACTIVITIES`].
    pub activities: Vec<(char, String)>,
    /// The units, at most [`Vocabulary::MOST_UNITS`].
    pub units: Vec<UnitOfWork>,
    /// Words of the message that answers a job.
    pub answer_words: u64,
}

impl Vocabulary {
    /// As many units as an op can tell apart.
    pub const MOST_UNITS: usize = 64;

    /// As many activities as statistics have room for.
    pub const MOST_ACTIVITIES: usize = 8;

    /// A vocabulary in which each activity has one unit, with its letter for a code: that of priced traces, whose units are
    /// cycles.
    pub fn of_cycles(activities: &[(char, &str)], answer_words: u64) -> Vocabulary {
        let unit = |(place, &(letter, name)): (usize, &(char, &str))| UnitOfWork {
            code: letter.to_string(),
            name: format!("{name}_cycle"),
            activity: Activity(place as u8),
            used: true,
        };
        Vocabulary {
            activities: activities.iter().map(|&(letter, name)| (letter, name.to_owned())).collect(),
            units: activities.iter().enumerate().map(unit).collect(),
            answer_words,
        }
    }

    /// What a unit is; `None` if there is none with that number.
    pub fn unit(&self, unit: Unit) -> Option<&UnitOfWork> {
        self.units.get(unit.0 as usize)
    }

    /// The unit with that code.
    pub fn unit_coded(&self, code: &str) -> Option<Unit> {
        self.units.iter().position(|unit| unit.code == code).map(|place| Unit(place as u8))
    }
}

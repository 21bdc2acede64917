//! The heading of a trace in units of work.

use std::sync::Arc;

use super::MAGIC;
use super::line::Line;
use crate::error::InputError;
use crate::quantities::Cycles;
use crate::seam::{Activity, Costs, OpKind, UnitOfWork, Vocabulary};

/// Why the reading of a heading ends.
pub(super) enum Halt {
    /// The lines of ops begin.
    AtBody,
    Input(InputError),
}

impl From<InputError> for Halt {
    fn from(error: InputError) -> Halt {
        Halt::Input(error)
    }
}

/// The heading of a trace in units.
pub(super) struct Heading {
    vocabulary: Vocabulary,
    cycles: Vec<Cycles>,
}

impl Heading {
    pub(super) fn begin(line: &Line<'_>) -> Result<Heading, InputError> {
        let form = "expected 'pcs-sim trace 2 cells N answer WORDS'";
        let words: Vec<&str> = line.text[MAGIC.len()..].split_whitespace().collect();
        let &["cells", _, "answer", answer] = words.as_slice() else { return Err(line.error(line.text, form)) };
        match answer.parse() {
            Ok(answer_words @ 1..=1024) => {
                let vocabulary = Vocabulary { activities: Vec::new(), units: Vec::new(), answer_words };
                Ok(Heading { vocabulary, cycles: Vec::new() })
            }
            _ => Err(line.error(answer, "an answer has from 1 to 1024 words")),
        }
    }

    pub(super) fn add(&mut self, line: &Line<'_>) -> Result<(), InputError> {
        let words: Vec<&str> = line.text.split_whitespace().collect();
        let &["unit", code, name, activity, cycles] = words.as_slice() else {
            return Err(line.error(line.text, "expected 'unit CODE NAME ACTIVITY CYCLES'"));
        };
        let is_code = code.bytes().all(|byte| byte.is_ascii_lowercase());
        if !is_code || OpKind::from_word(code).is_some() || self.vocabulary.unit_coded(code).is_some() {
            let message = "a unit's code is small letters that no other op and no other unit has";
            return Err(line.error(code, message));
        }
        let Some(cycles) = cycles.parse().ok().filter(|cycles| *cycles <= Costs::MOST.0) else {
            return Err(line.error(cycles, format!("expected a number of cycles, at most {}", Costs::MOST.0)));
        };
        let activity = self
            .activity(activity)
            .ok_or_else(|| line.error(activity, format!("more than {} activities", Vocabulary::MOST_ACTIVITIES)))?;
        if self.cycles.len() == Vocabulary::MOST_UNITS {
            return Err(line.error(code, format!("more than {} units", Vocabulary::MOST_UNITS)));
        }
        self.vocabulary.units.push(UnitOfWork { code: code.to_owned(), name: name.to_owned(), activity, used: true });
        self.cycles.push(Cycles(cycles));
        Ok(())
    }

    /// The activity of that name, which is new if it has not been named before. `None` if there are too many.
    fn activity(&mut self, name: &str) -> Option<Activity> {
        let all = &mut self.vocabulary.activities;
        let place = all.iter().position(|(_, other)| other == name).unwrap_or(all.len());
        if place == all.len() {
            all.push((name.chars().next().unwrap_or('?'), name.to_owned()));
        }
        (place < Vocabulary::MOST_ACTIVITIES).then_some(Activity(place as u8))
    }

    pub(super) fn into_costs(self) -> Costs {
        let Heading { vocabulary, cycles } = self;
        Costs::new(Arc::new(vocabulary), |unit| cycles[unit.0 as usize])
    }
}

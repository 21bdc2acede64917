//! What shards have found, taken as it comes.

use std::collections::HashMap;
use std::time::SystemTime;

use pcs_sim::shards::{Folder, Found, Plan};
use pcs_sim::sweep::{Account, Record, Sweep};

use super::super::Failure;

/// Results of points on their way into a record.
#[derive(Default)]
pub struct Gathered {
    /// For each shard, when its results were written that were taken last, and how long they are.
    taken: HashMap<usize, (SystemTime, u64)>,
    accounts: HashMap<usize, Account>,
}

impl Gathered {
    /// Takes what is new; `seen` is told of each row.
    pub fn take(
        &mut self,
        (folder, plan): (&Folder, &Plan),
        sweep: &Sweep,
        record: &mut Record,
        mut seen: impl FnMut(&[String]),
    ) -> Result<(), Failure> {
        for shard in 0..plan.shards {
            let written = std::fs::metadata(folder.results(shard));
            let Some(stamp) = written.ok().and_then(|data| Some((data.modified().ok()?, data.len()))) else { continue };
            if self.taken.insert(shard, stamp) == Some(stamp) {
                continue;
            }
            if let Some(Found::Points(points)) = folder.found(shard)? {
                let results = points.results.iter().map(|(point, results)| (point.as_str(), results.as_slice()));
                let taken = record.take(sweep, results, &mut seen);
                taken.map_err(|error| Failure::Output(format!("the table cannot be written: {error}")))?;
                self.accounts.insert(shard, points.account);
            }
        }
        Ok(())
    }

    /// What is to be said of all points.
    pub fn account(self) -> Account {
        let mut all = Account::default();
        self.accounts.into_values().for_each(|account| all.add(account));
        all
    }
}

//! `--watch`: the machine at work, above the progress bar.

mod view;

use std::time::{Duration, Instant};

use console::Term;
use indicatif::ProgressBar;
use pcs_sim::measure::{Clock, SoFar};

use view::View;

/// A machine is looked at no more often: each look takes far less time than passes between two.
const PAUSE: Duration = Duration::from_millis(250);

/// A progress bar, with the machine above it if it is watched.
pub struct Live {
    bar: ProgressBar,
    watch: Option<Watch>,
}

/// What is needed to look at a machine now and then.
pub struct Watch {
    clock: Clock,
    cell_names: Vec<String>,
    before: SoFar,
    due: Instant,
}

impl Live {
    /// On a pipe nothing is drawn, and nothing watched.
    pub fn new(bar: ProgressBar, watch: Option<Watch>) -> Live {
        let watch = watch.filter(|_| !bar.is_hidden());
        Live { bar, watch }
    }

    /// So much more is done.
    pub fn inc(&self, more: u64) {
        self.bar.inc(more);
    }

    /// So much is done of so much.
    pub fn set(&self, done: u64, of: u64) {
        self.bar.set_length(of);
        self.bar.set_position(done);
    }

    /// Shows the machine, if it is watched and was not shown just now; `so_far` tells what it has done.
    pub fn show(&mut self, so_far: impl FnOnce() -> SoFar) {
        let Some(watch) = &mut self.watch else { return };
        let now = Instant::now();
        if now < watch.due {
            return;
        }
        watch.due = now + PAUSE;
        let so_far = so_far();
        let (height, width) = Term::stderr().size();
        let view = View { clock: watch.clock, cell_names: &watch.cell_names, before: &watch.before, now: &so_far };
        // The bar has a line of its own, and the cursor stands on the next.
        let lines = view.lines(width as usize, (height as usize).saturating_sub(2));
        self.bar.set_prefix(lines.iter().map(|line| format!("{line}\n")).collect::<String>());
        watch.before = so_far;
    }

    /// Clears it all away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch {
    /// For a machine whose cells run what the names tell, as far as that is known. The first look waits for no pause: a short run
    /// would be over before.
    pub fn new(clock: Clock, cell_names: Vec<String>) -> Watch {
        Watch { clock, cell_names, before: SoFar::default(), due: Instant::now() }
    }
}

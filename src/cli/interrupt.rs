//! Ctrl-C, for every command alike: it stops at once, leaves no file half-written, and says how far it came.

use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use indicatif::ProgressBar;
use pcs_sim::report::summary::grouped;
use pcs_sim::run::Outputs;

use super::Failure;

/// What is under way.
#[derive(Clone)]
struct Stage {
    bar: ProgressBar,
    /// What the bar counts; `None` if it just turns, with a message.
    counts: Option<&'static str>,
    /// What becomes of the work done so far, if it is not lost.
    kept: Option<String>,
}

static STAGE: Mutex<Option<Stage>> = Mutex::new(None);

/// The result files of the command.
static OUTPUTS: LazyLock<Outputs> = LazyLock::new(Outputs::default);

/// The folder of a server, which is removed when it ends.
static SERVING: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Held by who ends the process: the command, or the signal.
static ENDING: Mutex<()> = Mutex::new(());

/// The result files of the command, which a signal abandons.
pub fn outputs() -> &'static Outputs {
    &OUTPUTS
}

/// Waits for the process to end, if a signal has begun to end it: what then fails for want of files is not told.
pub fn settle() {
    // The process ends with the lock held, whoever ends it.
    std::mem::forget(ENDING.lock());
}

/// From here on, a signal to stop ends the process: exit status 130.
///
/// Signals are taken on a thread of their own, so it does not matter what the command is doing.
pub fn listen() -> Result<(), Failure> {
    let handler = ctrlc::set_handler(|| {
        let _ending = ENDING.lock();
        let finished = OUTPUTS.abandon();
        let stage = STAGE.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let folder = SERVING.lock().unwrap_or_else(PoisonError::into_inner).take();
        let told = if folder.is_some() { String::new() } else { told(stage.as_ref(), &finished) };
        if let Some(stage) = stage {
            stage.bar.finish_and_clear();
        }
        eprintln!("stopped{told}");
        if let Some(folder) = folder {
            let _ = std::fs::remove_dir_all(folder);
        }
        std::process::exit(130);
    });
    handler.map_err(|error| Failure::Output(format!("cannot listen for signals: {error}")))
}

/// Notes that this process serves until it is stopped, and what is then removed.
pub fn serving(folder: &Path) {
    *SERVING.lock().unwrap_or_else(PoisonError::into_inner) = Some(folder.to_owned());
}

/// Notes what is under way: the bar shows how far it is, `counts` says what the bar counts.
pub fn under_way(bar: &ProgressBar, counts: Option<&'static str>, kept: Option<&'static str>) {
    let kept = kept.map(str::to_owned);
    *STAGE.lock().unwrap_or_else(PoisonError::into_inner) = Some(Stage { bar: bar.clone(), counts, kept });
}

/// Notes what becomes of what is under way if this process does not wait for its end.
pub fn keeping(kept: String) {
    if let Some(stage) = &mut *STAGE.lock().unwrap_or_else(PoisonError::into_inner) {
        stage.kept = Some(kept);
    }
}

fn told(stage: Option<&Stage>, finished: &[PathBuf]) -> String {
    let far = match stage {
        None => " before it began".to_owned(),
        Some(Stage { bar, counts: None, .. }) => format!(" while {}", bar.message()),
        Some(Stage { bar, counts: Some(noun), .. }) => {
            format!(" after {} of {} {noun}", grouped(bar.position()), grouped(bar.length().unwrap_or_default()))
        }
    };
    let files: Vec<String> = finished.iter().map(|path| path.display().to_string()).collect();
    match stage.and_then(|stage| stage.kept.as_ref()) {
        Some(kept) => format!("{far}; {kept}"),
        None if files.is_empty() => format!("{far}; nothing was written"),
        None => format!("{far}; wrote {}", files.join(", ")),
    }
}

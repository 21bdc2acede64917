//! How long work is stopped, from any thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// How often who waits for what cannot be stopped looks whether to go on waiting.
const PAUSE: Duration = Duration::from_millis(20);

/// A way to stop what takes long, from any thread. Clones stop the same work.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

/// The work was told to stop, and has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before the end, as it was told to")]
pub struct Cancelled;

impl Cancel {
    /// Stops the work, as soon as it comes to its next batch of rays or polygons. Nothing that is stopped goes on again.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Does something that cannot be stopped, and no longer waits for it once the work is stopped: it then ends by itself.
    pub fn wait_for<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> Result<T, Cancelled> {
        let (sender, receiver) = mpsc::channel();
        let worker = thread::spawn(move || {
            // Nobody takes it who has stopped waiting.
            let _ = sender.send(work());
        });
        loop {
            match receiver.recv_timeout(PAUSE) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => self.check()?,
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Ok(()) => return Err(Cancelled),
                    Err(panic) => std::panic::resume_unwind(panic),
                },
            }
        }
    }

    /// Fails once the work has been stopped.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.0.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work that never ends is waited for until it is told to stop.
    #[test]
    fn waits_no_longer_than_it_is_told_to() {
        let cancel = Cancel::default();
        assert_eq!(cancel.wait_for(|| 7), Ok(7));
        let other = cancel.clone();
        let (_kept, never) = mpsc::channel::<()>();
        let stops = thread::spawn(move || other.cancel());
        assert_eq!(cancel.wait_for(move || never.recv()), Err(Cancelled));
        assert!(stops.join().is_ok());
    }
}

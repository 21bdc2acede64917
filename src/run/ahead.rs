//! Work in batches on several threads, taken in order by the one that asks.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// What the threads share.
struct Shared<B> {
    state: Mutex<State<B>>,
    changed: Condvar,
    count: usize,
    /// How many batches may be made and not yet taken.
    window: usize,
}

struct State<B> {
    /// The next batch that nobody makes yet.
    next: usize,
    /// How many have been taken.
    taken: usize,
    ready: BTreeMap<usize, B>,
    spare: Vec<B>,
    stop: bool,
}

/// Makes `count` batches on `threads` threads, this one included, and takes them here in order.
///
/// Each thread makes batches with a `worker` of its own from an old batch, whose memory it may use. This thread makes
/// batches too whenever the next one to be taken is not ready, so that all threads are busy whatever taking costs.
pub(super) fn in_order<W, B: Default + Send, E>(
    count: usize,
    threads: usize,
    worker: impl Fn() -> W + Sync,
    make: impl Fn(&mut W, usize, B) -> B + Sync,
    mut take: impl FnMut(B) -> Result<B, E>,
) -> Result<(), E> {
    let state = State { next: 0, taken: 0, ready: BTreeMap::new(), spare: Vec::new(), stop: false };
    let window = 4 * threads.max(1);
    let shared = Shared { state: Mutex::new(state), changed: Condvar::new(), count, window };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|| {
                // A panic here must not leave the others waiting for a batch that never comes.
                let _guard = Defer(|| {
                    if std::thread::panicking() {
                        shared.stop()
                    }
                });
                let mut worker = worker();
                while shared.make_one(&make, &mut worker, Wait::ForRoom) {}
            });
        }
        let _guard = Defer(|| shared.stop());
        let mut own = worker();
        (0..count).map_while(|index| shared.wait_for(index, &make, &mut own)).try_for_each(|batch| {
            let spare = take(batch)?;
            shared.give_back(spare);
            Ok(())
        })
    })
}

/// Calls a function when it goes out of scope, by whatever way.
struct Defer<F: FnMut()>(F);

impl<F: FnMut()> Drop for Defer<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// What a thread does that may not make the next batch yet.
#[derive(PartialEq)]
enum Wait {
    /// Waits until there is room for it.
    ForRoom,
    /// Goes on with something else.
    Not,
}

impl<B: Default> Shared<B> {
    /// Makes the next batch. False if there was none to make (yet).
    fn make_one<W>(&self, make: impl Fn(&mut W, usize, B) -> B, worker: &mut W, wait: Wait) -> bool {
        let mut state = self.lock();
        while !state.stop && state.next < self.count && state.next >= state.taken + self.window {
            if wait == Wait::Not {
                return false;
            }
            state = self.wait(state);
        }
        if state.stop || state.next >= self.count {
            return false;
        }
        let index = state.next;
        state.next += 1;
        let spare = state.spare.pop().unwrap_or_default();
        drop(state);
        let batch = make(worker, index, spare);
        self.lock().ready.insert(index, batch);
        self.changed.notify_all();
        true
    }

    /// Batch `index`, which is the next to be taken; makes batches until it is ready. `None` if all has been stopped.
    fn wait_for<W>(&self, index: usize, make: impl Fn(&mut W, usize, B) -> B, worker: &mut W) -> Option<B> {
        loop {
            if let Some(batch) = self.lock().ready.remove(&index) {
                return Some(batch);
            }
            if self.make_one(&make, worker, Wait::Not) {
                continue;
            }
            let mut state = self.lock();
            while !state.ready.contains_key(&index) {
                if state.stop {
                    return None;
                }
                state = self.wait(state);
            }
        }
    }

    fn give_back(&self, spare: B) {
        let mut state = self.lock();
        state.taken += 1;
        state.spare.push(spare);
        drop(state);
        self.changed.notify_all();
    }

    fn stop(&self) {
        self.lock().stop = true;
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, State<B>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State<B>>) -> MutexGuard<'a, State<B>> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_come_in_order_on_any_number_of_threads() {
        for threads in 1..6 {
            let mut taken = Vec::new();
            let make = |_: &mut (), index: usize, _: usize| index * 3;
            in_order(
                100,
                threads,
                || (),
                make,
                |batch| {
                    taken.push(batch);
                    Ok::<_, ()>(batch)
                },
            )
            .unwrap();
            assert_eq!(taken, (0..100).map(|index| index * 3).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_failure_to_take_stops_all() {
        let take = |batch: usize| if batch == 7 { Err("seven") } else { Ok(batch) };
        assert_eq!(in_order(1_000_000_000, 3, || (), |_, index, _| index, take), Err("seven"));
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_panic_in_a_thread_is_no_hang() {
        let main_thread = std::thread::current().id();
        let make = |_: &mut (), index: usize, _: usize| {
            assert!(std::thread::current().id() == main_thread || index < 10);
            std::thread::sleep(std::time::Duration::from_millis(1));
            index
        };
        let _ = in_order(1_000_000_000, 3, || (), make, Ok::<_, ()>);
    }
}

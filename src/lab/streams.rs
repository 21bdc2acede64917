//! Answers that come bit by bit: server-sent events, and work that ends when nobody takes them any more.

use std::convert::Infallible;
use std::sync::Arc;

use axum::http::StatusCode;
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::poll_fn;
use pcs_sim::cancel::Cancel;
use tokio::sync::{Semaphore, mpsc};

/// Events that may wait to be taken.
const WAITING: usize = 8;

/// Where work tells what it has.
pub struct Events(mpsc::Sender<Event>);

impl Events {
    /// Tells something, once there is room for it. Who has gone away is told nothing.
    pub fn tell(&self, name: &str, data: impl AsRef<str>) {
        let _ = self.0.blocking_send(Event::default().event(name).data(data));
    }

    /// Tells something that will soon be out of date, if there is room for it.
    pub fn tell_now(&self, name: &str, data: impl AsRef<str>) {
        let _ = self.0.try_send(Event::default().event(name).data(data));
    }
}

/// Stops work when it goes out of scope.
struct Stops(Cancel);

impl Drop for Stops {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Does something on a thread of its own, and answers with what it tells. It is stopped when the answer is no longer wanted.
pub fn answer(work: impl FnOnce(&Events, Cancel) + Send + 'static) -> Response {
    let (sender, mut receiver) = mpsc::channel(WAITING);
    let cancel = Cancel::default();
    let stops = Stops(cancel.clone());
    tokio::task::spawn_blocking(move || {
        // It may have waited for a thread for longer than it was wanted.
        if cancel.check().is_ok() {
            work(&Events(sender), cancel);
        }
    });
    let events = poll_fn(move |context| {
        let _stops = &stops;
        receiver.poll_recv(context).map(|event| event.map(Ok::<_, Infallible>))
    });
    Sse::new(events).into_response()
}

/// Does something on a thread of its own when it has its turn, and answers with what comes of it. It is stopped when the answer is no
/// longer wanted; its turn lasts until it has stopped.
pub async fn whole(turns: Arc<Semaphore>, work: impl FnOnce(Cancel) -> Response + Send + 'static) -> Response {
    let failed = || StatusCode::INTERNAL_SERVER_ERROR.into_response();
    let Ok(turn) = turns.acquire_owned().await else { return failed() };
    let cancel = Cancel::default();
    let _stops = Stops(cancel.clone());
    let done = tokio::task::spawn_blocking(move || {
        let _turn = turn;
        // It may have waited for a thread, too.
        cancel.check().ok().map(|()| work(cancel))
    });
    done.await.ok().flatten().unwrap_or_else(failed)
}

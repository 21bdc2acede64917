//! The lab: a page, served on this machine, on which runs are changed and seen. A door to the same rooms as the command.
//!
//! A run is asked for by a URL whose query is its parameters, and told as a stream of events: how far it is, and in the end what
//! a page shows of it. Who goes away stops what they have asked for.

mod benches;
mod controls;
mod guard;
mod moments;
mod pages;
mod request;
mod runs;
mod streams;
mod sweeps;
mod uploads;

use std::convert::Infallible;
use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{get, post};
use pcs_sim::error::InputError;
use pcs_sim::run::RunError;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use benches::Benches;
use guard::Hosts;
use pages::Pages;
use uploads::Uploads;

/// How a lab is served.
#[derive(Clone, Debug)]
pub struct Options {
    /// The address that it listens on.
    pub listen: IpAddr,
    /// The port; 0 is any that is free.
    pub port: u16,
    /// The largest scene that is taken, in bytes.
    pub max_upload: usize,
    /// Threads that work on a run.
    pub threads: usize,
    /// How the door beside this one says things.
    pub words: Words,
}

/// How the command says things, for the page to say them so too.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// Why a run failed, as it stands in a terminal.
    pub failure: fn(RunError<Infallible>) -> String,
    /// What a parameter is.
    pub help: fn(&str) -> Option<String>,
}

/// What all requests share.
struct Lab {
    benches: Benches,
    uploads: Uploads,
    pages: Pages,
    /// Who may look something up.
    turns: Arc<Semaphore>,
    threads: usize,
    words: Words,
}

impl Lab {
    /// Why a run failed, as it stands in a terminal of its user.
    fn failure(&self, error: RunError<Infallible>) -> String {
        self.uploads.as_named(&(self.words.failure)(error))
    }

    /// What is wrong with an input.
    fn refusal(&self, error: InputError) -> String {
        self.failure(RunError::Unfit(error))
    }
}

/// How long a thread that has nothing to do waits for more.
const IDLE: Duration = Duration::from_secs(1);

/// Runs at a time; those beyond wait for one of them to end.
const MOST_RUNS: usize = 32;

/// Moments, rays and differences of runs that are looked up at a time, each of which may be a run again.
const MOST_LOOKED_UP: usize = 4;

/// Serves the lab, until the process ends. `ready` is told where it is, and the folder that is to be removed in the end.
///
/// # Errors
///
/// If it cannot listen there.
pub fn serve(options: &Options, ready: impl FnOnce(&SocketAddr, &Path)) -> Result<(), InputError> {
    let failed = |error: std::io::Error| InputError::new(format!("the lab cannot be served: {error}"));
    let mut builder = tokio::runtime::Builder::new_current_thread();
    let runtime = builder.enable_all().max_blocking_threads(MOST_RUNS).thread_keep_alive(IDLE).build();
    runtime.map_err(failed)?.block_on(async {
        let (listen, port) = (options.listen, options.port);
        let listener = TcpListener::bind((listen, port)).await.map_err(|error| {
            let error = InputError::new(format!("cannot listen on {listen}, port {port}: {error}"));
            error.help("--port 0 takes any port that is free")
        })?;
        let at = listener.local_addr().map_err(failed)?;
        let lab = Arc::new(Lab {
            benches: Benches::new(options.threads),
            uploads: Uploads::new(options.max_upload)?,
            pages: Pages::new(options.words.help).map_err(|error| InputError::new(error.to_string()))?,
            turns: Arc::new(Semaphore::new(MOST_LOOKED_UP)),
            threads: options.threads,
            words: options.words,
        });
        ready(&at, lab.uploads.folder());
        axum::serve(listener, routes(lab, Hosts::of(at))).await.map_err(failed)
    })
}

fn routes(lab: Arc<Lab>, hosts: Hosts) -> Router {
    Router::new()
        .route("/", get(pages::lab))
        .route("/run", get(runs::run))
        .route("/why", get(runs::why))
        .route("/sweep", post(sweeps::sweep).layer(DefaultBodyLimit::max(sweeps::MOST_SENT)))
        .route("/compare", post(runs::compare).layer(DefaultBodyLimit::max(runs::MOST_COMPARED)))
        .route("/scenes", post(uploads::take).layer(DefaultBodyLimit::max(lab.uploads.most_sent())))
        .route("/window/{from}/{until}", get(moments::window))
        .route("/find/{after}/{*what}", get(moments::find))
        .route("/ray/{x}/{y}", get(moments::ray))
        .route("/look/{ray}", get(moments::look))
        .route("/instructions/{cell}/{ray}", get(moments::instructions))
        .route("/{file}", get(pages::file))
        .with_state(lab)
        .layer(from_fn(guard::tell_browsers))
        .layer(from_fn_with_state(Arc::new(hosts), guard::check))
}

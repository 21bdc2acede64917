//! A sweep, told point by point.

use std::sync::{Arc, Mutex, PoisonError};

use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use pcs_sim::error::InputError;
use pcs_sim::run::{RunOptions, Workers};
use pcs_sim::sweep::{Points, Sweep};
use serde_json::{Value, json};
use tokio::task::spawn_blocking;

use super::Lab;
use super::controls::ELSEWHERE;
use super::request::{check, received};
use super::streams::answer;

/// Points that a sweep of the lab may have: the command has no such bound.
const MOST_POINTS: usize = 1000;

/// Bytes of the text of one: enough for the names of as many scenes.
pub const MOST_SENT: usize = 1_000_000;

/// `POST /sweep`: the sweep that JSON describes as a sweep's file does.
pub async fn sweep(State(lab): State<Arc<Lab>>, asked: Result<Json<Value>, JsonRejection>) -> Response {
    let too_long = || InputError::new(format!("the lab takes sweeps of up to {} kbyte", MOST_SENT / 1000));
    let asked = match received(&lab, asked, || too_long().help("`pcs-sim sweep` takes longer ones")) {
        Ok(asked) => asked,
        Err(refusal) => return refusal.into_response(),
    };
    // It reads the scenes that it names.
    let planning = lab.clone();
    let planned = spawn_blocking(move || planned(&planning, asked)).await;
    let sweep = match planned {
        Ok(Ok(sweep)) => sweep,
        Ok(Err(error)) => return (StatusCode::UNPROCESSABLE_ENTITY, lab.refusal(error)).into_response(),
        Err(_) => return StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    };
    answer(move |events, cancel| {
        let columns: Vec<Value> =
            sweep.columns().iter().map(|column| json!({ "name": column.name, "label": column.label })).collect();
        // Files are named as their user does.
        let own = |text: &str| lab.uploads.as_named(text);
        let file = own(&sweep.text());
        events.tell("columns", json!({ "columns": columns, "points": sweep.points(), "file": file }).to_string());
        let workers = Workers { threads: lab.threads, cancel };
        let all: Vec<usize> = (0..sweep.points()).collect();
        let telling = Mutex::new(events);
        let room = lab.benches.room();
        let ended = sweep.run(&all, &workers, room.memory, |index, results| {
            let row: Vec<String> = sweep.point(index).iter().chain(&results).map(|cell| own(cell)).collect();
            let events = telling.lock().unwrap_or_else(PoisonError::into_inner);
            events.tell("point", json!({ "index": index, "row": row }).to_string());
        });
        if let Ok(account) = ended {
            let notes: Vec<String> = account.notes.iter().map(|note| own(&note.text)).collect();
            events.tell("done", json!({ "notes": notes }).to_string());
        }
    })
}

/// The sweep, if it can be run here.
fn planned(lab: &Lab, asked: Value) -> Result<Sweep, InputError> {
    let others =
        || InputError::new("the lab's sweeps are of arrays, without images").help("`pcs-sim sweep` takes others");
    let sweep = Sweep::from_json(asked, |name, value| {
        let known = RunOptions::parameters().find(|known| known.name == name && !ELSEWHERE.contains(&name));
        check(known.ok_or_else(others)?, value)?;
        if name == "scene" {
            *value = lab.uploads.scene(std::mem::take(value))?;
        }
        Ok(())
    })?;
    if sweep.of != Points::Arrays {
        return Err(others());
    }
    if sweep.points() > MOST_POINTS {
        let error = InputError::new(format!("has {} points, and the lab takes up to {MOST_POINTS}", sweep.points()));
        return Err(error.help("`pcs-sim sweep` takes more"));
    }
    Ok(sweep)
}

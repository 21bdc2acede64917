//! A sweep, told point by point.

use std::sync::{Arc, Mutex, PoisonError};

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use pcs_sim::error::InputError;
use pcs_sim::run::{Workers, is_builtin};
use pcs_sim::sweep::{Points, Sweep};
use serde_json::{Map, Value, json};

use super::Lab;
use super::request::{FILES, check_no_file};
use super::streams::answer;

/// Points that a sweep of the lab may have: the command has no such bound.
const MOST_POINTS: usize = 1000;

/// `POST /sweep`: the sweep that JSON describes as a sweep's file does.
pub async fn sweep(State(lab): State<Arc<Lab>>, Json(asked): Json<Map<String, Value>>) -> Response {
    let sweep = match planned(&lab, asked) {
        Ok(sweep) => sweep,
        Err(error) => return (StatusCode::UNPROCESSABLE_ENTITY, lab.refusal(error)).into_response(),
    };
    answer(move |events, cancel| {
        let columns: Vec<Value> =
            sweep.columns().iter().map(|column| json!({ "name": column.name, "label": column.label })).collect();
        events
            .tell("columns", json!({ "columns": columns, "points": sweep.points(), "file": sweep.text() }).to_string());
        let workers = Workers { threads: lab.threads, cancel };
        let all: Vec<usize> = (0..sweep.points()).collect();
        let telling = Mutex::new(events);
        let ended = sweep.run(&all, &workers, lab.benches.memory(), |index, results| {
            let row = [sweep.point(index), results].concat();
            let events = telling.lock().unwrap_or_else(PoisonError::into_inner);
            events.tell("point", json!({ "index": index, "row": row }).to_string());
        });
        if let Ok(account) = ended {
            let notes: Vec<String> = account.notes.into_iter().map(|note| note.text).collect();
            events.tell("done", json!({ "notes": notes }).to_string());
        }
    })
}

/// The sweep, if it can be run here.
fn planned(lab: &Lab, mut asked: Map<String, Value>) -> Result<Sweep, InputError> {
    for (name, value) in &mut asked {
        let values = match value {
            Value::Array(values) => values.iter_mut().collect(),
            one => vec![one],
        };
        for value in values {
            let Value::String(text) = value else {
                if FILES.contains(&name.as_str()) {
                    check_no_file(name, "")?;
                }
                continue;
            };
            check_no_file(name, text)?;
            if name == "scene" && !is_builtin(text) {
                *text = lab.uploads.path_of(text)?;
            }
        }
    }
    let sweep = Sweep::from_json(Value::Object(asked))?;
    if sweep.of != Points::Arrays {
        return Err(InputError::new("the lab's sweeps are of arrays").help("`pcs-sim sweep` takes others"));
    }
    if sweep.points() > MOST_POINTS {
        let error = InputError::new(format!("has {} points, and the lab takes up to {MOST_POINTS}", sweep.points()));
        return Err(error.help("`pcs-sim sweep` takes more"));
    }
    Ok(sweep)
}

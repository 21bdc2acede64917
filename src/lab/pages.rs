//! The page's files, which are in the program.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use minijinja::{Environment, UndefinedBehavior, Value, context};
use pcs_sim::report::page::{self, PageError};

use super::Lab;
use super::controls;

/// The files, made once.
#[derive(Debug)]
pub struct Pages {
    lab: String,
    /// What draws a run, and how it looks: those of the pages that the command writes.
    view_script: String,
    view_style: String,
}

impl Pages {
    /// Makes them. `help` says what a parameter is.
    pub fn new(help: fn(&str) -> Option<String>) -> Result<Pages, PageError> {
        let mut environment = Environment::new();
        environment.set_undefined_behavior(UndefinedBehavior::Strict);
        let lab = environment.render_named_str(
            "lab.html",
            include_str!("page/lab.html"),
            context! {
                groups => controls::groups(help).iter().map(controls::Group::value).collect::<Vec<Value>>(),
                programs => serde_json::to_string(&controls::programs()).unwrap_or_default(),
                version => env!("CARGO_PKG_VERSION"),
            },
        );
        Ok(Pages {
            lab: lab.map_err(PageError::new)?,
            view_script: page::line_script()?,
            view_style: page::line_style(),
        })
    }
}

/// `GET /`: the page. What stands in its query its script asks for.
pub async fn lab(State(lab): State<Arc<Lab>>) -> Html<String> {
    Html(lab.pages.lab.clone())
}

/// `GET /FILE`: what the page is made of.
pub async fn file(State(lab): State<Arc<Lab>>, Path(name): Path<String>) -> Response {
    let (kind, text) = match name.as_str() {
        "lab.css" => ("text/css", include_str!("page/lab.css")),
        "controls.js" => ("text/javascript", include_str!("page/controls.js")),
        "runs.js" => ("text/javascript", include_str!("page/runs.js")),
        "sweep.js" => ("text/javascript", include_str!("page/sweep.js")),
        "lab.js" => ("text/javascript", include_str!("page/lab.js")),
        "charts.js" => ("text/javascript", page::CHART_SCRIPT),
        "charts.css" => ("text/css", page::CHART_STYLE),
        "theme.js" => ("text/javascript", page::THEME_SCRIPT),
        "theme.css" => ("text/css", page::THEME_STYLE),
        "view" => ("text/html", include_str!("page/view.html")),
        "run.js" => ("text/javascript", lab.pages.view_script.as_str()),
        "view.js" => ("text/javascript", include_str!("page/view.js")),
        "frame.css" => ("text/css", include_str!("page/frame.css")),
        "view.css" => ("text/css", lab.pages.view_style.as_str()),
        _ => return (StatusCode::NOT_FOUND, "the lab has no such page\n").into_response(),
    };
    ([(header::CONTENT_TYPE, format!("{kind}; charset=utf-8"))], text.to_owned()).into_response()
}

//! Errors as people see them.

use std::fmt::Write;
use std::io::IsTerminal;

use annotate_snippets::{AnnotationKind, Level, Origin, Renderer, Snippet};
use pcs_sim::error::{InputError, Place, Spot};
use pcs_sim::isa::Fault;
use pcs_sim::machine::Stuck;

use super::{Failure, is_dumb};

/// Longer source lines are cut down to this many characters around the fault.
const WIDEST_SOURCE: usize = 160;

/// Why a command failed, in lines.
pub fn drawn(failure: &Failure) -> String {
    text(failure, &renderer())
}

/// The same without colours.
pub fn plain(failure: &Failure) -> String {
    text(failure, &Renderer::plain())
}

fn text(failure: &Failure, renderer: &Renderer) -> String {
    match failure {
        Failure::Input(error) => draw(error, renderer) + "\n",
        Failure::Stuck(stuck) => draw_stuck(stuck),
        Failure::Fault(fault) => draw_fault(fault, renderer) + "\n",
        Failure::Output(message) => format!("error: {message}\n"),
        Failure::Differ => String::new(),
    }
}

/// Draws an error with its place: the line with a caret under the fault, or just the file.
fn draw(error: &InputError, renderer: &Renderer) -> String {
    let title = Level::ERROR.primary_title(error.message.as_str());
    let path = error.place.as_ref().map(|place| place.file.display().to_string()).unwrap_or_default();
    let excerpt = error.place.as_ref().and_then(excerpt);
    let mut group = match (&error.place, &excerpt) {
        (Some(_), Some(excerpt)) => {
            let annotation = AnnotationKind::Primary.span(excerpt.start..excerpt.end);
            let snippet = Snippet::source(excerpt.source.as_str()).line_start(excerpt.line).path(path.as_str());
            title.element(snippet.annotation(annotation))
        }
        (Some(Place { spot: Some(Spot::Byte { offset }), .. }), _) => {
            title.element(Origin::path(format!("{path}, byte {offset}")))
        }
        (Some(_), None) => title.element(Origin::path(path.as_str())),
        (None, _) => annotate_snippets::Group::with_title(title),
    };
    if let Some(help) = &error.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    renderer.render(&[group])
}

/// With colours on a terminal, unless it has none or the user wants none (<https://no-color.org>).
fn renderer() -> Renderer {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    match std::io::stderr().is_terminal() && !unwanted && !is_dumb() {
        true => Renderer::styled(),
        false => Renderer::plain(),
    }
}

/// The part of a source line that is shown, and where in it the fault is, in bytes.
struct Excerpt {
    line: usize,
    source: String,
    start: usize,
    end: usize,
}

fn excerpt(place: &Place) -> Option<Excerpt> {
    let Some(Spot::Text { line, column, width, source }) = &place.spot else { return None };
    let before = column.saturating_sub(1);
    let skipped = if source.chars().count() > WIDEST_SOURCE { before.saturating_sub(WIDEST_SOURCE / 4) } else { 0 };
    let source: String = source.chars().skip(skipped).take(WIDEST_SOURCE).collect();
    let byte = |char: usize| source.char_indices().nth(char).map_or(source.len(), |(at, _)| at);
    let (start, end) = (byte(before - skipped), byte(before - skipped + width));
    Some(Excerpt { line: *line, start, end, source })
}

/// Draws a fault of a cell's program: what is wrong, and the line of source that was executed.
fn draw_fault(fault: &Fault, renderer: &Renderer) -> String {
    let Fault { kind, cell, message, address, source } = fault;
    let title = format!("{kind}: cell {cell}, ray {message}, address {address}");
    let title = Level::ERROR.primary_title(title);
    let Some(source) = source else { return renderer.render(&[annotate_snippets::Group::with_title(title)]) };
    let path = source.path.display().to_string();
    let annotation = AnnotationKind::Primary.span(0..source.text.len());
    let snippet = Snippet::source(source.text.as_str()).line_start(source.line as usize).path(path.as_str());
    renderer.render(&[title.element(snippet.annotation(annotation))])
}

/// Draws a standstill: the chain of waits, one a line.
fn draw_stuck(stuck: &Stuck) -> String {
    let mut text = format!("error: {}\n", stuck.kind);
    for wait in &stuck.waits {
        let _ = writeln!(text, "  {wait}");
    }
    let _ = writeln!(text, "  = help: {}", stuck.help());
    text
}

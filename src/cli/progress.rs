//! The progress bar: on a terminal only.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{interrupt, is_dumb, is_quiet};

/// A bar that counts rays, with the time that is left. It draws on stderr, and only if that is a terminal.
pub fn rays(count: u64) -> ProgressBar {
    let bar = bar(count, "{prefix}tracing {human_pos} of {human_len} rays {wide_bar} {eta} left");
    interrupt::under_way(&bar, Some("rays"), None);
    bar
}

/// A bar that counts the points of a sweep.
pub fn points(count: u64) -> ProgressBar {
    let bar = bar(count, "{prefix}{human_pos} of {human_len} points {wide_bar} {eta} left");
    interrupt::under_way(&bar, Some("points"), Some("the same command goes on from there"));
    bar
}

/// The same for shards.
pub fn shards(count: u64) -> ProgressBar {
    let bar = bar(count, "{prefix}{human_pos} of {human_len} shards {wide_bar} {eta} left");
    interrupt::under_way(&bar, Some("shards"), None);
    bar
}

/// The same for the samples of an image, whose number is set later.
pub fn samples() -> ProgressBar {
    let bar = bar(0, "{prefix}{human_pos} of {human_len} samples {wide_bar} {eta} left");
    interrupt::under_way(&bar, Some("samples"), None);
    bar
}

/// A bar that has no end in sight.
pub fn waiting(message: &'static str) -> ProgressBar {
    let bar = drawn(ProgressBar::no_length()).with_style(style("{prefix}{spinner} {msg}")).with_message(message);
    bar.enable_steady_tick(Duration::from_millis(200));
    interrupt::under_way(&bar, None, None);
    bar
}

/// Progress in a line; `{prefix}` stands for what is seen above it.
fn bar(count: u64, template: &str) -> ProgressBar {
    drawn(ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::hidden())).with_style(style(template))
}

/// Lets a bar be seen, where that is wanted and lines can be drawn again.
fn drawn(bar: ProgressBar) -> ProgressBar {
    let hidden = is_quiet() || is_dumb();
    bar.set_draw_target(if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() });
    bar
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

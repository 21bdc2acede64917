//! One page that shows a run: it opens from disk, in any browser, and asks the network for nothing.

mod data;
mod window;

use base64::Engine;
use minijinja::{Environment, Value, context};

use super::bottleneck;
use super::losses::Losses;
use super::palette;
use super::plot::Caption;
use super::stats::Configuration;
use super::summary::{self, Rows};
use super::why;
use crate::measure::{Clock, CriticalPath, Measured, Profile, Recording, Shape};

/// What a page shows.
#[derive(Debug)]
pub struct Page<'a> {
    /// What ran.
    pub caption: &'a Caption,
    /// The machine's clock.
    pub clock: Clock,
    /// The whole run.
    pub stats: &'a Measured,
    /// What is lost against the busiest cell's work, if that is worth a word.
    pub losses: Option<&'a Losses>,
    /// The run over time.
    pub profile: &'a Profile,
    /// A window of it cycle by cycle, of which the page tells each moment.
    pub recording: Option<&'a Recording>,
    /// Why it took as long, if that was asked for.
    pub path: Option<&'a CriticalPath>,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    /// All parameters, if they are known.
    pub configuration: &'a Configuration,
    /// The picture that was traced, as PNG, if there is one.
    pub image: Option<&'a [u8]>,
}

/// A page could not be made.
#[derive(Debug, thiserror::Error)]
#[error("the page cannot be made: {0}")]
pub struct PageError(String);

/// What draws it: templates, as they name what the machine is made of.
const SCRIPTS: [&str; 8] = [
    include_str!("theme.js"),
    include_str!("window.js"),
    include_str!("array.js"),
    include_str!("charts.js"),
    include_str!("overview.js"),
    include_str!("space_time.js"),
    include_str!("moment.js"),
    include_str!("page.js"),
];

/// The page as HTML.
pub fn html(page: &Page<'_>) -> Result<String, PageError> {
    // Only of a line is it drawn who waits for whom.
    let recording = page.recording.filter(|recording| recording.topology.shape == Shape::Line);
    let page = &Page { recording, ..*page };
    let mut environment = Environment::new();
    environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
    environment.add_template("page.html", include_str!("page.html")).map_err(|error| PageError(error.to_string()))?;
    let json = |value: serde_json::Result<String>| value.map_err(|error| PageError(error.to_string()));
    let data = json(serde_json::to_string(&data::Data::new(page)))?;
    let configuration = json(serde_json::to_string_pretty(page.configuration))?;
    let topology = &*page.stats.topology;
    let called = context! {
        is_line => topology.shape == Shape::Line,
        has_buses => topology.shape == Shape::Farm,
        machine_name => topology.names.machine.as_str(),
        station => topology.names.station.as_str(),
        job => topology.names.job.as_str(),
    };
    // The engine leaves a last end of line out.
    let script = |text: &str| environment.render_str(text, &called).map(|script| script + "\n");
    let scripts: Result<Vec<String>, _> = SCRIPTS.iter().map(|text| script(text)).collect();
    let scripts = scripts.map_err(|error| PageError(error.to_string()))?;
    let template = environment.get_template("page.html").map_err(|error| PageError(error.to_string()))?;
    let rendered = template.render(context! {
        title => page.caption.what_ran(),
        machine => page.caption.machine.as_str(),
        speed => summary::speed(page.stats, page.clock),
        bottleneck => bottleneck::sentence(page.stats),
        losses => page.losses.map(|losses| losses.sentence(page.stats, page.clock)).unwrap_or_default(),
        cells => value(summary::cell_rows(page.stats, page.cell_names)),
        fifos => value(summary::fifo_rows(page.stats)),
        state_colors => state_colors(page.stats),
        has_window => page.recording.is_some(),
        why => page.path.map(|path| context! {
            sentence => why::sentence(path),
            subject_to => why::subject_to(path),
            times => value(why::time_rows(path, false)),
            places => value(why::place_rows(path)),
        }),
        configuration,
        image => page.image.map(|png| base64::engine::general_purpose::STANDARD.encode(png)).unwrap_or_default(),
        // No text in it may end the script that it stands in.
        data => data.replace('<', "\\u003c"),
        chart_style => include_str!("../../../assets/uplot.min.css"),
        chart_script => include_str!("../../../assets/uplot.min.js"),
        style => include_str!("page.css"),
        scripts,
        version => env!("CARGO_PKG_VERSION"),
        ..called.clone()
    });
    rendered.map_err(|error| PageError(error.to_string()))
}

/// Two pages beside one another, whose charts show the same time. What they are of should have one length: see
/// [`Profile::extended`].
pub fn side_by_side(a: &str, b: &str) -> Result<String, PageError> {
    let rendered =
        Environment::new().render_str(include_str!("pair.html"), context! { runs => [a.to_owned(), b.to_owned()] });
    rendered.map(|page| page + "\n").map_err(|error| PageError(error.to_string()))
}

/// The colours of the states that the cells' table has, on white and on black.
fn state_colors(run: &Measured) -> Vec<[String; 2]> {
    let states = &run.topology.states;
    states.used().map(|state| palette::on_both(palette::of_state(states, state))).collect()
}

/// A table as the template reads it.
fn value(table: Rows) -> Value {
    context! { header => table.header, rows => table.rows }
}

//! One page that shows a run: it opens from disk, in any browser, and asks the network for nothing.

mod data;
mod looks;
mod packed;
mod sides;
mod window;

use base64::Engine;
use minijinja::{Environment, Value, context};

use super::bottleneck;
use super::links;
use super::losses::Losses;
use super::palette;
use super::plot::Caption;
use super::stats::Configuration;
use super::summary::{self, Rows};
use super::why;
use crate::measure::{Clock, CriticalPath, Measured, Profile, Recording, Shape, Topology};
use crate::run::Setup;

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
    /// What the run was made of, of which the page shows what single rays come to; none if there is no scene.
    pub setup: Option<&'a Setup>,
}

/// A page could not be made.
#[derive(Debug, thiserror::Error)]
#[error("the page cannot be made: {0}")]
pub struct PageError(String);

impl PageError {
    /// Why, in a sentence.
    pub fn new(error: impl std::fmt::Display) -> PageError {
        PageError(error.to_string())
    }
}

/// What draws it: templates, as they name what the machine is made of.
const SCRIPTS: [&str; 12] = [
    include_str!("theme.js"),
    include_str!("window.js"),
    include_str!("array.js"),
    include_str!("charts.js"),
    include_str!("overview.js"),
    include_str!("space_time.js"),
    include_str!("moment.js"),
    include_str!("steps.js"),
    include_str!("store.js"),
    include_str!("ray.js"),
    include_str!("stepper.js"),
    include_str!("page.js"),
];

/// The page as HTML.
pub fn html(page: &Page<'_>) -> Result<String, PageError> {
    let page = &of_line(page);
    let data = data(page)?;
    let names = names(&page.stats.topology);
    environment()?
        .get_template("page.html")
        .and_then(|template| {
            template.render(context! {
                // No text in it may end the script that it stands in.
                data => data.replace('<', "\\u003c"),
                chart_style => CHART_STYLE,
                chart_script => CHART_SCRIPT,
                style => STYLE,
                script => script(&page.stats.topology)?,
                ..run_context(page, &names)
            })
        })
        .map_err(PageError::new)
}

/// What a page shows of one run: its text as HTML, and the data that its script ([`line_script`]) draws, as JSON.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What stands in the page's `main`.
    pub body: String,
    /// What the script's `show` takes.
    pub data: String,
}

/// What a page that is open already shows of a run in place of another.
pub fn shown(page: &Page<'_>) -> Result<Shown, PageError> {
    let page = &of_line(page);
    let names = names(&page.stats.topology);
    let body = environment()?.get_template("run.html").and_then(|run| run.render(run_context(page, &names)));
    Ok(Shown { body: body.map_err(PageError::new)?, data: data(page)? })
}

/// The beginning of a recording as JSON, for a page that steps through it.
pub fn window(recording: &Recording) -> Result<String, PageError> {
    serde_json::to_string(&window::Window::new(recording)).map_err(PageError::new)
}

/// A ray's way through the scene as JSON, for a page that shows it: of the ray with that number in the order in which they are sent.
/// `null` if there is none.
pub fn look(setup: &Setup, ray: u32) -> Result<String, PageError> {
    serde_json::to_string(&looks::LookedAt::new(setup, ray)).map_err(PageError::new)
}

/// What the rays of a recording's beginning come to as JSON, for a page whose data were made without a [`Page::setup`]: it takes
/// longer than all else.
pub fn looks(setup: &Setup, recording: &Recording) -> Result<String, PageError> {
    serde_json::to_string(&looks::Looks::new(setup, recording, window::end(recording))).map_err(PageError::new)
}

/// The instructions that a cell executes for a ray as JSON, for a page that steps through them. `null` if cells run no programs.
pub fn instructions(setup: &Setup, cell: usize, ray: u32) -> Result<String, PageError> {
    let sent = setup.prepared.rays.get(ray as usize).filter(|_| setup.workload.executable(cell).is_some());
    let steps = sent.map(|sent| setup.workload.instructions(cell, ray, sent, looks::MOST_STEPS));
    serde_json::to_string(&steps.map(|steps| looks::Steps::new(&steps))).map_err(PageError::new)
}

/// What a page that shows runs of a row of cells, one in place of another, is drawn by.
pub fn line_script() -> Result<String, PageError> {
    let script = script(&Topology::default()).map_err(PageError::new)?;
    Ok(format!("{CHART_SCRIPT}\n{script}"))
}

/// How it looks.
pub fn line_style() -> String {
    format!("{CHART_STYLE}\n{STYLE}")
}

/// What the pages' charts are drawn by.
pub const CHART_SCRIPT: &str = include_str!("../../../assets/uplot.min.js");

/// How its charts look.
pub const CHART_STYLE: &str = include_str!("../../../assets/uplot.min.css");

/// The colours of pages on white and on black, and what scripts make of them.
pub const THEME_SCRIPT: &str = include_str!("theme.js");

/// The same for what is not drawn by scripts.
pub const THEME_STYLE: &str = include_str!("theme.css");

const STYLE: &str = concat!(include_str!("theme.css"), include_str!("page.css"), include_str!("stepper.css"));

/// Only of a line is it drawn who waits for whom.
fn of_line<'a>(page: &Page<'a>) -> Page<'a> {
    let recording = page.recording.filter(|recording| recording.topology.shape == Shape::Line);
    Page { recording, ..*page }
}

fn environment() -> Result<Environment<'static>, PageError> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
    for (name, text) in [("page.html", include_str!("page.html")), ("run.html", include_str!("run.html"))] {
        environment.add_template(name, text).map_err(PageError::new)?;
    }
    Ok(environment)
}

fn data(page: &Page<'_>) -> Result<String, PageError> {
    serde_json::to_string(&data::Data::new(page)).map_err(PageError::new)
}

/// What the templates call the parts of a machine.
fn names(topology: &Topology) -> Value {
    context! {
        is_line => topology.shape == Shape::Line,
        has_buses => topology.shape == Shape::Farm,
        is_cube => topology.shape == Shape::Cube,
        machine_name => topology.names.machine.as_str(),
        station => topology.names.station.as_str(),
        fifo => topology.names.fifo.as_str(),
        word => topology.names.word.as_str(),
        job => topology.names.job.as_str(),
    }
}

/// The scripts of pages of such a machine.
fn script(topology: &Topology) -> Result<String, minijinja::Error> {
    let (environment, names) = (Environment::new(), names(topology));
    // The engine leaves a last end of line out.
    let scripts = SCRIPTS.iter().map(|text| environment.render_str(text, &names).map(|script| script + "\n"));
    scripts.collect::<Result<String, _>>()
}

/// What the template of a run reads.
fn run_context(page: &Page<'_>, names: &Value) -> Value {
    context! {
        title => page.caption.what_ran(),
        machine => page.caption.machine.as_str(),
        speed => summary::speed(page.stats, page.clock),
        bottleneck => bottleneck::sentence(page.stats),
        losses => page.losses.map(|losses| losses.sentence(page.stats, page.clock)).unwrap_or_default(),
        cells => value(summary::cell_rows(page.stats, page.cell_names)),
        fifos => value(summary::fifo_rows(page.stats)),
        links => (page.stats.topology.shape == Shape::Cube).then(|| value(links::rows(page.stats, page.clock))),
        state_colors => state_colors(page.stats),
        has_window => page.recording.is_some(),
        why => page.path.map(|path| context! {
            sentence => why::sentence(path),
            subject_to => why::subject_to(path),
            times => value(why::time_rows(path, false)),
            places => value(why::place_rows(path)),
        }),
        configuration => serde_json::to_string_pretty(page.configuration).unwrap_or_default(),
        image => page.image.map(|png| base64::engine::general_purpose::STANDARD.encode(png)).unwrap_or_default(),
        version => env!("CARGO_PKG_VERSION"),
        ..names.clone()
    }
}

/// Two pages beside one another, whose charts show the same time. What they are of should have one length: see
/// [`Profile::extended`].
pub fn side_by_side(a: &str, b: &str) -> Result<String, PageError> {
    let rendered =
        Environment::new().render_str(include_str!("pair.html"), context! { runs => [a.to_owned(), b.to_owned()] });
    rendered.map(|page| page + "\n").map_err(PageError::new)
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

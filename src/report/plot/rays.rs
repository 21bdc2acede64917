//! When rays are done, and how long they take.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, rgb};
use super::render::{Drawn, Figure};
use crate::measure::{Clock, Latency, Names};
use crate::report::palette;
use crate::report::summary;
use crate::report::time_unit::TimeUnit;

/// Height of these two figures, in panels of the others.
const PANELS: usize = 3;

/// Rays done over time.
pub struct Rays<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    /// What a ray is called.
    pub called: &'a Names,
    pub rays: &'a [u64],
}

impl Figure for Rays<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(PANELS)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let job = &self.called.job;
        let told = format!("{job}s done per unit of simulated time");
        let what = format!("{}s done over time", capital(job));
        let panels = chart::panels(area, self.caption, &what, &[(&told, palette::AMOUNT)], 1)?;
        let rate =
            |(index, &rays): (usize, &u64)| rays as f64 / (self.scale.cycles_of(index) as f64 * self.scale.cycle);
        let rates: Vec<f64> = self.rays.iter().enumerate().map(rate).collect();
        let top = rates.iter().copied().fold(0.0, f64::max) * 1.1;
        let mean = self.rays.iter().sum::<u64>() as f64 / self.scale.end();
        let unit = self.scale.unit.name;
        let name = format!("on average {mean:.3} {job}s per {unit}");
        let mut chart = chart::builder(&panels[0], &name, true)
            .build_cartesian_2d(0.0..self.scale.end(), 0.0..top.max(f64::MIN_POSITIVE))?;
        chart::axes(&mut chart, (Some(&self.scale.label()), &format!("{job}s per {unit}")), 8, &chart::number)?;
        let color = rgb(palette::AMOUNT);
        let steps = self.scale.steps(rates.into_iter(), chart::grain(top.max(f64::MIN_POSITIVE)) / PANELS as f64);
        chart.draw_series(AreaSeries::new(steps, 0.0, color.mix(0.35)).border_style(color))?;
        let line = [(0.0, mean), (self.scale.end(), mean)];
        chart.draw_series(DashedLineSeries::new(line, 6, 4, BLACK.into()))?;
        Ok(())
    }
}

/// How long rays take.
pub struct Latencies<'a> {
    pub caption: &'a Caption,
    pub clock: Clock,
    /// What a ray is called.
    pub called: &'a Names,
    pub latency: &'a Latency,
}

impl Figure for Latencies<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(PANELS)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let Names { job, job_time, .. } = self.called;
        let told = format!("share of the {job}s, as the area of the bars");
        let what = format!("How long {job}s take, {job_time}");
        let panels = chart::panels(area, self.caption, &what, &[(&told, palette::AMOUNT)], 1)?;
        let latency = self.latency;
        let unit = TimeUnit::of(self.clock.seconds(latency.max));
        let time = |bucket: usize| self.clock.seconds(Latency::start_of(bucket)) / unit.seconds;
        let share = |count: u64| 100.0 * count as f64 / latency.jobs.max(1) as f64;
        // Buckets differ in width: the areas, not the heights, compare.
        let density = |(bucket, &count): (usize, &u64)| share(count) / (time(bucket + 1) - time(bucket));
        let densities: Vec<f64> = latency.buckets.iter().enumerate().map(density).collect();
        let top = densities.iter().copied().fold(0.0, f64::max) * 1.1;
        let mut chart = chart::builder(&panels[0], &self.figures(), true).build_cartesian_2d(
            0.0..time(latency.buckets.len()).max(f64::MIN_POSITIVE),
            0.0..top.max(f64::MIN_POSITIVE),
        )?;
        let (across, up) = (format!("latency ({})", unit.name), format!("% of the {job}s per {}", unit.name));
        chart::axes(&mut chart, (Some(&across), &up), 8, &chart::number)?;
        let bars = densities.iter().enumerate().filter(|(_, density)| **density > 0.0).map(|(bucket, &density)| {
            Rectangle::new([(time(bucket), 0.0), (time(bucket + 1), density)], rgb(palette::AMOUNT).filled())
        });
        chart.draw_series(bars)?;
        Ok(())
    }
}

impl Latencies<'_> {
    fn figures(&self) -> String {
        let latency = self.latency;
        let time = |cycles| summary::time(self.clock.seconds(cycles));
        format!(
            "shortest {}, mean {}, half within {}, 99 % within {}, longest {}",
            time(latency.min),
            summary::time(self.clock.seconds_of(latency.mean())),
            time(latency.quantile(0.5)),
            time(latency.quantile(0.99)),
            time(latency.max),
        )
    }
}

/// With a capital letter.
fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

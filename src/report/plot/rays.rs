//! When rays are done, and how long they take.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, font, rgb};
use super::render::{Drawn, Figure};
use super::scale::Scale;
use crate::measure::{Clock, Latency, Names};
use crate::quantities::Cycles;
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
        let across = 0.0..self.scale.end();
        let mut chart = chart::builder(&panels[0], &name, true, &across)
            .build_cartesian_2d(across, 0.0..top.max(f64::MIN_POSITIVE))?;
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
        let told = format!("share of the {job}s that take no longer");
        let what = format!("How long {job}s take, {job_time}");
        let panels = chart::panels(area, self.caption, &what, &[(&told, palette::AMOUNT)], 1)?;
        let latency = self.latency;
        let unit = TimeUnit::of(self.clock.seconds(latency.max));
        let time = |cycles: Cycles| self.clock.seconds(cycles) / unit.seconds;
        // From the shortest to the longest, with a tenth of air, and over a cycle at the least.
        let (low, high) = (time(latency.min.max(Cycles(1))) / 1.1, time(latency.max.max(Cycles(2))) * 1.1);
        let scale = Scale::logarithmic(low, high);
        let mut chart = chart::builder(&panels[0], &self.figures(), true, &(low..high))
            .build_cartesian_2d(scale.clone(), 0.0..100.0)?;
        let mut mesh = chart.configure_mesh();
        let name = |tick: &f64| scale.name_of(*tick);
        mesh.max_light_lines(1).x_label_formatter(&name).y_label_formatter(&chart::number).y_labels(11);
        mesh.label_style(font(chart::SMALL)).axis_desc_style(font(chart::SMALL));
        let rounded = if self.is_rounded() { ", rounded up by 3 % at most" } else { "" };
        mesh.x_desc(format!("latency ({}), logarithmic{rounded}", unit.name))
            .y_desc(format!("% of the {job}s"))
            .draw()?;
        let steps: Vec<(f64, f64)> = self.steps().into_iter().map(|(at, share)| (time(at), share)).collect();
        chart.draw_series(LineSeries::new(steps, rgb(palette::AMOUNT).stroke_width(2)))?;
        Ok(())
    }
}

impl Latencies<'_> {
    /// The share of the jobs that take no longer than each time, in percent: steps at the ends of the buckets.
    fn steps(&self) -> Vec<(Cycles, f64)> {
        let Latency { jobs, min, max, buckets, .. } = self.latency;
        let mut steps = vec![((*min).max(Cycles(1)), 0.0)];
        let (mut done, mut share) = (0, 0.0);
        for (bucket, &count) in buckets.iter().enumerate().filter(|(_, count)| **count > 0) {
            let end = Latency::last_of(bucket).clamp((*min).max(Cycles(1)), *max);
            done += count;
            steps.push((end, share));
            share = 100.0 * done as f64 / (*jobs).max(1) as f64;
            steps.push((end, share));
        }
        steps
    }

    /// Whether any lie in buckets of several latencies, so that only these are known.
    fn is_rounded(&self) -> bool {
        let buckets = self.latency.buckets.iter().enumerate();
        let mut filled = buckets.filter(|(_, count)| **count > 0).map(|(bucket, _)| bucket);
        filled.any(|bucket| Latency::last_of(bucket) > Latency::start_of(bucket))
    }

    /// A quantile is told by the bounds of its bucket, where these do not look alike.
    fn figures(&self) -> String {
        let latency = self.latency;
        let time = |cycles| summary::time(self.clock.seconds(cycles));
        let quantile = |share| {
            let (least, most) = latency.quantile(share);
            let (least, most) = (time(least), time(most));
            if least == most { most } else { format!("{least} to {most}") }
        };
        format!(
            "shortest {}, mean {}, median {}, 99 % within {}, longest {}",
            time(latency.min),
            summary::time(self.clock.seconds_of(latency.mean())),
            quantile(0.5),
            quantile(0.99),
            time(latency.max),
        )
    }
}

/// With a capital letter.
pub fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

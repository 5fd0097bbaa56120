//! Progress on stderr: a bar on a terminal, now and then a line elsewhere.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::layout::Layout;
use crate::schedule::Schedule;

/// Simulated time between two plain lines.
const LINE_PERIOD_S: f64 = 10.0;
/// Simulated time between two updates of the bar.
const BAR_PERIOD_S: f64 = 0.1;

pub struct Progress {
    bar: Option<ProgressBar>,
    /// Simulated time at which the run should end, as far as is known.
    end_s: f64,
    next_s: f64,
}

impl Progress {
    pub fn new(stop_time_s: f64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:20} {msg}, {eta} left");
            ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr())
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, end_s: stop_time_s, next_s: 0.0 }
    }

    pub fn row(&mut self, schedule: &Schedule, layout: &Layout, row: &[f64]) {
        let time_s = row[0];
        if time_s < self.next_s {
            return;
        }
        let phase = layout.scalar(row, "phase");
        let phase = schedule.code_name("phase", phase).unwrap_or("?").replace('_', " ");
        let altitude_m = layout.scalar(row, "altimeter_m");
        let state = format!("{time_s:5.1} s, altitude {altitude_m:6.1} m, {phase}");
        match &self.bar {
            None => {
                self.next_s = time_s + LINE_PERIOD_S;
                // Nobody has to listen.
                let _ = writeln!(std::io::stderr(), "{state}");
            }
            Some(bar) => {
                self.next_s = time_s + BAR_PERIOD_S;
                // Guidance knows when its plan ends; before the first only the stop time is sure.
                let to_go_s = layout.scalar(row, "plan_time_to_go_s");
                if to_go_s > 0.0 {
                    self.end_s = time_s + to_go_s;
                }
                bar.set_message(state);
                bar.set_length((self.end_s.max(time_s) * 1e3) as u64);
                bar.set_position((time_s * 1e3) as u64);
            }
        }
    }

    /// Removes the bar.
    pub fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Progress over a known number of equal pieces of work, from any thread.
pub struct Count {
    what: &'static str,
    total: u64,
    bar: ProgressBar,
    /// With stderr no terminal: start, and when to say the next line.
    lines: Option<(Instant, Mutex<Instant>)>,
}

/// Time between two plain lines of a `Count`.
const COUNT_LINE_PERIOD: Duration = Duration::from_secs(10);

impl Count {
    pub fn new(what: &'static str, total: usize) -> Self {
        let total = total as u64;
        let terminal = std::io::stderr().is_terminal();
        let target =
            if terminal { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let style =
            ProgressStyle::with_template("{bar:20} {pos}/{len} {msg}, {per_sec}, {eta} left");
        let bar = ProgressBar::with_draw_target(Some(total), target)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_message(what);
        let now = Instant::now();
        let lines = (!terminal).then(|| (now, Mutex::new(now + COUNT_LINE_PERIOD)));
        Self { what, total, bar, lines }
    }

    pub fn one_more(&self) {
        self.bar.inc(1);
        let Some((start, next)) = &self.lines else { return };
        // Whoever holds the lock says the line.
        let Ok(mut next) = next.try_lock() else { return };
        if Instant::now() < *next {
            return;
        }
        *next = Instant::now() + COUNT_LINE_PERIOD;
        let (done, total) = (self.bar.position(), self.total);
        let rate = done as f64 / start.elapsed().as_secs_f64();
        let left_s = (total - done) as f64 / rate;
        // Nobody has to listen.
        let _ = writeln!(
            std::io::stderr(),
            "{done}/{total} {}, {rate:.3}/s, {left_s:.0} s left",
            self.what
        );
    }

    /// Removes the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

//! Fig. 7: trajectories of the Monte Carlo, nominal, with a failure mode, and the undisturbed reference.

use std::ops::ControlFlow;

use lander_models::signals::POSITION_W;
use lander_models::{ModelError, Scenario};
use rayon::prelude::*;

use super::drawing::key;
use super::flights::{CLOSED_LOOP, Flown, OPEN_LOOP};
use super::{Error, Inputs};
use crate::flight;
use crate::report::Figure;
use crate::study::run::World;
use crate::svg::{Frame, picture};

/// Drawn runs without a failure mode, the first ones; and with one, at most.
const NOMINAL: usize = 60;
const FAILED: usize = 30;
/// Between two points of a path, s.
const DRAWN_S: f64 = 0.25;

const REFERENCE: &str = include_str!("../../../../models/scenarios/landing.toml");
const COLOURS: [(&str, &str); 3] =
    [("without failure", "#38a169"), ("failure mode", "#dd6b20"), ("undisturbed", "#2b6cb0")];

type Path = Vec<[f64; 4]>;

/// Time and position of O along a flight.
fn path(flown: &Flown, truth: flight::World, believed: flight::World) -> Path {
    let (mut path, mut next_s) = (Vec::new(), 0.0);
    let columns = &flown.columns;
    // A flight that a component breaks off is drawn up to there.
    let _ = flight::fly(&columns.schedule, truth, believed, |row| {
        if row[0] >= next_s {
            next_s = row[0] + DRAWN_S;
            let [x, y, z] = columns.layout.vector(row, POSITION_W.name).unwrap_or_default();
            path.push([row[0], x, y, z]);
        }
        Ok::<_, ModelError>(ControlFlow::Continue(()))
    });
    path
}

fn pair(world: &World) -> flight::World<'_> {
    (&world.scenario, &world.vehicle)
}

/// The drawn runs of a scheme, each with its index into `COLOURS`.
fn paths(flown: &Flown, inputs: &Inputs) -> Result<Vec<(usize, u64, Path)>, Error> {
    let failed = |run: &usize| flown.failures.get(*run) != "none";
    let all = 0..flown.runs();
    let mut drawn: Vec<(usize, u64)> =
        all.clone().filter(|run| !failed(run)).take(NOMINAL).map(|run| (0, run as u64)).collect();
    drawn.extend(all.filter(failed).take(FAILED).map(|run| (1, run as u64)));
    let one = |(kind, number): (usize, u64)| {
        let run = flown.study.run(number)?;
        let path = path(flown, pair(&run.truth), pair(&run.believed));
        Ok((kind, number, path))
    };
    let found: Vec<Result<_, Error>> = drawn.into_par_iter().map(one).collect();
    let mut found: Vec<_> = found.into_iter().collect::<Result<_, _>>()?;
    let reference = Scenario::parse("landing.toml".as_ref(), REFERENCE, &inputs.bug)?;
    let world = (&reference, &inputs.bug);
    found.push((2, 0, path(flown, world, world)));
    Ok(found)
}

/// # Errors
/// A run that can't be drawn again.
pub fn figure(inputs: &Inputs) -> Result<Figure, Error> {
    let (mut parts, mut csv) = (String::new(), "guidance,kind,run,time_s,x_m,y_m,z_m\n".to_owned());
    for (column, (name, scheme)) in
        [("this kit's closed loop", CLOSED_LOOP), ("open loop", OPEN_LOOP)].into_iter().enumerate()
    {
        let Some(flown) = inputs.flights.of(scheme) else { continue };
        let left = 65.0 + 450.0 * column as f64;
        let side = Frame {
            left,
            top: 64.0,
            width: 380.0,
            height: 260.0,
            x: [-60.0, 360.0],
            y: [0.0, 560.0],
        };
        let near = Frame {
            left,
            top: 384.0,
            width: 380.0,
            height: 260.0,
            x: [-60.0, 60.0],
            y: [-45.0, 45.0],
        };
        for (kind, run, path) in paths(flown, inputs)? {
            for [t, x, y, z] in &path {
                csv += &format!("{name},{},{run},{t},{x},{y},{z}\n", COLOURS[kind].0);
            }
            let width = if kind == 2 { 2.2 } else { 0.8 };
            let style = format!(
                "stroke=\"{}\" stroke-width=\"{width}\" stroke-opacity=\"0.8\"",
                COLOURS[kind].1
            );
            let from_side: Vec<[f64; 2]> = path.iter().map(|[_, x, _, z]| [*x, *z]).collect();
            let from_above: Vec<[f64; 2]> = path.iter().map(|[_, x, y, _]| [*x, *y]).collect();
            parts += &side.path(&from_side, &style);
            parts += &near.path(&from_above, &style);
            if let Some(end) = from_above.last()
                && end[0].abs() < 60.0
                && end[1].abs() < 45.0
            {
                parts += &near.dot(*end, 2.4, COLOURS[kind].1);
            }
        }
        parts += &side.axes(name, "east of the target, m", "height, m");
        parts += &near.axes("near the target, from above", "east, m", "north, m");
        if column == 0 {
            for (index, (words, colour)) in COLOURS.into_iter().enumerate() {
                parts += &key(&Frame { top: 36.0, ..side }, index, words, colour);
            }
        }
    }
    Ok(Figure {
        name: "trajectories".to_owned(),
        caption: format!(
            "Fig. 7 (fig:mc_cl_trajectories): the first {NOMINAL} landings without a failure \
             mode and up to {FAILED} with one, and the undisturbed reference, in six degrees of \
             freedom; dots: where they came to rest."
        ),
        svg: picture(930.0, 695.0, &parts),
        csv,
    })
}

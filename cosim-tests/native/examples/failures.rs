//! `cargo run --release -p cosim --example failures`: how landings with a failure on board end, with
//! guidance that looks for failures and without. The table of guidance-fmu/README.md.

use std::error::Error;

use cosim::failures::{Ending, FAILURES, campaign};
use cosim::statistics::spread::Spread;
use lander_models::Vehicle;

fn main() -> Result<(), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref())?;
    println!("| failure | declared after, s | landed | down, m/s | tilt, deg | miss, m |");
    println!("|---|---|---|---|---|---|");
    for failure in &FAILURES {
        let [without, with] = [false, true].map(|response| campaign(failure, response, &vehicle));
        let (without, with) = (without?, with?);
        let landed = |endings: &[Ending]| endings.iter().filter(|ending| ending.landed).count();
        let pair = |of: fn(&Ending) -> f64| {
            let median = |endings: &[Ending]| Spread::of(endings.iter().map(of)).p50;
            format!("{:.2} / {:.2}", median(&with), median(&without))
        };
        let declared = Spread::of(with.iter().map(|ending| ending.declared_after_s));
        println!(
            "| {} | {:.2} | {} / {} of {} | {} | {} | {} |",
            failure.name,
            declared.p50,
            landed(&with),
            landed(&without),
            with.len(),
            pair(|ending| ending.down_m_s),
            pair(|ending| ending.tilt_deg),
            pair(|ending| ending.miss_m),
        );
    }
    Ok(())
}

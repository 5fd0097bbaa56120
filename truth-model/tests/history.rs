//! What landers did, and whether the model puts it in the same order. Nothing here is tuned.
#[path = "common/contact.rs"]
mod contact;

use contact::{Contact, EARTH_M_S2, vehicle};
use lander_models::Outcome;
use nalgebra::Vector3;

#[test]
fn probe_a15() {
    let lm = Contact { friction: 0.4, down_m_s: 2.07, slope_deg: 11.0, yaw_deg: 45.0, across_m_s: -0.37, ..Contact::of(vehicle("apollo-lm"), 349.0) };
    for (yaw, fr, v) in [(45.0, 0.4, 2.07), (45.0, 0.7, 2.07), (0.0, 0.4, 2.07), (45.0, 0.4, 1.5)] {
        let c = Contact { yaw_deg: yaw, friction: fr, down_m_s: v, ..lm.clone() };
        let mut peak = 0.0f64;
        let s = c.run(30.0, |_, s| peak = peak.max(s.motion.rate_b.norm()));
        println!("{yaw} {fr} {v}: {:?} t {} peak {:.1} deg/s margin {:?} stroke {:?} slide {} rest tilt {:.2} legs {:?}", s.touchdown.outcome, s.now.seconds(), peak.to_degrees(), s.touchdown.margin_j, s.touchdown.peak_stroke_m, s.touchdown.slide_m,
            lander_models::frames::tilt_rad(&s.motion.attitude_wb).to_degrees(), s.legs.iter().map(|l| l.crushed_m).collect::<Vec<_>>());
    }
    let c = Contact { down_m_s: 0.52, across_m_s: 0.64, ..Contact::of(vehicle("apollo-lm"), 349.0) };
    let s = c.run(30.0, |_, _| {});
    println!("A11 {:?} {:?}", s.touchdown, s.legs);
}
#[test]
fn probe_surveyor() {
    for g in [1.625] {
        let c = Contact { gravity_m_s2: g, down_m_s: 3.048, friction: 0.6, ..Contact::of(vehicle("surveyor"), 2.9) };
        let (mut up, mut clear) = (0.0f64, 0.0f64);
        let s = c.run(30.0, |m, s| { if s.touchdown.first.is_some() { up = up.max(s.motion.velocity_w.z); clear = clear.max(m.lowest_m(s)); } });
        println!("S1 {:?} up {up} clear {clear} {:?}", s.touchdown, s.now);
    }
    for v in [1.0, 1.8, 2.5] {
    let c = Contact { down_m_s: v, across_m_s: 0.9, thrust_n: 0.9 * 299.0 * 1.625, friction: 0.6, ..Contact::of(vehicle("surveyor"), 10.0) };
    let (mut contacts, mut was, mut clear) = (0, false, 0.0f64);
    let mut times = vec![];
    let s = c.run(34.0, |m, s| { let d = s.feet_down.contains(&true); if d && !was { contacts += 1; times.push(s.now.0) } was = d; if s.touchdown.first.is_some() { clear = clear.max(m.lowest_m(s)); }});
    println!("S3 {v} {:?} contacts {contacts} clear {clear} {:?} thrust {} tilt {:.2} {times:?}", s.touchdown.outcome, s.now, s.motion.thrust_n, lander_models::frames::tilt_rad(&s.motion.attitude_wb).to_degrees());
    }
}
#[test]
fn probe_langley() {
    let base = Contact { gravity_m_s2: EARTH_M_S2, ..Contact::of(vehicle("langley-sixth-scale"), 0.1) };
    let t = std::time::Instant::now();
    let mut n = 0;
    for yaw in [0.0, 45.0] { for fr in [0.4, 0.7, 0.85, 1.0] { for down in [1.5, 2.25, 3.0] {
        print!("yaw {yaw} mu {fr} down {down}: ");
        for pitch in [-15.0, 0.0, 15.0] { for across in [0.0, 0.75, 1.5, 2.25, 3.0] {
            let c = Contact { yaw_deg: yaw, friction: fr, down_m_s: down, across_m_s: across, pitch_deg: pitch, ..base.clone() };
            let s = c.run(3.0, |_, _| {});
            n += 1;
            print!("{}", match s.touchdown.outcome { Outcome::Landed => 'l', Outcome::Tipped => 'T', Outcome::Struck => 's', Outcome::Slid => 'd', Outcome::InFlight => '?', _ => 'x' });
        } print!(" "); }
        println!();
    }}}
    println!("{n} runs {:?}", t.elapsed());
    let _ = Vector3::<f64>::zeros();
}

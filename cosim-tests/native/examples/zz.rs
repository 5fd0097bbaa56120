use lander_models::scenario::ContactEngine;
use lander_models::*;
fn main() {
    let v = Vehicle::load("models/vehicles/bug.toml".as_ref()).unwrap();
    for (row, mu) in [
        ([10.0, 1.625, 2.0, 2.0, 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.2, 0.], 0.2),
        ([10.0, 1.625, 1.0, 1.0, 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.05, 0.], 0.05),
    ] {
        for e in [ContactEngine::Rapier, ContactEngine::Strut] {
            for r in [1, 4] {
                let m = cosim::touchdowns::model(&v, e, Ticks(30000), &row).unwrap();
                let mut sc = m.scenario().clone();
                sc.contact_refinement = r;
                let m = truth_model::TruthModel::new(sc, v.clone());
                let mut s = m.initial_state();
                let v0 = m.com_velocity_w(&s.motion);
                print!("{e:?} {r} ");
                for t in 1..=600 {
                    m.tick(&mut s).unwrap();
                    if [5, 10, 20, 40, 60, 100, 200, 400, 600].contains(&t) {
                        let c = m.com_velocity_w(&s.motion);
                        let due = mu * (c.z - v0.z + 1.625 * 1e-3 * t as f64);
                        print!(" {t}: {:.5}/{:.5}", v0.x - c.x, due);
                    }
                }
                println!();
            }
        }
    }
}

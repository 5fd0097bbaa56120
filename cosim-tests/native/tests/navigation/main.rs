//! The navigation filter beside the truth's sensors.

mod flight;

use flight::{CORE, Flight, drawn};

#[test]
fn explore() {
    let runs = 40;
    let seconds = 24;
    let mut nees = vec![Vec::new(); seconds + 1];
    let mut parts = vec![[0.0; 5]; seconds + 1];
    let mut nis = [[0.0f64; 3]; 6];
    for seed in 1..=runs {
        let mut flight = Flight::new(drawn(seed));
        for k in 0..=seconds * 100 {
            let updates = flight.observe();
            for (n, u) in updates.to_array().iter().enumerate() {
                if let Some(u) = u {
                    nis[n][0] += u.nis;
                    nis[n][1] += 1.0;
                    if !u.taken { nis[n][2] += 1.0; }
                }
            }
            if k % 100 == 0 {
                nees[k / 100].push(flight.nees());
                let (e, p) = (flight.error(), flight.covariance());
                for part in 0..5 {
                    let b: nalgebra::Matrix3<f64> = p.fixed_view::<3, 3>(3 * part, 3 * part).into();
                    let e: nalgebra::Vector3<f64> = e.fixed_rows::<3>(3 * part).into();
                    parts[k / 100][part] += e.dot(&(b.try_inverse().unwrap() * e)) / 3.0 / runs as f64;
                }
                if seed == 1 {
                    println!("{} h {:.1} s: p {:?} v {:?} a {:?} bg {:?} ba {:?}", k / 100, flight.state.motion.position_w.z,
                        flight.estimator.filter.sigma3(0).as_slice(), flight.estimator.filter.sigma3(3).as_slice(),
                        flight.estimator.filter.sigma3(6).as_slice(),flight.estimator.filter.sigma3(9).as_slice(),flight.estimator.filter.sigma3(12).as_slice());
                }
            }
            flight.fly();
        }
    }
    for (k, all) in nees.iter().enumerate() {
        println!("{k}: {:.3} {:?}", all.iter().sum::<f64>() / (runs as f64 * CORE as f64), parts[k].map(|x| (x * 100.0).round() / 100.0));
    }
    println!("{:?}", nis.map(|[s, n, r]| (s / n, n, r)));
}

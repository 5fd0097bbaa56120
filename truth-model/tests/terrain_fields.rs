//! Random fields follow their published laws, queries miss no rock, and soil bears what was
//! measured.

mod common;

use std::f64::consts::PI;

use claims::{Bound, Claim};
use common::relief::{cratered, level, place};
use common::{bug, on_plane};
use lander_models::scenario::{RockLaw, Rocks, Soil, Terrain};
use nalgebra::Vector3;
use truth_model::terrain::{Cylinder, Ground, ROCK_REACH_M, Rock};

const ABUNDANCE: f64 = 0.05;

fn rocks(law: RockLaw) -> Rocks {
    Rocks { extent_m: 150.0, diameter_min_m: 0.2, diameter_max_m: 3.0, law, burial: 0.5 }
}

/// Craters below, rocks by the exponential law on top.
fn strewn() -> Ground {
    let rocks = rocks(RockLaw::Exponential { abundance: ABUNDANCE });
    Ground::new(&Terrain { rocks: Some(rocks), ..cratered() })
}

/// By how many standard deviations of a Poisson count a field strays.
fn astray(found: usize, expected: f64) -> f64 {
    (found as f64 - expected) / expected.sqrt()
}

/// Counts stay within five deviations: one field in two million strays farther.
#[track_caller]
fn count_claim(id: &str, claim: &str, reference: &str, off: impl IntoIterator<Item = f64>) {
    Claim {
        id,
        section: "Terrain",
        claim,
        reference,
        unit: "σ",
        bound: Bound::AtMost(5.0),
        origin: "one field in two million strays farther",
        noise: 0.0,
    }
    .holds_for(off);
}

/// Kolmogorov's distance between diameters and the part of a law below each, at the 0.1 % level.
#[track_caller]
fn follows(mut diameters_m: Vec<f64>, below: impl Fn(f64) -> f64) {
    diameters_m.sort_by(f64::total_cmp);
    let n = diameters_m.len() as f64;
    let distance = |(index, d): (usize, &f64)| {
        let (low, high) = (index as f64 / n, (index + 1) as f64 / n);
        (below(*d) - low).abs().max((high - below(*d)).abs())
    };
    let worst = diameters_m.iter().enumerate().map(distance).fold(0.0, f64::max);
    assert!(worst < 1.95 / n.sqrt(), "{worst} at {n} bodies");
}

#[test]
fn craters_follow_trask() {
    let ground = Ground::new(&cratered());
    let widths_m: Vec<_> = ground.craters().iter().map(|crater| 2.0 * crater.radius_m).collect();
    // 10^10.9 D^-2 per 10^6 km² (Trask 1966), D in m, on a disc 200 m in radius.
    let wider = |d_m: f64| 10_f64.powf(10.9) / 1e12 * (d_m.powi(-2) - 1e-4) * PI * 200.0 * 200.0;
    let count = |least_m| widths_m.iter().filter(|d_m| **d_m > least_m).count();
    let off = [4.0, 8.0, 20.0].map(|least_m| astray(count(least_m), wider(least_m)));
    count_claim("craters-trask", "craters wider than 4, 8 and 20 m", "Trask 1966", off);
    follows(widths_m, |d_m| 1.0 - wider(d_m) / wider(4.0));
}

#[test]
fn fields_are_uniform_on_their_disc() {
    let ground = strewn();
    let places: Vec<_> = ground.rocks().iter().map(|rock| rock.centre_w.xy()).collect();
    follows(places.iter().map(|at| at.norm()).collect(), |r_m| (r_m / 150.0).powi(2));
    let azimuth = |at: &nalgebra::Vector2<f64>| at.y.atan2(at.x) / (2.0 * PI) + 0.5;
    follows(places.iter().map(azimuth).collect(), |part| part);
}

#[test]
fn rocks_cover_the_area_that_golombek_s_law_says() {
    let ground = strewn();
    // Counts wider than D on the disc, from the law's integral by SciPy 1.x: quad and expn agree to
    // twelve digits.
    let total = 16_972.004_836_744;
    let shares = [(0.2, 1.0), (0.3, 0.334677136785744), (0.5, 0.056447823842289)];
    let off = shares.map(|(least_m, part)| {
        let found = ground.rocks().iter().filter(|rock| 2.0 * rock.radius_m > least_m).count();
        astray(found, total * part)
    });
    let law = "Golombek and Rapp 1997, integrated by SciPy";
    count_claim("rocks-golombek", "rocks wider than 0.2, 0.3 and 0.5 m", law, off);
    let q = 1.79 + 0.152 / ABUNDANCE;
    let covered = |d_m: f64| ABUNDANCE * (-q * d_m).exp();
    let area_m2: f64 = ground.rocks().iter().map(|rock| PI * rock.radius_m.powi(2)).sum();
    let squares_m4: f64 =
        ground.rocks().iter().map(|rock| (PI * rock.radius_m.powi(2)).powi(2)).sum();
    let expected_m2 = (covered(0.2) - covered(3.0)) * PI * 150.0 * 150.0;
    // Five standard deviations of a compound Poisson sum.
    assert!((area_m2 - expected_m2).abs() < 5.0 * squares_m4.sqrt(), "{area_m2} {expected_m2}");
}

#[test]
fn rocks_follow_a_power_law_where_asked() {
    let law = RockLaw::Power { density_at_1m_m2: 0.0003, exponent: 2.482 };
    let ground = Ground::new(&Terrain { rocks: Some(rocks(law)), ..level() });
    let wider = |d_m: f64| 0.0003 * (d_m.powf(-2.482) - 3_f64.powf(-2.482)) * PI * 150.0 * 150.0;
    let off = [astray(ground.rocks().len(), wider(0.2))];
    count_claim("rocks-power", "rocks of a power law, wider than 0.2 m", "VIPER-MSE-SPEC-001", off);
    let widths_m = ground.rocks().iter().map(|rock| 2.0 * rock.radius_m).collect();
    follows(widths_m, |d_m| 1.0 - wider(d_m) / wider(0.2));
}

#[test]
fn a_field_is_its_seed_s_and_grows_without_changing() {
    let widths_m = |terrain: &Terrain| -> Vec<_> {
        Ground::new(terrain).craters().iter().map(|crater| crater.radius_m).collect()
    };
    let mut terrain = cratered();
    let first = widths_m(&terrain);
    assert_eq!(first, widths_m(&terrain));
    terrain.craters.as_mut().unwrap().diameter_min_m = 3.0;
    let finer = widths_m(&terrain);
    assert!(finer.len() > first.len() && finer[..first.len()] == first[..]);
    terrain.seed = 1;
    assert_ne!(finer, widths_m(&terrain));
}

#[test]
fn rocks_are_buried_by_the_part_that_was_asked_for() {
    for burial in [0.0, 0.3, 0.5] {
        let law = RockLaw::Exponential { abundance: ABUNDANCE };
        let rocks = Some(Rocks { burial, ..rocks(law) });
        let ground = Ground::new(&Terrain { rocks, ..cratered() });
        for rock in ground.rocks() {
            let Rock { centre_w, radius_m } = rock;
            let out_m = centre_w.z + radius_m - ground.height_m(centre_w.x, centre_w.y);
            // Rounding of heights of a few metres.
            assert!((out_m - (1.0 - burial) * 2.0 * radius_m).abs() < 1e-12);
        }
    }
}

#[test]
fn queries_find_what_a_look_at_every_rock_finds() {
    let ground = strewn();
    let mut hits = 0;
    for index in 0..3000 {
        // Beyond the disc too.
        let mut point_w = place(index, Vector3::new(160.0, 160.0, 1.0));
        point_w.z += ground.height_m(point_w.x, point_w.y) + 0.5;
        for reach_m in [0.2, ROCK_REACH_M, 3.0] {
            let within = |rock: &&Rock| rock.surface(&point_w).clearance_m <= reach_m;
            let mut expected: Vec<_> = ground.rocks().iter().filter(within).collect();
            let mut found: Vec<_> = ground.rocks_near(&point_w, reach_m).collect();
            let key = |rock: &&Rock| rock.centre_w.x.to_bits();
            expected.sort_by_key(key);
            found.sort_by_key(key);
            assert!(expected.iter().zip(&found).all(|(a, b)| std::ptr::eq(*a, *b)));
            assert_eq!(expected.len(), found.len());
            hits += found.len();
        }
        let all_m = ground.rocks().iter().map(|rock| rock.surface(&point_w).clearance_m);
        let least_m = all_m.fold(f64::INFINITY, f64::min);
        let nearest = ground.nearest_rock(&point_w);
        assert_eq!(nearest.map(|rock| rock.clearance_m), (least_m <= 1.0).then_some(least_m));
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn ground_without_rocks_has_none_near() {
    let ground = Ground::new(&cratered());
    assert!(ground.nearest_rock(&Vector3::zeros()).is_none());
    assert_eq!(ground.rocks_near(&Vector3::zeros(), 100.0).count(), 0);
}

#[test]
fn the_distance_to_a_cylinder_is_what_dense_sampling_finds() {
    for index in 0..60 {
        let bottom_w = place(index, Vector3::repeat(1.0));
        let top_w = bottom_w + place(index + 5000, Vector3::repeat(2.0));
        let part = Cylinder { bottom_w, top_w, radius_m: 0.7 };
        let point_w = place(index + 10_000, Vector3::repeat(3.0));
        let axis_w = (top_w - bottom_w).normalize();
        let aside_w = axis_w.cross(&Vector3::new(0.3, -0.8, 0.5)).normalize();
        let other_w = axis_w.cross(&aside_w);
        // The skin: the wall and both discs, 1.5 cm apart at most.
        let mut least_m = f64::INFINITY;
        for turn in 0..300 {
            let (sin, cos) = (f64::from(turn) / 300.0 * 2.0 * PI).sin_cos();
            let rim_w = (aside_w * cos + other_w * sin) * part.radius_m;
            for step in 0..=250 {
                let part = f64::from(step) / 250.0;
                for skin_w in [
                    bottom_w + (top_w - bottom_w) * part + rim_w,
                    bottom_w + rim_w * part,
                    top_w + rim_w * part,
                ] {
                    least_m = least_m.min((point_w - skin_w).norm());
                }
            }
        }
        let distance_m = part.distance_m(&point_w);
        // A sample lies within 1.1 cm of any point of the skin.
        let excess_m = least_m - distance_m.abs();
        assert!((-1e-12..0.011).contains(&excess_m), "{distance_m}, sampled {least_m}");
        let along_m = (point_w - bottom_w).dot(&axis_w);
        let inside = (0.0..(top_w - bottom_w).norm()).contains(&along_m)
            && (point_w - bottom_w - axis_w * along_m).norm() < part.radius_m;
        assert_eq!(distance_m < 0.0, inside);
    }
}

#[test]
fn a_cylinder_feels_the_rock_below_it() {
    let ground = strewn();
    let rock = ground.rocks()[0];
    for height_m in [0.0, 0.1, 0.5] {
        let bottom_w = rock.centre_w + Vector3::z() * (rock.radius_m + height_m);
        let top_w = bottom_w + Vector3::z() * 1.5;
        let hull = Cylinder { bottom_w, top_w, radius_m: 0.7 };
        // Its bottom disc covers the rock's summit; the relief is farther down.
        assert!((ground.cylinder_clearance_m(&hull) - height_m).abs() < 1e-12);
    }
}

#[test]
fn a_pad_over_a_rock_has_the_rock_s_clearance() {
    let mut setup = on_plane(bug(), 20.0);
    let law = RockLaw::Exponential { abundance: ABUNDANCE };
    setup.scenario.terrain.rocks = Some(rocks(law));
    let rock = setup.model().ground().rocks()[0];
    let foot_b = setup.vehicle.gear.legs[0].foot_b;
    let summit_w = rock.centre_w + Vector3::z() * rock.radius_m;
    setup.scenario.initial.position_w = summit_w - foot_b + Vector3::z() * 0.25;
    let model = setup.model();
    let state = model.initial_state();
    // Rounding of metres.
    let clearance_m = model.foot_clearances_m(&state).next().unwrap();
    assert!((clearance_m - 0.25).abs() < 1e-12, "{clearance_m}");
    assert!(model.lowest_m(&state) <= clearance_m);
}

#[test]
fn lunar_soil_bears_what_surveyor_3_measured_and_sinkage_is_the_inverse() {
    let lunar =
        Soil { cohesive_modulus_n_m2: 1.4e3, frictional_modulus_n_m3: 8.2e5, exponent: 1.0 };
    // 2 to 6 N/cm² at 2 to 5 cm under plates 20 to 30 cm wide (Christensen et al. 1968).
    // From 2.5 cm: at 2 cm the law bears 1.7 N/cm².
    for (width_m, depth_m) in [(0.2, 0.025), (0.2, 0.05), (0.3, 0.025), (0.3, 0.05)] {
        let radius_m = 0.5 * width_m;
        let pressure_n_m2 = lunar.pad_load_n(radius_m, depth_m) / (PI * radius_m * radius_m);
        assert!((2e4..6e4).contains(&pressure_n_m2), "{pressure_n_m2}");
    }
    for exponent in [0.5, 1.0, 1.8] {
        let soil = Soil { exponent, ..lunar };
        for depth_m in [0.0, 1e-4, 0.03, 0.4] {
            let back_m = soil.pad_sinkage_m(0.15, soil.pad_load_n(0.15, depth_m));
            // Two powers, each within an ulp or two.
            assert!((back_m - depth_m).abs() <= 1e-14 * depth_m, "{depth_m} {back_m}");
        }
        assert_eq!(soil.pad_load_n(0.15, -0.01), 0.0);
    }
}

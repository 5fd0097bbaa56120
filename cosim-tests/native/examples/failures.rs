use cosim::failures::{Flight, wiring};
use lander_models::Vehicle;
const CASES: &[(&str, &str, bool)] = &[
    ("none", "", false),
    ("none-s", "", true),
    ("shutoff", "[faults.engine_shutoff]\nonset = ONSET", false),
    ("thrust-50", "[faults.thrust_degradation]\nonset = ONSET\nfraction = { value = 0.5, unit = \"1\" }", false),
    ("thrust-70", "[faults.thrust_degradation]\nonset = ONSET\nfraction = { value = 0.7, unit = \"1\" }", false),
    ("thrust-80", "[faults.thrust_degradation]\nonset = ONSET\nfraction = { value = 0.8, unit = \"1\" }", false),
    ("brownout-1", "[faults.power_brownout]\nonset = ONSET\nduration = { value = 1.0, unit = \"s\" }", false),
    ("brownout-3", "[faults.power_brownout]\nonset = ONSET\nduration = { value = 3.0, unit = \"s\" }", false),
    ("imu-s", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"imu\"", true),
    ("alt", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"altimeter\"", false),
    ("alt-s", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"altimeter\"", true),
    ("velo-s", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"velocimeter\"", true),
    ("star-s", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"star_tracker\"", true),
    ("probes", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"leg_probes\"", false),
    ("rcs-x+", "[faults.rcs_stuck]\nonset = ONSET\naxis = \"x\"", false),
    ("rcs-y-", "[faults.rcs_stuck]\nonset = ONSET\naxis = \"y\"\nsense = \"negative\"", false),
    ("rcs-z+", "[faults.rcs_stuck]\nonset = ONSET\naxis = \"z\"", false),
    ("leak-3", "[faults.propellant_leak]\nonset = ONSET\nflow = { value = 3.0, unit = \"kg/s\" }", false),
    ("leak-4", "[faults.propellant_leak]\nonset = ONSET\nflow = { value = 4.0, unit = \"kg/s\" }", false),
    ("gimbal", "[faults.gimbal_seizure]\nonset = ONSET", false),
    ("reset-0", "[faults.computer_reset]\nonset = ONSET\nduration = { value = 0.5, unit = \"s\" }\ncommands = \"zero\"", false),
    ("reset-h", "[faults.computer_reset]\nonset = ONSET\nduration = { value = 0.5, unit = \"s\" }\ncommands = \"held\"", false),
    ("slosh-30", "[slosh]\nactive = \"on\"\n[faults.slosh]\nonset = ONSET\nangle = { value = 30.0, unit = \"deg\" }", false),
    ("erosion", "[faults.nozzle_erosion]\nonset = ONSET\nrate = { value = 0.1, unit = \"1/s\" }\npointing_rate = { value = 0.3, unit = \"deg/s\" }", false),
];
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref()).unwrap();
    let (schedule, layout) = wiring().unwrap();
    let responses: &[bool] = if args[1] == "both" { &[false, true] } else if args[1] == "on" { &[true] } else { &[false] };
    for (name, fault, sensors) in CASES {
        if args[0] != "all" && !args[0].split(',').any(|p| name.starts_with(p)) { continue; }
        for onset_s in [0.5, 3.5, 6.0, 12.0, 18.0, 20.0, 22.0, 24.0, 26.0] {
            if let Ok(only) = std::env::var("T") && only.parse::<f64>().unwrap() != onset_s { continue; }
            for &response in responses {
                for seed in [None, Some(1)] {
                let flight = Flight { fault, onset_s, response, sensors: *sensors, seed };
                let verbose = std::env::var("V").is_ok();
                let mut last = Vec::new();
                let see = |row: &[f64]| {
                    if !verbose { return; }
                    let mut now: Vec<f64> = row[layout.columns("fault_declared")].to_vec();
                    now.push(layout.scalar(row, "goal"));
                    now.push(layout.scalar(row, "phase"));
                    let z = row[layout.columns("position_w")][2];
                    let vz = row[layout.columns("velocity_w")][2];
                    if now != last {
                        println!("   {:6.2} faults {:?} goal {} phase {} z {:.1} vz {:.1} cmd {:.0} thrust {:.0} acc {} fail {} tgo {:.2} tilt {:.1}", row[0], &now[..7], now[7], now[8], z, vz, layout.scalar(row, "thrust_command_n"), layout.scalar(row, "thrust_n"), layout.scalar(row, "plans_accepted"), layout.scalar(row, "plans_failed"), layout.scalar(row, "plan_time_to_go_s"), layout.scalar(row, "tilt_deg"));
                        last = now;
                    }
                };
                match flight.fly(&vehicle, &schedule, &layout, see) {
                Ok(e) => println!("{name:10} {onset_s:5.1} ph{} {} {:?} {:9} miss {:7.2} down {:6.2} across {:5.2} tilt {:6.2} rate {:6.2} left {:5.1} t {:5.1}", e.phase, if response {"on "} else {"off"}, seed, e.outcome, e.miss_m, e.down_m_s, e.across_m_s, e.tilt_deg, e.rate_deg_s, e.propellant_left_kg, e.flight_s),
                Err(e) => println!("{name} {onset_s} {response} {seed:?} ERROR {e}"),
                }
                }
            }
            if fault.is_empty() { break; }
        }
    }
}

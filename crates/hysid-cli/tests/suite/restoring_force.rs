//! `hysid restoring-force`: restoring forces from tables of measured motion and force, what other commands make of them, and what is
//! refused.

use hysid_core::elementary::{cos, sin};

use crate::workbench::{Ran, Workbench, cases, columns};

const ROWS: usize = 1200;

/// A motion of 2 t on a spring of 800 kN/m beside a damper of 4 kN s/m: time in s, displacement in m, velocity, acceleration,
/// applied force in N, restoring force in N.
fn motion(row: usize) -> [f64; 6] {
    let t = 0.005 * row as f64;
    let tones = [(0.02, 6.0), (0.012, 13.0), (0.004, 21.0)];
    let sum = |of: &dyn Fn(f64, f64) -> f64| tones.iter().map(|&(size, pace)| of(size, pace)).sum::<f64>();
    let y = sum(&|size, pace| size * sin(pace * t));
    let v = sum(&|size, pace| size * pace * cos(pace * t));
    let a = sum(&|size, pace| -size * pace * pace * sin(pace * t));
    let r = 8e5 * y + 4e3 * v;
    [t, y, v, a, 2e3 * a + r, r]
}

fn table(header: &str, cells: impl Fn(usize, [f64; 6]) -> String) -> String {
    let rows = (0..ROWS).map(|row| cells(row, motion(row)) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

fn ran(bench: &Workbench, line: &str) -> Ran {
    let ran = bench.shell(&format!("hysid {line}"));
    assert_eq!(ran.status, Some(0), "{line}: {}", ran.stderr);
    ran
}

/// Largest deviation of a column from exact values, in percent of the largest of these.
fn error_percent(found: &[f64], exact: impl Fn([f64; 6]) -> f64) -> f64 {
    let exact: Vec<f64> = (0..ROWS).map(|row| exact(motion(row))).collect();
    let largest = exact.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let apart = found.iter().zip(&exact).filter(|(found, _)| !found.is_nan()).map(|(a, b)| (a - b).abs());
    100.0 * apart.fold(0.0, f64::max) / largest
}

/// A number from 0 to 1 without relation to that of the next row: the finaliser of splitmix64.
fn mixed(row: u64) -> f64 {
    let mut bits = (row + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// The table of a stranger: mm, kN and g.
fn bench() -> Workbench {
    let bench = Workbench::new();
    let cells = |_, [t, y, _, a, u, _]: [f64; 6]| format!("{t},{},{},{}", 1e3 * y, u / 1e3, a / 9.80665);
    bench.put("rig.csv", table("time [s],disp [mm],force [kN],acc [g]", cells));
    bench
}

#[test]
fn millimetres_kilonewtons_and_gravity_are_converted() {
    let bench = bench();
    let said = ran(&bench, "restoring-force rig.csv --mass '2 t' --acceleration acc");
    let (header, found) = columns(&bench.text("rig.force.csv"));
    assert_eq!(header, ["time [s]", "disp [mm]", "velocity_mm_s", "restoring_force_kN"]);
    assert!(error_percent(&found[1], |at| 1e3 * at[1]) < 1e-12);
    assert!(error_percent(&found[2], |at| 1e3 * at[2]) < 1e-2);
    assert!(error_percent(&found[3], |at| at[5] / 1e3) < 1e-9);
    for told in [
        "acc [g]: acceleration relative to the base",
        "s, mm, g, kN: converted; the force is in kN",
        "m        2 t",
    ] {
        assert!(said.stderr.contains(told), "{told}: {}", said.stderr);
    }
    for text in [&said.stdout, &said.stderr] {
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    }
    // The same without the measured acceleration, and in kg.
    let said = ran(&bench, "restoring-force rig.csv --mass 2000 -o computed.csv");
    let (_, found) = columns(&bench.text("computed.csv"));
    assert!(error_percent(&found[3], |at| at[5] / 1e3) < 1e-3);
    let blank = found[3].iter().filter(|force| force.is_nan()).count();
    assert!((4..40).contains(&blank) && found[3][0].is_nan() && found[3][ROWS - 1].is_nan(), "{blank}");
    assert!(said.stderr.contains("acc [g]: name it with --acceleration"), "{}", said.stderr);
    assert!(said.stdout.contains(&format!("rows with a force   {} of {ROWS}", ROWS - blank)), "{said}");
    // Numbers without units are taken as they are.
    bench.put("plain.csv", table("t,y,u", |_, [t, y, _, _, u, _]| format!("{t},{y},{u}")));
    let said = ran(&bench, "restoring-force plain.csv --mass 2000 --displacement y --applied-force u");
    let (header, found) = columns(&bench.text("plain.force.csv"));
    assert_eq!(header, ["t", "y", "velocity", "restoring_force"]);
    assert!(error_percent(&found[3], |at| at[5]) < 1e-3);
    assert!(said.stderr.contains("none known, nothing is converted"), "{}", said.stderr);
    // As do those of a table whose units are not to be converted: mm, kN and t mm/s² per kN.
    let same = ran(&bench, "restoring-force rig.csv --mass 0.002 --same-units -o same.csv");
    let (header, found) = columns(&bench.text("same.csv"));
    assert_eq!(header[3], "restoring_force_kN");
    assert!(error_percent(&found[3], |at| at[5] / 1e3) < 1e-3, "{}", same.stdout);
    // A column without a unit beside others is taken to be in an SI unit.
    bench.put("mixed.csv", table("t,y_mm,force", |_, [t, y, _, _, u, _]| format!("{t},{},{u}", 1e3 * y)));
    let said = ran(&bench, "restoring-force mixed.csv --mass 2000");
    let (header, found) = columns(&bench.text("mixed.force.csv"));
    assert_eq!(header[3], "restoring_force");
    assert!(error_percent(&found[3], |at| at[5]) < 1e-3);
    assert!(said.stderr.contains("t is taken to be in s, force is taken to be in N"), "{}", said.stderr);
}

#[test]
fn a_moving_base_drives_the_mass() {
    let bench = Workbench::new();
    // The force on the mass is that of the base: u = 0, and a = -(u of the motion)/m.
    let cells = |row, [t, y, v, a, u, _]: [f64; 6]| {
        let base = -u / 2e3;
        let record = if row < 600 { "first" } else { "second" };
        format!("{record},{t},{},{v},{},{},{}", 1e3 * y, (a + base) / 9.80665, 100.0 * base, 20.0 + t)
    };
    bench.put("table.csv", table("record,t_s,drift_mm,v_m_s,floor_g,ground [Gal],temperature [degC]", cells));
    for (name, options) in [
        ("absolute", "--absolute-acceleration floor_g"),
        ("base", "--base-acceleration 'ground [Gal]' --velocity v_m_s --keep 'temperature [degC]'"),
    ] {
        ran(&bench, &format!("restoring-force table.csv --mass '2 t' {options} -o {name}.csv"));
        let (header, found) = columns(&bench.text(&format!("{name}.csv")));
        assert_eq!((header[0].as_str(), header[header.len() - 1].as_str()), ("record", "restoring_force_kN"));
        assert!(error_percent(&found[header.len() - 1], |at| at[5] / 1e3) < 2e-2, "{name}");
        assert!(error_percent(&found[3], |at| 1e3 * at[2]) < 2e-2, "{name}");
        assert_eq!(header.contains(&"temperature [degC]".to_string()), name == "base");
    }
    let told = ran(
        &bench,
        "restoring-force table.csv --mass '2 t' --absolute-acceleration floor_g --json -o json.csv",
    );
    let told: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    assert_eq!(
        (&told["records"], &told["rows"], &told["rows_with_force"]),
        (&2.into(), &1200.into(), &1200.into())
    );
    assert_eq!((&told["force_unit"], &told["table"]), (&"kN".into(), &"json.csv".into()));
    assert!(
        told["acceleration_filter"].is_null() && told["velocity_filter"]["window"].as_u64().unwrap() >= 5
    );
    assert!(told["noise_percent"].as_f64().unwrap() < 1.0);
}

#[test]
fn other_commands_take_the_table_without_options() {
    let bench = bench();
    ran(&bench, "restoring-force rig.csv --mass '2 t'");
    let told = ran(&bench, "look rig.force.csv").stdout;
    for role in ["disp [mm]            input", "velocity_mm_s       unused", "restoring_force_kN  output"] {
        assert!(told.contains(role), "{role}: {told}");
    }
    assert!(told.contains("a rate, not an input (use it with --rate)"), "{told}");
    let fit = ran(&bench, "fit rig.force.csv --model bouc-wen --starts 1 -o model.json --no-report --json");
    let told: serde_json::Value = serde_json::from_str(&fit.stdout).unwrap();
    // The spring alone leaves the damper, 4 kN s/m of it.
    assert!(told["train"]["nrmse_std_percent"].as_f64().unwrap() < 5.0, "{told}");
    let with_rate =
        "fit rig.force.csv --rate velocity_mm_s --model xpnn --starts 1 --epochs 1 -o rate.json --no-report";
    let told = ran(&bench, with_rate).stderr;
    assert!(told.contains("rate     of disp [mm] from column velocity_mm_s"), "{told}");
    ran(&bench, "diagnose rig.force.csv");
    ran(&bench, "cycles rig.force.csv --no-report");
    ran(&bench, "plot rig.force.csv --kind loops -o loops.svg");
    // Two inputs are still two inputs where they are named.
    let told = ran(&bench, "look rig.force.csv --input 'disp [mm]' --input velocity_mm_s").stdout;
    assert!(told.contains("velocity_mm_s        input"), "{told}");
}

#[test]
fn noise_is_told_and_a_longer_window_lets_less_of_it_through() {
    let bench = Workbench::new();
    let cells = |row: usize, [t, y, _, _, u, _]: [f64; 6]| {
        let noise = 2e-4 * (mixed(row as u64) - 0.5) * 12f64.sqrt();
        format!("{t},{},{}", y + noise, u)
    };
    bench.put("noisy.csv", table("t_s,y_m,force_N", cells));
    let share = |options: &str| {
        let said = ran(&bench, &format!("restoring-force noisy.csv --mass 2000 --json {options}"));
        let told: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        (told["noise_percent"].as_f64().unwrap(), said.stderr)
    };
    let (chosen, said) = share("");
    assert!(chosen < 10.0 && !said.contains("warning"), "{chosen} {said}");
    let (short, said) = share("--window 5");
    let warning = "warning: the noise of the restoring force is about";
    assert!(
        short > 10.0 && said.contains(warning) && said.contains("use a longer --window"),
        "{short} {said}"
    );
    assert!(!said.contains("smoothing error"), "{said}");
    let (_, said) = share("--window 151");
    assert!(said.contains("warning: the smoothing error of the restoring force is about"), "{said}");
    assert!(said.contains("use a shorter --window"), "{said}");
}

#[test]
fn zero_removes_offsets_of_displacement_and_force() {
    let bench = Workbench::new();
    let cells = |_, [t, y, _, a, u, _]: [f64; 6]| format!("{t},{},{},{a}", y + 0.5, u + 700.0);
    bench.put("offset.csv", table("t_s,y_m,force_N,acc_m_s2", cells));
    ran(&bench, "restoring-force offset.csv --mass 2000 --acceleration acc_m_s2 --zero 1");
    let (_, found) = columns(&bench.text("offset.force.csv"));
    assert_eq!((found[1][0], found[3][0]), (0.0, 0.0));
    let first = motion(0)[5];
    assert!(error_percent(&found[3].iter().map(|r| r + first).collect::<Vec<_>>(), |at| at[5]) < 1e-9);
}

#[test]
fn blanks_leave_blanks_and_a_force_goes_to_stdout() {
    let bench = Workbench::new();
    let cells = |row: usize, [t, y, _, a, u, _]: [f64; 6]| {
        let a = if row == 7 { String::new() } else { a.to_string() };
        format!("{t};{y};{u};{a}").replace('.', ",")
    };
    bench.put("blank.csv", table("t_s;y_m;force_N;acc_m_s2", cells));
    let said = ran(&bench, "restoring-force blank.csv --mass 2000 --acceleration acc_m_s2 -o -");
    let line = said.stdout.lines().nth(8).unwrap();
    assert!(line.starts_with("0,035;") && line.ends_with(';'), "{line}");
    assert_eq!(said.stdout.lines().count(), ROWS + 1);
}

/// Hint if `--force` is given a value.
const HINT: &str =
    "--force replaces files; a column with the applied force is named by --applied-force force)";

#[test]
fn the_help_speaks_of_the_columns_of_a_motion() {
    let help = Workbench::new().shell("hysid restoring-force --help options").stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for told in [
        "Subtract from the displacement and from the restoring force their means over the first ROWS rows",
        "the restoring force is blank; time, displacement and velocity need a number in every row",
        "are always missing values",
    ] {
        assert!(help.contains(told), "{told}: {help}");
    }
    for other in ["the first input", "scored", "--input"] {
        assert!(!help.contains(other), "{other}: {help}");
    }
}

#[test]
fn what_has_no_restoring_force_is_refused_in_one_line() {
    let bench = bench();
    let refused = |line: &str, status: i32, expected: &str| {
        let ran = bench.shell(&format!("hysid {line}"));
        assert_eq!(ran.status, Some(status), "{line}: {}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 1, "{line}: {}", ran.stderr);
        assert!(ran.last_line().contains(expected), "{line}: {}", ran.stderr);
    };
    let rows = |header: &str, cells: &dyn Fn(usize, [f64; 6]) -> String| table(header, cells);
    bench.put("constant.csv", rows("t_s,y_mm,F_N", &|_, at| format!("{},3,{}", at[0], at[4])));
    bench.put(
        "empty.csv",
        rows("t_s,y_mm,F_N", &|row, at| {
            if row == 4 { format!("{},,{}", at[0], at[4]) } else { format!("{},{},{}", at[0], at[1], at[4]) }
        }),
    );
    bench.put(
        "back.csv",
        rows("t_ms,y_mm,F_N", &|row, at| {
            format!("{},{},{}", if row == 5 { 19.0 } else { 1e3 * at[0] }, at[1], at[4])
        }),
    );
    // Words in the first row.
    let beginning = |y: Option<&str>, force: Option<&str>| {
        rows("t_s,y_mm,F_N", &|row, at| {
            let cell = |word: Option<&str>, value: f64| match word.filter(|_| row == 0) {
                Some(word) => word.to_string(),
                None => value.to_string(),
            };
            format!("{},{},{}", at[0], cell(y, at[1]), cell(force, at[4]))
        })
    };
    bench.put("word.csv", beginning(Some("zero"), None));
    bench.put("off.csv", beginning(None, Some("off")));
    bench.put(
        "slow.csv",
        rows("t_s,y_mm,v_mm_s,F_N", &|row, at| {
            let v = if row == 2 { String::new() } else { at[2].to_string() };
            format!("{},{},{v},{}", at[0], at[1], at[4])
        }),
    );
    bench.put("one.csv", "t_s,y_mm,F_N\n0,1,2\n");
    bench.put(
        "two.csv",
        rows("t_s,y_mm,x_mm,F_N", &|_, at| format!("{},{},{},{}", at[0], at[1], at[1], at[4])),
    );
    bench.put("free.csv", rows("t_s,y_mm", &|_, at| format!("{},{}", at[0], at[1])));
    bench.put("stress.csv", rows("t_s,y_mm,s_MPa", &|_, at| format!("{},{},{}", at[0], at[1], at[4])));
    bench.put("no-time.csv", rows("y_mm,F_N", &|_, at| format!("{},{}", at[1], at[4])));
    for (status, line, expected) in cases(&format!(
        r#"
        2 restoring-force rig.csv => --mass
        2 restoring-force rig.csv --mass 0 => a mass above 0 is needed
        2 restoring-force rig.csv --mass -2 => a mass above 0 is needed
        2 restoring-force rig.csv --mass '2 mm' => the unit of the mass is unknown
        2 restoring-force rig.csv --mass '2 stone' => the unit of the mass is unknown
        2 restoring-force rig.csv --mass 2 --window 6 => an odd number of rows is needed, 5 or more
        1 restoring-force rig.csv --mass 2 --window 1201 => column "disp [mm]" has 1200 rows: at least 1201 rows are needed
        1 restoring-force rig.csv --mass 2 --displacement drift => there is no column "drift" for --displacement
        1 restoring-force rig.csv --mass 2 --applied-force none --acceleration 'force [kN]' => is in kN, which is not an acceleration
        2 restoring-force rig.csv --mass 2 --velocity acc --acceleration acc => is named twice, by --velocity and --acceleration
        1 restoring-force rig.csv --mass 2 --absolute-acceleration acc => may be a force on the mass
        2 restoring-force rig.csv --mass 2 --acceleration acc --absolute-acceleration acc => cannot be used with
        2 restoring-force rig.csv --mass 2 -o rig.csv => would be overwritten
        2 restoring-force rig.csv --mass 2 -o - --json => name a file for the table with -o
        1 restoring-force constant.csv --mass 2 => column "y_mm" is constant (3)
        1 restoring-force empty.csv --mass 2 => empty.csv, line 6, column "y_mm": the cell is empty (time, displacement and velocity need a number in every row; choose rows with --rows)
        1 restoring-force slow.csv --mass 2 --velocity v_mm_s => slow.csv, line 4, column "v_mm_s": the cell is empty (time, displacement and velocity need
        1 restoring-force word.csv --mass 2 => (not the displacement? name it with --displacement)
        1 restoring-force off.csv --mass 2 => (if it stands for a missing value: --missing off)
        2 restoring-force rig.csv --mass 2 --force force => {HINT}
        2 restoring-force --force force rig.csv --mass 2 => {HINT}
        2 restoring-force rig.csv --mass 2 --force=force => {HINT}
        1 restoring-force --mass 2 --force force => {HINT}
        2 restoring-force rig.csv --mass 2 --force --bogus => (see `hysid restoring-force --help`)
        1 restoring-force back.csv --mass 2 => back.csv, line 7, column "t_ms": time 19 does not come after 20
        1 restoring-force one.csv --mass 2 => column "y_mm" has 1 row: at least 5 rows are needed
        1 restoring-force two.csv --mass 2 => several columns may be the displacement: y_mm, x_mm
        1 restoring-force free.csv --mass 2 => a free vibration has --applied-force none
        1 restoring-force stress.csv --mass 2 => is in MPa, which is not a force
        1 restoring-force no-time.csv --mass 2 => there is no column of time
        1 restoring-force nowhere.csv --mass 2 => nowhere.csv: cannot be read
    "#
    )) {
        refused(line, status, expected);
    }
    assert_eq!(ran(&bench, "restoring-force free.csv --mass 2 --applied-force none").status, Some(0));
}

//! `hysid fit --inverse`: a model of the inverse.

use hysid_core::elementary::sin;

use crate::workbench::Workbench;

/// A spring beside a slider, whose first and last outputs are blank.
fn table(blank_within: bool) -> String {
    let mut play: f64 = 0.0;
    let mut text = String::from("u_V,y_um\n");
    for row in 0..400 {
        let x = 0.01 * f64::from(row) * sin(0.1 * f64::from(row));
        play = play.clamp(x - 0.5, x + 0.5);
        let is_blank = !(5..395).contains(&row) || blank_within && row == 100;
        let y = if is_blank { String::new() } else { format!("{}", 2.0 * x + play) };
        text += &format!("{x},{y}\n");
    }
    text
}

#[test]
fn the_model_gives_the_input_for_an_output() {
    let bench = Workbench::new();
    bench.put("loops.csv", table(false));
    let ran = bench
        .succeeds("fit loops.csv --inverse --model prandtl-ishlinskii -o inverse.json --no-report --json");
    assert!(ran.stderr.contains("390") && ran.stderr.contains("output u_V: "), "{}", ran.stderr);
    // The inverse of a Prandtl-Ishlinskii model is one.
    let printed: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let error = printed["train"]["nrmse_std_percent"].as_f64().unwrap();
    assert!(error < 1.0, "{error}");
    bench.put("wanted.csv", "y_um\n0.1\n0.5\n1.0\n0.2\n");
    let ran = bench.succeeds("simulate inverse.json wanted.csv");
    assert!(ran.stdout.starts_with("y_um,u_V_model\n"), "{}", ran.stdout);
}

#[test]
fn what_cannot_be_exchanged_is_refused_with_its_line() {
    let bench = Workbench::new();
    bench.put("loops.csv", table(true));
    let ran = bench.run("fit loops.csv --inverse --model prandtl-ishlinskii -o inverse.json");
    assert_eq!(ran.status, Some(1));
    assert!(ran.stderr.contains("loops.csv, line 102, column \"y_um\": is blank here"), "{}", ran.stderr);
    bench.put("rate.csv", "t,x,v,y\n0,0,1,0\n1,1,1,1\n2,2,1,2\n3,1,1,1\n");
    let ran = bench.run("fit rate.csv --inverse --rate v --model xpnn -o inverse.json");
    assert_eq!(ran.status, Some(2));
    assert!(ran.stderr.contains("--inverse: the rate would be that of the output"), "{}", ran.stderr);
}

//! Text files with a preamble, as testing machines, oscilloscopes and loggers write them.

use super::record::{COMMA, POINT, lines, table};

/// All of them.
pub fn all() -> Vec<(&'static str, String)> {
    let quoted = table(",", |_, row| POINT.cells(row).iter().map(|cell| format!("\"{cell}\"")).collect());
    vec![
        (
            "testing-machine.csv",
            format!(
                "\"Sample\",\"A-17\"\n\"Operator\",\"N. N.\"\n\"Rate\",\"2.0\",\"mm/min\"\n\n\"Time\",\"Extension\",\"Load\"\n\
                 \"(s)\",\"(mm)\",\"(kN)\"\n{quoted}"
            ),
        ),
        (
            "servo-hydraulic.txt",
            format!(
                "Station Name: Frame 2\nTest File Name: cyclic.000\nData Header:\tTime:\t4.7\tSec\t2024-03-01 10:11:12\n\
                 Running Time\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n{}",
                lines(POINT, "\t")
            ),
        ),
        (
            "oscilloscope.csv",
            format!(
                "Model,DPO 4000\nFirmware,2.1\nSample Interval,1.0E-1\nRecord Length,48\nVertical Scale,5.0E+0,2.0E+0\n\n\
                 TIME,CH1,CH2\n{}",
                lines(POINT, ",")
            ),
        ),
        (
            "logger.csv",
            format!(
                "Gerät;Logger 8\nSeriennummer;004711\nMesskanäle;2\n\nZeit;Weg;Kraft\ns;mm;kN\n{}",
                lines(COMMA, ";")
            ),
        ),
        (
            "labview.lvm",
            format!(
                "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
                 Multi_Headings\tNo\nX_Columns\tOne\nTime_Pref\tRelative\nOperator\tN. N.\nDate\t2024/03/01\n\
                 Time\t10:11:12.345\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t48\t48\t\n\
                 Date\t2024/03/01\t2024/03/01\t\nTime\t10:11:12.345\t10:11:12.345\t\nX_Dimension\tTime\tTime\t\n\
                 X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\nDelta_X\t0.100000\t0.100000\t\n\
                 ***End_of_Header***\t\t\t\nX_Value\tDisplacement\tForce\tComment\n{}",
                table("\t", |k, row| {
                    let mut cells = POINT.cells(row);
                    if k == 0 {
                        cells.push(String::new());
                    }
                    cells
                })
            ),
        ),
        (
            "magnetometer.txt",
            format!(
                "@@Sample 3\n@@Mass 0.1 g\n\nH [A/m]\tB [T]\n{}",
                table("\t", |_, row| vec![POINT.x(row), POINT.y(row)])
            ),
        ),
        (
            "finite-elements.out",
            format!(
                "%\n% nodal results, step 3\n%\n%   TIME        U1         RF1\n{}",
                table("", |_, row| POINT.cells(row).iter().map(|cell| format!("{cell:>12}")).collect())
            ),
        ),
    ]
}

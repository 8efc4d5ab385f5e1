//! Text files: delimiters, headers, numbers, missing values, time, names in several languages.

use hysid_core::elementary::{powi, sin};

use super::record::{COMMA, POINT, Row, lines, table};

type Named = (&'static str, String);

/// All of them.
pub fn all() -> Vec<Named> {
    [delimiters(), headers(), numbers(), missing(), times(), languages(), unclear()].concat()
}

fn with_header(header: &str, lines: String) -> String {
    format!("{header}\n{lines}")
}

fn delimiters() -> Vec<Named> {
    let aligned = |k: usize, row: Row| {
        let _ = k;
        vec![
            format!("{:>8}", POINT.time(row)),
            format!("{:>12}", POINT.x(row)),
            format!("{:>12}", POINT.y(row)),
        ]
    };
    let comma_aligned =
        |_: usize, row: Row| COMMA.cells(row).iter().map(|cell| format!("{cell:>12}")).collect::<Vec<_>>();
    vec![
        ("plain.csv", with_header("t,x,y", lines(POINT, ","))),
        ("semicolon-comma.csv", with_header("Time (s);Displacement (mm);Force (kN)", lines(COMMA, ";"))),
        ("semicolon-point.csv", with_header("Time (s);Displacement (mm);Force (kN)", lines(POINT, ";"))),
        ("tab.txt", with_header("Time (s)\tDisplacement (mm)\tForce (kN)", lines(POINT, "\t"))),
        ("tab-comma.txt", with_header("Time (s)\tDisplacement (mm)\tForce (kN)", lines(COMMA, "\t"))),
        ("blanks.dat", with_header("       t           x           y", table("", aligned))),
        (
            "blanks-comma.dat",
            with_header("Time (s)  Displacement (mm)  Force (kN)", table("", comma_aligned)),
        ),
        ("bar.txt", with_header("t|x|y", lines(POINT, "|"))),
        ("comma-and-blank.csv", with_header("t, x, y", lines(POINT, ", "))),
        (
            "trailing-delimiter.csv",
            with_header("t,x,y,", table(",", |_, row| [POINT.cells(row), vec![String::new()]].concat())),
        ),
        ("no-header.csv", lines(POINT, ",")),
        ("no-header-semicolon.csv", lines(COMMA, ";")),
        ("no-header-tab.txt", lines(POINT, "\t")),
        ("no-header-blanks.dat", table("", aligned)),
        ("carriage-returns.csv", with_header("t,x,y", lines(POINT, ",")).replace('\n', "\r")),
        ("windows-lines.csv", with_header("t,x,y\n", lines(POINT, ",")).replace('\n', "\r\n")),
        (
            "quoted.csv",
            with_header(
                "\"t\",\"x\",\"y\"",
                table(",", |_, row| POINT.cells(row).iter().map(|cell| format!("\"{cell}\"")).collect()),
            ),
        ),
        (
            "quoted-decimal-comma.csv",
            with_header(
                "t,x,y",
                table(",", |_, row| COMMA.cells(row).iter().map(|cell| format!("\"{cell}\"")).collect()),
            ),
        ),
    ]
}

fn headers() -> Vec<Named> {
    let indexed = |first: i64| {
        move |k: usize, row: Row| [vec![(k as i64 + first).to_string()], POINT.cells(row)].concat()
    };
    let extended =
        |extra: &'static str| move |_: usize, row: Row| [POINT.cells(row), vec![extra.into()]].concat();
    vec![
        ("units-row.csv", with_header("Time,Displacement,Force\ns,mm,kN", lines(POINT, ","))),
        ("units-row-brackets.csv", with_header("Time;Displacement;Force\n(s);(mm);(kN)", lines(COMMA, ";"))),
        (
            "names-units-remarks.txt",
            with_header(
                "Time\tDisplacement\tForce\ns\tmm\tkN\t\nTimer\tLVDT 3\tCell 50 kN",
                lines(POINT, "\t"),
            )
            .replace("kN\t\n", "kN\n"),
        ),
        (
            "two-header-lines.csv",
            with_header("Test 4,Actuator,Actuator\nTime (s),Value (mm),Value (kN)", lines(POINT, ",")),
        ),
        ("comment-header.txt", with_header("# t x y", lines(POINT, " "))),
        ("comments.csv", {
            let text = with_header("# measured on Monday\n# rate 10 Hz\nt,x,y", lines(POINT, ","));
            text.replacen("\n2.0,", "\n# pause\n2.0,", 1)
        }),
        ("index-unnamed.csv", with_header(",t,x,y", table(",", indexed(0)))),
        ("index-named.csv", with_header("index,t,x,y", table(",", indexed(0)))),
        (
            "index-without-name.txt",
            with_header(
                "\"t\" \"x\" \"y\"",
                table(" ", |k, row| [vec![format!("\"{}\"", k + 1)], POINT.cells(row)].concat()),
            ),
        ),
        ("duplicate-names.csv", with_header("t,Channel,Channel", lines(POINT, ","))),
        ("status-column.csv", with_header("t,x,y,status", table(",", extended("ok")))),
        ("constant-column.csv", with_header("t,x,y,room_degC", table(",", extended("21.5")))),
        (
            "temperature-last.csv",
            with_header(
                "t_s,x_mm,F_kN,T_degC",
                table(",", |k, row| {
                    [POINT.cells(row), vec![format!("{:.2}", 20.0 + sin(0.3 * k as f64))]].concat()
                }),
            ),
        ),
        ("text-behind.csv", with_header("t,x,y", lines(POINT, ",")) + "\nEnd of test\nOperator: N. N.\n"),
        (
            "record-column.csv",
            with_header(
                "record,t,x,y",
                table(",", |k, row| {
                    [vec![if k < 24 { "up" } else { "down" }.into()], POINT.cells(row)].concat()
                }),
            ),
        ),
    ]
}

/// A number with its thousands separated.
fn grouped(value: i64, decimal: char, separator: &str) -> String {
    let (whole, part) = (value.abs() / 1000, value.abs() % 1000);
    let sign = if value < 0 { "-" } else { "" };
    let whole = if whole >= 1000 {
        format!("{}{separator}{:03}", whole / 1000, whole % 1000)
    } else {
        whole.to_string()
    };
    format!("{sign}{whole}{decimal}{part:03}")
}

fn numbers() -> Vec<Named> {
    let newtons = |decimal: char, separator: &'static str, quote: &'static str| {
        move |_: usize, row: Row| {
            let style = if decimal == '.' { POINT } else { COMMA };
            let force = format!("{quote}{}{quote}", grouped(1000 * row.y, decimal, separator));
            vec![style.time(row), style.x(row), force]
        }
    };
    let exponent = |letter: &'static str| {
        move |_: usize, row: Row| {
            let number = |value: i64, digits: i32| {
                let text = format!("{:.4e}", value as f64 / powi(10.0, digits));
                let (mantissa, power) = text.split_once('e').unwrap();
                let power: i32 = power.parse().unwrap();
                format!("{mantissa:>9}{letter}{}{:02}", if power < 0 { '-' } else { '+' }, power.abs())
            };
            vec![number(row.t, 1), number(row.x, 3), number(row.y, 3)]
        }
    };
    vec![
        ("exponents.csv", with_header("t,x,y", table(",", exponent("E")))),
        ("fortran-exponents.dat", with_header("t x y", table("  ", exponent("D")))),
        ("thousands-comma.csv", with_header("t_s,x_mm,F_N", table(",", newtons('.', ",", "\"")))),
        ("thousands-point.csv", with_header("t_s;x_mm;F_N", table(";", newtons(',', ".", "")))),
        ("thousands-blank.csv", with_header("t_s;x_mm;F_N", table(";", newtons(',', " ", "")))),
        ("thousands-apostrophe.csv", with_header("t_s;x_mm;F_N", table(";", newtons('.', "'", "")))),
        (
            "units-in-cells.csv",
            with_header(
                "Time,Displacement,Force",
                table(",", |_, row| {
                    vec![
                        format!("{} s", POINT.time(row)),
                        format!("{} mm", POINT.x(row)),
                        format!("{} kN", POINT.y(row)),
                    ]
                }),
            ),
        ),
        (
            "plus-signs.csv",
            with_header(
                "t,x,y",
                table(",", |_, row| {
                    POINT
                        .cells(row)
                        .iter()
                        .map(|cell| if cell.starts_with('-') { cell.clone() } else { format!("+{cell}") })
                        .collect()
                }),
            ),
        ),
    ]
}

/// The record without some of its outputs.
fn with_missing(word: &'static str) -> impl Fn(usize, Row) -> Vec<String> {
    move |k, row| {
        let mut cells = POINT.cells(row);
        if k % 10 == 7 {
            cells[2] = word.into();
        }
        cells
    }
}

fn missing() -> Vec<Named> {
    let file = |name, word| (name, with_header("t,x,y", table(",", with_missing(word))));
    vec![
        file("missing-empty.csv", ""),
        file("missing-nan.csv", "NaN"),
        file("missing-na.csv", "#N/A"),
        file("missing-dash.csv", "-"),
        file("missing-null.csv", "NULL"),
        file("missing-999.csv", "-999"),
        file("missing-word.csv", "overflow"),
    ]
}

/// A clock that begins before midnight, in tenths of a second.
fn clock(tenths: i64, decimal: char) -> String {
    let tenths = (tenths + 863_980).rem_euclid(864_000);
    let seconds = tenths / 10;
    format!("{:02}:{:02}:{:02}{decimal}{}", seconds / 3600, seconds / 60 % 60, seconds % 60, tenths % 10)
}

/// Whether the clock has passed midnight.
fn is_next_day(row: Row) -> bool {
    row.t >= 20
}

fn times() -> Vec<Named> {
    let timed = |header: &str, delimiter: &str, time: &dyn Fn(Row) -> String| {
        with_header(header, table(delimiter, |_, row| vec![time(row), POINT.x(row), POINT.y(row)]))
    };
    let american = |row: Row| {
        let tenths = (row.t + 863_980).rem_euclid(864_000);
        let (hour, rest) = (tenths / 36_000, tenths % 36_000);
        let half = if hour < 12 { "AM" } else { "PM" };
        let day = if is_next_day(row) { "3/2/2024" } else { "3/1/2024" };
        format!(
            "{day} {}:{:02}:{:02}.{} {half}",
            if hour % 12 == 0 { 12 } else { hour % 12 },
            rest / 600,
            rest / 10 % 60,
            rest % 10
        )
    };
    let iso = |row: Row, between: char, end: &str| {
        let day = if is_next_day(row) { "2024-03-01" } else { "2024-02-29" };
        format!("{day}{between}{}{end}", clock(row.t, '.'))
    };
    vec![
        ("time-iso.csv", timed("timestamp,x,y", ",", &|row| iso(row, 'T', "Z"))),
        ("time-iso-blank.csv", timed("timestamp,x,y", ",", &|row| iso(row, ' ', ""))),
        (
            "time-german.csv",
            with_header(
                "Datum und Uhrzeit;x;y",
                table(";", |_, row| {
                    let day = if is_next_day(row) { "01.03.2024" } else { "29.02.2024" };
                    vec![format!("{day} {}", clock(row.t, ',')), COMMA.x(row), COMMA.y(row)]
                }),
            ),
        ),
        ("time-american.csv", timed("Date/Time,x,y", ",", &american)),
        ("time-clock.csv", timed("clock,x,y", ",", &|row| clock(row.t, '.'))),
        (
            "time-date-and-clock.txt",
            timed("Date\tTime\tx\ty", "\t", &|row| {
                format!(
                    "{}\t{}",
                    if is_next_day(row) { "2024-03-01" } else { "2024-02-29" },
                    clock(row.t, '.')
                )
            }),
        ),
        ("time-milliseconds.csv", timed("time_ms,x,y", ",", &|row| (100 * row.t).to_string())),
        ("time-restarting.csv", timed("t,x,y", ",", &|row| POINT.number(row.t % 24, 1))),
        ("time-rounded.csv", timed("Elapsed,x,y", ",", &|row| POINT.number(5 * (row.t / 5), 1))),
        ("no-time.csv", with_header("x,y", table(",", |_, row| vec![POINT.x(row), POINT.y(row)]))),
    ]
}

fn languages() -> Vec<Named> {
    let file = |name, header: &str| (name, with_header(header, lines(COMMA, ";")));
    vec![
        file("german.csv", "Zeit [s];Weg [mm];Kraft [kN]"),
        file("french.csv", "Temps (s);Déplacement (mm);Effort (kN)"),
        file("spanish.csv", "Tiempo (s);Desplazamiento (mm);Fuerza (kN)"),
        file("russian.csv", "Время, с;Перемещение, мм;Сила, кН"),
        file("chinese.csv", "时间(s);位移(mm);荷载(kN)"),
        file("japanese.csv", "時間(s);変位(mm);荷重(kN)"),
    ]
}

/// Files that need an option; the error says which.
fn unclear() -> Vec<Named> {
    let swapped = |_: usize, row: Row| vec![POINT.time(row), POINT.y(row), POINT.x(row)];
    let many = |k: usize, row: Row| {
        let mut cells = vec![POINT.time(row)];
        cells.extend((1..=6).map(|gauge| format!("{:.3}", sin(f64::from(gauge) * 0.37 * k as f64))));
        cells.extend([POINT.x(row), POINT.y(row)]);
        cells
    };
    let doubled = |k: usize, row: Row| {
        vec![
            POINT.time(row),
            format!("{:.3}", 0.001 * row.x as f64 + 0.01 * sin(1.7 * k as f64)),
            POINT.x(row),
            POINT.y(row),
        ]
    };
    vec![
        ("force-first.csv", with_header("t_s,force_kN,disp_mm", table(",", swapped))),
        ("colons.txt", with_header("t:x:y", lines(POINT, ":"))),
        ("many-columns.csv", with_header("t,g1,g2,g3,g4,g5,g6,x,y", table(",", many))),
        ("command-and-measured.csv", with_header("t,command,measured,y", table(",", doubled))),
        ("growing-column.csv", with_header("position,x,y", lines(POINT, ","))),
        (
            "two-tables.csv",
            with_header("t,x,y", lines(POINT, ","))
                + "Second test\nt,x,y\n0.0,1.0,2.0\n0.1,1.1,2.2\n0.2,1.2,2.4\n",
        ),
        ("missing-input.csv", {
            let text = with_header("t,x,y", lines(POINT, ","));
            text.replacen("\n0.0,0.000,", "\n0.0,,", 1)
        }),
    ]
}

//! A folder to run the program in, and measured data to put there.
use std::fmt::{self, Display, Formatter};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use hysid_core::elementary::{cos, sin};
use tempfile::TempDir;

/// A folder of its own for one test.
pub struct Workbench {
    folder: TempDir,
}

/// Result of a run.
pub struct Ran {
    /// Exit status; `None` if a signal ended it.
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Ran {
    pub fn last_line(&self) -> &str {
        self.stderr.lines().last().unwrap_or_default()
    }
}

impl Display for Ran {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.stdout, self.stderr)
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Workbench {
    /// An empty folder.
    pub fn new() -> Self {
        Self { folder: TempDir::new().unwrap() }
    }

    /// A folder with `good.csv`, the small record.
    pub fn with_data() -> Self {
        let bench = Self::new();
        bench.put("good.csv", table());
        bench
    }

    /// A folder with `good.csv` and `model.json`, quickly trained on it.
    pub fn with_model() -> Self {
        let bench = Self::with_data();
        bench.succeeds("fit good.csv -o model.json --no-report --model xpnn+ --starts 1 --epochs 3");
        bench
    }

    /// Path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    /// A page without the script of its figures, which is the last thing in it.
    pub fn page(&self, name: &str) -> String {
        let text = self.text(name);
        let (page, end) = text.split_once("<script>\n// Figures of a page").expect("a page with figures");
        assert!(end.ends_with("</script>\n</body>\n</html>\n"), "{name}");
        page.to_string()
    }

    /// Reads a file.
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Names of the files in a folder of the workbench, in order.
    pub fn files(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program, to be run in the folder.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hysid"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &str) -> Ran {
        self.command(arguments).output().unwrap().into()
    }

    /// Runs what must succeed.
    #[track_caller]
    pub fn succeeds(&self, arguments: &str) -> Ran {
        let ran = self.run(arguments);
        assert_eq!(ran.status, Some(0), "hysid {arguments}: {}", ran.stderr);
        ran
    }

    /// Runs the program, which must succeed, and parses its stdout as JSON.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> serde_json::Value {
        json(&self.succeeds(arguments))
    }

    /// Runs the lines of a table of [`cases`], and compares exit status and last line of stderr.
    pub fn refuses(&self, table: &str) {
        for (status, arguments, expected) in cases(table) {
            let ran = self.run(arguments);
            assert_eq!(ran.last_line(), error_line(arguments, status, expected), "hysid {arguments}");
            assert_eq!((ran.status, ran.stdout.as_str()), (Some(status), ""), "hysid {arguments}");
        }
    }

    /// Runs the lines of such a table, each with a part of the last line of stderr.
    pub fn refuses_in_part(&self, table: &str) {
        for (status, arguments, part) in cases(table) {
            let ran = self.run(arguments);
            assert_eq!(ran.status, Some(status), "hysid {arguments}: {}", ran.stderr);
            assert!(ran.last_line().contains(part), "hysid {arguments}: {}", ran.stderr);
        }
    }

    /// Runs a line of shell in the folder; `hysid` is the program.
    pub fn shell(&self, line: &str) -> Ran {
        let program = assert_cmd::cargo::cargo_bin!("hysid");
        let line = format!("hysid() {{ '{}' \"$@\"; }}\n{line}", program.display());
        Command::new("sh").current_dir(self.folder.path()).args(["-c", &line]).output().unwrap().into()
    }
}

#[track_caller]
pub fn must_contain(text: &str, words: &[&str]) {
    for words in words {
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// Stdout of a successful run, parsed as JSON.
pub fn json(ran: &Ran) -> serde_json::Value {
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap_or_else(|error| panic!("{error}: {}", ran.stdout))
}

/// Names and columns of a table; NaN for a cell that is no number.
pub fn columns(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for row in reader.records() {
        for (column, cell) in columns.iter_mut().zip(&row.unwrap()) {
            column.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    (names, columns)
}

/// Rows of a table: on each line the exit status, the arguments of the program, `=>`, and its output.
pub fn cases(table: &str) -> impl Iterator<Item = (i32, &str, &str)> {
    table.lines().filter(|line| !line.trim().is_empty()).map(|line| {
        let (asked, said) = line.trim().split_once(" => ").unwrap();
        let (status, arguments) = asked.split_once(' ').unwrap();
        (status.parse().unwrap(), arguments, said)
    })
}

/// How errors begin that the parser of the command line finds.
const OF_THE_PARSER: [&str; 5] =
    ["invalid value", "unexpected argument", "the argument", "the following", "unrecognized"];

/// The line of an error as the program says it. A wrong command line (status 2) points to the help of its command, unless
/// the program itself names an option or a command that helps.
fn error_line(arguments: &str, status: i32, said: &str) -> String {
    let is_of_the_parser = OF_THE_PARSER.iter().any(|beginning| said.starts_with(beginning));
    let names_help = said.contains("--") || said.contains("hysid ");
    let help = match arguments.split(' ').next() {
        _ if status != 2 || (names_help && !is_of_the_parser) => String::new(),
        Some("fot") => " (see `hysid --help`)".into(),
        command => format!(" (see `hysid {} --help`)", command.unwrap_or_default()),
    };
    format!("error: {said}{help}")
}

/// Rows of [`table`].
pub const ROWS: usize = 60;

/// A small record of time, input and output with hysteresis: cells of each row.
pub fn rows() -> Vec<Vec<String>> {
    let row = |k: usize| {
        let phase = 0.3 * k as f64;
        let x = sin(phase) * (0.5 + k as f64 / 120.0);
        let number = |value: f64| format!("{value:.6}");
        vec![format!("{}.{}", k / 10, k % 10), number(x), number(x + 0.2 * cos(phase))]
    };
    (0..ROWS).map(row).collect()
}

/// The record as CSV.
pub fn table() -> String {
    csv("t,x,y", ",", "\n", &rows())
}

/// Rows as text, with this header, delimiter and line end.
pub fn csv(header: &str, delimiter: &str, end: &str, rows: &[Vec<String>]) -> String {
    let mut text = header.to_string() + end;
    for row in rows {
        text += &(row.join(delimiter) + end);
    }
    text
}

/// The table with one cell changed.
pub fn with_cell(row: usize, column: usize, cell: &str) -> String {
    let mut rows = rows();
    rows[row][column] = cell.into();
    csv("t,x,y", ",", "\n", &rows)
}

/// The table with every cell of a column changed.
pub fn with_column(column: usize, change: impl Fn(&str) -> String) -> String {
    let mut rows = rows();
    for row in &mut rows {
        row[column] = change(&row[column]);
    }
    csv("t,x,y", ",", "\n", &rows)
}

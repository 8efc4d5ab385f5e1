//! The program `hysid`: building it, and asking it a question that is answered within its time.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// How often to look whether the program has ended.
const PAUSE: Duration = Duration::from_millis(20);

/// The program's exit status after Ctrl-C.
const INTERRUPTED_STATUS: i32 = 130;

/// The longest reason that is told in full.
const LONGEST_REASON: usize = 200;

/// From now on Ctrl-C ends the question that is asked, and not us.
pub fn listen() -> Result<()> {
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::SeqCst)).context("cannot listen for Ctrl-C")
}

/// True once Ctrl-C was pressed.
fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// The release build of the program.
pub fn build() -> Result<PathBuf> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--release", "--locked", "--package", "hysid-cli"]).current_dir(product());
    let status = cargo.status().context("cargo could not be started")?;
    ensure!(status.success(), "the program could not be built ({status})");
    Ok(target().join("release").join(format!("hysid{}", std::env::consts::EXE_SUFFIX)))
}

/// The folder of the product's `Cargo.toml`.
pub fn product() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the laboratory lies in a folder of the product")
        .to_path_buf()
}

/// The target folder of the product.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| product().join("target"), PathBuf::from)
}

/// What the program says of its version.
pub fn version(program: &Path) -> Result<String> {
    let output = Command::new(program).arg("--version").stdin(Stdio::null()).output();
    let output = output.with_context(|| format!("{} could not be started", program.display()))?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// A program in a folder where its files are. Arguments are separated by blanks.
pub struct InFolder {
    pub program: PathBuf,
    pub folder: PathBuf,
}

impl InFolder {
    /// A file of the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The command, which reads nothing.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(&self.folder).args(arguments.split_whitespace()).stdin(Stdio::null());
        command
    }

    /// What it writes until it ends.
    pub fn output(&self, arguments: &str) -> Result<Output> {
        let output = self.command(arguments).output();
        output.with_context(|| format!("{} could not be started", self.program.display()))
    }
}

/// The last line on stderr.
pub fn last_line(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned()
}

/// How the program's answers are read.
pub type Reading<T> = fn(&str) -> Result<T, String>;

/// Runs the command and reads its answer; gives the reason if there is none, and `None` if Ctrl-C came first.
pub fn ask<T>(command: &mut Command, read: Reading<T>, limit: Option<Duration>) -> Option<Result<T, String>> {
    let began = Instant::now();
    let started = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut program = match started {
        Ok(program) => program,
        Err(error) => return Some(Err(format!("could not be started: {error}"))),
    };
    // Read while it runs: a full pipe would stop it.
    let (stdout, stderr) = (gather(program.stdout.take()), gather(program.stderr.take()));
    let status = loop {
        match program.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) => {}
            Err(error) => return Some(Err(error.to_string())),
        }
        let over = limit.filter(|&limit| began.elapsed() > limit);
        if interrupted() || over.is_some() {
            // Whoever ended by itself in the meantime need not be ended.
            let _ = program.kill();
            let _ = program.wait();
            return over.map(|limit| Err(format!("not done after {} s", limit.as_secs_f64())));
        }
        thread::sleep(PAUSE);
    };
    if status.code() == Some(INTERRUPTED_STATUS) || interrupted() && !status.success() {
        return None;
    }
    let [stdout, stderr] = [stdout, stderr].map(|text| text.join().unwrap_or_default());
    Some(outcome(read(&stdout), &stderr, status).map_err(|reason| shortened(&reason)))
}

/// Reads all there is in another thread.
fn gather(stream: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            // What came before an error is still worth telling.
            let _ = stream.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The answer, if there is one, whatever the exit status; otherwise what the program said last.
fn outcome<T>(answer: Result<T, String>, stderr: &str, status: ExitStatus) -> Result<T, String> {
    answer.map_err(|reason| {
        if status.success() {
            return reason;
        }
        let last = stderr.lines().map(str::trim).rfind(|line| !line.is_empty());
        let last = last.map(|line| line.strip_prefix("error: ").unwrap_or(line));
        last.map_or_else(|| status.to_string(), str::to_owned)
    })
}

fn shortened(reason: &str) -> String {
    match reason.char_indices().nth(LONGEST_REASON) {
        Some((end, _)) => format!("{}...", &reason[..end]),
        None => reason.to_owned(),
    }
}

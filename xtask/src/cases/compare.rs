//! Running `hysid compare` on one case, within its time.

use std::io::Read;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use super::answer::{self, Answer};
use super::interrupted;

/// How often to look whether the program has ended.
const PAUSE: Duration = Duration::from_millis(20);

/// The program's exit status after Ctrl-C.
const INTERRUPTED_STATUS: i32 = 130;

/// The longest reason that is told in full.
const LONGEST_REASON: usize = 200;

/// What the program says of its version.
pub fn version(program: &Path) -> Result<String> {
    let output = Command::new(program).arg("--version").stdin(Stdio::null()).output();
    let output = output.with_context(|| format!("{} could not be started", program.display()))?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Runs the command and reads its answer; gives the reason if there is none, and `None` if Ctrl-C came first.
pub fn run(command: &mut Command, limit: Option<Duration>) -> Option<Result<Vec<Answer>, String>> {
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
    Some(outcome(&stdout, &stderr, status).map_err(|reason| shortened(&reason)))
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

/// The answer, if there is one, whatever the exit status.
fn outcome(stdout: &str, stderr: &str, status: ExitStatus) -> Result<Vec<Answer>, String> {
    match answer::parse(stdout) {
        Ok(answers) if !answers.is_empty() => Ok(answers),
        parsed if status.success() => {
            Err(parsed.err().unwrap_or_else(|| "the answer is an empty list".into()))
        }
        _ => {
            let last = stderr.lines().map(str::trim).rfind(|line| !line.is_empty());
            let last = last.map(|line| line.strip_prefix("error: ").unwrap_or(line));
            Err(last.map_or_else(|| status.to_string(), str::to_owned))
        }
    }
}

fn shortened(reason: &str) -> String {
    match reason.char_indices().nth(LONGEST_REASON) {
        Some((end, _)) => format!("{}...", &reason[..end]),
        None => reason.to_owned(),
    }
}

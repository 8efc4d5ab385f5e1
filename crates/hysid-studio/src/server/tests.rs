use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::*;
use crate::folder::Folder;

/// A server that runs, asked byte by byte.
struct RunningServer {
    port: u16,
    address: String,
    studio: Arc<Studio>,
    ending: Ending,
    serving: Option<JoinHandle<()>>,
}

/// Status line, headers and body of an answer.
struct Answered {
    status: u16,
    headers: String,
    body: String,
}

impl RunningServer {
    fn begin(folder: &Path, limits: Limits) -> Self {
        let studio = Arc::new(Studio::open(Folder::open(Some(folder)).unwrap()).unwrap());
        let (server, ending) = Server::bind(Arc::clone(&studio), Some(0)).unwrap();
        let (port, address) = (server.port, server.address());
        let serving = std::thread::spawn(move || server.serve_within(limits));
        Self { port, address, studio, ending, serving: Some(serving) }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    fn ask(&self, request: &str, headers: &str, body: &str) -> Answered {
        asked(&mut self.connect(), self.port, request, headers, body).expect("an answer")
    }

    /// The token in the file that opens the page.
    fn filed_token(&self) -> String {
        let text = std::fs::read_to_string(self.studio.folder().entrance()).unwrap();
        let (_, rest) = text.split_once("?token=").unwrap();
        rest[..48].into()
    }

    /// The cookie with a ticket, for a token.
    fn ticket(&self, token: &str) -> Option<String> {
        let answer = self.ask(&format!("GET /?token={token}"), "", "");
        let (_, cookie) = answer.headers.split_once("set-cookie: ")?;
        assert_eq!(answer.status, 303);
        assert!(answer.headers.contains("location: /\r\n"), "{}", answer.headers);
        Some(cookie.split(';').next().unwrap().into())
    }

    /// The header with the key, which a ticket gives.
    fn key(&self, cookie: &str) -> Option<String> {
        let headers = format!("Origin: http://127.0.0.1:{}\r\nCookie: {cookie}\r\n", self.port);
        let answer = self.ask("POST /api/session", &headers, "");
        assert!(answer.headers.contains("Max-Age=0"), "{}", answer.headers);
        let answer: serde_json::Value = serde_json::from_str(&answer.body).unwrap();
        answer["key"].as_str().map(|key| format!("X-Hysid-Key: {key}\r\n"))
    }

    fn opened(&self) -> String {
        let token = self.address.split_once("?token=").unwrap().1;
        self.key(&self.ticket(token).unwrap()).unwrap()
    }
}

impl Drop for RunningServer {
    fn drop(&mut self) {
        self.ending.end();
        drop(self.serving.take().map(JoinHandle::join));
    }
}

/// Sends a request; `None` if the connection is closed without an answer.
fn asked(stream: &mut TcpStream, port: u16, request: &str, headers: &str, body: &str) -> Option<Answered> {
    let length = body.len();
    let text = format!(
        "{request} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\
         {headers}\r\n{body}"
    );
    stream.write_all(text.as_bytes()).ok()?;
    let mut answer = Vec::new();
    let mut block = [0; 4096];
    let length = |text: &str| -> Option<usize> {
        let (head, body) = text.split_once("\r\n\r\n")?;
        let length = head.split_once("content-length: ")?.1.split("\r\n").next()?.parse().ok()?;
        (body.len() >= length).then_some(length)
    };
    while length(&String::from_utf8_lossy(&answer)).is_none() {
        let read = stream.read(&mut block).ok().filter(|read| *read > 0)?;
        answer.extend(&block[..read]);
    }
    let text = String::from_utf8(answer).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    Some(Answered { status, headers: format!("{head}\r\n"), body: body.into() })
}

#[test]
fn tokens_work_once_and_only_the_key_reads_the_project() {
    let place = tempfile::tempdir().unwrap();
    let running = RunningServer::begin(&place.path().join("p"), Limits::default());
    let token = running.address.split_once("?token=").unwrap().1.to_string();
    let cookie = running.ticket(&token).unwrap();
    assert_eq!(running.ask(&format!("GET /?token={token}"), "", "").status, 403, "a second time");
    // What another server on this address would get: the cookie is no key, and is worth nothing once it was used.
    let with_cookie = format!("Cookie: {cookie}\r\n");
    assert_eq!(running.ask("GET /api/project", &with_cookie, "").status, 403);
    let key = running.key(&cookie).unwrap();
    assert_eq!(running.key(&cookie), None);
    assert_eq!(running.ask("GET /api/project", &key, "").status, 200);
    for wrong in
        ["", "X-Hysid-Key: 0\r\n", &key.replace("Key: ", "Key: 0"), &format!("X-Hysid-Key: {token}\r\n")]
    {
        assert_eq!(running.ask("GET /api/project", wrong, "").status, 403, "{wrong}");
    }
    let elsewhere = format!("{key}Origin: http://127.0.0.1:1\r\n");
    assert_eq!(running.ask("POST /api/reading", &elsewhere, "{}").status, 403);
    // The page itself holds nothing that is secret.
    let page = running.ask("GET /", "", "");
    assert_eq!(page.status, 200);
    assert!(!page.body.contains(key.trim_end().rsplit(' ').next().unwrap()));
}

#[test]
fn the_file_that_opens_the_page_is_private_and_always_new() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("p");
    let running = RunningServer::begin(&folder, Limits::default());
    let (first, printed) = (running.filed_token(), running.address.split_once("=").unwrap().1);
    assert_ne!(first, printed);
    assert!(running.key(&running.ticket(&first).unwrap()).is_some());
    let second = running.filed_token();
    assert_ne!(second, first);
    assert_eq!(running.ticket(&first), None);
    assert!(running.ticket(&second).is_some());
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |name: &str| folder.join(name).metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!(["studio.html", "", "data", "models"].map(mode), [0o600, 0o700, 0o700, 0o700]);
    }
    drop(running);
    assert!(!folder.join("studio.html").exists());
    // A file of the user stays, and the printed address does it alone.
    std::fs::write(folder.join("studio.html"), "mine").unwrap();
    let running = RunningServer::begin(&folder, Limits::default());
    running.opened();
    drop(running);
    assert_eq!(std::fs::read(folder.join("studio.html")).unwrap(), b"mine");
}

#[test]
fn strangers_that_only_wait_are_closed_and_shut_nobody_out() {
    let place = tempfile::tempdir().unwrap();
    let limits = Limits { header: Duration::from_secs(1), connections: 6 };
    let running = RunningServer::begin(&place.path().join("p"), limits);
    let key = running.opened();
    let mut own = running.connect();
    assert_eq!(asked(&mut own, running.port, "GET /api/project", &key, "").unwrap().status, 200);
    // More than there are connections: a half line each, and nothing more.
    let mut idle: Vec<TcpStream> = (0..20).map(|_| running.connect()).collect();
    idle.iter_mut().for_each(|stream| drop(stream.write_all(b"GET / HT")));
    let began = Instant::now();
    assert_eq!(running.ask("GET /api/project", &key, "").status, 200, "a new connection");
    assert_eq!(
        asked(&mut own, running.port, "GET /api/project", &key, "").unwrap().status,
        200,
        "the first one"
    );
    assert!(began.elapsed() < Duration::from_millis(800), "{:?}", began.elapsed());
    // Each is closed soon.
    for stream in &mut idle {
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
    }
    assert!(began.elapsed() < Duration::from_secs(10), "{:?}", began.elapsed());
}

#[test]
fn light_requests_are_answered_while_files_are_read_and_diagnoses_run() {
    let place = tempfile::tempdir().unwrap();
    let running = RunningServer::begin(&place.path().join("p"), Limits::default());
    let key = running.opened();
    running.studio.take_specimen("ferromagnet", 1, 0.0).unwrap();
    let _reading = running.studio.being_read();
    // Requests that wait for the files; nobody waits for them.
    let waiting: Vec<TcpStream> = (0..4).map(|_| running.connect()).collect();
    running.studio.forget_view();
    for mut stream in &waiting {
        let head = format!("GET /api/diagnosis HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{key}\r\n", running.port);
        stream.write_all(head.as_bytes()).unwrap();
    }
    std::thread::sleep(Duration::from_millis(100));
    drop(waiting);
    let answer = running.ask("GET /api/project", &key, "");
    let state: serde_json::Value = serde_json::from_str(&answer.body).unwrap();
    assert_eq!(state["is_reading"], true);
    assert_eq!(state["files"].as_array().unwrap().len(), 2);
    assert_eq!(
        running
            .ask("POST /api/fit/stop", &format!("{key}Origin: http://127.0.0.1:{}\r\n", running.port), "{}")
            .status,
        200
    );
}

#[test]
fn errors_have_words_and_not_too_many() {
    let place = tempfile::tempdir().unwrap();
    let running = RunningServer::begin(&place.path().join("p"), Limits::default());
    let headers = format!("{}Origin: http://127.0.0.1:{}\r\n", running.opened(), running.port);
    let long = "x".repeat(200_000);
    for (request, body) in [
        ("POST /api/fit", format!("{{\"{long}\": 1}}")),
        ("POST /api/fit", format!("{{\"options\": {{\"{long}\": 1}}}}")),
        ("POST /api/specimens", format!("{{\"name\": \"{long}\"}}")),
        ("POST /api/reading", "[".into()),
        ("PUT /api/project", String::new()),
        ("GET /api/files/x/columns", String::new()),
    ] {
        let answer = running.ask(request, &headers, &body);
        assert!((400..500).contains(&answer.status), "{request}: {}", answer.status);
        let error: serde_json::Value = serde_json::from_str(&answer.body).expect(&answer.body);
        let words = error["error"].as_str().unwrap();
        assert!((5..4096).contains(&words.len()), "{request}: {} bytes", words.len());
    }
}

#[test]
fn a_report_runs_the_script_of_the_program_alone() {
    let foreign = "<script>fetch('/api/project')</script>";
    let policy = |response: axum::response::Response| {
        response.headers()["content-security-policy"].to_str().unwrap().to_string()
    };
    let policies = [policy(assets::report_text(foreign.into())), policy(assets::report())];
    let page = hysid_document::html::script_of_pages();
    for policy in policies {
        let script = policy.split("; ").find(|part| part.starts_with("script-src")).unwrap().to_string();
        assert!(!script.contains("unsafe"), "{script}");
        assert!(!script.contains(&assets::checksum("fetch('/api/project')")), "{script}");
        assert!(script.contains(&assets::checksum(page)), "{script}");
    }
}

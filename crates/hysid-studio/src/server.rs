//! The server of a studio: on this machine only, for one page.

mod answer;
mod assets;
mod connections;
mod events;
mod files;
mod guard;
mod keys;
mod models;
mod routes;
#[cfg(test)]
mod tests;

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use hysid_core::words::{Hint, Words};
use hysid_document::{Problem, Result, problem};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, watch};

use crate::studio::Studio;
use connections::Limits;
use guard::Guard;
use keys::Keys;

/// The port that is tried first if none is asked for.
const PORT: u16 = 4973;

/// Requests that read tables or run models at the same time.
const COMPUTING: usize = 2;

/// Requests that diagnose at the same time. A diagnosis may take minutes, also when nobody waits for it any more.
const DIAGNOSING: usize = 1;

/// A server that listens and sends no responses yet.
pub struct Server {
    runtime: Runtime,
    listener: TcpListener,
    shared: Shared,
    keys: Arc<Keys>,
    port: u16,
}

/// State that all requests share.
#[derive(Clone)]
struct Shared {
    studio: Arc<Studio>,
    computing: Arc<Semaphore>,
    diagnosing: Arc<Semaphore>,
    /// Time after which a response is given up.
    longest: Duration,
    is_over: watch::Receiver<bool>,
}

#[derive(Clone)]
pub struct Ending {
    is_over: watch::Sender<bool>,
    keys: Arc<Keys>,
}

impl Ending {
    /// Answers what is asked already, and ends.
    pub fn end(&self) {
        self.keys.close();
        self.is_over.send_replace(true);
    }
}

impl Server {
    /// Listens on a port of this machine; without one on 4973, or on any that is free.
    ///
    /// # Errors
    /// A port that is taken.
    pub fn bind(studio: Arc<Studio>, port: Option<u16>) -> Result<(Self, Ending)> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("studio")
            .enable_all()
            .build()
            .map_err(|error| problem!("cannot start the threads: {error}"))?;
        let bind = |port: u16| {
            let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
            runtime.block_on(TcpListener::bind(address))
        };
        let no_port = |error| problem!("no port of this machine can be used: {error}");
        let listener = match port {
            Some(port) => bind(port).map_err(|error| match error.kind() {
                std::io::ErrorKind::AddrInUse => {
                    let words = Words::from(format!("port {port} is in use: name another one with "));
                    Problem::Request(words + Hint::Option("port") + ", or leave it out")
                }
                _ => problem!("port {port} cannot be used: {}", hysid_files::reason(&error)),
            })?,
            None => bind(PORT).or_else(|_| bind(0)).map_err(no_port)?,
        };
        let port = listener.local_addr().map_err(no_port)?.port();
        let (ending, is_over) = watch::channel(false);
        let keys = Arc::new(Keys::new(Arc::clone(&studio), port)?);
        let semaphore = |permits| Arc::new(Semaphore::new(permits));
        let shared = Shared {
            studio,
            computing: semaphore(COMPUTING),
            diagnosing: semaphore(DIAGNOSING),
            longest: answer::LONGEST_COMPUTATION,
            is_over,
        };
        let ending = Ending { is_over: ending, keys: Arc::clone(&keys) };
        Ok((Self { runtime, listener, shared, keys, port }, ending))
    }

    /// The address that opens the page once.
    pub fn address(&self) -> String {
        self.keys.address()
    }

    /// The file that opens the page, as often as is wanted; `None` if it could not be written.
    pub fn entrance(&self) -> Option<PathBuf> {
        self.keys.file()
    }

    /// Answers until it is ended. Reads the files of the project meanwhile.
    pub fn serve(self) {
        self.serve_within(Limits::default());
    }

    fn serve_within(self, limits: Limits) {
        let Self { runtime, listener, shared, keys, port } = self;
        let (studio, is_over) = (Arc::clone(&shared.studio), shared.is_over.clone());
        std::thread::spawn(move || studio.read_files());
        let router = routes::router(shared, Guard::new(port, keys));
        runtime.block_on(connections::serve(listener, router, limits, is_over));
        // What is computed for nobody does not hold up the end.
        runtime.shutdown_background();
    }
}

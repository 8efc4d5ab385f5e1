//! The server of a studio: on this machine only, for one page.

mod answer;
mod assets;
mod events;
mod files;
mod guard;
mod models;
mod routes;

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use hysid_records::Usage;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, watch};

use crate::studio::Studio;
use guard::Guard;

/// The port that is tried first if none is asked for.
const PORT: u16 = 4973;

/// Requests that compute at the same time.
const COMPUTING: usize = 2;

/// A server that listens and does not answer yet.
pub struct Server {
    runtime: Runtime,
    listener: TcpListener,
    shared: Shared,
    token: String,
    port: u16,
}

/// What every answer is made of.
#[derive(Clone)]
struct Shared {
    studio: Arc<Studio>,
    computing: Arc<Semaphore>,
    is_over: watch::Receiver<bool>,
}

/// Ends a server.
#[derive(Debug, Clone)]
pub struct Ending(watch::Sender<bool>);

impl Ending {
    /// Answers what is asked already, and ends.
    pub fn end(&self) {
        self.0.send_replace(true);
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
            .context("cannot start the threads")?;
        let bind = |port: u16| {
            let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
            runtime.block_on(TcpListener::bind(address))
        };
        let listener = match port {
            Some(port) => bind(port).map_err(|error| match error.kind() {
                std::io::ErrorKind::AddrInUse => anyhow::Error::from(Usage(format!(
                    "port {port} is in use: name another one with --port, or leave it out"
                ))),
                _ => anyhow!("port {port} cannot be used: {}", hysid_files::reason(&error)),
            })?,
            None => bind(PORT).or_else(|_| bind(0)).context("no port of this machine can be used")?,
        };
        let port = listener.local_addr()?.port();
        let (ending, is_over) = watch::channel(false);
        let shared = Shared { studio, computing: Arc::new(Semaphore::new(COMPUTING)), is_over };
        Ok((Self { runtime, listener, shared, token: guard::token()?, port }, Ending(ending)))
    }

    /// The address that opens the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    /// Answers until it is ended.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn serve(self) -> Result<()> {
        let Self { runtime, listener, shared, token, port } = self;
        let mut is_over = shared.is_over.clone();
        let router = routes::router(shared, Guard::new(port, token));
        runtime.block_on(async move {
            let over = async move {
                let _ = is_over.wait_for(|is_over| *is_over).await;
            };
            axum::serve(listener, router).with_graceful_shutdown(over).await
        })?;
        Ok(())
    }
}

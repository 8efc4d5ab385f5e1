//! Connections: each with a time limit for the lines of a request, and a bounded number of them.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::{AbortHandle, JoinSet};

/// Time after which a connection is tried again that the system refused: once one was closed, and if none could be.
const AFTER_FAILURE: [Duration; 2] = [Duration::from_millis(2), Duration::from_millis(100)];

/// Limits of connections.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Time for the first lines of a request; a connection without requests is closed after it too.
    pub header: Duration,
    /// Connections at the same time.
    pub connections: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { header: Duration::from_secs(20), connections: 128 }
    }
}

/// True once a request with the key has come over a connection.
#[derive(Debug, Clone, Default)]
pub struct Proof(Arc<AtomicBool>);

impl Proof {
    /// Says that a request had the key.
    pub fn give(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_given(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Connections, the oldest first.
#[derive(Default)]
struct Open(Vec<(AbortHandle, Proof)>);

impl Open {
    /// Closes the oldest connection that has not shown the key; false if there is none.
    fn close_a_stranger(&mut self) -> bool {
        self.0.retain(|(task, _)| !task.is_finished());
        let stranger = self.0.iter().position(|(_, proof)| !proof.is_given());
        stranger.map(|place| self.0.remove(place).0.abort()).is_some()
    }
}

/// Answers until it is over. When all connections are taken, a new one takes the place of the oldest that has not shown
/// the key: strangers shut nobody out.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    limits: Limits,
    mut is_over: watch::Receiver<bool>,
) {
    let (mut tasks, mut open) = (JoinSet::new(), Open::default());
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = tasks.join_next() => continue,
            _ = is_over.wait_for(|is_over| *is_over) => break,
        };
        let Ok((stream, _)) = accepted else {
            // Too many open files, most likely.
            let [soon, later] = AFTER_FAILURE;
            tokio::time::sleep(if open.close_a_stranger() { soon } else { later }).await;
            continue;
        };
        if tasks.len() >= limits.connections && !open.close_a_stranger() {
            continue;
        }
        let proof = Proof::default();
        let router = router.clone().layer(Extension(proof.clone()));
        open.0.push((tasks.spawn(answer(stream, router, limits, is_over.clone())), proof));
    }
    while tasks.join_next().await.is_some() {}
}

/// Answers the requests of a connection.
async fn answer(stream: TcpStream, router: Router, limits: Limits, mut is_over: watch::Receiver<bool>) {
    let mut server = http1::Builder::new();
    server.timer(TokioTimer::new()).header_read_timeout(limits.header);
    let service = TowerToHyperService::new(router);
    let mut connection = pin!(server.serve_connection(TokioIo::new(stream), service));
    let over = async move { drop(is_over.wait_for(|is_over| *is_over).await) };
    // A connection that breaks off is the affair of its other side.
    tokio::select! {
        _ = connection.as_mut() => {}
        () = over => {
            connection.as_mut().graceful_shutdown();
            let _ = connection.await;
        }
    }
}

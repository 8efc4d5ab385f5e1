//! Changes, as server-sent events for the page.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use futures_util::Stream;
use futures_util::stream::unfold;
use serde_json::json;
use tokio::sync::watch;

use super::Shared;
use crate::studio::News;

/// Least time between two events: a page cannot show more.
const BETWEEN: Duration = Duration::from_millis(150);

/// Time between two keep-alive messages, by which a browser notices that a connection is gone.
const ALIVE: Duration = Duration::from_secs(15);

/// State that a page has received.
struct PageState {
    shared: Shared,
    news: watch::Receiver<News>,
    project: Option<u64>,
    fit: u64,
}

/// Sends changes until the page or the studio is closed. The first event is the state of the project.
pub async fn events(State(shared): State<Shared>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let news = shared.studio.news();
    let fit = news.borrow().fit.wrapping_sub(1);
    let known = PageState { fit, news, shared, project: None };
    Sse::new(unfold(known, next)).keep_alive(KeepAlive::new().interval(ALIVE))
}

async fn next(mut known: PageState) -> Option<(Result<Event, Infallible>, PageState)> {
    loop {
        let present = *known.news.borrow_and_update();
        if known.project != Some(present.project) {
            known.project = Some(present.project);
            return Some((Ok(event("project", &json!({"version": present.project}))), known));
        }
        if known.fit != present.fit {
            known.fit = present.fit;
            if let Some(fit) = known.shared.studio.fit() {
                tokio::time::sleep(BETWEEN).await;
                return Some((Ok(event("fit", &json!(fit))), known));
            }
        }
        let mut is_over = known.shared.is_over.clone();
        tokio::select! {
            changed = known.news.changed() => changed.ok()?,
            _ = is_over.wait_for(|is_over| *is_over) => return None,
        }
    }
}

fn event(name: &str, data: &serde_json::Value) -> Event {
    Event::default().event(name).data(data.to_string())
}

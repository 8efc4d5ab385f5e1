//! Keys of a studio: a token that is used once, and the key that the page has from then on.
//!
//! A token is in the address that is printed, another in a file that only the user can read. Whoever opens one of them
//! gets a ticket in a cookie, which the page exchanges for the key at once. The key goes with every request in a header,
//! so it is in no address, and no other server gets it.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::studio::Studio;
use hysid_document::{Result, problem};

/// Bytes of a token, a ticket or the key.
const BYTES: usize = 24;

/// Time in which a page exchanges its ticket.
const TICKET_LIFE: Duration = Duration::from_secs(60);

/// Tokens, tickets and the key of a studio.
pub struct Keys {
    studio: Arc<Studio>,
    port: u16,
    key: String,
    valid: Mutex<Valid>,
}

/// Tokens and tickets that are valid until used.
struct Valid {
    /// The token of the printed address.
    printed: Option<String>,
    /// The token of the file.
    filed: Option<String>,
    tickets: Vec<(String, Instant)>,
}

impl Keys {
    /// Of a server on this port. Writes the file that opens the page.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn new(studio: Arc<Studio>, port: u16) -> Result<Self> {
        let valid = Valid { printed: Some(random()?), filed: None, tickets: Vec::new() };
        let keys = Self { studio, port, key: random()?, valid: Mutex::new(valid) };
        keys.valid().filed = keys.write_file();
        Ok(keys)
    }

    /// The address that opens the page once.
    pub fn address(&self) -> String {
        self.address_with(self.valid().printed.as_deref().unwrap_or_default())
    }

    fn address_with(&self, token: &str) -> String {
        format!("http://127.0.0.1:{}/?token={token}", self.port)
    }

    /// The file that opens the page, if it could be written.
    pub fn file(&self) -> Option<PathBuf> {
        self.valid().filed.as_ref().map(|_| self.studio.folder().entrance())
    }

    /// Removes the file that opens the page.
    pub fn close(&self) {
        if self.valid().filed.take().is_some() {
            self.studio.folder().remove_entrance();
        }
    }

    /// Writes the file with a new token, and gives it.
    fn write_file(&self) -> Option<String> {
        let token = random().ok()?;
        let address = self.address_with(&token);
        let body = format!(
            "<meta charset=\"utf-8\">\n<meta name=\"referrer\" content=\"no-referrer\">\n\
             <meta http-equiv=\"refresh\" content=\"0; url={address}\">\n<title>Hysid studio</title>\n\
             <p><a href=\"{address}\">Open the studio</a></p>\n"
        );
        self.studio.folder().write_entrance(&body).ok().map(|()| token)
    }

    /// A ticket for a token, which is then no longer valid; `None` for any other text.
    pub fn open(&self, token: &str) -> Option<String> {
        let ticket = random().ok()?;
        let mut valid = self.valid();
        if valid.printed.take_if(|known| are_same(known, token)).is_none() {
            valid.filed.take_if(|known| are_same(known, token))?;
            valid.filed = self.write_file();
        }
        valid.tickets.push((ticket.clone(), Instant::now()));
        Some(ticket)
    }

    /// The key for a ticket, which is then no longer valid.
    pub fn exchange(&self, ticket: &str) -> Option<&str> {
        let mut valid = self.valid();
        valid.tickets.retain(|(_, given)| given.elapsed() < TICKET_LIFE);
        let place = valid.tickets.iter().position(|(known, _)| are_same(known, ticket))?;
        valid.tickets.swap_remove(place);
        Some(&self.key)
    }

    /// True for the key.
    pub fn is_key(&self, text: &str) -> bool {
        are_same(&self.key, text)
    }

    fn valid(&self) -> MutexGuard<'_, Valid> {
        self.valid.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn random() -> Result<String> {
    let mut random = [0; BYTES];
    getrandom::fill(&mut random).map_err(|error| problem!("no random numbers: {error}"))?;
    Ok(random.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Takes the same time wherever the first difference is.
fn are_same(known: &str, text: &str) -> bool {
    let (known, text) = (known.as_bytes(), text.as_bytes());
    let differences = known.iter().zip(text).fold(0, |sum, (a, b)| sum | (a ^ b));
    known.len() == text.len() && differences == 0
}

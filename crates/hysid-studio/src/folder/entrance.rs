//! The file in the folder of a project that opens the page in a browser. It has a token, so only the user can read it.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use super::Folder;
use hysid_document::{Result, problem};

/// Opens the page in a browser.
pub(super) const ENTRANCE: &str = "studio.html";

/// How that file begins.
const ENTRANCE_MARK: &str = "<!DOCTYPE html>\n<meta name=\"generator\" content=\"Hysid studio\">\n";

impl Folder {
    /// The path of the file that opens the page in a browser.
    pub fn entrance(&self) -> PathBuf {
        self.root.join(ENTRANCE)
    }

    /// Writes the file that opens the page in a browser. Only the user can read it.
    pub fn write_entrance(&self, body: &str) -> Result<()> {
        let path = self.entrance();
        let stored = |error: std::io::Error| {
            problem!("{}: cannot be written: {}", path.display(), hysid_files::reason(&error))
        };
        if fs::symlink_metadata(&path).is_ok() && !self.remove_entrance() {
            return Err(problem!(
                "{}: a file is there already that the studio did not write",
                path.display()
            ));
        }
        let mut options = fs::OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&path).map_err(stored)?;
        file.write_all(format!("{ENTRANCE_MARK}{body}").as_bytes()).map_err(stored)
    }

    /// Removes the file that opens the page; false if it is of others.
    pub fn remove_entrance(&self) -> bool {
        let path = self.entrance();
        let is_ours = self.read(&path).is_ok_and(|text| text.starts_with(ENTRANCE_MARK.as_bytes()));
        is_ours && fs::remove_file(&path).is_ok()
    }
}

//! Paths in commands that a reader copies into a shell.

use std::borrow::Cow;
use std::path::Path;

use crate::visible::visible;

/// The path as an argument of a shell command.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else if let Cow::Owned(visible) = visible(&text.replace('\\', r"\\")) {
        // What is visible of control characters, shells read as these characters.
        format!("$'{}'", visible.replace('\'', r"\'"))
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shell_arguments_are_quoted_where_needed() {
        assert_eq!(shown(Path::new("a/b-1.csv")), "a/b-1.csv");
        assert_eq!(shown(Path::new("my data.csv")), "'my data.csv'");
        assert_eq!(shown(Path::new("a\n\x1b'b\\.csv")), r"$'a\n\x1b\'b\\.csv'");
    }
}

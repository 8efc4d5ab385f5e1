//! Paths in commands that a reader copies into a shell.

use std::path::Path;

use crate::visible::{is_hidden, visible};

/// The path as an argument of a shell command.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else if text.contains(is_hidden) {
        let quoted = text.chars().map(|letter| match letter {
            '\\' | '\'' => format!("\\{letter}"),
            // What is visible of control characters, shells read as these characters.
            hidden if hidden.is_ascii_control() => visible(&hidden.to_string()).into_owned(),
            hidden if is_hidden(hidden) => format!("\\U{:08x}", u32::from(hidden)),
            plain => plain.to_string(),
        });
        format!("$'{}'", quoted.collect::<String>())
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
        assert_eq!(shown(Path::new("$(touch x).csv")), "'$(touch x).csv'");
        assert_eq!(shown(Path::new("a\n\x1b'b\\.csv")), r"$'a\n\x1b\'b\\.csv'");
        assert_eq!(shown(Path::new("a\u{202e}b")), r"$'a\U0000202eb'");
    }
}

//! Words of commands that a reader copies into a shell.

use std::path::Path;

use crate::visible::{is_hidden, visible};

/// A path as an argument: never an option, whatever its name begins with. `-` stays, for standard input.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    quoted(&if text.starts_with('-') && text != "-" { format!("./{text}") } else { text })
}

/// The option of a name as it is typed.
pub fn flag(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// An option and its value, which may begin with a minus sign.
pub fn option(name: &str, value: &str) -> String {
    let between = if value.starts_with('-') { '=' } else { ' ' };
    format!("{}{between}{}", flag(name), quoted(value))
}

/// A text as one word of a shell command.
pub fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_string()
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

    #[test]
    fn no_path_and_no_value_is_read_as_an_option() {
        assert_eq!(shown(Path::new("-a.json")), "./-a.json");
        assert_eq!(shown(Path::new("-$x")), "'./-$x'");
        assert_eq!(shown(Path::new("-")), "-");
        assert_eq!(option("input", "x"), "--input x");
        assert_eq!(option("applied_force", "-$x"), "--applied-force='-$x'");
    }
}

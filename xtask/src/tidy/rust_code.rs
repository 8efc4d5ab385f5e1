//! Telling the code of a Rust source from its comments, strings and characters.

/// The text with comments, string literals and character literals blanked out. Lines keep their numbers.
pub fn code_only(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let inside_word = code.ends_with(is_word);
        match blank_length(rest, inside_word) {
            Some(length) => {
                let (blank, after) = rest.split_at(length);
                code.extend(blank.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
                rest = after;
            }
            None => {
                code.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    code
}

/// Whether `line` contains `pattern` and not merely as a part of a longer word.
pub fn contains_word(line: &str, pattern: &str) -> bool {
    line.match_indices(pattern).any(|(start, _)| {
        let before = &line[..start];
        let after = &line[start + pattern.len()..];
        let glued_before = pattern.starts_with(is_word) && before.ends_with(is_word);
        let glued_after = pattern.ends_with(is_word) && after.starts_with(is_word);
        !glued_before && !glued_after
    })
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The length in bytes of the comment or literal that `rest` starts with, if it does.
fn blank_length(rest: &str, inside_word: bool) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(block_comment_length(rest));
    }
    if !inside_word && let Some(length) = raw_string_length(rest) {
        return Some(length);
    }
    if rest.starts_with('"') {
        return Some(quoted_length(rest, '"'));
    }
    if let Some(quoted) = rest.strip_prefix('\'') {
        // 'a' and '\n' are characters, 'a alone is a lifetime.
        let mut following = quoted.chars();
        let (first, second) = (following.next()?, following.next());
        if first == '\\' || second == Some('\'') {
            return Some(quoted_length(rest, '\''));
        }
    }
    None
}

/// Block comments nest.
fn block_comment_length(rest: &str) -> usize {
    let mut depth = 0_usize;
    let mut position = 0;
    while position < rest.len() {
        let here = &rest[position..];
        if here.starts_with("/*") {
            depth += 1;
            position += 2;
        } else if here.starts_with("*/") {
            depth -= 1;
            position += 2;
            if depth == 0 {
                return position;
            }
        } else {
            position += here.chars().next().map_or(1, char::len_utf8);
        }
    }
    rest.len()
}

/// `r"..."`, `r#"..."#`, and the same after `b` or `c`.
fn raw_string_length(rest: &str) -> Option<usize> {
    let after_prefix =
        rest.strip_prefix("br").or_else(|| rest.strip_prefix("cr")).or_else(|| rest.strip_prefix('r'))?;
    let after_hashes = after_prefix.trim_start_matches('#');
    let hashes = after_prefix.len() - after_hashes.len();
    let body = after_hashes.strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let opening = rest.len() - body.len();
    let length = body.find(&end).map_or(body.len(), |at| at + end.len());
    Some(opening + length)
}

/// A literal between two `quote`s, in which a backslash shields the next character.
fn quoted_length(rest: &str, quote: char) -> usize {
    let mut shielded = false;
    for (position, c) in rest.char_indices().skip(1) {
        if shielded {
            shielded = false;
        } else if c == '\\' {
            shielded = true;
        } else if c == quote {
            return position + c.len_utf8();
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The code with every run of blanks shortened to one space.
    fn words(text: &str) -> String {
        let code = code_only(text);
        code.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn comments_are_no_code() {
        assert_eq!(words("a // b\nc"), "a c");
        assert_eq!(words("a /* b /* c */ d */ e"), "a e");
        assert_eq!(words("/// a `b`\nc // \"\nd"), "c d");
        assert_eq!(words("a /* never ends"), "a");
    }

    #[test]
    fn strings_are_no_code() {
        assert_eq!(words(r#"a("b // \" c", d)"#), "a( , d)");
        assert_eq!(words("a(r#\"b \" c\"#, d)"), "a( , d)");
        assert_eq!(words("a(br\"b\\\", d)"), "a( , d)");
        assert_eq!(words("a(\"α → β\", γ)"), "a( , γ)");
        assert_eq!(words("a(\"never ends"), "a(");
    }

    #[test]
    fn raw_identifiers_are_code() {
        assert_eq!(words("r#type + for_r"), "r#type + for_r");
    }

    #[test]
    fn characters_are_no_code_but_lifetimes_are() {
        assert_eq!(words(r"a('b', '\'', '\\', '\u{e9}', '→');"), "a( , , , , );");
        assert_eq!(words("fn a<'b>(c: &'b str)"), "fn a<'b>(c: &'b str)");
        assert_eq!(words("('\"', a, '\"')"), "( , a, )");
    }

    #[test]
    fn line_numbers_are_kept() {
        let text = "/* 1\n2 */ a\n\"4\n5\" b";
        let code = code_only(text);
        let lines: Vec<&str> = code.split('\n').map(str::trim).collect();
        assert_eq!(lines, ["", "a", "", "b"]);
    }

    #[test]
    fn words_are_whole() {
        assert!(contains_word("let t = Instant::now();", "Instant"));
        assert!(!contains_word("let t = Instantaneous;", "Instant"));
        assert!(contains_word("print!(x)", "print!"));
        assert!(!contains_word("eprint!(x)", "print!"));
        assert!(contains_word("std::fs::read", "fs::"));
        assert!(!contains_word("offs::read", "fs::"));
    }
}

//! JSON for readers.

use serde::Serialize;

use crate::visible::is_hidden;

/// An object of JSON: fields with their values, in their order. The crate needs `serde`.
#[macro_export]
macro_rules! object {
    ($($(#[$attribute:meta])* $field:ident: $value:expr),* $(,)?) => {{
        #[allow(non_camel_case_types)]
        mod object {
            #[derive(serde::Serialize)]
            pub struct Object<$($field),*> {
                $($(#[$attribute])* pub $field: $field),*
            }
        }
        object::Object { $($field: $value),* }
    }};
}

/// True for `null` and an empty list, which an [`object!`](crate::object) leaves out of a field with
/// `#[serde(skip_serializing_if = "hysid_document::is_nothing")]`.
pub fn is_nothing(value: &impl Serialize) -> bool {
    let is_empty = |value: serde_json::Value| value.is_null() || value == serde_json::json!([]);
    serde_json::to_value(value).is_ok_and(is_empty)
}

/// JSON that a terminal can show: characters that serde leaves as they are, such as those that turn the direction of
/// the text, are escaped too.
pub fn json(value: &impl Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string_pretty(value)?;
    let mut shown = String::with_capacity(text.len() + 1);
    for letter in text.chars() {
        match letter {
            // Outside of strings JSON has no other white space, and inside it is escaped already.
            '\n' => shown.push('\n'),
            hidden if is_hidden(hidden) => {
                for half in hidden.encode_utf16(&mut [0; 2]) {
                    shown.push_str(&format!("\\u{half:04x}"));
                }
            }
            plain => shown.push(plain),
        }
    }
    Ok(shown + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_reads_back_as_the_same_and_hides_nothing() {
        let value = vec!["a\n\u{9b}2J\u{7f}\u{202e}\u{e0041}\"é".to_string()];
        let text = json(&value).unwrap();
        assert!(!text.chars().any(|letter| letter != '\n' && is_hidden(letter)), "{text:?}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).unwrap(), value);
    }
}

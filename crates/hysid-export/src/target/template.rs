//! Files that are written by hand, with places to be filled in.

/// The template with each word replaced by its text. What is filled in is not searched again.
pub(super) fn filled(template: &str, words: &[(&str, &str)]) -> String {
    let mut text = String::with_capacity(template.len());
    let mut rest = template;
    loop {
        let next = words.iter().filter_map(|pair| rest.find(pair.0).map(|place| (place, pair)));
        let Some((place, (word, with))) = next.min_by_key(|(place, _)| *place) else { break };
        text += &rest[..place];
        text += with;
        rest = &rest[place + word.len()..];
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_stays_as_it_is() {
        assert_eq!(
            filled("NAME of UPPER, @x@", &[("NAME", "UPPER"), ("UPPER", "Z"), ("@x@", "")]),
            "UPPER of Z, "
        );
    }
}

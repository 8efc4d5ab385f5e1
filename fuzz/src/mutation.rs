//! Changes to bytes, drawn at random: of bits, bytes and stretches, and of the numbers and words of a text.

use rand::{Rng, RngExt};

/// Longest input that is made.
const LONGEST: usize = 1 << 16;

/// Some changes to one of the inputs, maybe with a stretch of another.
pub fn mutated(corpus: &[Vec<u8>], words: &[&str], generator: &mut impl Rng) -> Vec<u8> {
    let mut bytes = pick(corpus, generator).clone();
    for _ in 0..1 + generator.random_range(0..6) {
        change(&mut bytes, corpus, words, generator);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn pick<'c, T>(all: &'c [T], generator: &mut impl Rng) -> &'c T {
    &all[generator.random_range(0..all.len())]
}

fn change(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], words: &[&str], generator: &mut impl Rng) {
    let place =
        |length: usize, generator: &mut _| -> usize { Rng::next_u64(generator) as usize % (length + 1) };
    let at = place(bytes.len(), generator);
    match generator.random_range(0..9) {
        0 if at < bytes.len() => bytes[at] ^= 1 << generator.random_range(0..8),
        1 if at < bytes.len() => bytes[at] = generator.random(),
        2 => bytes.insert(at, generator.random()),
        3 => {
            let end = (at + place(16, generator)).min(bytes.len());
            bytes.drain(at..end);
        }
        // A stretch once more, elsewhere.
        4 => {
            let end = (at + place(64, generator)).min(bytes.len());
            let stretch = bytes[at..end].to_vec();
            let to = place(bytes.len(), generator);
            bytes.splice(to..to, stretch);
        }
        // A stretch of another input.
        5 => {
            let other = pick(corpus, generator);
            let from = place(other.len(), generator);
            let end = (from + place(64, generator)).min(other.len());
            let over = (at + (end - from)).min(bytes.len());
            bytes.splice(at..over, other[from..end].iter().copied());
        }
        6 if !words.is_empty() => {
            bytes.splice(at..at, pick(words, generator).bytes());
        }
        7 if !words.is_empty() => {
            let word: &&str = pick(words, generator);
            replace_number(bytes, at, word);
        }
        _ if bytes.len() >= 8 => {
            // Numbers of eight bytes, as in a checkpoint.
            const NUMBERS: [f64; 9] =
                [0.0, -1.0, 1e308, -1e308, 5e-324, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e15];
            let first = at.min(bytes.len() - 8);
            bytes[first..first + 8].copy_from_slice(&pick(&NUMBERS, generator).to_be_bytes());
        }
        _ => bytes.push(generator.random()),
    }
}

/// Puts a word in the place of the number at or after a place of a text.
fn replace_number(bytes: &mut Vec<u8>, at: usize, word: &str) {
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let Some(from) = bytes[at..].iter().position(u8::is_ascii_digit).map(|offset| at + offset) else {
        return;
    };
    let before = bytes[..from].iter().rev().take_while(|byte| is_of_number(byte)).count();
    let after = bytes[from..].iter().take_while(|byte| is_of_number(byte)).count();
    bytes.splice(from - before..from + after, word.bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_replaced_as_a_whole() {
        let mut text = b"{\"a\": -1.5e3, \"b\": 2}".to_vec();
        replace_number(&mut text, 8, "7");
        assert_eq!(text, b"{\"a\": 7, \"b\": 2}");
        replace_number(&mut text, 9, "null");
        assert_eq!(text, b"{\"a\": 7, \"b\": null}");
        let before = text.clone();
        replace_number(&mut text, 9, "0");
        assert_eq!(text, before);
    }
}

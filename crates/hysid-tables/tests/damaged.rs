//! Damaged files: every one is read or refused, and none ends the program.

use std::fs;
use std::path::Path;

use hysid_tables::{Reading, Table};

/// Bytes that change what a table looks like.
const BYTES: &[u8] = b"\"\n\r\t,;. #\0\xff-eE1:";

/// Reads a file; what comes of it does not matter here.
fn read(bytes: &[u8]) {
    let _ = Table::from_bytes(Path::new("f"), bytes.to_vec(), &Reading::default());
}

/// A random number generator of the least kind.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

fn files(endings: &[&str]) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hysid-cli/tests/files");
    let names = fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let wanted = names.filter(|name| endings.iter().any(|ending| name.ends_with(ending)));
    let mut files: Vec<(String, Vec<u8>)> =
        wanted.map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

#[test]
fn damaged_binary_files_are_refused() {
    for (name, whole) in files(&[".xlsx", ".mat", ".gz"]) {
        println!("{name}");
        for end in (0..whole.len()).step_by(whole.len() / 50 + 1) {
            read(&whole[..end]);
        }
        let mut state = 1;
        for _ in 0..300 {
            let mut damaged = whole.clone();
            for _ in 0..1 + next(&mut state) % 4 {
                let place = next(&mut state) % damaged.len();
                damaged[place] = next(&mut state) as u8;
            }
            read(&damaged);
        }
    }
}

#[test]
fn damaged_text_is_read_or_refused() {
    for (name, whole) in files(&[".csv", ".txt", ".dat", ".lvm", ".out"]) {
        println!("{name}");
        let mut state = 1;
        for _ in 0..60 {
            let mut damaged = whole.clone();
            for _ in 0..1 + next(&mut state) % 6 {
                let place = next(&mut state) % damaged.len();
                damaged[place] = BYTES[next(&mut state) % BYTES.len()];
            }
            damaged.truncate(1 + next(&mut state) % whole.len());
            read(&damaged);
        }
    }
}

/// Content in which something stands for every kind of file that has several tables.
fn several() -> Vec<Vec<u8>> {
    let row = |k: usize| format!("{k}.5,{},{k},{}", k * k % 7, k % 5);
    let rows: String = (0..30).map(|k| row(k) + "\n").collect();
    let numbers =
        |of: &dyn Fn(usize) -> usize| (0..30).map(|k| of(k).to_string()).collect::<Vec<_>>().join(",");
    let (line, other) = (numbers(&|k| k), numbers(&|k| k * k % 7));
    vec![
        format!("H,M,H,M\n{rows}").into_bytes(),
        format!("Test 1\na,b,c,d\n{rows}\nTest 2\na,b,c,d\n{rows}e,f\n1,2\n3,4\n5,6\n").into_bytes(),
        format!("x,{line}\ny,{other}\n").into_bytes(),
        format!("H,M_up,M_down\n{}", rows.replace(",0\n", "\n").replace(",1\n", "\n")).into_bytes(),
        format!("{{\"a\": {{\"t\": [{line}], \"x\": [{other}]}}, \"b\": [[1, 2], [3, 4]]}}").into_bytes(),
        format!("[{{\"t\": 1, \"x\": 2}}, {{\"t\": 3}}, [{line}]]").into_bytes(),
    ]
}

#[test]
fn damaged_files_with_several_tables_are_read_or_refused() {
    for whole in several() {
        let mut state = 1;
        for _ in 0..150 {
            let mut damaged = whole.clone();
            for _ in 0..1 + next(&mut state) % 6 {
                let place = next(&mut state) % damaged.len();
                damaged[place] = b"\"\n\t,[]{}:#e1 "[next(&mut state) % 13];
            }
            damaged.truncate(1 + next(&mut state) % (2 * whole.len()));
            read(&damaged);
        }
    }
}

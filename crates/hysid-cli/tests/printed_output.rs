//! `docs/how-to/read-files.md` shows what the program prints: each `console` block has a command after `$`, and below it
//! its stdout and stderr to the letter.

mod workbench;

use std::fs;
use std::path::Path;

use workbench::Workbench;

/// The commands of a page and what the page says they print.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let blocks = page.split("```console\n$ hysid ").skip(1);
    blocks.filter_map(|rest| rest.split_once("\n```")?.0.split_once('\n')).collect()
}

#[test]
fn the_page_shows_what_is_printed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("../../docs/how-to/read-files.md")).unwrap().replace("\r\n", "\n");
    let blocks = blocks(&page);
    assert!(blocks.len() > 5);
    let bench = Workbench::new();
    for (command, shown) in blocks {
        let file = command.split(' ').nth(1).unwrap();
        bench.put(file, fs::read(root.join("tests/files").join(file)).unwrap());
        let ran = bench.run(command);
        let printed = format!("{}{}", ran.stdout, ran.stderr);
        assert_eq!(printed.trim_end(), shown, "`hysid {command}`");
    }
}

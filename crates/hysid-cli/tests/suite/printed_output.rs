//! `docs/how-to/read-files.md` shows what the program prints: each `console` block has a command after `$`, and below it
//! its stdout and stderr to the letter. `docs/options.md` and `docs/files.md` explain every option of `hysid fit`.

use std::fs;
use std::path::Path;

use crate::workbench::Workbench;

/// The commands of a page and their output on the page.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let blocks = page.split("```console\n$ hysid ").skip(1);
    blocks.filter_map(|rest| rest.split_once("\n```")?.0.split_once('\n')).collect()
}

#[test]
fn the_page_shows_what_is_printed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page =
        fs::read_to_string(root.join("../../docs/how-to/read-files.md")).unwrap().replace("\r\n", "\n");
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

#[test]
fn every_option_of_a_fit_is_on_a_page() {
    let page = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
        fs::read_to_string(path).unwrap()
    };
    let pages = page("options.md") + &page("files.md");
    let help = Workbench::new().run("fit --help options").stdout;
    let words =
        help.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(str::split_whitespace);
    let options: Vec<&str> = words.filter_map(|word| word.strip_prefix("--")).collect();
    assert!(options.len() > 40);
    for option in options {
        let keyword = option.replace('-', "_");
        let is_there = pages.contains(&format!("### `{keyword}`"))
            || ["`", " "].iter().any(|end| pages.contains(&format!("`--{option}{end}")));
        assert!(is_there || option == "help", "no page explains `--{option}`");
    }
}

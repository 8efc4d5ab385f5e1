//! Text of a table: what is read is data, or one line says why not.

use crate::assert_is_one_line;

pub const WORDS: [&str; 24] = [
    "t", "time", "x", "y", "record", "t_ms", "# ", ",", ";", "\t", "\n", "\r\n", "\r", "\"", "\"\"", " ",
    "1e5", "-1", "NaN", "inf", "0x1", "\u{feff}", "1,5", "é",
];

pub fn run(text: &[u8]) {
    match hysid_records::data_of_text(text) {
        Ok(data) => {
            assert!(data.rows() > 0);
            for record in data.records() {
                assert!(record.inputs().iter().all(|input| input.iter().all(|x| x.is_finite())));
                assert!(record.output().iter().all(|y| !y.is_infinite()));
                let time = record.time().unwrap_or_default();
                assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
            }
        }
        Err(error) => assert_is_one_line(&format!("{error:#}")),
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    let table = |header: &str, delimiter: &str, end: &str| {
        let rows = (0..12).map(|k| format!("{k}{delimiter}{}{delimiter}{}", k % 5, 0.5 * f64::from(k)));
        let rows: Vec<String> = std::iter::once(header.replace(',', delimiter)).chain(rows).collect();
        (rows.join(end) + end).into_bytes()
    };
    vec![
        table("t,x,y", ",", "\n"),
        table("time (s),\"in,put\",y", ";", "\r\n"),
        table("record,x,y", "\t", "\n"),
        b"# a remark\n\nx,y\n1,\n2,0.5\n".to_vec(),
        b"{\"format\": 1}".to_vec(),
        // A letter of two bytes, cut by a delimiter.
        b"x,y\n1\xc9,\xb72\n".to_vec(),
    ]
}

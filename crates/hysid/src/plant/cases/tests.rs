use std::collections::BTreeSet;

use super::*;

/// All numbers of a data set, to the last bit.
fn bits(data: &Dataset) -> Vec<u64> {
    let columns = |record: &Record| {
        let inputs = record.inputs().iter().map(Vec::as_slice);
        inputs
            .chain(record.time())
            .chain([record.output()])
            .flatten()
            .map(|v| v.to_bits())
            .collect::<Vec<_>>()
    };
    data.records().iter().flat_map(columns).collect()
}

#[test]
fn a_seed_and_a_number_fix_a_case() {
    let (cases, again) = (generated(KINDS, 1).unwrap(), generated(KINDS + 1, 1).unwrap());
    let other = generated(KINDS, 2).unwrap();
    for (case, (again, other)) in cases.iter().zip(again.iter().zip(&other)) {
        assert_eq!(case.name, again.name);
        for (data, same) in [(&case.train, &again.train), (&case.test, &again.test)] {
            assert_eq!(data.names(), same.names());
            assert!(bits(data) == bits(same), "{}", case.name);
        }
        assert!(bits(&case.train) != bits(&other.train), "{}", case.name);
    }
    let round = &again[KINDS];
    assert_eq!(round.law, cases[0].law);
    assert!(bits(&round.train) != bits(&cases[0].train));
}

#[test]
fn cases_are_as_engineers_measure() {
    for seed in 1..=3 {
        let cases = generated(KINDS, seed).unwrap();
        let laws: BTreeSet<_> = cases.iter().map(|case| case.law).collect();
        assert!(laws.len() >= 12, "{laws:?}");
        for Case { name, train, test, .. } in &cases {
            assert!((200..=4000).contains(&train.scored()), "{name}: {} rows in training", train.scored());
            assert!((130..=3000).contains(&test.scored()), "{name}: {} rows in the test", test.scored());
            for record in train.records().iter().chain(test.records()) {
                assert!(record.scored() > 0, "{name}: {} is blank", record.name());
            }
            train.check_identifiable(10).unwrap();
        }
    }
}

/// Where the test goes on with a record of training, it begins with the input of training, all blank.
#[test]
fn continued_records_carry_their_past() {
    let cases = generated(KINDS, 1).unwrap();
    let continued = cases.iter().filter(|case| case.design.contains("first"));
    let mut count = 0;
    for Case { name, train, test, .. } in continued {
        let (train, test) = (&train.records()[0], &test.records()[0]);
        let past = train.len();
        assert!(train.scored() == past && test.len() > past, "{name}");
        assert_eq!(train.inputs()[0][..], test.inputs()[0][..past], "{name}");
        assert!(test.output()[..past].iter().all(|y| y.is_nan()), "{name}");
        assert_eq!(test.scored(), test.len() - past, "{name}");
        count += 1;
    }
    assert_eq!(count, KINDS / 3 + 1);
}

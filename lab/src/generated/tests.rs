use std::collections::BTreeSet;

use super::*;

/// All numbers of a data set, to the last bit.
fn bits(data: &Dataset) -> Vec<u64> {
    let columns = |record: &Record| {
        let inputs = record.inputs().iter().map(|input| &**input);
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

#[test]
fn one_loop_has_no_reversal_inside_and_its_test_has() {
    let cases = one_loop(26, 1).unwrap();
    assert_eq!(cases[3].train, one_loop(4, 1).unwrap()[3].train);
    for Case { name, train, test, .. } in &cases {
        let (low, high) = train.input_range(0);
        let at_an_end =
            |x: &f64| x.min(high - 1e-9 * (high - low)) <= low || *x >= high - 1e-9 * (high - low);
        let turning = |record: &Record| -> Vec<f64> {
            let x = &record.inputs()[0];
            hysid_core::data::turning_points::turning_points(x, 0.02 * (high - low))
                .into_iter()
                .map(|row| x[row])
                .collect()
        };
        assert!(train.records().iter().flat_map(turning).all(|x| at_an_end(&x)), "{name}");
        assert!(test.records().iter().all(|record| !turning(record).iter().all(at_an_end)), "{name}");
        let of_test = test.input_range(0);
        assert!((of_test.0 - low).abs() + (of_test.1 - high).abs() < 1e-9 * (high - low), "{name}");
        assert!(test.records().iter().all(|record| record.scored() > 0), "{name}");
        train.check_identifiable(10).unwrap();
    }
}

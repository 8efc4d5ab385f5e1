use super::super::answer::Answer;
use super::*;

fn figures(test: f64) -> Figures {
    Figures { test: Some(test), ..Figures::default() }
}

fn answer(model: &str, figures: Result<Figures, &str>) -> Answer {
    Answer { model: model.into(), figures: figures.map_err(str::to_owned) }
}

fn case(name: &str, answers: Vec<Answer>) -> Case {
    Case { name: name.into(), outcome: Ok(answers) }
}

fn failed(name: &str, reason: &str) -> Case {
    Case { name: name.into(), outcome: Err(reason.into()) }
}

fn test_table(cases: &[Case]) -> (String, String) {
    let mut reasons = Reasons::default();
    let table = table(cases, |figures| figures.test, &mut reasons);
    (table, reasons.list())
}

#[test]
fn columns_are_aligned_and_the_best_is_marked() {
    let cases = [
        case("steel", vec![answer("pnn", Ok(figures(8.0))), answer("xpnn+", Ok(figures(2.0)))]),
        case("a-ferrite", vec![answer("pnn", Ok(figures(0.5))), answer("xpnn+", Ok(figures(128.4)))]),
    ];
    let expected = "\
| case           |       pnn |    xpnn+ |
| -------------- | --------: | -------: |
| steel          |      8.00 | **2.00** |
| a-ferrite      | **0.500** |      128 |
| geometric mean |  **2.00** |     16.0 |
";
    assert_eq!(test_table(&cases), (expected.into(), String::new()));
}

#[test]
fn failures_are_cells_with_a_reason_told_once() {
    let cases = [
        case("one", vec![answer("pnn", Err("takes one input, not 2")), answer("xpnn", Ok(figures(4.0)))]),
        failed("two", "train.csv, line 3: is no number"),
        case("three", vec![answer("pnn", Err("takes one input, not 2")), answer("xpnn", Ok(figures(9.0)))]),
        case("four", vec![answer("xpnn", Ok(Figures::default()))]),
    ];
    let expected = "\
| case           |         xpnn |   pnn |
| -------------- | -----------: | ----: |
| one            |     **4.00** | – (1) |
| two            |        – (2) | – (2) |
| three          |     **9.00** | – (1) |
| four           |        – (3) | – (4) |
| geometric mean | **6.00** (2) |     – |
";
    let reasons = "\
1. takes one input, not 2
2. train.csv, line 3: is no number
3. the answer has no such number
4. not among the answers
";
    assert_eq!(test_table(&cases), (expected.into(), reasons.into()));
}

#[test]
fn a_model_that_fails_where_it_is_hard_has_not_the_best_mean() {
    let cases = [
        case("easy", vec![answer("brittle", Ok(figures(1.0))), answer("sturdy", Ok(figures(2.0)))]),
        case("hard", vec![answer("brittle", Err("diverged")), answer("sturdy", Ok(figures(50.0)))]),
    ];
    let (table, _) = test_table(&cases);
    let mean = table.lines().last().unwrap();
    assert_eq!(mean, "| geometric mean | **10.0** | 1.00 (1) |");
}

#[test]
fn without_any_answer_the_reasons_stay() {
    let reason = "unrecognized subcommand 'compare'";
    let (table, reasons) = test_table(&[failed("one", reason), failed("two", reason)]);
    let expected = "\
| case           | any model |
| -------------- | --------: |
| one            |     – (1) |
| two            |     – (1) |
| geometric mean |         – |
";
    assert_eq!((table.as_str(), reasons.as_str()), (expected, "1. unrecognized subcommand 'compare'\n"));
}

#[test]
fn the_best_model_is_on_the_left() {
    let cases = [
        case("one", vec![answer("middling", Ok(figures(2.0))), answer("best", Ok(figures(3.0)))]),
        case(
            "two",
            vec![
                answer("never", Err("diverged")),
                answer("once", Ok(figures(0.1))),
                answer("best", Ok(figures(1.0))),
                answer("middling", Ok(figures(2.0))),
            ],
        ),
    ];
    assert_eq!(models(&cases), ["best", "middling", "once", "never"]);
}

#[test]
fn three_digits_are_shown_after_rounding() {
    for (value, text) in [
        (0.0, "0"),
        (1e-7, "1.00e-7"),
        (0.001234, "0.00123"),
        (0.19, "0.190"),
        (9.994, "9.99"),
        (9.996, "10.0"),
        (99.96, "100"),
        (12345.6, "12346"),
        (999_999.0, "1.00e6"),
        (3.456e8, "3.46e8"),
    ] {
        assert_eq!(shown(value), text);
    }
}

#[test]
fn all_that_look_the_same_are_the_best() {
    let answers = vec![
        answer("a", Ok(figures(1.0001))),
        answer("b", Ok(figures(1.0002))),
        answer("c", Ok(figures(1.01))),
    ];
    let (table, _) = test_table(&[case("one", answers)]);
    assert_eq!(table.lines().nth(2).unwrap(), "| one            | **1.00** | **1.00** | 1.01 |");
}

#[test]
fn names_do_not_break_the_table() {
    let (table, _) = test_table(&[case("a|b", vec![answer("ß", Ok(figures(1.0)))])]);
    let expected = "\
| case           |        ß |
| -------------- | -------: |
| a\\|b           | **1.00** |
| geometric mean | **1.00** |
";
    assert_eq!(table, expected);
}

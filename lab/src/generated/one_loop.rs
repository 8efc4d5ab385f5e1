//! Cases of one loop, as most magnetics laboratories measure it, without information on smaller loops.

use hysid_core::data::record::{Dataset, Record};
use hysid_core::error::Result;

use hysid::specimens::path;

use super::draw::Draw;
use super::plans::{PLANS, Plan};
use super::subject::Subject;
use super::{Case, noisy};

/// A generator of its own, apart from that of the other cases.
const FIRST_DRAW: usize = 1000;

/// Rows of one way through the whole range.
const ROWS: (usize, usize) = (60, 200);

/// Amplitudes of centred smaller loops, as shares of the whole.
const SHARES: [f64; 3] = [0.75, 0.5, 0.25];

/// Places at which reversal curves begin, from the lower end of the range.
const REVERSALS: [f64; 4] = [0.8, 0.6, 0.4, 0.2];

/// Turning points of a path by chance.
const BY_CHANCE: usize = 8;

/// Cases whose training data are one loop, repeated up to three times, and whose test data are smaller loops
/// and reversal curves inside it. The laws are those of [`super::generated`] that need no time.
///
/// # Errors
/// As [`super::generated`].
pub fn one_loop(count: usize, seed: u64) -> Result<Vec<Case>> {
    let plans: Vec<&Plan> = PLANS.iter().filter(|plan| plan.design.band().is_none()).collect();
    (0..count).map(|index| case(plans[index % plans.len()], index, seed)).collect()
}

fn case(plan: &Plan, index: usize, seed: u64) -> Result<Case> {
    let mut draw = Draw::new(seed, FIRST_DRAW + index);
    let subject = (plan.subject)(&mut draw)?;
    let step = (subject.range.1 - subject.range.0) / draw.whole(ROWS.0, ROWS.1) as f64;
    let train = training(&mut draw, &subject, step)?;
    let test = ["smaller loops", "reversal curves", "by chance"]
        .into_iter()
        .enumerate()
        .map(|(kind, name)| test(&mut draw, &subject, step, kind, name))
        .collect::<Result<_>>()?;
    let names = plan.names();
    let percent = draw.between(plan.noise.0, plan.noise.1);
    Ok(Case {
        name: format!("l{:02}-{}", index + 1, plan.name),
        law: plan.law,
        design: "one loop, then smaller ones inside it",
        train: noisy(Dataset::new(names.clone(), vec![train])?, percent, &mut draw)?,
        test: noisy(Dataset::new(names, test)?, percent, &mut draw)?,
    })
}

/// Where an untouched specimen is at rest.
fn rest(subject: &Subject) -> f64 {
    let (low, high) = subject.range;
    if low < 0.0 && high > 0.0 { 0.0 } else { low }
}

fn training(draw: &mut Draw, subject: &Subject, step: f64) -> Result<Record> {
    let (low, high) = subject.range;
    let cycles = draw.whole(1, 3);
    let is_virgin = draw.whole(0, 1) == 0;
    let mut turning = vec![if is_virgin { rest(subject) } else { low }];
    (0..cycles).for_each(|_| turning.extend([high, low]));
    if !is_virgin || draw.whole(0, 1) == 0 {
        turning.push(high);
    }
    let input = path::through(&turning, step);
    let output = subject.run_still(&input);
    Record::new("loop", vec![input], output)
}

/// A test begins with the whole loop, its outputs blank.
fn test(draw: &mut Draw, subject: &Subject, step: f64, kind: usize, name: &str) -> Result<Record> {
    let (low, high) = subject.range;
    let (middle, half) = subject.swing();
    let mut turning = vec![rest(subject), high, low, high];
    let blank = path::through(&turning, step).len();
    match kind {
        0 => {
            let around = |share: f64| [middle - share * half, middle + share * half];
            turning.extend(SHARES.into_iter().flat_map(|share| [around(share), around(share)].concat()));
        }
        1 => turning.extend(REVERSALS.into_iter().flat_map(|place| [low + place * (high - low), high])),
        _ => turning.extend((0..BY_CHANCE).map(|_| draw.between(low, high))),
    }
    let input = path::through(&turning, step);
    let mut output = subject.run_still(&input);
    output[..blank].fill(f64::NAN);
    Record::new(name, vec![input], output)
}

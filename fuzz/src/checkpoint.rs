//! Content of a checkpoint whose checksum is right: the fit goes on from it, or one line says why not.

use std::ops::ControlFlow;

use hysid::data::rate::RateMethod;
use hysid::fit::network::{fit, resume};
use hysid::fit::progress::Checkpoint;
use hysid::options::network::{FitOptions, Trainer};
use hysid_core::network::{Family, Sizes};

use crate::{assert_is_one_line, fixtures};

/// First bytes of a checkpoint; the checksum of the content follows.
const MAGIC: &[u8] = b"hysid checkpoint 1\n";

/// Epochs after which a fit is stopped.
const EPOCHS: usize = 12;

pub fn run(content: &[u8]) {
    let bytes = [MAGIC, &crc32fast::hash(content).to_le_bytes(), content].concat();
    let checkpoint = match Checkpoint::from_bytes(&bytes) {
        Ok(checkpoint) => checkpoint,
        Err(error) => return assert_is_one_line(&error.to_string()),
    };
    let sizes = checkpoint.options().sizes;
    // The program refuses what would not fit into memory, before it resumes.
    if sizes.stops.max(sizes.hidden).max(sizes.relaxation) > 20
        || checkpoint.options().population > 200
        || checkpoint.options().starts > 20
    {
        return;
    }
    let mut calls = 0;
    let resumed = resume(fixtures::data(), checkpoint, &mut |_| {
        calls += 1;
        if calls > EPOCHS { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match resumed {
        Ok(fitted) => assert!(fitted.model.provenance().train.rmse.is_finite()),
        Err(error) => assert_is_one_line(&error.to_string()),
    }
}

/// The contents of checkpoints of every trainer, early and late.
pub fn seeds() -> Vec<Vec<u8>> {
    let of = |training: Trainer, starts: usize, epochs: usize| {
        let options = FitOptions {
            model: Family::XpnnPlus,
            sizes: Sizes { stops: 2, hidden: 2, relaxation: 1 },
            rate: Some(RateMethod::Backward),
            starts,
            epochs: 4,
            population: 6,
            ..FitOptions::of(training)
        };
        let mut last: Option<Checkpoint> = None;
        let mut count = 0;
        let stopped = fit(fixtures::data(), &options, &mut |progress| {
            count += 1;
            last = progress.checkpoint().or(last.take());
            if count >= epochs { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        stopped.expect("a small fit has a model");
        let bytes = last.expect("a checkpoint").to_bytes();
        assert!(bytes.starts_with(MAGIC), "otherwise every input would be refused at its first bytes");
        bytes[MAGIC.len() + 4..].to_vec()
    };
    Trainer::ALL
        .into_iter()
        .flat_map(|training| [of(training, 1, 1), of(training, 2, 3), of(training, 2, 9)])
        .collect()
}

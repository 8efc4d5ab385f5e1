//! The tables: false alarms by noise, power by dependence.

use hysid::diagnosis::residuals::ResidualTest;

use super::drives::DRIVES;
use super::residual::{Dependence, Noise};
use super::{Cell, SIZES};
use crate::cases::{aligned, row};

/// Both tables.
pub fn tables(cells: &[Cell]) -> String {
    let mut alarms = vec![row("noise alone", &["drive", "any finding but whiteness", "most of one test"])];
    for noise in Noise::ALL {
        for cell in cells.iter().filter(|cell| cell.planted.is_none() && cell.noise == noise) {
            let others = cell.found.iter().filter(|(test, _)| *test != ResidualTest::Whiteness);
            let (test, most) = others.fold((ResidualTest::Bias, 0.0), |most, (test, share)| match share {
                Some(share) if *share > most.1 => (*test, *share),
                _ => most,
            });
            let most =
                if most > 0.0 { format!("{} ({})", percent(Some(most)), test.name()) } else { "0 %".into() };
            alarms.push(row(noise.name(), &[cell.drive.into(), percent(Some(cell.any)), most]));
        }
    }
    let sizes = SIZES.map(|size| format!("found, {size} times the noise"));
    let mut power = vec![row(
        "planted",
        &[
            "drive".into(),
            sizes[0].clone(),
            sizes[1].clone(),
            sizes[2].clone(),
            "rate found (largest)".into(),
        ],
    )];
    for dependence in Dependence::ALL {
        for drive in &DRIVES {
            let of_size = |size: f64, test: ResidualTest| {
                let is_it =
                    |cell: &&Cell| cell.drive == drive.name && cell.planted == Some((dependence, size));
                let cell = cells.iter().find(is_it).expect("every cell was measured");
                cell.found.iter().find(|(found, _)| *found == test).and_then(|(_, share)| *share)
            };
            let found = SIZES.map(|size| percent(of_size(size, dependence.test())));
            let rate = percent(of_size(SIZES[2], ResidualTest::Rate));
            let [a, b, c] = found;
            power.push(row(dependence.name(), &[drive.name.into(), a, b, c, rate]));
        }
    }
    format!("{}\n{}", aligned(&alarms), aligned(&power))
}

fn percent(share: Option<f64>) -> String {
    share.map_or("not testable".into(), |share| format!("{:.0} %", 100.0 * share))
}

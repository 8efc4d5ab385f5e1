//! The tables of a case: errors of every model, and of the unseen records one by one.

use hysid_document::{Cell, Table, unit};

use super::catalogue::Example;
use super::{Contestant, PlayedCase, SeedRun, TrainedModels, errors, largest, spaced};
use crate::chapter::stands_in;
use crate::spread::Spread;

impl PlayedCase<'_> {
    pub(super) fn heading(&self, example: &Example, of: &str) -> String {
        format!("{}: {of}", stands_in(self.specimen.name, &spaced(example.name)))
    }

    /// Every model by itself, and the medians of several.
    fn all(&self) -> impl Iterator<Item = &Contestant> {
        self.contestants.iter().flat_map(|TrainedModels { one, several }| std::iter::once(one).chain(several))
    }

    pub(super) fn errors_table(&self, example: &Example) -> Table {
        let unit = unit::of(&self.train.names().output);
        let columns = [
            "model".to_string(),
            "parameters".into(),
            format!("MSE ({unit})²"),
            "NRMSE (% of std)".into(),
            "NRMSE, range".into(),
            "largest error (% of largest output)".into(),
            "largest error, range".into(),
        ];
        let seeds = self.xpnn().one.train.len();
        let of = format!("errors of free runs, medians and ranges of {seeds} seeds");
        let mut table = Table::new(columns).headed(self.heading(example, &of));
        for contestant in self.all() {
            for (set, data, runs) in
                [("training", &self.train, &contestant.train), ("unseen", &self.unseen, &contestant.unseen)]
            {
                let spread = |value: &dyn Fn(&SeedRun) -> f64| Spread::of(runs.iter().map(value));
                let mse = spread(&|run| run.errors.mse);
                let percent = spread(&|run| run.errors.nrmse_std_percent.unwrap_or(f64::INFINITY));
                let worst = spread(&|run| 100.0 * run.errors.max_abs_error / largest(data));
                table.push([
                    format!("{}, {set}", contestant.name).into(),
                    contestant.parameters.into(),
                    middle(mse),
                    middle(percent),
                    range(percent),
                    middle(worst),
                    range(worst),
                ]);
            }
        }
        table
    }

    /// Errors on each unseen record, if there are several.
    pub(super) fn records_table(&self, example: &Example) -> Option<Table> {
        let records = self.unseen.records();
        if records.len() < 2 {
            return None;
        }
        let names = self.all().map(|contestant| format!("{}, NRMSE (% of std)", contestant.name));
        let row = |name: &str| {
            let of = |contestant: &Contestant| {
                let percent = |run: &SeedRun| {
                    let errors = errors(&self.unseen, &run.simulated, |other| other == name);
                    errors.and_then(|errors| errors.nrmse_std_percent).unwrap_or(f64::INFINITY)
                };
                Spread::of(contestant.unseen.iter().map(percent))
                    .map_or(Cell::Missing, |it| it.shown().into())
            };
            std::iter::once(name.into()).chain(self.all().map(of)).collect()
        };
        let table = Table::new(std::iter::once("unseen record".to_string()).chain(names))
            .headed(self.heading(example, "unseen records one by one, medians of the seeds"))
            .with_rows(records.iter().map(|record| row(record.name())));
        Some(table)
    }
}

fn middle(spread: Option<Spread>) -> Cell {
    spread.map(|spread| spread.median).into()
}

fn range(spread: Option<Spread>) -> Cell {
    spread.map_or(Cell::Missing, |spread| spread.range().into())
}

//! The roles of the columns of one table in another, whose columns have other names.

use hysid_core::data::unit::{self, Conversion};
use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};
use hysid_tables::{Head, Problem};

use super::{ColumnChoice, RateOption, Roles};

/// A role, the column that has it in the first table, and the column found for it.
struct Slot<'r> {
    role: &'static str,
    wanted: &'r str,
    found: Option<String>,
}

/// Ways to recognise a column, the surest first.
const WAYS: [fn(&Slot, &str) -> bool; 5] = [
    |slot, name| name == slot.wanted,
    |slot, name| quantity(name) == quantity(slot.wanted) && converts(name, slot.wanted),
    |slot, name| slot.role == "time" && unit::is_time(name),
    |slot, name| slot.role == "time" && unit::may_be_time(name),
    |slot, name| slot.role != "record" && has_unit(name, slot.wanted),
];

impl Roles {
    /// Finds columns with these roles in another table: those that are chosen, or the only ones of the same name, of the
    /// same quantity, of time, or in a unit that converts. Returns the roles that were found, and why others were not.
    /// `first` is the file of these roles.
    pub fn in_table(&self, table: &Head, first: &str, chosen: &ColumnChoice) -> (Self, Option<Problem>) {
        let inputs = self.inputs.iter().map(|name| ("input", name));
        let named = [("record", &self.record), ("time", &self.time), ("rate", &self.rate)];
        let named = named.into_iter().filter_map(|(role, name)| Some((role, name.as_ref()?)));
        let all = named.chain(inputs).chain([("output", &self.output)]);
        let mut slots: Vec<Slot> = all.map(|(role, wanted)| Slot { role, wanted, found: None }).collect();
        let mut free: Vec<&String> = table.header.iter().collect();
        take_chosen(table, chosen, &mut slots, &mut free);
        for is_it in WAYS {
            let rivals =
                |name: &str| slots.iter().filter(|slot| slot.found.is_none() && is_it(slot, name)).count();
            let only = |slot: &Slot| {
                let mut suitable = free.iter().filter(|name| is_it(slot, name));
                let name = suitable.next().filter(|name| suitable.next().is_none() && rivals(name) == 1)?;
                Some((*name).clone())
            };
            let found: Vec<Option<String>> =
                slots.iter().map(|slot| slot.found.clone().or_else(|| only(slot))).collect();
            free.retain(|name| !found.iter().flatten().any(|taken| taken == *name));
            slots.iter_mut().zip(found).for_each(|(slot, found)| slot.found = found);
        }
        // Without its column of records a table is one record.
        let missing = slots.iter().find(|slot| slot.found.is_none() && slot.role != "record");
        let problem = missing.map(|slot| doubt(slot, table, first, &free));
        (self.renamed(&slots, first), problem)
    }

    fn renamed(&self, slots: &[Slot], first: &str) -> Self {
        let of = |role: &str| -> Vec<String> {
            slots.iter().filter(|slot| slot.role == role).filter_map(|slot| slot.found.clone()).collect()
        };
        let renamed = slots.iter().filter_map(|slot| {
            let name = slot.found.clone().filter(|name| name != slot.wanted)?;
            Some((name, format!("as {} in {}", clipped(slot.wanted), clipped(first)).into()))
        });
        Self {
            record: of("record").pop(),
            time: of("time").pop(),
            inputs: of("input"),
            rate: of("rate").pop(),
            output: of("output").pop().unwrap_or_default(),
            set_aside: self.set_aside.iter().cloned().chain(renamed).collect(),
            ..self.clone()
        }
    }
}

fn take_chosen(table: &Head, chosen: &ColumnChoice, slots: &mut [Slot], free: &mut Vec<&String>) {
    let mut inputs = chosen.input.iter();
    for slot in slots {
        let name = match (slot.role, &chosen.rate) {
            ("record", _) => chosen.record.as_ref(),
            ("time", _) => chosen.time.as_ref(),
            ("input", _) => inputs.next(),
            ("rate", RateOption::Column(name)) => Some(name),
            ("output", _) => chosen.output.as_ref(),
            _ => None,
        };
        slot.found = name.and_then(|name| table.full_name(name)).map(str::to_string);
        free.retain(|name| slot.found.as_ref() != Some(*name));
    }
}

/// The problem of a role whose column is not certain.
fn doubt(slot: &Slot, table: &Head, first: &str, free: &[&String]) -> Problem {
    let (role, wanted) = (slot.role, clipped(slot.wanted));
    let suitable: Vec<String> = free
        .iter()
        .filter(|name| WAYS.iter().any(|is_it| is_it(slot, name)))
        .map(|name| (*name).clone())
        .collect();
    let words = match suitable.is_empty() {
        true => format!("no column is like \"{wanted}\", the {role} of {}", clipped(first)),
        false => format!(
            "several columns are like \"{wanted}\", the {role} of {}: {}",
            clipped(first),
            listed(&suitable)
        ),
    };
    let columns = format!("columns: {}; choose one with ", listed(&table.header));
    Problem::in_file(&table.file, Words::from(words).advised(Words::from(columns) + Hint::Option(role)))
}

/// The quantity of a name, in small letters without blanks and underscores.
fn quantity(name: &str) -> String {
    unit::split(name).0.to_lowercase().chars().filter(|letter| letter.is_alphanumeric()).collect()
}

fn converts(name: &str, wanted: &str) -> bool {
    Conversion::between(name, wanted) != Conversion::Impossible
}

/// True if both names have a unit, of the same quantity.
fn has_unit(name: &str, wanted: &str) -> bool {
    unit::of_column(name).is_some() && unit::of_column(wanted).is_some() && converts(name, wanted)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use hysid_tables::{Reading, Table};

    use super::*;

    fn table(header: &str) -> Table {
        let cells =
            |row: usize| header.split(',').map(|_| format!("{}", row * row)).collect::<Vec<_>>().join(",");
        let text = format!("{header}\n{}\n{}\n{}\n", cells(1), cells(2), cells(3));
        Table::from_bytes(Path::new("b.csv"), text.into_bytes(), &Reading::default()).unwrap()
    }

    fn roles() -> Roles {
        Roles::detect(&table("Time [s],Displacement [mm],Force [kN]"), &ColumnChoice::default()).unwrap()
    }

    fn found(header: &str, chosen: &ColumnChoice) -> (Vec<String>, Option<String>) {
        let (roles, problem) = roles().in_table(&table(header), "a.csv", chosen);
        let names = roles.time.into_iter().chain(roles.inputs).chain([roles.output]).collect();
        (names, problem.map(|problem| problem.to_string()))
    }

    #[test]
    fn columns_are_recognised_by_name_quantity_time_and_unit() {
        for header in [
            "Time [s],Displacement [mm],Force [kN]",
            "t_s,Displacement_mm,Force_kN",
            "force_N,displacement_m,Time",
            "Zeit (s),Weg (mm),Kraft (kN)",
        ] {
            let (names, problem) = found(header, &ColumnChoice::default());
            assert!(problem.is_none() && names.len() == 3, "{header}: {names:?} {problem:?}");
            let [time, input, output] = names.as_slice() else { unreachable!() };
            assert!(
                unit::may_be_time(time) && has_unit(input, "x_mm") && has_unit(output, "F_kN"),
                "{names:?}"
            );
        }
    }

    #[test]
    fn only_what_is_doubtful_is_asked_for() {
        let header = "t_s,command_mm,measured_mm,Force_kN";
        let (names, problem) = found(header, &ColumnChoice::default());
        let problem = problem.unwrap();
        assert_eq!(names, ["t_s", "Force_kN"]);
        assert!(
            problem.contains("several columns are like \"Displacement [mm]\", the input of a.csv"),
            "{problem}"
        );
        let chosen = ColumnChoice { input: vec!["measured_mm".into()], ..ColumnChoice::default() };
        assert_eq!(
            found(header, &chosen),
            (vec!["t_s".into(), "measured_mm".into(), "Force_kN".into()], None)
        );
        let (_, problem) = found("a,b,c", &ColumnChoice::default());
        assert!(problem.unwrap().contains("no column is like \"Time [s]\", the time of a.csv"));
    }
}

//! Which column of a table is which quantity of a motion. Options decide; displacement and applied force may be found by
//! name and unit, accelerations never: only their user knows what they are relative to.

use hysid::data::unit;
use hysid::data::usual_role::{Domain, UsualRole};
use hysid::error::MotionColumn;
use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};
use hysid_records::{CellNeed, Roles, require};
use hysid_tables::{Problem, Result, Table, is_record};

use super::acceleration::of_acceleration;

/// All columns of a motion, in the order in which records keep them.
pub const COLUMNS: [MotionColumn; 6] = [
    MotionColumn::Time,
    MotionColumn::Displacement,
    MotionColumn::Velocity,
    MotionColumn::Acceleration,
    MotionColumn::BaseAcceleration,
    MotionColumn::AppliedForce,
];

/// Requirement on the cells of a column.
pub fn kind(column: MotionColumn) -> CellNeed {
    let required = |if_no_number| CellNeed::Required {
        if_blank: (
            "time, displacement and velocity need a number in every row; choose rows with ",
            Some("rows"),
        ),
        if_no_number: Some(if_no_number),
    };
    match column {
        MotionColumn::Time => required(("not the time? name it with ", "time")),
        MotionColumn::Displacement => required(("not the displacement? name it with ", "displacement")),
        MotionColumn::Velocity => required(("not the velocity? name it with ", "velocity")),
        MotionColumn::Acceleration | MotionColumn::BaseAcceleration | MotionColumn::AppliedForce => {
            CellNeed::Optional
        }
    }
}

/// Parts of words for an acceleration.
const ACCELERATION: [&str; 6] = ["acc", "beschl", "accél", "aceler", "ускор", "加速度"];

/// The value of `--applied-force` for none.
const NONE: &str = "none";

/// Columns that the user named, by the options of their names; all others are found.
#[derive(Debug, Clone, Default)]
pub struct MotionChoice {
    pub record: Option<String>,
    pub time: Option<String>,
    pub displacement: Option<String>,
    pub velocity: Option<String>,
    pub acceleration: Option<String>,
    pub absolute_acceleration: Option<String>,
    pub base_acceleration: Option<String>,
    pub applied_force: Option<String>,
    pub keep: Vec<String>,
}

#[derive(Debug, Clone)]
pub struct MotionColumns {
    /// Column with the name of each row's record.
    pub record: Option<String>,
    pub time: String,
    /// Displacement relative to the base.
    pub displacement: String,
    /// Velocity relative to the base.
    pub velocity: Option<String>,
    pub acceleration: Option<String>,
    /// The acceleration is absolute, not relative to the base.
    pub is_absolute: bool,
    pub base_acceleration: Option<String>,
    pub applied_force: Option<String>,
    /// Columns that are copied.
    pub keep: Vec<String>,
    /// Columns that were chosen by name and unit, each with the option that overrides the choice.
    pub guessed: Vec<Words>,
    /// Columns that may be an acceleration of the mass, if none is used.
    pub unused_accelerations: Vec<String>,
}

impl MotionColumns {
    /// The columns that options name, and those that are found.
    pub fn find(table: &Table, options: &MotionChoice) -> Result<Self> {
        table.require_columns()?;
        let named = NamedColumns::of(table, options)?;
        let mut guessed = Vec::new();
        let time = match named.of_option("time") {
            Some(time) => time,
            None => time_of(table, &named)?,
        };
        let record =
            named.of_option("record").or_else(|| table.header.iter().find(|name| is_record(name)).cloned());
        let is_kept = |name: &String| options.keep.iter().any(|kept| table.full_name(kept) == Some(name));
        let has_role = |name: &String| *name == time || record.as_ref() == Some(name) || named.has(name);
        let is_free = |name: &String| !has_role(name) && !is_kept(name);
        let free: Vec<&String> = table.header.iter().filter(|name| is_free(name)).collect();
        let displacement = match named.of_option("displacement") {
            Some(displacement) => displacement,
            None => {
                guessed.push(from_name("displacement", "displacement"));
                let found = free
                    .iter()
                    .filter(|name| UsualRole::of(name) == Some(UsualRole::Drives(Domain::Mechanics)));
                only(table, found.map(|name| (*name).clone()).collect(), "displacement", "displacement")?
            }
        };
        let absolute = named.of_option("absolute_acceleration");
        let base_acceleration = named.of_option("base_acceleration");
        let has_inertia = absolute.is_some() || base_acceleration.is_some();
        let applied_force = match (&options.applied_force, named.of_option("applied_force")) {
            (Some(none), _) if none == NONE => None,
            (_, Some(force)) => Some(force),
            (_, None) => {
                let forces = free.iter().filter(|name| **name != &displacement && is_force(name));
                let force = applied_force(table, forces.map(|name| (*name).clone()).collect(), has_inertia)?;
                guessed.extend(force.iter().map(|_| from_name("applied force", "applied_force")));
                force
            }
        };
        let is_absolute = absolute.is_some();
        let acceleration = absolute.or_else(|| named.of_option("acceleration"));
        let unused = free.iter().filter(|name| acceleration.is_none() && may_be_acceleration(name));
        Ok(Self {
            unused_accelerations: unused.map(|name| (*name).clone()).collect(),
            record,
            time,
            velocity: named.of_option("velocity"),
            acceleration,
            is_absolute,
            base_acceleration,
            applied_force,
            keep: options.keep.iter().map(|name| full_name(table, name, "keep")).collect::<Result<_>>()?,
            displacement,
            guessed,
        })
    }

    pub fn name_of(&self, column: MotionColumn) -> Option<&str> {
        match column {
            MotionColumn::Time => Some(&self.time),
            MotionColumn::Displacement => Some(&self.displacement),
            MotionColumn::Velocity => self.velocity.as_deref(),
            MotionColumn::Acceleration => self.acceleration.as_deref(),
            MotionColumn::BaseAcceleration => self.base_acceleration.as_deref(),
            MotionColumn::AppliedForce => self.applied_force.as_deref(),
        }
    }

    /// Roles of columns that divide the table into records.
    pub fn roles(&self) -> Roles {
        Roles {
            record: self.record.clone(),
            time: Some(self.time.clone()),
            inputs: vec![self.displacement.clone()],
            rate: self.velocity.clone(),
            output: self.displacement.clone(),
            ..Roles::default()
        }
    }
}

/// The columns that options name, with their options.
struct NamedColumns(Vec<(&'static str, String)>);

impl NamedColumns {
    fn of(table: &Table, options: &MotionChoice) -> Result<Self> {
        let applied_force = options.applied_force.as_ref().filter(|name| *name != NONE);
        let all = [
            ("record", options.record.as_ref()),
            ("time", options.time.as_ref()),
            ("displacement", options.displacement.as_ref()),
            ("velocity", options.velocity.as_ref()),
            ("acceleration", options.acceleration.as_ref()),
            ("absolute_acceleration", options.absolute_acceleration.as_ref()),
            ("base_acceleration", options.base_acceleration.as_ref()),
            ("applied_force", applied_force),
        ];
        let mut named: Vec<(&'static str, String)> = Vec::new();
        for (option, name) in all {
            let Some(name) = name else { continue };
            let name = full_name(table, name, option)?;
            if let Some((other, _)) = named.iter().find(|(_, known)| *known == name) {
                let words = Words::from(format!("column \"{}\" is named twice, by ", clipped(&name)));
                return Err(Problem::Request(words + Hint::Option(other) + " and " + Hint::Option(option)));
            }
            named.push((option, name));
        }
        Ok(Self(named))
    }

    fn of_option(&self, option: &str) -> Option<String> {
        self.0.iter().find(|(known, _)| *known == option).map(|(_, name)| name.clone())
    }

    fn has(&self, name: &String) -> bool {
        self.0.iter().any(|(_, known)| known == name)
    }
}

fn full_name(table: &Table, name: &str, option: &'static str) -> Result<String> {
    require(table, name, option)?;
    Ok(table.full_name(name).unwrap_or(name).to_string())
}

fn from_name(what: &str, option: &'static str) -> Words {
    let words = Words::from(format!("{what}, from its name or unit"));
    words.advised(Words::from("change: ") + Hint::Option(option))
}

fn time_of(table: &Table, named: &NamedColumns) -> Result<String> {
    let free = || table.header.iter().filter(|name| !named.has(name));
    let found =
        free().find(|name| unit::is_time(name)).or_else(|| free().find(|name| unit::may_be_time(name)));
    found.cloned().ok_or_else(|| {
        let words = Words::from("there is no column of time").advised(name_it(table, "time"));
        Problem::in_file(&table.file, words)
    })
}

/// The only column that may be meant.
fn only(table: &Table, mut found: Vec<String>, what: &str, option: &'static str) -> Result<String> {
    let words = match found.len() {
        0 => {
            Words::from(format!("no column is a {what} by its name or unit")).advised(name_it(table, option))
        }
        1 => return Ok(found.remove(0)),
        _ => several(what, &found, option),
    };
    Err(Problem::in_file(&table.file, words))
}

fn name_it(table: &Table, option: &'static str) -> Words {
    Words::from(format!("columns: {}; name it with ", listed(&table.header))) + Hint::Option(option)
}

fn several(what: &str, found: &[String], option: &'static str) -> Words {
    let words = Words::from(format!("several columns may be the {what}: {}", listed(found)));
    words.advised(Words::from("choose with ") + Hint::Option(option))
}

/// Applied force without an option. A force that is left out would be missing in the result.
fn applied_force(table: &Table, mut found: Vec<String>, has_inertia: bool) -> Result<Option<String>> {
    let (force, none) = (Hint::Option("applied_force"), Hint::Value("applied_force", NONE.into()));
    let words = match (found.len(), has_inertia) {
        (0, true) => return Ok(None),
        (0, false) => {
            let words = Words::from("what drives the mass? Name a force with ") + force;
            let words = words + ", the acceleration of the base with " + Hint::Option("base_acceleration");
            let words = words + ", or that of the mass with " + Hint::Option("absolute_acceleration");
            let columns = format!("columns: {}", listed(&table.header));
            (words + "; a free vibration has " + none).advised(columns)
        }
        (1, false) => return Ok(Some(found.remove(0))),
        (_, true) => {
            let column = clipped(&found[0]);
            let words = format!("column \"{column}\" may be a force on the mass: name it with ");
            Words::from(words) + force + ", or use " + none
        }
        (_, false) => several("applied force", &found, "applied_force"),
    };
    Err(Problem::in_file(&table.file, words))
}

fn is_force(name: &str) -> bool {
    match UsualRole::of(name) {
        Some(UsualRole::Follows(Domain::Mechanics)) => true,
        Some(UsualRole::Excites) => {
            unit::of_column(name).is_none_or(|unit| unit::factor(&unit, "N").is_some())
        }
        _ => false,
    }
}

fn may_be_acceleration(name: &str) -> bool {
    let (quantity, unit) = unit::split(name);
    let lower = quantity.to_lowercase();
    ACCELERATION.iter().any(|word| lower.contains(word))
        || unit.is_some_and(|unit| unit != "g" && of_acceleration(&unit).is_some())
}

//! Two branches of one loop in columns side by side: `H,M_up,M_down`, or `H_up,M_up,H_down,M_down`.

use hysid_core::data::unit;

/// Words of a branch that goes out, and of the one that returns.
const BRANCHES: [(&str, &str); 16] = [
    ("up", "down"),
    ("forward", "backward"),
    ("forward", "reverse"),
    ("fwd", "rev"),
    ("loading", "unloading"),
    ("load", "unload"),
    ("charge", "discharge"),
    ("adsorption", "desorption"),
    ("absorption", "desorption"),
    ("sorption", "desorption"),
    ("ads", "des"),
    ("wetting", "drying"),
    ("ascending", "descending"),
    ("increasing", "decreasing"),
    ("heating", "cooling"),
    ("trace", "retrace"),
];

/// Places of the columns of a loop: input and output of the branch that goes out, and of the one that returns.
#[derive(Debug, PartialEq, Eq)]
pub struct LoopBranches {
    pub out: [usize; 2],
    pub back: [usize; 2],
    pub names: [String; 2],
}

impl LoopBranches {
    /// Those of columns with these names.
    pub fn of(names: &[String]) -> Option<Self> {
        match names {
            [input, out, back] => {
                let name = common(out, back)?;
                Some(Self { out: [0, 1], back: [0, 2], names: [input.clone(), name] })
            }
            [input, output, input_back, output_back] => {
                let names = [common(input, input_back)?, common(output, output_back)?];
                Some(Self { out: [0, 1], back: [2, 3], names })
            }
            _ => None,
        }
    }

    /// True if the branch that returns stands in the direction of the other, so that its rows must be turned. `None` if the
    /// branches do not meet, or an input does not go one way.
    pub fn is_turned(out: &[f64], back: &[f64]) -> Option<bool> {
        let is_monotonic = |values: &[f64]| {
            values.windows(2).all(|pair| pair[1] >= pair[0])
                || values.windows(2).all(|pair| pair[1] <= pair[0])
        };
        let (first, last) = (out.first()?, out.last()?);
        let near = |value: &f64| (value - last).abs() <= NEAR * (last - first).abs();
        if !is_monotonic(out) || !is_monotonic(back) || first == last {
            return None;
        }
        match (near(back.first()?), near(back.last()?)) {
            (true, false) => Some(false),
            (false, true) => Some(true),
            _ => None,
        }
    }

    /// True if the outputs run in opposite directions over inputs that run in the same: each branch counts its input from its
    /// own beginning, as the charge of a battery.
    pub fn is_counted(out: &[f64], back: &[f64]) -> bool {
        let gain = |values: &[f64]| values[values.len() - 1] - values[0];
        let all = || out.iter().chain(back).copied();
        let range = all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min);
        let (gains, least) = ([gain(out), gain(back)], CLEAR * range);
        gains[0] * gains[1] < 0.0 && gains.iter().all(|gain| gain.abs() > least)
    }
}

/// Least share of the range of both outputs by which each of them rises or falls over its branch, to tell a direction.
const CLEAR: f64 = 0.2;

/// Largest gap between the branches, as a share of the range of the input.
const NEAR: f64 = 0.1;

/// True for the names of two branches of one quantity.
pub fn are_branches(out: &str, back: &str) -> bool {
    common(out, back).or_else(|| common(back, out)).is_some()
}

/// The name that two names have in common besides the words of their branches; the first where nothing is left.
fn common(out: &str, back: &str) -> Option<String> {
    let parts = |name: &str| -> Vec<String> {
        let quantity = unit::split(name).0.to_lowercase();
        quantity
            .split(|letter: char| !letter.is_alphanumeric())
            .map(String::from)
            .filter(|part| !part.is_empty())
            .collect()
    };
    let (outward, returning) = (parts(out), parts(back));
    if unit::of_column(out) != unit::of_column(back) || outward.len() != returning.len() {
        return None;
    }
    let different: Vec<usize> =
        (0..outward.len()).filter(|&place| outward[place] != returning[place]).collect();
    let [place] = different.as_slice() else { return None };
    let is_pair = |&(first, second): &(&str, &str)| outward[*place] == first && returning[*place] == second;
    let (word, _) = BRANCHES.iter().find(|pair| is_pair(pair))?;
    if outward.len() == 1 {
        return Some(out.to_string());
    }
    let at = out.to_lowercase().find(word)?;
    let (before, behind) = (out.get(..at)?, out.get(at + word.len()..)?);
    let separators = ['_', '-', ' ', '.', '/'];
    Some(match before.is_empty() {
        true => behind.trim_start_matches(separators).to_string(),
        false => format!("{}{behind}", before.trim_end_matches(separators)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_known_by_their_words() {
        let names = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
            LoopBranches::of(&names).map(|branches| branches.names.join(" | "))
        };
        assert_eq!(names(&["H", "M_up", "M_down"]).unwrap(), "H | M");
        assert_eq!(
            names(&["Field up (T)", "Moment up (emu)", "Field down (T)", "Moment down (emu)"]).unwrap(),
            "Field (T) | Moment (emu)"
        );
        assert_eq!(
            names(&["p/p0", "Adsorption (mmol/g)", "Desorption (mmol/g)"]).unwrap(),
            "p/p0 | Adsorption (mmol/g)"
        );
        assert_eq!(
            names(&["SOC", "Charge voltage (V)", "Discharge voltage (V)"]).unwrap(),
            "SOC | voltage (V)"
        );
        assert_eq!(
            names(&["Target RH [%]", "Sorption [%]", "Desorption [%]"]).unwrap(),
            "Target RH [%] | Sorption [%]"
        );
        assert_eq!(names(&["aw [-]", "EMC ads [%]", "EMC des [%]"]).unwrap(), "aw [-] | EMC [%]");
        assert_eq!(names(&["H", "M_up", "M_left"]), None);
        assert_eq!(names(&["H", "M_up (T)", "M_down (V)"]), None);
        assert_eq!(names(&["t", "x", "y"]), None);
    }

    #[test]
    fn branches_meet_where_the_input_turns() {
        assert_eq!(LoopBranches::is_turned(&[0.0, 1.0, 2.0], &[2.0, 1.0, 0.0]), Some(false));
        assert_eq!(LoopBranches::is_turned(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]), Some(true));
        assert_eq!(LoopBranches::is_turned(&[0.0, 1.0, 2.0], &[5.0, 6.0]), None);
        assert_eq!(LoopBranches::is_turned(&[0.0, 2.0, 1.0], &[1.0, 0.0]), None);
    }

    #[test]
    fn a_branch_that_counts_from_its_own_beginning_has_the_opposite_direction() {
        assert!(LoopBranches::is_counted(&[3.6, 3.7], &[3.5, 3.4]));
        assert!(!LoopBranches::is_counted(&[3.6, 3.7], &[3.4, 3.5]));
        assert!(!LoopBranches::is_counted(&[-1.0, 0.9, -0.99], &[-1.0, 0.9, -1.01]), "a butterfly");
    }
}

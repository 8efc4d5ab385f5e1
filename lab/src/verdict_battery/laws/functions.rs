//! Laws without memory: the output is a function of the input.

use hysid_core::elementary::{powi, tanh};

use super::{Law, Specimen};

struct Function(fn(f64) -> f64);

impl Specimen for Function {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        (self.0)(x)
    }
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "linear",
            answers: "n - n  y y y  y n  n y",
            why: "every branch is a part of one line",
            specimen: || Box::new(Function(|x| 2.0 * x)),
        },
        Law {
            name: "cubic",
            answers: "n - n  y y n  y n  n y",
            why: "branches depend on their place, not on the past",
            specimen: || Box::new(Function(|x| powi(x, 3) + 0.05 * x)),
        },
        Law {
            name: "tanh-2",
            answers: "n - n  y y n  y -  n y",
            why: "saturates to a tenth of the largest slope: neither clearly nor clearly not",
            specimen: || Box::new(Function(|x| tanh(2.0 * x))),
        },
        Law {
            name: "tanh-4",
            answers: "n - n  y y n  y y  n y",
            why: "saturates clearly",
            specimen: || Box::new(Function(|x| tanh(4.0 * x))),
        },
        Law {
            name: "abs",
            answers: "n - n  y y n  n n  n y",
            why: "even: turned by half a turn it is another function",
            specimen: || Box::new(Function(f64::abs)),
        },
    ]
}

//! Laws with the memory of Preisach: nested turning points are all that counts.

use hysid_core::elementary::{exp, powi, square};

use super::memory::{Branches, Memory};
use super::{Law, Specimen};

/// Integrals of a density of relays over triangles of the half-plane `up >= down`, from a table. Between its nodes
/// the density of a cell is constant. Everett, Transactions of the Faraday Society 51 (1955) 1551.
struct Everett {
    table: Vec<f64>,
}

/// Cells of the table along either axis.
const CELLS: usize = 160;

/// The table covers inputs of this magnitude.
const REACH: f64 = 1.6;

impl Everett {
    /// Of a density of the half-width and the centre of the relays; the output spans -1 ... 1.
    fn of(density: impl Fn(f64, f64) -> f64) -> Self {
        let place = |cell: usize| REACH * (2.0 * (cell as f64 + 0.5) / CELLS as f64 - 1.0);
        let nodes = CELLS + 1;
        let mut table = vec![0.0; nodes * nodes];
        for up in 1..nodes {
            // Cells of this row with `down` from the highest to the lowest.
            let mut row = 0.0;
            for down in (0..up).rev() {
                let (a, b) = (place(up - 1), place(down));
                let share = if down == up - 1 { 0.5 } else { 1.0 };
                row += share * density(0.5 * (a - b), 0.5 * (a + b));
                table[up * nodes + down] = table[(up - 1) * nodes + down] + row;
            }
        }
        let all = table[CELLS * nodes];
        table.iter_mut().for_each(|value| *value *= 2.0 / all);
        Self { table }
    }
}

impl Branches for Everett {
    fn growth(&self, low: f64, high: f64) -> f64 {
        let cell = |x: f64| ((x / REACH + 1.0) * 0.5 * CELLS as f64).clamp(0.0, CELLS as f64 - 1e-9);
        let (high, low) = (cell(high), cell(low));
        let (i, j) = (high as usize, low as usize);
        let (u, v) = (high - i as f64, low - j as f64);
        let node = |i: usize, j: usize| self.table[i * (CELLS + 1) + j];
        if i == j {
            return node(i + 1, j) * (u - v).max(0.0);
        }
        let lower = node(i, j) + u * (node(i + 1, j) - node(i, j));
        let upper = node(i, j + 1) + u * (node(i + 1, j + 1) - node(i, j + 1));
        lower + v * (upper - lower)
    }
}

/// A normal density of half-width and centre of the relays.
fn normal((width, of_width): (f64, f64), (centre, of_centre): (f64, f64)) -> Everett {
    Everett::of(move |half, middle| {
        let (a, b) = ((half - width) / of_width, (middle - centre) / of_centre);
        exp(-0.5 * (a * a + b * b))
    })
}

/// A function of the input and of a memory.
struct Remembering<B: Branches> {
    memory: Memory<B>,
    output: fn(f64, f64) -> f64,
}

impl<B: Branches> Specimen for Remembering<B> {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        (self.output)(x, self.memory.advance(x))
    }
}

/// Moving model: the field of the relays is `h = x + k y`. Della Torre, IEEE Transactions on Audio and
/// Electroacoustics 14 (1966) 86.
struct Moving {
    memory: Memory<Everett>,
    feedback: f64,
    output: f64,
}

impl Specimen for Moving {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        // The feedback is weak: the fixed point attracts.
        for _ in 0..80 {
            let next = self.memory.seen(x + self.feedback * self.output);
            if (next - self.output).abs() < 1e-12 {
                break;
            }
            self.output = next;
        }
        self.output = self.memory.advance(x + self.feedback * self.output);
        self.output
    }
}

/// Relays of half-widths and centres on a lattice, of equal weight. Mayergoyz (1991), section 1.1.
struct Relays {
    relays: Vec<(f64, f64, bool)>,
}

impl Relays {
    fn lattice() -> Self {
        let half_widths = (1..=5).map(|k| 0.115 * f64::from(k));
        let relays = half_widths
            .flat_map(|half| (-3..=3).map(move |k| (0.106 * f64::from(k), half)))
            .map(|(centre, half)| (centre + half, centre - half, centre < 0.0));
        Self { relays: relays.collect() }
    }
}

impl Specimen for Relays {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let mut sum = 0.0;
        for (up, down, is_up) in &mut self.relays {
            *is_up = x >= *up || *is_up && x > *down;
            sum += if *is_up { 1.0 } else { -1.0 };
        }
        sum / self.relays.len() as f64
    }
}

/// Ramberg-Osgood's curve with Masing's branches: `x = y/E + (y/K)^(1/n)`, every later branch twice as large. Ramberg &
/// Osgood, NACA Technical Note 902 (1943); Jayakumar, EERL 87-01 (1987).
struct RambergOsgood;

impl Branches for RambergOsgood {
    fn growth(&self, low: f64, high: f64) -> f64 {
        let x = 0.5 * (high - low);
        let strain = |y: f64| y / 3.0 + powi(y / 1.0_f64, 4);
        let (mut least, mut most) = (0.0, 3.0 * x);
        for _ in 0..60 {
            let middle = 0.5 * (least + most);
            if strain(middle) < x {
                least = middle;
            } else {
                most = middle;
            }
        }
        2.0 * most
    }
}

fn symmetric() -> Everett {
    normal((0.35, 0.12), (0.0, 0.15))
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "preisach-symmetric",
            answers: "y n n  y y n  y y  n y",
            why: "a normal density about half-width 0.35: branches depend on their place",
            specimen: || Box::new(Remembering { memory: Memory::virgin(symmetric()), output: |_, p| p }),
        },
        Law {
            name: "preisach-asymmetric",
            answers: "y n n  y y n  n y  n y",
            why: "relays of one sign of the centre prevail, so that no turn maps the loop onto itself",
            specimen: || {
                let density = Everett::of(|half, middle| {
                    let narrow = exp(-0.5 * (square((half - 0.15) / 0.08) + square((middle + 0.35) / 0.12)));
                    let wide = exp(-0.5 * (square((half - 0.4) / 0.1) + square((middle - 0.15) / 0.1)));
                    narrow + wide
                });
                Box::new(Remembering { memory: Memory::saturated(density, -REACH), output: |_, p| p })
            },
        },
        Law {
            name: "preisach-broad",
            answers: "y n n  y y n  y -  n y",
            why: "narrow relays with centres all over the range",
            specimen: || {
                let density = normal((0.2, 0.1), (0.0, 0.45));
                Box::new(Remembering { memory: Memory::saturated(density, -REACH), output: |_, p| p })
            },
        },
        Law {
            name: "relay-sum",
            answers: "y n n  y y n  y -  n y",
            why: "35 relays: a Preisach operator with a staircase as output",
            specimen: || Box::new(Relays::lattice()),
        },
        Law {
            name: "preisach-times-function",
            answers: "y n n  y n n  y -  n y",
            why: "a factor 1 + 2 x² keeps the memory and stretches the level on which a minor loop lies",
            specimen: || {
                Box::new(Remembering {
                    memory: Memory::virgin(symmetric()),
                    output: |x, p| (1.0 + 2.0 * x * x) * p,
                })
            },
        },
        Law {
            name: "preisach-moving",
            answers: "y n n  y n n  y y  n y",
            why: "the output moves the relays: minor loops tilt with the level on which they lie",
            specimen: || {
                Box::new(Moving {
                    memory: Memory::saturated(symmetric(), -REACH),
                    feedback: 0.18,
                    output: -1.0,
                })
            },
        },
        Law {
            name: "ramberg-osgood",
            answers: "y y n  y y y  y -  n y",
            why: "Masing's rule by construction",
            specimen: || Box::new(Remembering { memory: Memory::virgin(RambergOsgood), output: |_, p| p }),
        },
    ]
}

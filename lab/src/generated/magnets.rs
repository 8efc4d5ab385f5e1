//! Soft magnets and ferroelectrics of the cases.

use hysid::specimens::{Everett, Ferromagnet};
use hysid_core::elementary::{exp, square};
use hysid_core::error::Result;
use hysid_core::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use hysid_core::law::preisach::{Preisach, PreisachWeights};
use hysid_core::law::{Law, Sample};
use hysid_core::operator::Relaxation;

use super::draw::Draw;
use super::subject::Subject;

/// Permeability of vacuum in T m/A.
const MU_0: f64 = 4e-7 * std::f64::consts::PI;

/// Intervals of each axis of a Preisach plane.
const INTERVALS: usize = 60;

/// A sheet with the values of its Everett function perturbed, and its field driven to a share of saturation.
fn perturbed(draw: &mut Draw, Everett { h_sat, m, r, q, p1, p2, hc, k }: Everett) -> Ferromagnet {
    Ferromagnet::new(Everett {
        h_sat,
        m: draw.around(m),
        r: draw.around(r).min(0.9),
        q: draw.around(q),
        p1: draw.around(p1),
        p2: draw.around(p2),
        hc: draw.around(hc),
        k: draw.around(k),
    })
}

fn sheet(draw: &mut Draw, material: &Ferromagnet) -> Subject {
    let mut sheet = perturbed(draw, material.everett);
    let largest = draw.between(0.4, 0.9) * material.everett.h_sat;
    Subject::new((-largest, largest), move |sample| sheet.step(sample.x))
}

/// Electrical steel of low loss.
pub(super) fn thin_sheet(draw: &mut Draw) -> Result<Subject> {
    Ok(sheet(draw, &Ferromagnet::m270_50a()))
}

/// Electrical steel of high loss.
pub(super) fn coarse_sheet(draw: &mut Draw) -> Result<Subject> {
    Ok(sheet(draw, &Ferromagnet::m800_65a()))
}

/// Cobalt-iron.
pub(super) fn cobalt_iron(draw: &mut Draw) -> Result<Subject> {
    Ok(sheet(draw, &Ferromagnet::vacoflux17()))
}

/// Electrical steel behind eddy currents: the field inside lags behind the one applied.
pub(super) fn eddy_current_sheet(draw: &mut Draw) -> Result<Subject> {
    let material = Ferromagnet::m400_50ap();
    let mut sheet = perturbed(draw, material.everett);
    let largest = draw.between(0.3, 0.7) * material.everett.h_sat;
    let mut inside = lag(draw.around(2.5e-4));
    Ok(Subject::new((-largest, largest), move |sample| sheet.step(inside(sample))))
}

/// What follows the input with a time constant in s, from 0 on: `τ u' = x - u`. The difference `x - u` is the
/// stress of a relaxation element.
fn lag(tau: f64) -> impl FnMut(Sample) -> f64 + Clone + 'static {
    let mut behind = Relaxation::new(tau).expect("the time constant is positive");
    move |sample| sample.x - behind.step(sample.x, sample.step)
}

/// Values of a Jiles-Atherton law, and of the field, in the units of `a`.
struct Core {
    saturation: f64,
    a: f64,
    pinning: f64,
    coupling: f64,
    reversible: f64,
    form: JilesAthertonForm,
    /// Largest field.
    largest: f64,
}

fn core(draw: &mut Draw, values: &Core) -> Result<Subject> {
    let a = draw.around(values.a);
    let saturation = draw.around(values.saturation);
    let law = JilesAtherton {
        offset: 0.0,
        permeability: MU_0,
        saturation,
        a,
        k: a * draw.around(values.pinning),
        // Not near 3, where the anhysteretic curve would become a step.
        alpha: a * draw.around(values.coupling).min(2.6) / saturation,
        c: draw.around(values.reversible).min(0.9),
        form: values.form,
    };
    let largest = a * draw.around(values.largest);
    Ok(Subject::of_law((-largest, largest), law.validated()?))
}

/// A soft ferrite.
pub(super) fn ferrite(draw: &mut Draw) -> Result<Subject> {
    let values = Core {
        saturation: 0.45,
        a: 18.0,
        pinning: 0.9,
        coupling: 1.2,
        reversible: 0.25,
        form: JilesAthertonForm::Original,
        largest: 8.0,
    };
    core(draw, &values)
}

/// A nanocrystalline core: loops much narrower than the field's range.
pub(super) fn narrow_core(draw: &mut Draw) -> Result<Subject> {
    let values = Core {
        saturation: 1.2,
        a: 12.0,
        pinning: 0.2,
        coupling: 1.6,
        reversible: 0.1,
        form: JilesAthertonForm::Original,
        largest: 14.0,
    };
    core(draw, &values)
}

/// A cast-steel core.
pub(super) fn cast_core(draw: &mut Draw) -> Result<Subject> {
    let values = Core {
        saturation: 1.7,
        a: 500.0,
        pinning: 1.1,
        coupling: 1.5,
        reversible: 0.15,
        form: JilesAthertonForm::Differential,
        largest: 7.0,
    };
    core(draw, &values)
}

/// A Preisach plane over `±end`: relays around the half-width `coercivity`, spread in half-width and centre by
/// shares of it, with a density that falls as `shape` says of the squared distance. The output saturates at
/// `±saturation`, but for its slope.
fn plane(
    end: f64,
    [coercivity, width, spread]: [f64; 3],
    shape: fn(f64) -> f64,
    (saturation, slope): (f64, f64),
) -> Result<Preisach> {
    let lines: Vec<f64> = (0..=INTERVALS).map(|k| end * (2.0 * k as f64 / INTERVALS as f64 - 1.0)).collect();
    let middle = |k: usize| 0.5 * (lines[k] + lines[k + 1]);
    let mut cells = Vec::new();
    for i in 0..INTERVALS {
        for j in 0..=i {
            let (half_width, centre) = (0.5 * (middle(i) - middle(j)), 0.5 * (middle(i) + middle(j)));
            let distance = (half_width - coercivity) / (width * coercivity);
            let area = if i == j { 0.5 } else { 1.0 };
            cells.push(area * shape(distance * distance) * shape(square(centre / (spread * coercivity))));
        }
    }
    let sum: f64 = cells.iter().sum();
    cells.iter_mut().for_each(|cell| *cell *= saturation / sum);
    Preisach::new(PreisachWeights { constant: 0.0, slope, lines, reversible: vec![0.0; INTERVALS], cells })
}

fn gaussian(square: f64) -> f64 {
    exp(-0.5 * square)
}

fn lorentzian(square: f64) -> f64 {
    1.0 / (1.0 + square)
}

/// A powder core: relays spread as Lorentz' density is.
pub(super) fn powder_core(draw: &mut Draw) -> Result<Subject> {
    let coercivity = draw.around(60.0);
    let end = 6.0 * coercivity;
    let values = [coercivity, draw.around(0.5), draw.around(0.6)];
    let law = plane(end, values, lorentzian, (draw.around(1.1), draw.around(2e-4)))?;
    let largest = draw.between(0.6, 0.9) * end;
    Ok(Subject::of_law((-largest, largest), law))
}

/// A recording medium: relays around one coercivity, spread as Gauss' density is.
pub(super) fn recording_medium(draw: &mut Draw) -> Result<Subject> {
    let coercivity = draw.around(25_000.0);
    let end = 2.4 * coercivity;
    let values = [coercivity, draw.around(0.25), draw.around(0.25)];
    let law = plane(end, values, gaussian, (draw.around(0.3), draw.around(2e-7)))?;
    Ok(Subject::of_law((-end, end), law))
}

/// A ferroelectric capacitor in µC/cm²: relays behind a lag, and a dielectric.
pub(super) fn ferroelectric(draw: &mut Draw) -> Result<Subject> {
    let coercivity = draw.around(1.1);
    let end = 3.0 * coercivity;
    let values = [coercivity, draw.around(0.25), draw.around(0.35)];
    let law = plane(end, values, gaussian, (draw.around(22.0), 0.0))?;
    let dielectric = draw.around(1.5);
    let mut inside = lag(draw.around(6e-5));
    let mut state = law.virgin();
    let largest = draw.between(0.8, 1.0) * end;
    Ok(Subject::new((-largest, largest), move |sample| {
        let x = inside(sample);
        law.step(&mut state, Sample { x, ..sample }) + dielectric * sample.x
    }))
}

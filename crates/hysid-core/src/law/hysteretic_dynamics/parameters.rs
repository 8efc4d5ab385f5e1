//! The parameters found by search, as one flat vector.

use std::ops::Range;

use super::{DAMPING_RATIOS, Dynamics, Element, ElementShape, LARGEST_WEIGHT, Mode};
use crate::elementary::{exp, ln};

/// Which coefficients are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DynamicsForm {
    /// An oscillator: its output, and what moves its elements, are displacements.
    Oscillator,
    /// A state space model: any sums of displacements, velocities and inputs.
    StateSpace,
}

/// Positions of the parameters of a mode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModeLayout {
    /// `ln ω`.
    pub ln_frequency: usize,
    /// `ln ζ`.
    pub ln_damping: usize,
    /// `b`.
    pub gain: usize,
    /// `η`; empty for an oscillator.
    pub velocity_in_output: Range<usize>,
}

/// Positions of the parameters of an element, in the order of [`Element`]; empty if not free.
#[derive(Debug, Clone, PartialEq, Eq)]
#[allow(missing_docs, reason = "each field is the one of its name")]
pub struct ElementLayout {
    pub of_displacements: Range<usize>,
    pub of_velocities: Range<usize>,
    pub of_input: Range<usize>,
    pub compliances: Range<usize>,
    pub in_output: Range<usize>,
    pub layer: Range<usize>,
    pub rising: Range<usize>,
    pub falling: Range<usize>,
    pub ln_path_leaks: Range<usize>,
    pub initial: Range<usize>,
    pub ln_thresholds: Range<usize>,
    pub stop_velocities: Range<usize>,
    pub strength_losses: Range<usize>,
    pub force: Range<usize>,
}

/// Positions of the parameters in the flat vector: the offset in units of the output scale, `d`, modes and elements.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DynamicsLayout {
    /// The numbers of the parts of each element.
    pub shape: ElementShape,
    /// Of each mode.
    pub modes: Vec<ModeLayout>,
    /// Of each element.
    pub elements: Vec<ElementLayout>,
    /// Displacement and velocity of each mode at the first sample; empty if records begin at rest.
    pub beginning: Range<usize>,
    count: usize,
}

/// Place of the offset.
pub(super) const OFFSET: usize = 0;

/// Place of `d`.
pub(super) const DIRECT: usize = 1;

impl DynamicsLayout {
    /// The layout for these numbers of modes and elements.
    pub fn new(form: DynamicsForm, modes: usize, elements: usize, shape: ElementShape) -> Self {
        let mut end = DIRECT + 1;
        let mut next = |length: usize| {
            let start = end;
            end += length;
            start..end
        };
        let is_general = form == DynamicsForm::StateSpace;
        let if_general = |length: usize| if is_general { length } else { 0 };
        let coupled = if is_general || modes > 1 { modes } else { 0 };
        let of_mode = |_| ModeLayout {
            ln_frequency: next(1).start,
            ln_damping: next(1).start,
            gain: next(1).start,
            velocity_in_output: next(if_general(1)),
        };
        let of_modes = (0..modes).map(of_mode).collect();
        let of_element = |_| ElementLayout {
            of_displacements: next(coupled),
            of_velocities: next(if_general(modes)),
            of_input: next(if_general(1)),
            compliances: next(coupled),
            in_output: next(if_general(1)),
            layer: next((shape.inputs() - shape.first_free_input()) * shape.neurons),
            rising: next(shape.states * shape.neurons),
            falling: next(shape.states * shape.neurons),
            ln_path_leaks: next(shape.states),
            initial: next(shape.states),
            ln_thresholds: next(shape.stops),
            stop_velocities: next(shape.stops),
            strength_losses: next(if shape.deteriorates { shape.stops } else { 0 }),
            force: next(shape.stops + shape.states + shape.neurons),
        };
        let of_elements = (0..elements).map(of_element).collect();
        Self { shape, modes: of_modes, elements: of_elements, beginning: end..end, count: end }
    }

    /// The same for a record that may begin in mid-motion.
    pub fn with_beginning(&self) -> Self {
        let end = self.count + 2 * self.modes.len();
        Self { beginning: self.count..end, count: end, ..self.clone() }
    }

    /// Number of parameters.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True for a weight, on which a penalty acts; false for offsets, gains, frequencies and leaks.
    pub fn has_decay(&self, index: usize) -> bool {
        self.elements.iter().any(|element| {
            [&element.layer, &element.rising, &element.falling, &element.force, &element.of_velocities]
                .into_iter()
                .any(|range| range.contains(&index))
        })
    }

    /// True for a gain or a compliance of a mode after the first. Where all of them are 0, only the first mode moves.
    pub fn excites_later_modes(&self, index: usize) -> bool {
        let is_later = |compliances: &Range<usize>| compliances.contains(&index) && index > compliances.start;
        self.modes[1..].iter().any(|mode| mode.gain == index)
            || self.elements.iter().any(|element| is_later(&element.compliances))
    }

    /// True for what is a logarithm.
    pub fn is_logarithm(&self, index: usize) -> bool {
        self.modes.iter().any(|mode| index == mode.ln_frequency || index == mode.ln_damping)
            || self.elements.iter().any(|element| {
                element.ln_path_leaks.contains(&index) || element.ln_thresholds.contains(&index)
            })
    }

    /// These parameters, with what is not free from a template of as many modes.
    pub fn dynamics(&self, parameters: &[f64], template: &Dynamics) -> Dynamics {
        let mode = |(layout, template): (&ModeLayout, &Mode)| Mode {
            frequency: exp(parameters[layout.ln_frequency]),
            damping: within(parameters[layout.ln_damping], DAMPING_RATIOS),
            gain: parameters[layout.gain],
            velocity_in_output: layout
                .velocity_in_output
                .clone()
                .next()
                .map_or(template.velocity_in_output, |place| parameters[place]),
        };
        let part = |range: &Range<usize>, otherwise: &[f64]| match range.is_empty() {
            true => otherwise.to_vec(),
            false => parameters[range.clone()].to_vec(),
        };
        let constants = vec![0.0; self.shape.first_free_input() * self.shape.neurons];
        let one = |range: &Range<usize>, otherwise: f64| part(range, &[otherwise])[0];
        let positive = (f64::MIN_POSITIVE, LARGEST_WEIGHT);
        let exponentials =
            |range: &Range<usize>| parameters[range.clone()].iter().map(|&ln| within(ln, positive)).collect();
        let element = |(layout, template): (&ElementLayout, &Element)| Element {
            of_displacements: part(&layout.of_displacements, &template.of_displacements),
            of_velocities: part(&layout.of_velocities, &template.of_velocities),
            of_input: one(&layout.of_input, template.of_input),
            compliances: part(&layout.compliances, &template.compliances),
            in_output: one(&layout.in_output, template.in_output),
            thresholds: exponentials(&layout.ln_thresholds),
            stop_velocities: part(&layout.stop_velocities, &[]),
            strength_losses: part(&layout.strength_losses, &[]),
            layer: [&constants, &parameters[layout.layer.clone()]].concat(),
            rising: part(&layout.rising, &[]),
            falling: part(&layout.falling, &[]),
            path_leaks: exponentials(&layout.ln_path_leaks),
            initial: part(&layout.initial, &[]),
            force: part(&layout.force, &[]),
        };
        Dynamics {
            output_offset: template.output_offset + template.output_scale * parameters[OFFSET],
            direct: parameters[DIRECT],
            modes: self.modes.iter().zip(&template.modes).map(mode).collect(),
            elements: self.elements.iter().zip(&template.elements).map(element).collect(),
            ..*template
        }
    }

    /// The parameters of a model, whose offset is 0.
    pub fn parameters(&self, dynamics: &Dynamics) -> Vec<f64> {
        let mut parameters = vec![0.0; self.count];
        parameters[DIRECT] = dynamics.direct;
        for (layout, mode) in self.modes.iter().zip(&dynamics.modes) {
            parameters[layout.ln_frequency] = ln(mode.frequency);
            parameters[layout.ln_damping] = ln(mode.damping);
            parameters[layout.gain] = mode.gain;
            parameters[layout.velocity_in_output.clone()].fill(mode.velocity_in_output);
        }
        for (layout, element) in self.elements.iter().zip(&dynamics.elements) {
            let ln = |values: &[f64]| values.iter().copied().map(ln).collect::<Vec<f64>>();
            let parts: [(&Range<usize>, &[f64]); 14] = [
                (&layout.of_displacements, &element.of_displacements),
                (&layout.of_velocities, &element.of_velocities),
                (&layout.of_input, &[element.of_input]),
                (&layout.compliances, &element.compliances),
                (&layout.in_output, &[element.in_output]),
                (&layout.layer, &element.layer[self.shape.first_free_input() * self.shape.neurons..]),
                (&layout.rising, &element.rising),
                (&layout.falling, &element.falling),
                (&layout.ln_path_leaks, &ln(&element.path_leaks)),
                (&layout.initial, &element.initial),
                (&layout.ln_thresholds, &ln(&element.thresholds)),
                (&layout.stop_velocities, &element.stop_velocities),
                (&layout.strength_losses, &element.strength_losses),
                (&layout.force, &element.force),
            ];
            for (range, values) in parts {
                parameters[range.clone()].iter_mut().zip(values).for_each(|(to, from)| *to = *from);
            }
        }
        parameters
    }
}

/// The exponential of a logarithm that was limited to bounds: rounding may put it just outside them.
fn within(ln: f64, (low, high): (f64, f64)) -> f64 {
    exp(ln).clamp(low, high)
}

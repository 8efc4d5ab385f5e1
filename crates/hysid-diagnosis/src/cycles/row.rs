//! One cycle in figures.

use serde::Serialize;

/// A cycle, or an incomplete part of one, in figures. Inputs and outputs are in the user's units. A figure that the data do
/// not give is `None`, and `notes` says why; those of other fields are `None` too. Each figure is defined in [`FIGURES`](crate::cycles::FIGURES) and docs/cycles.md.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CycleRow {
    /// Name of the record.
    pub record: String,
    /// Number of the row within its record, counted from 1.
    pub cycle: usize,
    /// First and last row, counted from 0 at the beginning of the record.
    pub rows: (usize, usize),
    /// False for what is left of a cycle at the beginning or the end of a record.
    pub complete: bool,
    /// Time at its beginning.
    pub start_time: Option<f64>,
    /// Its duration.
    pub period: Option<f64>,
    /// Cycles in a unit of time.
    pub frequency: Option<f64>,
    /// Smallest input.
    pub input_min: Option<f64>,
    /// Largest input.
    pub input_max: Option<f64>,
    /// Half the difference of the largest and the smallest input.
    pub amplitude: Option<f64>,
    /// Half the sum of the largest and the smallest input.
    pub mean_input: Option<f64>,
    /// Smallest output.
    pub output_min: Option<f64>,
    /// Largest output.
    pub output_max: Option<f64>,
    /// Input at the peak, where the input turned down.
    pub peak_input: Option<f64>,
    /// Output at the peak.
    pub peak_output: Option<f64>,
    /// Input at the valley, where the input turned up.
    pub valley_input: Option<f64>,
    /// Output at the valley.
    pub valley_output: Option<f64>,
    /// `∮ y dx`: the energy lost, positive if the loop is passed clockwise; of a magnet `∮ x dy = -∮ y dx`.
    pub energy: Option<f64>,
    /// Standard deviation of the energy from the noise of the output.
    pub energy_deviation: Option<f64>,
    /// Sum of the energies of the record's complete cycles so far.
    pub cumulative_energy: Option<f64>,
    /// Energy lost per unit of time.
    pub power: Option<f64>,
    /// Energy lost in a cycle by the improved generalised Steinmetz equation, with the parameters of the cycles of sines.
    pub igse_energy: Option<f64>,
    /// Energy lost per mass, of an energy per volume.
    pub energy_per_mass: Option<f64>,
    /// Energy lost per unit of time and mass.
    pub power_per_mass: Option<f64>,
    /// Slope of the line from valley to peak.
    pub secant_stiffness: Option<f64>,
    /// Equivalent viscous damping ratio in percent of critical damping.
    pub damping_percent: Option<f64>,
    /// First harmonic of the output in phase with a sine of the input, over its amplitude.
    pub storage_modulus: Option<f64>,
    /// First harmonic of the output a quarter of a period ahead of a sine of the input, over its amplitude.
    pub loss_modulus: Option<f64>,
    /// Angle in degrees whose tangent is the loss modulus over the storage modulus.
    pub loss_angle: Option<f64>,
    /// Input at which the output is 0 on the way down from the peak.
    pub residual_after_peak: Option<f64>,
    /// Input at which the output is 0 on the way up from the valley.
    pub residual_after_valley: Option<f64>,
    /// True if the peak is a point of the backbone.
    pub backbone_peak: bool,
    /// True if the valley is a point of the backbone.
    pub backbone_valley: bool,
    /// Half the distance along the input of both branches at the output 0.
    pub coercive_input: Option<f64>,
    /// Half the distance along the output of both branches at the input 0.
    pub remanent_output: Option<f64>,
    /// Remanence over half the range of the output.
    pub squareness: Option<f64>,
    /// Largest difference of the outputs of both branches at equal input.
    pub width: Option<f64>,
    /// Standard deviation of the width from the noise of the output.
    pub width_deviation: Option<f64>,
    /// The same in percent of the loop's range of the output.
    pub width_percent: Option<f64>,
    /// The input where it is.
    pub width_at_input: Option<f64>,
    /// Largest deviation of the mean of both branches from the best straight line, in percent of the range of the output.
    pub nonlinearity_percent: Option<f64>,
    /// Range of the output of a butterfly loop.
    pub peak_to_peak: Option<f64>,
    /// Mean distance of the outputs of both branches at the input 0 from their extremes inside, of a butterfly loop.
    pub butterfly_remanence: Option<f64>,
    /// Half the distance along the input of these extremes.
    pub butterfly_coercive_input: Option<f64>,
    /// Input at which the transition of the rising branch starts, by tangents.
    pub heating_start: Option<f64>,
    /// Input at which it is finished.
    pub heating_finish: Option<f64>,
    /// Input at which the transition of the falling branch starts, by tangents.
    pub cooling_start: Option<f64>,
    /// Input at which it is finished.
    pub cooling_finish: Option<f64>,
    /// Middle of the transition of the rising branch less that of the falling branch.
    pub thermal_width: Option<f64>,
    /// Mean distance of both branches along the output.
    pub mean_gap: Option<f64>,
    /// `∫ y dx` of one direction in percent of that of the other, the smaller over the larger.
    pub energy_efficiency_percent: Option<f64>,
    /// Mean difference of the rising and the falling branch in shares of the range of the output.
    pub hysteresis_index: Option<f64>,
    /// Duration of the longest hold of the input that begins in the cycle.
    pub hold_duration: Option<f64>,
    /// Change of the output during that hold.
    pub creep: Option<f64>,
    /// The same in percent of the data's range of the output.
    pub creep_percent: Option<f64>,
    /// Change of the output in a decade of time since the beginning of the hold.
    pub creep_per_decade: Option<f64>,
    /// Why figures are missing or to be read with care.
    pub notes: Vec<String>,
    /// Signs of a measurement that is not the specimen's loop alone.
    #[serde(skip)]
    pub(crate) faults: LoopFaults,
}

/// Begins the note on an open loop.
pub(super) const OPEN_LOOP: &str = "the loop is open by";

impl CycleRow {
    /// Multiplies energies, and frequencies, by these factors.
    pub(super) fn scale(&mut self, energy: f64, rate: f64) {
        let energies = [&mut self.energy, &mut self.energy_deviation, &mut self.cumulative_energy];
        energies.into_iter().flatten().for_each(|value| *value *= energy);
        self.power.iter_mut().for_each(|power| *power *= energy * rate);
        self.frequency.iter_mut().for_each(|frequency| *frequency *= rate);
    }

    /// Output at the end less output at the beginning, in the unit of the output, if the loop is open.
    pub fn opening(&self) -> Option<f64> {
        self.faults.opening
    }

    /// The notes on anything but an open loop.
    pub fn other_notes(&self) -> impl Iterator<Item = &String> {
        self.notes.iter().filter(|note| !note.starts_with(OPEN_LOOP))
    }
}

/// Signs that something lies under or beside a loop.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct LoopFaults {
    /// Output at the end less output at the beginning, if the loop is open.
    pub opening: Option<f64>,
    /// How often both branches pass the middle of the outputs, if more than once.
    pub passings: usize,
    /// The middle of the outputs of a loop about the input 0, if it is not 0.
    pub offset: Option<f64>,
}

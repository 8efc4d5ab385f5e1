//! The native commands: `BoucWen` and `BWBN`.
//!
//! ```text
//! native:  stress = α k_o ε + (1 - α) k_o z,   dz = [A - |z|^n (γ + β sgn(z dε))]/η dε
//! ours:    y - c0 = α k x + (1 - α) k z,       z in yield displacements z_u           theory.md (8.4) to (8.11)
//! ```
//!
//! So `β = b/z_u^n` and `γ = (1 - b)/z_u^n`. The native energy is in the unit of work, ours in `(1 - α) k z_u²`.

use hysid_core::elementary::powf;
use hysid_core::law::Classical;
use hysid_core::law::bouc_wen::{BoucWen, Degradation};
use hysid_core::model::Model;

/// A native command.
pub(super) struct Native {
    command: &'static str,
    /// Names and values of the arguments after the tag.
    arguments: Vec<(&'static str, f64)>,
    /// Whole numbers behind them.
    iterations: Option<u32>,
    /// Constants added to the input and to the stress.
    origin: f64,
    offset: f64,
}

impl Native {
    /// The command for a model, or why there is none.
    pub fn of(model: &Model) -> Result<Self, String> {
        let Some(Classical::BoucWen(law)) = model.law() else {
            return Err(format!("only bouc-wen models have one, and this is {}", model.name().name()));
        };
        let transform = model.input_transform();
        if transform.companding.is_some() || transform.history.is_some() {
            return Err("it transforms its input".into());
        }
        if !model.lead_in().is_empty() {
            return Err("it does not begin at rest".into());
        }
        if law.damping != 0.0 {
            return Err("its damping (c) belongs to the rate in the data, and the native law has none".into());
        }
        let stiffness = law.stiffness();
        if stiffness == 0.0 {
            return Err("its initial stiffness is 0, which the native law divides by".into());
        }
        let exponent = powf(law.yield_displacement, law.n);
        let mut arguments = vec![
            ("alpha", law.alpha()),
            ("ko", stiffness),
            ("n", law.n),
            ("gamma", (1.0 - law.b) / exponent),
            ("beta", law.b / exponent),
            ("Ao", 1.0),
        ];
        let energy = law.hysteretic_stiffness * law.yield_displacement * law.yield_displacement;
        let (command, iterations) = match law.degradation {
            Some(degradation) if degradation.zeta_s != 0.0 => {
                arguments.extend(pinching(law, &degradation, energy)?);
                ("BWBN", Some(100))
            }
            degradation => {
                let deltas = degradation.map_or([0.0; 3], |degradation| {
                    [degradation.delta_a, degradation.delta_nu, degradation.delta_eta]
                });
                let names = ["deltaA", "deltaNu", "deltaEta"];
                arguments.extend(names.into_iter().zip(deltas.map(|delta| delta / energy)));
                ("BoucWen", None)
            }
        };
        let is_usable = arguments.iter().all(|(_, value)| value.is_finite());
        if !is_usable {
            return Err("its parameters are too large in the units of the native law".into());
        }
        Ok(Self { command, arguments, iterations, origin: transform.origin(0), offset: law.offset })
    }

    pub fn command(&self) -> &'static str {
        self.command
    }

    /// Explains the constants.
    pub fn constants(&self) -> String {
        let strain = if self.origin == 0.0 { "x".into() } else { format!("x - {:?}", self.origin) };
        format!("Its strain is `{strain}` and its stress is `y - {:?}`.", self.offset)
    }

    pub fn tcl(&self) -> String {
        let names: String = self.arguments.iter().map(|(name, _)| format!(" {name}")).collect();
        let values: String = self.arguments.iter().map(|(_, value)| format!(" {value:?}")).collect();
        let (name, value) = self.last(" tolerance iterations", " ");
        format!(
            "# {}\n# uniaxialMaterial {} tag{names}{name}\nif {{![info exists tag]}} {{ set tag 1 }}\nuniaxialMaterial {} $tag{values}{value}\n",
            self.constants(),
            self.command,
            self.command
        )
    }

    pub fn python(&self) -> String {
        let values: String =
            self.arguments.iter().map(|(name, value)| format!("        {value:?},  # {name}\n")).collect();
        let (_, value) = self.last("", "        ");
        let last = if value.is_empty() { String::new() } else { format!("{},\n", value.trim_end()) };
        format!(
            "\"\"\"{}\"\"\"\n\nimport openseespy.opensees as ops\n\n\ndef define(tag=1):\n    \"\"\"Define the \
             material.\"\"\"\n    ops.uniaxialMaterial(\n        \"{}\",\n        tag,\n{values}{last}    )\n",
            self.constants(),
            self.command
        )
    }

    /// Tolerance and iterations, where the command takes them.
    fn last(&self, name: &str, before: &str) -> (String, String) {
        match self.iterations {
            None => (String::new(), String::new()),
            Some(iterations) if before.len() > 1 => {
                (name.into(), format!("{before}1e-10,\n{before}{iterations}"))
            }
            Some(iterations) => (name.into(), format!("{before}1e-10{before}{iterations}")),
        }
    }
}

/// Pinching, which the native law has without degradation of strength and stiffness.
fn pinching(
    law: &BoucWen,
    degradation: &Degradation,
    energy: f64,
) -> Result<Vec<(&'static str, f64)>, String> {
    let Degradation { delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda } = *degradation;
    if [delta_a, delta_nu, delta_eta] != [0.0; 3] {
        return Err(
            "it has both pinching and degradation; of the native laws, BoucWen has no pinching and BWBN no \
                    degradation of strength and stiffness"
                .into(),
        );
    }
    let z_u = law.yield_displacement;
    Ok(vec![
        ("q", q),
        ("zetas", zeta_s),
        ("p", p / energy),
        ("Shi", psi_0 * z_u),
        ("deltaShi", delta_psi * z_u / energy),
        ("lambda", lambda),
    ])
}

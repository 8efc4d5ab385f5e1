//! Native commands of OpenSees that define a model's law.

mod bouc_wen;
mod steel;
mod stops;

use hysid_core::law::Classical;
use hysid_core::model::Model;

use crate::target::template::filled;

/// The native commands of a model.
pub(super) struct Native {
    /// The material is the last of them, and has the user's tag; its parts have the next tags.
    commands: Vec<Command>,
    /// How the native material differs from the model.
    agreement: &'static str,
    /// Constants that are added to the input and to the stress.
    origin: f64,
    offset: f64,
}

/// A `uniaxialMaterial` command.
struct Command {
    material: &'static str,
    arguments: Vec<Argument>,
}

/// An argument after the tag.
enum Argument {
    Number {
        name: &'static str,
        value: f64,
    },
    Count {
        name: &'static str,
        value: u32,
    },
    /// The tag of a part: the first one is 1.
    Part(usize),
    Flag(&'static str),
}

/// Commands of a law, how they differ from it, and the constant that they leave out.
struct NativeLaw {
    commands: Vec<Command>,
    agreement: &'static str,
    offset: f64,
}

impl Native {
    /// The commands for a model, or why there are none.
    pub fn of(model: &Model) -> Result<Self, String> {
        let law = match model.law() {
            Some(Classical::BoucWen(law)) => bouc_wen::native(law),
            Some(Classical::MenegottoPinto(law)) => steel::native(law),
            Some(Classical::PrandtlIshlinskii(law)) => Ok(stops::of_plays(law)),
            Some(Classical::Masing(law)) => Ok(stops::of_masing(law)),
            _ => Err(format!("OpenSees has no material with the law of {}", model.name().name())),
        };
        let transform = model.input_transform();
        if transform.compression.is_some() || transform.history.is_some() {
            return Err("it transforms its input".into());
        }
        if !model.lead_in().is_empty() {
            return Err("it does not begin at rest".into());
        }
        let NativeLaw { commands, agreement, offset } = law?;
        let is_finite =
            |argument: &Argument| !matches!(argument, Argument::Number { value, .. } if !value.is_finite());
        if !commands.iter().flat_map(|command| &command.arguments).all(is_finite) {
            return Err("its parameters are too large in the units of the native law".into());
        }
        Ok(Self { commands, agreement, origin: transform.origin(0), offset })
    }

    /// The materials, the main one last.
    pub fn materials(&self) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = self.commands.iter().map(|command| command.material).collect();
        names.dedup();
        names
    }

    pub fn agreement(&self) -> &'static str {
        self.agreement
    }

    /// Explains the constants.
    pub fn constants(&self) -> String {
        let strain = match self.origin {
            0.0 => "Its strain is the input of the model".into(),
            origin => format!("Its strain is the input of the model, less {origin:?}"),
        };
        format!("{strain}. The output of the model is its stress plus {:?}.", self.offset)
    }

    /// The tag of a command, counted from that of the material.
    fn tag_of(&self, place: usize) -> usize {
        if place + 1 == self.commands.len() { 0 } else { place + 1 }
    }

    pub fn tcl(&self) -> String {
        let tag = |part: usize| if part == 0 { "$tag".into() } else { format!("[expr {{$tag + {part}}}]") };
        let mut text = format!("# {}\nif {{![info exists tag]}} {{ set tag 1 }}\n", self.constants());
        for (place, Command { material, arguments }) in self.commands.iter().enumerate() {
            let names: Vec<&str> = arguments.iter().filter_map(Argument::name).collect();
            if !names.is_empty() {
                text += &format!("# uniaxialMaterial {material} tag {}\n", names.join(" "));
            }
            let values =
                arguments.iter().map(|argument| format!(" {}", argument.text(tag))).collect::<String>();
            text += &format!("uniaxialMaterial {material} {}{values}\n", tag(self.tag_of(place)));
        }
        text
    }

    pub fn python(&self, name: &str) -> String {
        let tag = |part: usize| if part == 0 { "tag".into() } else { format!("tag + {part}") };
        let mut commands = String::new();
        for (place, Command { material, arguments }) in self.commands.iter().enumerate() {
            let tag_of = tag(self.tag_of(place));
            commands += &format!("    ops.uniaxialMaterial(\n        \"{material}\",\n        {tag_of},\n");
            for argument in arguments {
                let name = argument.name().map_or(String::new(), |name| format!("  # {name}"));
                let value = match argument {
                    Argument::Flag(flag) => format!("\"{flag}\""),
                    other => other.text(tag),
                };
                commands += &format!("        {value},{name}\n");
            }
            commands += "    )\n";
        }
        let parts = match self.commands.len() - 1 {
            0 => String::new(),
            parts => format!("; its parts have the tags from `tag + 1` to `tag + {parts}`"),
        };
        filled(
            include_str!("native.py.txt"),
            &[
                ("@constants@", &self.constants()),
                ("@origin@", &format!("{:?}", self.origin)),
                ("@offset@", &format!("{:?}", self.offset)),
                ("@parts@", &parts),
                ("@commands@", &commands),
                ("NAME", name),
            ],
        )
    }
}

impl Command {
    fn new(material: &'static str, numbers: impl IntoIterator<Item = (&'static str, f64)>) -> Self {
        let number = |(name, value)| Argument::Number { name, value };
        Self { material, arguments: numbers.into_iter().map(number).collect() }
    }
}

impl Argument {
    fn name(&self) -> Option<&'static str> {
        match self {
            Self::Number { name, .. } | Self::Count { name, .. } => {
                Some(name).filter(|name| !name.is_empty()).copied()
            }
            Self::Part(_) | Self::Flag(_) => None,
        }
    }

    fn text(&self, tag: impl Fn(usize) -> String) -> String {
        match self {
            Self::Number { value, .. } => format!("{value:?}"),
            Self::Count { value, .. } => value.to_string(),
            Self::Part(part) => tag(*part),
            Self::Flag(flag) => (*flag).into(),
        }
    }
}

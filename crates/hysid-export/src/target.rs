//! The targets, one a file: each writes programs in its language.

mod abaqus;
pub(crate) mod c;
mod fmu;
mod matlab;
mod onnx;
mod opensees;
mod printer;
mod python;
mod template;

use crate::error::Error;
use crate::subject::{ExportFile, ExportSubject};

/// Where an exported model is to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A user material of Abaqus.
    Abaqus,
    /// C99.
    C,
    /// A Functional Mock-up Unit.
    Fmu,
    /// MATLAB without toolboxes, and GNU Octave.
    Matlab,
    /// Graphs of ONNX.
    Onnx,
    /// A material of OpenSees.
    OpenSees,
    /// Python with NumPy.
    Python,
}

impl Target {
    /// All targets.
    pub const ALL: [Self; 7] =
        [Self::C, Self::Fmu, Self::Matlab, Self::OpenSees, Self::Abaqus, Self::Onnx, Self::Python];

    /// The target of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.back_end().name
    }

    /// Names the target, in a few words.
    pub fn what(self) -> &'static str {
        match self {
            Self::Abaqus => "user material of Abaqus, in C",
            Self::C => "C99 source code with a test",
            Self::Fmu => "Functional Mock-up Unit, for Simulink, Dymola and others",
            Self::Matlab => "MATLAB without toolboxes, and GNU Octave",
            Self::Onnx => "graphs of ONNX",
            Self::OpenSees => "material of OpenSees",
            Self::Python => "Python module that needs NumPy alone",
        }
    }

    /// True if the inverse of a model can be exported to it.
    pub fn has_inverse(self) -> bool {
        self.back_end().has_inverse
    }

    pub(crate) fn back_end(self) -> &'static BackEnd {
        match self {
            Self::Abaqus => &abaqus::BACK_END,
            Self::C => &c::BACK_END,
            Self::Fmu => &fmu::BACK_END,
            Self::Matlab => &matlab::BACK_END,
            Self::Onnx => &onnx::BACK_END,
            Self::OpenSees => &opensees::BACK_END,
            Self::Python => &python::BACK_END,
        }
    }
}

/// How models are written for a target.
pub(crate) struct BackEnd {
    pub name: &'static str,
    pub has_single_precision: bool,
    /// True if it can have the inverse of a model too.
    pub has_inverse: bool,
    /// Lists of names that a model cannot have there.
    pub reserved: &'static [&'static str],
    /// Writes the files, without those that every export has.
    pub write: fn(&ExportSubject<'_>) -> Result<TargetFiles, Error>,
    /// The section of the export's page that says how to use them.
    pub usage: fn(&ExportSubject<'_>) -> String,
}

pub(crate) struct TargetFiles {
    pub files: Vec<ExportFile>,
    /// Note for the user.
    pub note: Option<String>,
}

impl From<Vec<ExportFile>> for TargetFiles {
    fn from(files: Vec<ExportFile>) -> Self {
        Self { files, note: None }
    }
}

//! What a law says about itself beside its equations.

/// What is true of a law whatever its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The name on the command line and in model files.
    pub name: &'static str,
    /// Whether the rate of the input is in its equations.
    pub rate: Rate,
    /// From where its input is measured.
    pub origin: Origin,
    /// How its parameters are found.
    pub identification: Identification,
    /// Options of a fit that it uses, beside those of every model.
    pub options: &'static [&'static str],
    /// Largest numbers of such options, where they are smaller than those of the table of options.
    pub limits: &'static [(&'static str, usize)],
    /// The option among them that adds a term or takes another form; both are tried where a law is tried in all its
    /// variants.
    pub variant: Option<&'static str>,
    /// For data of one loop: mean logarithm of the error inside the loop over the cross-validation error, measured on
    /// generated cases (docs/accuracy.md).
    pub log_error_inside: f64,
}

/// Whether the rate of the input is in the equations of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// It is not.
    Ignored,
    /// It can be.
    Optional,
    /// There is no such law without it.
    Needed,
}

/// From where the inputs of a model are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// From 0, for laws in which an input of 0 is a state of its own, as a demagnetising field is.
    Zero,
    /// From 0 where 0 lies within the data, otherwise from where they begin or from their middle.
    OfData,
}

/// How the parameters of a law are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Identification {
    /// By linear least squares, from one start.
    LeastSquares,
    /// By a search from several starts.
    Search,
}

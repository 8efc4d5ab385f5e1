//! Expressions of a program: real numbers, whole numbers, and truth values.

use std::ops::{Add, Div, Mul, Neg, Sub};

use hysid_core::from;

use crate::program::Array;

/// Name of a variable: its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RealVariable(pub(crate) usize);

/// Name of a variable with a whole number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WholeVariable(pub(crate) usize);

/// A function of one real number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unary {
    Negative,
    Magnitude,
    SquareRoot,
    Exp,
    /// `e^a - 1`, accurate near 0.
    ExpMinusOne,
    Ln,
    /// `ln(1 + a)`, accurate near 0.
    LnOnePlus,
    Tanh,
    /// Inverse hyperbolic sine. Languages without one: `ln(1 + |a| + |a|/(sqrt(1 + 1/a²) + 1/|a|))` with the sign of `a`.
    InverseSinh,
    /// The smallest whole number that is not below `a`.
    Ceiling,
    /// `2^a` for a whole number `a` whose magnitude is below 1000. Its derivative is 0.
    PowerOfTwo,
    /// `a`, whose derivative counts as 0.
    Detached,
}

/// A function of two real numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binary {
    Sum,
    Difference,
    Product,
    Quotient,
    /// `a^b` for `a >= 0`.
    Power,
    /// The magnitude of `a` with the sign of `b`.
    CopySign,
    Hypotenuse,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    Below,
    AtMost,
    Equal,
}

impl Relation {
    pub fn holds<T: PartialOrd>(self, a: T, b: T) -> bool {
        match self {
            Self::Below => a < b,
            Self::AtMost => a <= b,
            Self::Equal => a == b,
        }
    }
}

/// A real number: what a program computes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Real {
    Constant(f64),
    Variable(RealVariable),
    Element(Array, Box<Whole>),
    Unary(Unary, Box<Real>),
    Binary(Binary, Box<Real>, Box<Real>),
    /// `a * b + c`, see [`fused`].
    Fused(Box<Real>, Box<Real>, Box<Real>),
    /// The first number where the condition holds, otherwise the second. Only that one is computed.
    Choice(Box<Truth>, Box<Real>, Box<Real>),
    OfWhole(Box<Whole>),
}

/// A whole number: an index or a count.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Whole {
    Constant(i64),
    Variable(WholeVariable),
    Sum(Box<Whole>, Box<Whole>),
    Difference(Box<Whole>, Box<Whole>),
    Product(Box<Whole>, Box<Whole>),
    /// A real number that is whole, such as a count that is kept in a state.
    OfReal(Box<Real>),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Truth {
    /// A comparison of real numbers, false for NaN.
    Real(Relation, Box<Real>, Box<Real>),
    Whole(Relation, Box<Whole>, Box<Whole>),
    /// Both; the second is computed only where the first holds.
    And(Box<Truth>, Box<Truth>),
    /// One or both; the second is computed only where the first does not hold.
    Or(Box<Truth>, Box<Truth>),
    Not(Box<Truth>),
}

/// An expression of any kind.
#[derive(Clone, Copy)]
pub(crate) enum AnyExpression<'e> {
    Real(&'e Real),
    Whole(&'e Whole),
    Truth(&'e Truth),
}

impl<'e> AnyExpression<'e> {
    /// The expressions that it is made of, without those in them.
    pub fn parts(self) -> Vec<AnyExpression<'e>> {
        match self {
            Self::Real(Real::Constant(_) | Real::Variable(_)) => Vec::new(),
            Self::Whole(Whole::Constant(_) | Whole::Variable(_)) => Vec::new(),
            Self::Real(Real::Element(_, index) | Real::OfWhole(index)) => vec![Self::Whole(index)],
            Self::Real(Real::Unary(_, a)) | Self::Whole(Whole::OfReal(a)) => vec![Self::Real(a)],
            Self::Real(Real::Binary(_, a, b)) | Self::Truth(Truth::Real(_, a, b)) => {
                vec![Self::Real(a), Self::Real(b)]
            }
            Self::Real(Real::Fused(a, b, c)) => vec![Self::Real(a), Self::Real(b), Self::Real(c)],
            Self::Real(Real::Choice(condition, a, b)) => {
                vec![Self::Truth(condition), Self::Real(a), Self::Real(b)]
            }
            Self::Whole(Whole::Sum(a, b) | Whole::Difference(a, b) | Whole::Product(a, b))
            | Self::Truth(Truth::Whole(_, a, b)) => vec![Self::Whole(a), Self::Whole(b)],
            Self::Truth(Truth::And(a, b) | Truth::Or(a, b)) => vec![Self::Truth(a), Self::Truth(b)],
            Self::Truth(Truth::Not(a)) => vec![Self::Truth(a)],
        }
    }
}

from! {
    f64 => Real: value => Self::Constant(value);
    RealVariable => Real: variable => Self::Variable(variable);
    &Real => Real: value => value.clone();
    i32 => Whole: value => Self::Constant(value.into());
    usize => Whole: value => Self::Constant(i64::try_from(value).unwrap_or(i64::MAX));
    WholeVariable => Whole: variable => Self::Variable(variable);
    &Whole => Whole: value => value.clone();
}

macro_rules! real_operator {
    ($trait:ident, $method:ident, $binary:ident) => {
        impl<T: Into<Real>> $trait<T> for Real {
            type Output = Real;
            fn $method(self, other: T) -> Real {
                Real::Binary(Binary::$binary, Box::new(self), Box::new(other.into()))
            }
        }

        impl<T: Into<Real>> $trait<T> for &Real {
            type Output = Real;
            fn $method(self, other: T) -> Real {
                self.clone().$method(other)
            }
        }

        impl $trait<Real> for f64 {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                Real::from(self).$method(other)
            }
        }

        impl $trait<&Real> for f64 {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                Real::from(self).$method(other)
            }
        }
    };
}

real_operator!(Add, add, Sum);
real_operator!(Sub, sub, Difference);
real_operator!(Mul, mul, Product);
real_operator!(Div, div, Quotient);

impl Neg for Real {
    type Output = Real;
    fn neg(self) -> Real {
        self.apply(Unary::Negative)
    }
}

impl Neg for &Real {
    type Output = Real;
    fn neg(self) -> Real {
        -self.clone()
    }
}

macro_rules! whole_operator {
    ($trait:ident, $method:ident, $variant:ident) => {
        impl<T: Into<Whole>> $trait<T> for Whole {
            type Output = Whole;
            fn $method(self, other: T) -> Whole {
                Whole::$variant(Box::new(self), Box::new(other.into()))
            }
        }

        impl<T: Into<Whole>> $trait<T> for &Whole {
            type Output = Whole;
            fn $method(self, other: T) -> Whole {
                self.clone().$method(other)
            }
        }
    };
}

whole_operator!(Add, add, Sum);
whole_operator!(Sub, sub, Difference);
whole_operator!(Mul, mul, Product);

/// `a * b + c`: in one rounding in double precision, where the target can do it; in two otherwise.
pub(crate) fn fused(a: impl Into<Real>, b: impl Into<Real>, c: impl Into<Real>) -> Real {
    Real::Fused(Box::new(a.into()), Box::new(b.into()), Box::new(c.into()))
}

macro_rules! functions {
    ($($(#[$comment:meta])* $name:ident: $function:ident,)*) => {
        impl Real {$(
            $(#[$comment])*
            pub fn $name(&self) -> Self {
                self.clone().apply(Unary::$function)
            }
        )*}
    };
}

functions! {
    abs: Magnitude,
    exp: Exp,
    exp_m1: ExpMinusOne,
    ln: Ln,
    ln_1p: LnOnePlus,
    sqrt: SquareRoot,
    /// Hyperbolic tangent of `hysid_core::elementary`. Networks have one of their own.
    tanh: Tanh,
    asinh: InverseSinh,
    ceil: Ceiling,
    power_of_two: PowerOfTwo,
    detached: Detached,
}

macro_rules! of_two {
    ($($of:ident::$name:ident = $made:ident::$kind:ident($which:expr);)*) => {$(
        impl $of {
            pub fn $name(&self, other: impl Into<$of>) -> $made {
                $made::$kind($which, Box::new(self.clone()), Box::new(other.into()))
            }
        }
    )*};
}

of_two! {
    Real::powf = Real::Binary(Binary::Power);
    Real::copysign = Real::Binary(Binary::CopySign);
    Real::hypot = Real::Binary(Binary::Hypotenuse);
    Real::below = Truth::Real(Relation::Below);
    Real::at_most = Truth::Real(Relation::AtMost);
    Real::equals = Truth::Real(Relation::Equal);
    Whole::below = Truth::Whole(Relation::Below);
    Whole::equals = Truth::Whole(Relation::Equal);
}

impl Real {
    pub fn apply(self, function: Unary) -> Self {
        Self::Unary(function, Box::new(self))
    }

    pub fn signum(&self) -> Self {
        Self::Constant(1.0).copysign(self)
    }

    pub fn above(&self, other: impl Into<Real>) -> Truth {
        other.into().below(self)
    }

    pub fn at_least(&self, other: impl Into<Real>) -> Truth {
        other.into().at_most(self)
    }

    /// The larger of two numbers; the first where they are equal.
    pub fn max(&self, other: impl Into<Real>) -> Self {
        let other = other.into();
        self.below(&other).choose(other, self)
    }

    /// The smaller of two numbers; the first where they are equal.
    pub fn min(&self, other: impl Into<Real>) -> Self {
        let other = other.into();
        self.above(&other).choose(other, self)
    }

    /// The number within bounds. It stands in the result more than once: give a variable.
    pub fn clamp(&self, low: impl Into<Real>, high: impl Into<Real>) -> Self {
        let (low, high) = (low.into(), high.into());
        self.below(&low).choose(low, self.above(&high).choose(high, self))
    }

    pub fn to_whole(&self) -> Whole {
        Whole::OfReal(Box::new(self.clone()))
    }
}

impl Whole {
    pub fn to_real(&self) -> Real {
        Real::OfWhole(Box::new(self.clone()))
    }

    pub fn above(&self, other: impl Into<Whole>) -> Truth {
        other.into().below(self)
    }
}

impl Truth {
    /// The first number where the condition holds, otherwise the second.
    pub fn choose(self, yes: impl Into<Real>, no: impl Into<Real>) -> Real {
        Real::Choice(Box::new(self), Box::new(yes.into()), Box::new(no.into()))
    }

    pub fn and(self, other: Truth) -> Self {
        Self::And(Box::new(self), Box::new(other))
    }

    pub fn or(self, other: Truth) -> Self {
        Self::Or(Box::new(self), Box::new(other))
    }

    pub fn negated(self) -> Self {
        Self::Not(Box::new(self))
    }
}

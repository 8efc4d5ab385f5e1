//! Expressions of a program: real numbers, whole numbers, and truth values.

use std::ops::{Add, Div, Mul, Neg, Sub};

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
pub enum Comparison {
    Below,
    AtMost,
    Equal,
}

impl Comparison {
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
    Real(Comparison, Box<Real>, Box<Real>),
    Whole(Comparison, Box<Whole>, Box<Whole>),
    /// Both; the second is computed only where the first holds.
    And(Box<Truth>, Box<Truth>),
    /// One or both; the second is computed only where the first does not hold.
    Or(Box<Truth>, Box<Truth>),
    Not(Box<Truth>),
}

impl From<f64> for Real {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl From<RealVariable> for Real {
    fn from(variable: RealVariable) -> Self {
        Self::Variable(variable)
    }
}

impl From<&Real> for Real {
    fn from(value: &Real) -> Self {
        value.clone()
    }
}

impl From<i32> for Whole {
    fn from(value: i32) -> Self {
        Self::Constant(value.into())
    }
}

impl From<usize> for Whole {
    fn from(value: usize) -> Self {
        Self::Constant(i64::try_from(value).unwrap_or(i64::MAX))
    }
}

impl From<WholeVariable> for Whole {
    fn from(variable: WholeVariable) -> Self {
        Self::Variable(variable)
    }
}

impl From<&Whole> for Whole {
    fn from(value: &Whole) -> Self {
        value.clone()
    }
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

impl Real {
    pub fn apply(self, function: Unary) -> Self {
        Self::Unary(function, Box::new(self))
    }

    pub fn abs(&self) -> Self {
        self.clone().apply(Unary::Magnitude)
    }

    pub fn exp(&self) -> Self {
        self.clone().apply(Unary::Exp)
    }

    pub fn exp_m1(&self) -> Self {
        self.clone().apply(Unary::ExpMinusOne)
    }

    pub fn ln(&self) -> Self {
        self.clone().apply(Unary::Ln)
    }

    pub fn ln_1p(&self) -> Self {
        self.clone().apply(Unary::LnOnePlus)
    }

    pub fn sqrt(&self) -> Self {
        self.clone().apply(Unary::SquareRoot)
    }

    /// Hyperbolic tangent of `hysid_core::elementary`. Networks have one of their own.
    pub fn tanh(&self) -> Self {
        self.clone().apply(Unary::Tanh)
    }

    pub fn asinh(&self) -> Self {
        self.clone().apply(Unary::InverseSinh)
    }

    pub fn ceil(&self) -> Self {
        self.clone().apply(Unary::Ceiling)
    }

    pub fn power_of_two(&self) -> Self {
        self.clone().apply(Unary::PowerOfTwo)
    }

    pub fn detached(&self) -> Self {
        self.clone().apply(Unary::Detached)
    }

    pub fn powf(&self, exponent: impl Into<Real>) -> Self {
        Self::Binary(Binary::Power, Box::new(self.clone()), Box::new(exponent.into()))
    }

    pub fn copysign(&self, sign: impl Into<Real>) -> Self {
        Self::Binary(Binary::CopySign, Box::new(self.clone()), Box::new(sign.into()))
    }

    pub fn hypot(&self, other: impl Into<Real>) -> Self {
        Self::Binary(Binary::Hypotenuse, Box::new(self.clone()), Box::new(other.into()))
    }

    pub fn signum(&self) -> Self {
        Self::Constant(1.0).copysign(self)
    }

    pub fn below(&self, other: impl Into<Real>) -> Truth {
        Truth::Real(Comparison::Below, Box::new(self.clone()), Box::new(other.into()))
    }

    pub fn at_most(&self, other: impl Into<Real>) -> Truth {
        Truth::Real(Comparison::AtMost, Box::new(self.clone()), Box::new(other.into()))
    }

    pub fn above(&self, other: impl Into<Real>) -> Truth {
        Truth::Real(Comparison::Below, Box::new(other.into()), Box::new(self.clone()))
    }

    pub fn at_least(&self, other: impl Into<Real>) -> Truth {
        Truth::Real(Comparison::AtMost, Box::new(other.into()), Box::new(self.clone()))
    }

    pub fn equals(&self, other: impl Into<Real>) -> Truth {
        Truth::Real(Comparison::Equal, Box::new(self.clone()), Box::new(other.into()))
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

    pub fn below(&self, other: impl Into<Whole>) -> Truth {
        Truth::Whole(Comparison::Below, Box::new(self.clone()), Box::new(other.into()))
    }

    pub fn above(&self, other: impl Into<Whole>) -> Truth {
        Truth::Whole(Comparison::Below, Box::new(other.into()), Box::new(self.clone()))
    }

    pub fn equals(&self, other: impl Into<Whole>) -> Truth {
        Truth::Whole(Comparison::Equal, Box::new(self.clone()), Box::new(other.into()))
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

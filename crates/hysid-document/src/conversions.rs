//! Conversions that are an expression each.

macro_rules! from {
    ($($given:ty => $made:ident: $value:ident => $of_it:expr;)*) => {$(
        impl From<$given> for $made {
            fn from($value: $given) -> Self {
                $of_it
            }
        }
    )*};
}
pub(crate) use from;

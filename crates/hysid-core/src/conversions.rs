//! Conversions that are an expression each.

/// Makes `From` of rows `given => made: value => expression;`.
#[doc(hidden)]
#[macro_export]
macro_rules! from {
    ($($given:ty => $made:ident: $value:ident => $of_it:expr;)*) => {$(
        impl From<$given> for $made {
            fn from($value: $given) -> Self {
                $of_it
            }
        }
    )*};
}

//! The numbers of an environment by name.

use crate::certificate::Parameter;
use crate::environment::{
    DamperWall, DelayedSpring, Environment, FilteredWall, FreeMode, FreeModeWall, OneSided, Placed,
    Rational, Wall,
};

/// Something with numbers that have names.
pub trait NamedParameters {
    /// The number of this name; `None` where there is none.
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64>;
}

macro_rules! values {
    ($([$($generics:tt)*] $type:ty: $($parameter:ident => $field:ident),* $(; $inner:ident)?;)*) => {$(
        impl<$($generics)*> NamedParameters for $type {
            fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
                match parameter {
                    $(Parameter::$parameter => Some(&mut self.$field),)*
                    _ => values!(@ self parameter $($inner)?),
                }
            }
        }
    )*};
    (@ $self:ident $parameter:ident) => { None };
    (@ $self:ident $parameter:ident $inner:ident) => { $self.$inner.value($parameter) };
}

values! {
    [const N: usize] DelayedSpring<N>: Stiffness => stiffness;
    [const N: usize] DamperWall<N>: Stiffness => stiffness, Damping => damping;
    [const N: usize] FilteredWall<N>:
        Stiffness => stiffness, Damping => damping, Filter => filter;
    [W: NamedParameters] Placed<W>: Face => face; wall;
    [W: NamedParameters] OneSided<W>: Face => face; wall;
    [const N: usize] FreeMode<N>: Residual => residual;
    [W: NamedParameters] FreeModeWall<W>: Residual => residual; wall;
}

impl NamedParameters for Rational {
    /// Its coefficients belong together; none is changed alone.
    fn value(&mut self, _: Parameter) -> Option<&mut f64> {
        None
    }
}

impl NamedParameters for Wall {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Stiffness => Some(&mut self.stiffness),
            Parameter::Damping => Some(&mut self.damping),
            Parameter::Filter => self.filter.as_mut(),
            Parameter::Face => Some(&mut self.face),
            _ => None,
        }
    }
}

impl NamedParameters for Environment {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match (self, parameter) {
            // A spring has no damper, whatever its wall says.
            (Self::DelayedSpring(_), Parameter::Damping | Parameter::Filter) => None,
            (Self::DelayedSpring(wall) | Self::DamperWall(wall), _) => wall.value(parameter),
            (
                Self::FreeMode { residual, .. } | Self::FreeModeWall { residual, .. },
                Parameter::Residual,
            ) => Some(residual),
            (Self::FreeModeWall { wall, .. }, _) => wall.value(parameter),
            (Self::FreeMode { .. } | Self::Rational(_), _) => None,
        }
    }
}

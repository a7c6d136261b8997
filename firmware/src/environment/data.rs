//! Converts each environment type to data for the certificate, which is one function for all environments.

use super::*;

impl<const N: usize> DelayedSpring<N> {
    /// The spring as a wall without damping.
    pub const fn as_wall(&self) -> Wall {
        wall::<N>(self.stiffness, 0.0, None)
    }
}

impl<const N: usize> DamperWall<N> {
    /// As data.
    pub const fn as_wall(&self) -> Wall {
        wall::<N>(self.stiffness, self.damping, None)
    }
}

impl<const N: usize> FilteredWall<N> {
    /// As data.
    pub const fn as_wall(&self) -> Wall {
        wall::<N>(self.stiffness, self.damping, Some(self.filter))
    }
}

const fn wall<const N: usize>(stiffness: f64, damping: f64, filter: Option<f64>) -> Wall {
    Wall { stiffness, damping, filter, delay: N, face: 0.0, one_sided: false }
}

impl<const N: usize> FreeMode<N> {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        Environment::FreeMode { residual: self.residual, delay: N }
    }
}

impl<const KNOTS: usize, const N: usize> Profile<KNOTS, N> {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        Environment::Profile(self.as_any())
    }
}

impl<const KNOTS: usize, const N: usize> DampedProfile<KNOTS, N> {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        Environment::Profile(self.as_any())
    }
}

impl<const N: usize> ProfileModes<N> {
    /// As data: the selected profile.
    pub const fn as_data(&self) -> Environment {
        Environment::Profile(self.as_any())
    }
}

impl<const KNOTS: usize, const N: usize> SnapProfile<KNOTS, N> {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        Environment::Profile(self.as_any())
    }
}

impl Rational {
    /// As data.
    pub const fn as_data(&self) -> Environment {
        Environment::Rational(*self)
    }
}

impl Environment {
    /// Itself.
    pub const fn as_data(&self) -> Environment {
        *self
    }
}

macro_rules! wall_types {
    ($($wall:ident => $kind:ident),*) => {$(
        impl<const N: usize> $wall<N> {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                Environment::$kind(self.as_wall())
            }
        }

        impl<const N: usize> Placed<$wall<N>> {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                Environment::$kind(Wall { face: self.face, ..self.wall.as_wall() })
            }
        }

        impl<const N: usize> OneSided<$wall<N>> {
            /// As data.
            pub const fn as_wall(&self) -> Wall {
                Wall { face: self.face, one_sided: true, ..self.wall.as_wall() }
            }

            /// As data.
            pub const fn as_data(&self) -> Environment {
                Environment::$kind(self.as_wall())
            }
        }

        impl<const N: usize> FreeModeWall<$wall<N>> {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                Environment::FreeModeWall { residual: self.residual, wall: self.wall.as_wall() }
            }
        }

        impl<const N: usize> FreeModeWall<OneSided<$wall<N>>> {
            /// As data.
            pub const fn as_data(&self) -> Environment {
                Environment::FreeModeWall { residual: self.residual, wall: self.wall.as_wall() }
            }
        }
    )*};
}

wall_types!(DelayedSpring => DelayedSpring, DamperWall => DamperWall, FilteredWall => DamperWall);

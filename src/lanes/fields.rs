//! Structs of numbers that can stand for one particle or for several side by side.

use super::Real;
use crate::particles::Vector;

/// What a pair term reads of a particle, or adds up: numbers with names. [`fields!`] implements it for a struct.
pub trait Fields: Copy + Send + Sync {
    /// The same struct with numbers of type `R`.
    type With<R: Real>: Copy;

    /// Number of numbers.
    const COUNT: usize;

    /// Makes the struct of its numbers, which are asked for in their order.
    fn build<R: Real>(number: impl FnMut(usize) -> R) -> Self::With<R>;

    /// Hands out the numbers in their order.
    fn each<R: Real>(of: &Self::With<R>, number: impl FnMut(usize, R));
}

/// Nothing but the position.
impl Fields for () {
    type With<R: Real> = ();
    const COUNT: usize = 0;

    #[inline(always)]
    fn build<R: Real>(_: impl FnMut(usize) -> R) {}

    #[inline(always)]
    fn each<R: Real>((): &(), _: impl FnMut(usize, R)) {}
}

impl Fields for f64 {
    type With<R: Real> = R;
    const COUNT: usize = 1;

    #[inline(always)]
    fn build<R: Real>(mut number: impl FnMut(usize) -> R) -> R {
        number(0)
    }

    #[inline(always)]
    fn each<R: Real>(of: &R, mut number: impl FnMut(usize, R)) {
        number(0, *of);
    }
}

impl<const D: usize> Fields for Vector<D> {
    type With<R: Real> = Vector<D, R>;
    const COUNT: usize = D;

    #[inline(always)]
    fn build<R: Real>(number: impl FnMut(usize) -> R) -> Vector<D, R> {
        Vector(<[f64; D]>::build(number))
    }

    #[inline(always)]
    fn each<R: Real>(of: &Vector<D, R>, number: impl FnMut(usize, R)) {
        <[f64; D]>::each(&of.0, number);
    }
}

impl<T: Fields, const N: usize> Fields for [T; N] {
    type With<R: Real> = [T::With<R>; N];
    const COUNT: usize = N * T::COUNT;

    #[inline(always)]
    fn build<R: Real>(mut number: impl FnMut(usize) -> R) -> Self::With<R> {
        std::array::from_fn(
            #[inline(always)]
            |n| {
                T::build(
                    #[inline(always)]
                    |k| number(n * T::COUNT + k),
                )
            },
        )
    }

    #[inline(always)]
    fn each<R: Real>(of: &Self::With<R>, mut number: impl FnMut(usize, R)) {
        for (n, element) in of.iter().enumerate() {
            T::each(
                element,
                #[inline(always)]
                |k, value| number(n * T::COUNT + k, value),
            );
        }
    }
}

impl<A: Fields, B: Fields> Fields for (A, B) {
    type With<R: Real> = (A::With<R>, B::With<R>);
    const COUNT: usize = A::COUNT + B::COUNT;

    #[inline(always)]
    fn build<R: Real>(mut number: impl FnMut(usize) -> R) -> Self::With<R> {
        let a = A::build(&mut number);
        (
            a,
            B::build(
                #[inline(always)]
                |k| number(A::COUNT + k),
            ),
        )
    }

    #[inline(always)]
    fn each<R: Real>(of: &Self::With<R>, mut number: impl FnMut(usize, R)) {
        A::each(&of.0, &mut number);
        B::each(
            &of.1,
            #[inline(always)]
            |k, value| number(A::COUNT + k, value),
        );
    }
}

/// Declares a struct of numbers and vectors over the dimension `D`, generic over [`Real`], and its [`Fields`].
#[macro_export]
macro_rules! fields {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident<$D:ident> {
            $($(#[$field_meta:meta])* $field_vis:vis $field:ident: $kind:ty,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy)]
        $vis struct $name<const $D: usize, R: $crate::lanes::Real = f64> {
            $($(#[$field_meta])* $field_vis $field: <$kind as $crate::lanes::Fields>::With<R>,)*
        }

        impl<const $D: usize> $crate::lanes::Fields for $name<$D> {
            type With<R: $crate::lanes::Real> = $name<$D, R>;
            const COUNT: usize = 0 $(+ <$kind as $crate::lanes::Fields>::COUNT)*;

            #[inline(always)]
            fn build<R: $crate::lanes::Real>(mut number: impl FnMut(usize) -> R) -> $name<$D, R> {
                let mut next = 0;
                $(
                    let first = next;
                    next += <$kind as $crate::lanes::Fields>::COUNT;
                    let $field = <$kind as $crate::lanes::Fields>::build(#[inline(always)] |k| number(first + k));
                )*
                let _ = next;
                $name { $($field),* }
            }

            #[inline(always)]
            fn each<R: $crate::lanes::Real>(of: &$name<$D, R>, mut number: impl FnMut(usize, R)) {
                let mut next = 0;
                $(
                    let first = next;
                    next += <$kind as $crate::lanes::Fields>::COUNT;
                    <$kind as $crate::lanes::Fields>::each(&of.$field, #[inline(always)] |k, value| number(first + k, value));
                )*
                let _ = next;
            }
        }
    };
}
pub use fields;

//! What a run goes on from: all that changes while it goes on and cannot be rebuilt from its scene and settings.
//!
//! Each part lists its fields once ([`Saved::pass`]), and the same list writes them and reads them back, bit by bit. Columns that a
//! step fills before it reads them are not among them.

use glam::DVec2;

/// A part of a run that changes as it goes on.
pub trait Saved {
    /// Hands its fields to a pass, always in the same order.
    fn pass(&mut self, pass: &mut Pass<'_>);
}

/// One way through the fields of a run.
#[derive(Debug)]
pub struct Pass<'a> {
    way: Way<'a>,
}

#[derive(Debug)]
enum Way<'a> {
    /// Out of the run, to the end of these bytes.
    Save(Vec<u8>),
    /// Into the run, from the start of these bytes; and whether there were too few of them.
    Load(&'a [u8], bool),
}

/// Bytes that are not those of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("its fields are not those of this run")]
pub struct Foreign;

impl<'a> Pass<'a> {
    /// A pass that takes fields out.
    pub fn save() -> Self {
        Pass { way: Way::Save(Vec::new()) }
    }

    /// A pass that puts fields in.
    pub fn load(bytes: &'a [u8]) -> Self {
        Pass { way: Way::Load(bytes, false) }
    }

    /// What was taken out; nothing if fields were put in.
    pub fn into_bytes(self) -> Vec<u8> {
        match self.way {
            Way::Save(bytes) => bytes,
            Way::Load(..) => Vec::new(),
        }
    }

    /// Ends a pass that put fields in.
    ///
    /// # Errors
    /// Where there were too few bytes, or some are left.
    pub fn end(self) -> Result<(), Foreign> {
        match self.way {
            Way::Load([], false) | Way::Save(_) => Ok(()),
            Way::Load(..) => Err(Foreign),
        }
    }

    /// Whether fields are put in.
    pub fn loads(&self) -> bool {
        matches!(self.way, Way::Load(..))
    }

    /// Says that what was put in is not of this run.
    pub fn refuse(&mut self) {
        if let Way::Load(_, short) = &mut self.way {
            *short = true;
        }
    }

    /// All of some fields.
    pub fn all(&mut self, fields: &mut [&mut dyn Saved]) {
        for field in fields {
            field.pass(self);
        }
    }

    /// Some bytes of a length that is known.
    pub fn raw<const N: usize>(&mut self, raw: &mut [u8; N]) {
        match &mut self.way {
            Way::Save(bytes) => bytes.extend_from_slice(raw),
            Way::Load(bytes, short) => match bytes.split_first_chunk::<N>() {
                Some((first, rest)) => (*raw, *bytes) = (*first, rest),
                None => *short = true,
            },
        }
    }

    /// How many parts a field has that may have any number of them; never more than there are bytes left to put in.
    pub fn count(&mut self, count: usize) -> usize {
        let mut count = count as u64;
        count.pass(self);
        match &mut self.way {
            Way::Save(_) => count as usize,
            Way::Load(bytes, short) => {
                *short |= count > bytes.len() as u64;
                if *short { 0 } else { count as usize }
            }
        }
    }
}

/// Numbers, by their bytes.
macro_rules! numbers {
    ($($kind:ty),* $(,)?) => {
        $(impl Saved for $kind {
            #[inline]
            fn pass(&mut self, pass: &mut Pass<'_>) {
                let mut raw = self.to_le_bytes();
                pass.raw(&mut raw);
                *self = <$kind>::from_le_bytes(raw);
            }
        })*
    };
}

numbers!(u8, i32, u32, u64, f32, f64);

impl Saved for usize {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let mut wide = *self as u64;
        wide.pass(pass);
        *self = wide as usize;
    }
}

impl Saved for bool {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let mut byte = u8::from(*self);
        byte.pass(pass);
        *self = byte != 0;
    }
}

impl Saved for DVec2 {
    #[inline]
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.x.pass(pass);
        self.y.pass(pass);
    }
}

impl<A: Saved, B: Saved> Saved for (A, B) {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.0.pass(pass);
        self.1.pass(pass);
    }
}

impl<A: Saved, B: Saved, C: Saved> Saved for (A, B, C) {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.0.pass(pass);
        self.1.pass(pass);
        self.2.pass(pass);
    }
}

impl<T: Saved, const N: usize> Saved for [T; N] {
    #[inline]
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.iter_mut().for_each(|part| part.pass(pass));
    }
}

impl<T: Saved + Default> Saved for Option<T> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let mut is_there = self.is_some();
        is_there.pass(pass);
        if pass.loads() {
            *self = is_there.then(T::default);
        }
        if let Some(own) = self {
            own.pass(pass);
        }
    }
}

impl<T: Saved + Default> Saved for Vec<T> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let count = pass.count(self.len());
        if pass.loads() {
            self.resize_with(count, T::default);
        }
        self.iter_mut().for_each(|part| part.pass(pass));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Fields of all kinds.
    #[derive(Debug, Clone, Default, PartialEq)]
    struct Fields {
        column: Vec<f64>,
        count: usize,
        last: Option<(f64, u32)>,
        flags: Vec<bool>,
        pairs: [(i32, f32); 2],
        place: DVec2,
    }

    impl Saved for Fields {
        fn pass(&mut self, pass: &mut Pass<'_>) {
            let Fields { column, count, last, flags, pairs, place } = self;
            pass.all(&mut [column, count, last, flags, pairs, place]);
        }
    }

    fn saved(fields: &mut Fields) -> Vec<u8> {
        let mut pass = Pass::save();
        fields.pass(&mut pass);
        pass.into_bytes()
    }

    proptest! {
        #[test]
        fn what_is_put_in_is_what_was_taken_out(
            column in prop::collection::vec(any::<f64>(), 0..20),
            count in any::<usize>(),
            last in any::<Option<(f64, u32)>>(),
            flags in prop::collection::vec(any::<bool>(), 0..9),
            pairs in any::<[(i32, f32); 2]>(),
            (x, y) in any::<(f64, f64)>(),
        ) {
            let mut fields = Fields { column, count, last, flags, pairs, place: DVec2::new(x, y) };
            let bytes = saved(&mut fields);
            let mut read = Fields { column: vec![1.0; 3], ..Fields::default() };
            let mut pass = Pass::load(&bytes);
            read.pass(&mut pass);
            prop_assert_eq!(pass.end(), Ok(()));
            // By their bytes, for a value that is no number equals none.
            prop_assert_eq!(saved(&mut read), bytes);
        }

        #[test]
        fn bytes_that_were_cut_or_lengthened_are_refused(values in prop::collection::vec(any::<f64>(), 0..9), cut in 1usize..8) {
            let mut fields = Fields { column: values, ..Fields::default() };
            let bytes = saved(&mut fields);
            for wrong in [bytes[..bytes.len() - cut].to_vec(), [&bytes[..], &[0; 3]].concat()] {
                let mut pass = Pass::load(&wrong);
                Fields::default().pass(&mut pass);
                prop_assert_eq!(pass.end(), Err(Foreign));
            }
        }

        #[test]
        fn any_bytes_are_read_without_harm(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut pass = Pass::load(&bytes);
            let mut fields = Fields::default();
            fields.pass(&mut pass);
            prop_assert!(fields.column.len() <= bytes.len());
        }
    }
}

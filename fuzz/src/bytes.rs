//! Bytes as a source of choices: what a fuzzer changes in them changes a choice.

/// Takes choices from bytes; zeros where they are used up.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// One of so many, counted from 0.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// Any 64 bits as a number, so that NaN and infinities are among them.
    pub fn any(&mut self) -> f64 {
        f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte())))
    }

    /// A number of ordinary size, from -1 to 1.
    pub fn ordinary(&mut self) -> f64 {
        f64::from(self.byte() as i8) / 128.0 + f64::from(self.byte()) / 32768.0
    }

    /// A number that is ordinary, or extreme, or anything.
    pub fn number(&mut self) -> f64 {
        const EXTREMES: [f64; 10] = [
            0.0,
            1e100,
            -1e100,
            f64::MAX,
            f64::MIN,
            5e-324,
            1e-300,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        match self.below(4) {
            0 => self.any(),
            1 => self.one_of(&EXTREMES),
            _ => 3.0 * self.ordinary(),
        }
    }
}

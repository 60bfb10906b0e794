//! A number that identifies all that results depend on.

use std::fmt::{self, Write};

/// FNV-1a of 128 bits (G. Fowler, L. C. Noll, K.-P. Vo), byte by byte. It shows whether two pieces of work are the same, with the same
/// value on all machines; it is no protection against malice.
///
/// ```
/// use iwan_machine::checkpoint::Digest;
/// let of = |text: &str| Digest::default().text(&text).value();
/// assert_eq!(of("a joint"), of("a joint"));
/// assert_ne!(of("a joint"), of("another"));
/// assert_ne!(Digest::default().numbers(&[0.0]).value(), Digest::default().numbers(&[-0.0]).value());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Digest(u128);

impl Default for Digest {
    fn default() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Digest {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// Adds a whole number.
    #[must_use]
    pub fn count(mut self, count: usize) -> Self {
        self.bytes(&(count as u64).to_le_bytes());
        self
    }

    /// Adds numbers by their bits, and how many there are.
    #[must_use]
    pub fn numbers(self, numbers: &[f64]) -> Self {
        let mut longer = self.count(numbers.len());
        for x in numbers {
            longer.bytes(&x.to_bits().to_le_bytes());
        }
        longer
    }

    /// Adds the text that `{:?}` writes of a value, which holds all of the value where its fields are numbers and texts.
    #[must_use]
    pub fn text(mut self, value: &(impl fmt::Debug + ?Sized)) -> Self {
        // Neither this writer nor a derived `Debug` fails.
        let _ = write!(self, "{value:?}");
        self.bytes(&[0xff]);
        self
    }

    /// The digest as a number.
    #[must_use]
    pub const fn value(self) -> u128 {
        self.0
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

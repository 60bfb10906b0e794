//! Conversion of numbers of all stored types to f64; no read goes past the end of the bytes.

/// Byte order of stored numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// One number from a chunk with exactly as many bytes as its type has.
macro_rules! number {
    ($chunk:expr, $order:expr, $type:ty, $convert:expr) => {{
        let mut raw = [0; size_of::<$type>()];
        raw.copy_from_slice($chunk);
        let value = match $order {
            Order::Little => <$type>::from_le_bytes(raw),
            Order::Big => <$type>::from_be_bytes(raw),
        };
        $convert(value)
    }};
}

/// Stored types of numbers: signed and unsigned integers and IEEE 754 floating point, with their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Bytes of one number.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether the numbers are floating point.
    #[must_use]
    pub fn is_real(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Number `at` (from 0) of `bytes`; none beyond their end. 64-bit integers above 2^53 are rounded.
    ///
    /// ```
    /// use iwan_io::{NumberType, Order};
    /// assert_eq!(NumberType::I16.at(Order::Big, &[0, 1, 255, 254], 1), Some(-2.0));
    /// assert_eq!(NumberType::I16.at(Order::Big, &[0, 1, 255], 1), None);
    /// ```
    #[must_use]
    pub fn at(self, order: Order, bytes: &[u8], at: usize) -> Option<f64> {
        let chunk = bytes.get(at.checked_mul(self.size())?..)?.get(..self.size())?;
        Some(match self {
            Self::I8 => number!(chunk, order, i8, f64::from),
            Self::U8 => number!(chunk, order, u8, f64::from),
            Self::I16 => number!(chunk, order, i16, f64::from),
            Self::U16 => number!(chunk, order, u16, f64::from),
            Self::I32 => number!(chunk, order, i32, f64::from),
            Self::U32 => number!(chunk, order, u32, f64::from),
            Self::I64 => number!(chunk, order, i64, |v| v as f64),
            Self::U64 => number!(chunk, order, u64, |v| v as f64),
            Self::F32 => number!(chunk, order, f32, f64::from),
            Self::F64 => number!(chunk, order, f64, |v| v),
        })
    }
}

macro_rules! numbers {
    ($bytes:expr, $order:expr, $type:ty, $convert:expr) => {
        $bytes.chunks_exact(size_of::<$type>()).map(|chunk| number!(chunk, $order, $type, $convert)).collect()
    };
}

/// All complete numbers in `bytes` as f64; an incomplete number at the end is left out. 64-bit integers above 2^53 are rounded.
pub(crate) fn to_f64(bytes: &[u8], kind: NumberType, order: Order) -> Vec<f64> {
    match kind {
        NumberType::I8 => numbers!(bytes, order, i8, f64::from),
        NumberType::U8 => numbers!(bytes, order, u8, f64::from),
        NumberType::I16 => numbers!(bytes, order, i16, f64::from),
        NumberType::U16 => numbers!(bytes, order, u16, f64::from),
        NumberType::I32 => numbers!(bytes, order, i32, f64::from),
        NumberType::U32 => numbers!(bytes, order, u32, f64::from),
        NumberType::I64 => numbers!(bytes, order, i64, |v| v as f64),
        NumberType::U64 => numbers!(bytes, order, u64, |v| v as f64),
        NumberType::F32 => numbers!(bytes, order, f32, f64::from),
        NumberType::F64 => numbers!(bytes, order, f64, |v| v),
    }
}

/// The unsigned 32-bit number at `offset` of `bytes`; none where it would go beyond their end.
pub(crate) fn u32_at(bytes: &[u8], offset: usize, order: Order) -> Option<u32> {
    let chunk = bytes.get(offset..offset.checked_add(4)?)?;
    let raw = [chunk[0], chunk[1], chunk[2], chunk[3]];
    Some(match order {
        Order::Little => u32::from_le_bytes(raw),
        Order::Big => u32::from_be_bytes(raw),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_types_become_f64_in_both_orders() {
        assert_eq!(to_f64(&(-2_i16).to_be_bytes(), NumberType::I16, Order::Big), [-2.0]);
        assert_eq!(to_f64(&1.5_f32.to_le_bytes(), NumberType::F32, Order::Little), [1.5]);
        assert_eq!(to_f64(&[255, 1], NumberType::I8, Order::Little), [-1.0, 1.0]);
        assert_eq!(to_f64(&[1, 2, 3], NumberType::U16, Order::Little), [513.0]);
        assert_eq!(u32_at(&[0, 0, 0, 1, 9], 0, Order::Big), Some(1));
        assert_eq!(u32_at(&[0, 0, 0], 0, Order::Big), None);
    }
}

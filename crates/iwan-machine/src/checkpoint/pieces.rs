//! How pieces are stored in files: numbers as their bits, each piece with a check value before its numbers, by which an incomplete piece is
//! recognised and ignored.

use super::digest::Digest;

/// A state of work that proceeds step by step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// Number of steps that are done.
    pub steps: usize,
    /// Lists of numbers: those with which the next step begins, and those recorded so far.
    pub numbers: Vec<Vec<f64>>,
}

/// Bytes before the numbers of a piece: its key (16), the number of numbers (8), and the check value (16).
const HEAD: usize = 16 + 8 + 16;

/// The bytes of a piece: key, count, check value, numbers.
pub(super) fn written(key: u128, numbers: &[f64]) -> Vec<u8> {
    let check = Digest::default().numbers(numbers).value() ^ key;
    let mut bytes = Vec::with_capacity(HEAD + 8 * numbers.len());
    bytes.extend_from_slice(&key.to_le_bytes());
    bytes.extend_from_slice(&(numbers.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&check.to_le_bytes());
    for x in numbers {
        bytes.extend_from_slice(&x.to_bits().to_le_bytes());
    }
    bytes
}

/// The piece with which the bytes begin (key, numbers), and the bytes behind it; none where it is incomplete.
pub(super) fn read(bytes: &[u8]) -> Option<(u128, Vec<f64>, &[u8])> {
    let (key, rest) = bytes.split_first_chunk::<16>()?;
    let (count, rest) = rest.split_first_chunk::<8>()?;
    let (check, rest) = rest.split_first_chunk::<16>()?;
    let (key, check) = (u128::from_le_bytes(*key), u128::from_le_bytes(*check));
    let length = usize::try_from(u64::from_le_bytes(*count)).ok()?.checked_mul(8)?;
    let (numbers, rest) = rest.split_at_checked(length)?;
    let one = |x: &[u8]| x.first_chunk::<8>().map_or(f64::NAN, |x| f64::from_bits(u64::from_le_bytes(*x)));
    let numbers: Vec<f64> = numbers.chunks_exact(8).map(one).collect();
    (Digest::default().numbers(&numbers).value() ^ key == check).then_some((key, numbers, rest))
}

/// The bytes of a state: the number of steps, then each list of numbers as a piece.
pub(super) fn state(key: u128, steps: usize, numbers: &[&[f64]]) -> Vec<u8> {
    let lists = numbers.iter().flat_map(|list| written(key, list));
    written(key, &[steps as f64, numbers.len() as f64]).into_iter().chain(lists).collect()
}

/// The state in the bytes; none where it is incomplete or has another key.
pub(super) fn read_state(key: u128, bytes: &[u8]) -> Option<State> {
    let (first, head, mut rest) = read(bytes)?;
    let [steps, lists] = head.try_into().ok().filter(|_| first == key)?;
    let mut numbers = Vec::new();
    for _ in 0..lists as usize {
        let (own, list, behind) = read(rest)?;
        (own == key).then(|| numbers.push(list))?;
        rest = behind;
    }
    rest.is_empty().then_some(State { steps: steps as usize, numbers })
}

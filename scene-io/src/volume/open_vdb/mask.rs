//! A bit for each slot of a node, 64 a word.

/// Whether a slot is in the set.
pub(super) fn contains(mask: &[u64], slot: usize) -> bool {
    mask[slot / 64] >> (slot % 64) & 1 == 1
}

/// The slots in the set, in order.
pub(super) fn slots(mask: &[u64]) -> impl Iterator<Item = usize> + '_ {
    let bits = |mut word: u64| {
        std::iter::from_fn(move || {
            let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
            word &= word - 1;
            Some(bit)
        })
    };
    (mask.iter().enumerate()).flat_map(move |(w, &word)| bits(word).map(move |bit| 64 * w + bit))
}

/// How many slots are in the set.
pub(super) fn count(mask: &[u64]) -> usize {
    mask.iter().map(|word| word.count_ones() as usize).sum()
}

/// The set of the slots of which this holds.
pub(super) fn of(words: usize, holds: impl Fn(usize) -> bool) -> Vec<u64> {
    let word = |w: usize| (0..64).fold(0, |word, b| word | u64::from(holds(64 * w + b)) << b);
    (0..words).map(word).collect()
}

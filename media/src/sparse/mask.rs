//! Sets of slots that know how many come before each.

/// A bit for each of 64·W slots of a node. What the set slots hold lies together in a list, in
/// order: the rank of a slot is its place there.
#[derive(Clone, Debug)]
pub(super) struct Mask<const W: usize> {
    words: Box<[u64; W]>,
    /// Set bits before each word.
    before: Box<[u16; W]>,
}

impl<const W: usize> Mask<W> {
    /// The set of these slots, which rise.
    pub(super) fn of(slots: impl IntoIterator<Item = usize>) -> Self {
        let mut words = Box::new([0_u64; W]);
        for slot in slots {
            words[slot / 64] |= 1 << (slot % 64);
        }
        let mut before = Box::new([0; W]);
        let mut count = 0;
        for (word, before) in words.iter().zip(before.iter_mut()) {
            *before = count;
            count += word.count_ones() as u16;
        }
        Self { words, before }
    }

    /// Where the slot's content lies among those of the set, if it is in it.
    #[inline]
    pub(super) fn rank(&self, slot: usize) -> Option<usize> {
        let word = self.words[slot / 64];
        let bit = 1 << (slot % 64);
        let below = (word & (bit - 1)).count_ones() as usize;
        (word & bit != 0).then(|| usize::from(self.before[slot / 64]) + below)
    }

    /// The slots of the set, in order.
    pub(super) fn slots(&self) -> impl Iterator<Item = usize> + '_ {
        (self.words.iter().enumerate()).flat_map(|(w, &word)| bits(word).map(move |b| 64 * w + b))
    }
}

/// The set bits of a word, in order.
pub(super) fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros() as usize;
            word &= word - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_count_what_comes_before() {
        let slots = [0, 1, 63, 64, 130, 4095];
        let mask = Mask::<64>::of(slots);
        assert_eq!(mask.slots().collect::<Vec<_>>(), slots);
        for slot in 0..4096 {
            assert_eq!(mask.rank(slot), slots.iter().position(|&s| s == slot));
        }
        let full = Mask::<512>::of(0..32_768);
        assert_eq!(full.rank(32_767), Some(32_767));
    }
}

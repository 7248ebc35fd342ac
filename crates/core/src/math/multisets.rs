//! Multisets of numbers that share their memory: each is kept once, and told by one number.

use std::collections::BTreeMap;

/// The multisets so far: lists in rising order, each of a first number and the list of the others.
#[derive(Clone, Debug, Default)]
pub struct Multisets {
    lists: Vec<[u32; 2]>,
    known: BTreeMap<[u32; 2], u32>,
    /// Memory for the numbers below one.
    below: Vec<u32>,
}

/// The multiset without numbers.
pub const EMPTY: u32 = 0;

impl Multisets {
    /// The numbers of a multiset, in rising order.
    pub fn numbers(&self, mut list: u32) -> impl Iterator<Item = u32> {
        std::iter::from_fn(move || {
            let [first, rest] = self.split(list)?;
            list = rest;
            Some(first)
        })
    }

    /// A multiset, and this number once more.
    pub fn with(&mut self, list: u32, number: u32) -> u32 {
        self.changed(list, number, |own, list| own.joined([number, list]))
    }

    /// A multiset, and this number once less.
    pub fn without(&mut self, list: u32, number: u32) -> u32 {
        self.changed(list, number, |own, list| match own.split(list) {
            Some([first, rest]) if first == number => rest,
            _ => list,
        })
    }

    /// A multiset with a change of its part from a number on.
    fn changed(
        &mut self,
        mut list: u32,
        number: u32,
        change: impl FnOnce(&mut Self, u32) -> u32,
    ) -> u32 {
        let mut below = std::mem::take(&mut self.below);
        while let Some([first, rest]) = self.split(list).filter(|[first, _]| *first < number) {
            below.push(first);
            list = rest;
        }
        let mut changed = change(self, list);
        while let Some(first) = below.pop() {
            changed = self.joined([first, changed]);
        }
        self.below = below;
        changed
    }

    fn split(&self, list: u32) -> Option<[u32; 2]> {
        self.lists.get((list as usize).checked_sub(1)?).copied()
    }

    fn joined(&mut self, list: [u32; 2]) -> u32 {
        let Self { lists, known, .. } = self;
        *known.entry(list).or_insert_with(|| {
            lists.push(list);
            lists.len() as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_multisets_have_one_number_whatever_their_history() {
        let mut sets = Multisets::default();
        let of = |sets: &mut Multisets, numbers: &[u32]| {
            numbers.iter().fold(EMPTY, |list, &number| sets.with(list, number))
        };
        let one = of(&mut sets, &[5, 1, 3, 3]);
        assert_eq!(sets.numbers(one).collect::<Vec<_>>(), [1, 3, 3, 5]);
        assert_eq!(of(&mut sets, &[3, 5, 3, 1]), one);
        let less = sets.without(one, 3);
        assert_eq!(less, of(&mut sets, &[5, 3, 1]));
        assert_eq!(sets.without(less, 4), less);
        assert_eq!([1, 3, 5].iter().fold(less, |list, &number| sets.without(list, number)), EMPTY);
    }
}

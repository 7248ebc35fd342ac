//! Arrays that several own, as a scene and what is prepared of it do.

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use rayon::prelude::*;

/// An array that its owners share until one of them changes it: that one has a copy of its own from then on. So a clone
/// takes neither time nor memory, and an only owner changes its array in place.
pub struct Shared<T>(Arc<Vec<T>>);

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: fmt::Debug> fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> From<Vec<T>> for Shared<T> {
    fn from(items: Vec<T>) -> Self {
        Self(Arc::new(items))
    }
}

impl<T> FromIterator<T> for Shared<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        items.into_iter().collect::<Vec<T>>().into()
    }
}

impl<T: Copy + Send + Sync> Shared<T> {
    /// Makes room for so many items in all, at once instead of by doubling. A large array that has no other owner is not
    /// copied for it: the system moves pages.
    pub fn make_room(&mut self, all: usize) {
        if let Some(own) = Arc::get_mut(&mut self.0) {
            own.reserve_exact(all.saturating_sub(own.len()));
        } else if all > self.len() {
            let mut own = Vec::with_capacity(all);
            own.par_extend(self.0.par_iter().copied());
            *self = own.into();
        }
    }
}

impl<T> AsRef<[T]> for Shared<T> {
    fn as_ref(&self) -> &[T] {
        &self.0
    }
}

impl<T: PartialEq, Items: AsRef<[T]> + ?Sized> PartialEq<Items> for Shared<T> {
    fn eq(&self, other: &Items) -> bool {
        self.0.as_slice() == other.as_ref()
    }
}

impl<T> Deref for Shared<T> {
    type Target = Vec<T>;

    #[inline(always)]
    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T: Clone> DerefMut for Shared<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        Arc::make_mut(&mut self.0)
    }
}

impl<'a, T> IntoIterator for &'a Shared<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_is_copied_when_it_changes_and_has_another_owner() {
        let mut one: Shared<u32> = vec![1, 2, 3].into();
        let place = one.as_ptr();
        one[0] = 5;
        assert_eq!(one.as_ptr(), place, "it has no other owner");
        one.push(4);
        let other = one.clone();
        assert_eq!((one.as_ptr(), &*one), (other.as_ptr(), &vec![5, 2, 3, 4]));
        one.make_room(4);
        assert_eq!(one.as_ptr(), other.as_ptr(), "there is room");
        one.make_room(9);
        assert!(one.capacity() >= 9 && one == *other && one.as_ptr() != other.as_ptr());
        one.push(6);
        assert_eq!((&*one, &*other), (&vec![5, 2, 3, 4, 6], &vec![5, 2, 3, 4]));
        let place_of_one = one.as_ptr();
        assert_ne!(place_of_one, other.as_ptr());
        drop(other);
        one[0] = 7;
        assert_eq!(one.as_ptr(), place_of_one);
    }
}

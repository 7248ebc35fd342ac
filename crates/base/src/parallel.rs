//! Hands out work to the threads of the current pool: in order, one item at a time, to whichever thread is free.
//!
//! So the items that are worked on at any time are neighbours, which share data, and no thread waits while another has
//! items left. An item should take microseconds at least: cut what takes less into chunks.

use std::sync::Mutex;

use crate::lock;

/// Does `work` for each of `items` with the state of a thread, which the thread makes itself; returns the states, in any
/// order.
pub fn with_state<I, S>(
    items: I,
    state: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I::Item) + Sync,
) -> Vec<S>
where
    I: Iterator + Send,
    S: Send,
{
    let most = items.size_hint().1.unwrap_or(usize::MAX);
    let (items, states) = (Mutex::new(items), Mutex::new(Vec::new()));
    let next = || lock(&items).next();
    on_threads(most, &|| {
        let Some(mut item) = next() else { return };
        let mut own = state();
        loop {
            work(&mut own, item);
            let Some(another) = next() else { break };
            item = another;
        }
        lock(&states).push(own);
    });
    std::mem::take(&mut *lock(&states))
}

/// Does `work` for each of `items`.
pub fn each<I: Iterator + Send>(items: I, work: impl Fn(I::Item) + Sync) {
    with_state(items, || (), |(), item| work(item));
}

/// Items of a slice that a thread takes at once.
const TOGETHER: usize = 4096;

/// Does `work` for each of `items`, which may take nanoseconds, and its index.
pub fn each_mut<T: Send>(items: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    each(items.chunks_mut(TOGETHER).enumerate(), |(chunk, items)| {
        for (index, item) in (chunk * TOGETHER..).zip(items) {
            work(index, item);
        }
    });
}

/// Joins what `of` makes of each number below `count`, which may take nanoseconds, in their order; `none` leaves what it
/// is joined with as it is.
pub fn reduce<T: Copy + Send + Sync>(
    count: usize,
    none: T,
    of: impl Fn(usize) -> T + Sync,
    join: impl Fn(T, T) -> T + Sync,
) -> T {
    let starts = (0..count).step_by(TOGETHER);
    let part = |start: usize| (start..count.min(start + TOGETHER)).map(&of).fold(none, &join);
    map(starts, part).into_iter().fold(none, &join)
}

/// The index of the first of `items` that `is` holds for.
pub fn find_first<T: Sync>(items: &[T], is: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let first =
        |(chunk, items): (usize, &[T])| Some(chunk * TOGETHER + items.iter().position(&is)?);
    map(items.chunks(TOGETHER).enumerate(), first).into_iter().flatten().next()
}

/// What `make` makes of each of `items`, in their order.
pub fn map<I: Iterator + Send, T: Send>(items: I, make: impl Fn(I::Item) -> T + Sync) -> Vec<T> {
    let add = |own: &mut Vec<(usize, T)>, (index, item)| own.push((index, make(item)));
    let made = with_state(items.enumerate(), Vec::new, add);
    let mut in_order = Vec::new();
    in_order.resize_with(made.iter().map(Vec::len).sum(), || None);
    for own in made {
        for (index, made) in own {
            in_order[index] = Some(made);
        }
    }
    in_order.into_iter().flatten().collect()
}

/// Runs `work` on `most` threads of the current pool, or all. It is compiled once, for all kinds of work.
fn on_threads(most: usize, work: &(dyn Fn() + Sync)) {
    match rayon::current_num_threads().min(most) {
        0 | 1 => work(),
        threads => rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_handed_out_in_order_to_as_many_threads_as_there_are() {
        for threads in [1, 3] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| {
                assert_eq!(
                    map(0..1000_u32, |i| 2 * i),
                    (0..1000).map(|i| 2 * i).collect::<Vec<_>>()
                );
                let lists = with_state(0..1000_u32, Vec::new, |own, i| own.push(i));
                assert!(
                    (1..=threads).contains(&lists.len())
                        && lists.iter().all(|list| list.is_sorted())
                );
                assert_eq!(lists.concat().len(), 1000);
                // What is asked for within an item is done too.
                assert_eq!(
                    map(0..8_u32, |i| map(0..i, |j| j).len() as u32),
                    (0..8).collect::<Vec<_>>()
                );
                let mut squares = vec![0; 10_000];
                each_mut(&mut squares, |i, square| *square = i * i);
                assert_eq!(squares, (0..10_000).map(|i| i * i).collect::<Vec<_>>());
                assert_eq!(reduce(10_000, 0, |i| i, |a, b| a + b), 49_995_000);
                assert_eq!(find_first(&squares, |square| *square > 64_000_000), Some(8001));
                assert!(map(std::iter::empty::<u32>(), |i| i).is_empty());
            });
        }
    }
}

//! Inputs that are nearly right: changed at random from some that are, each as a function of a seed.

use serde_json::Value;
use wavecrest_core::math::random::Stream;

/// Words that may stand where another did, each in a line, and the empty one.
const WORDS: &str = include_str!("words.txt");

/// JSON that may stand where other did, each in a line.
const VALUES: &str = include_str!("values.txt");

/// Numbers that follow from a seed.
pub(crate) struct Numbers {
    seed: u64,
    used: u32,
}

impl Numbers {
    /// Those of `seed`.
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed, used: 0 }
    }

    /// Any.
    pub(crate) fn word(&mut self) -> u32 {
        self.used += 1;
        let stream = Stream { seed: self.seed, pixel: 0, sample: 0, bounce: 0 };
        stream.words(self.used)[0]
    }

    /// Less than `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        self.word() as usize % end.max(1)
    }

    fn of<'a, T>(&mut self, some: &'a [T]) -> &'a T {
        &some[self.below(some.len())]
    }

    fn line<'a>(&mut self, lines: &'a str) -> &'a str {
        let lines: Vec<&str> = lines.lines().collect();
        lines[self.below(lines.len())]
    }

    /// A part of `length` that is not long.
    fn part(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        let most = 1 + self.below(16);
        start..(start + self.below(most)).min(length)
    }
}

/// One of `seeds`, changed in a few places as files of lines and numbers are.
pub(crate) fn file(seeds: &[Vec<u8>], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = numbers.of(seeds).clone();
    for _ in 0..1 + numbers.below(4) {
        match numbers.below(8) {
            0..3 => change_word(&mut bytes, numbers),
            3..5 => change_line(&mut bytes, numbers),
            5..7 => change_bytes(&mut bytes, numbers),
            _ => join(&mut bytes, numbers.of::<Vec<u8>>(seeds), numbers),
        }
    }
    bytes
}

/// One of `seeds`, changed in a few places as JSON is, and sometimes as any file is.
pub(crate) fn json(seeds: &[Vec<u8>], numbers: &mut Numbers) -> Vec<u8> {
    if numbers.below(4) == 0 {
        return file(seeds, numbers);
    }
    let read = |seed: &Vec<u8>| serde_json::from_slice(seed).expect("a seed is JSON");
    let mut value: Value = read(numbers.of(seeds));
    let donor: Value = read(numbers.of(seeds));
    for _ in 0..1 + numbers.below(3) {
        let (place, from) = (numbers.below(count(&value)), numbers.below(count(&donor)));
        let new = match numbers.below(3) {
            0 => nth(&mut donor.clone(), &mut { from }, &mut |found| found.clone()),
            _ => serde_json::from_str(numbers.line(VALUES)).ok(),
        };
        let (action, which) = (numbers.below(6), numbers.word() as usize);
        nth(&mut value, &mut { place }, &mut |found| change(found, action, which, new.clone()));
    }
    value.to_string().into_bytes()
}

/// Bytes for a target that takes any as they are.
pub(crate) fn bytes(numbers: &mut Numbers) -> Vec<u8> {
    let length = 50 + numbers.below(1500);
    let words = (0..length.div_ceil(4)).map(|_| numbers.word());
    words.flat_map(u32::to_le_bytes).collect()
}

/// How many values there are in `value`, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(members) => members.values().map(count).sum(),
        _ => 0,
    }
}

/// What `act` makes of the value that `left` others stand before.
fn nth<T>(value: &mut Value, left: &mut usize, act: &mut dyn FnMut(&mut Value) -> T) -> Option<T> {
    if *left == 0 {
        return Some(act(value));
    }
    *left -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| nth(item, left, act)),
        Value::Object(members) => members.values_mut().find_map(|item| nth(item, left, act)),
        _ => None,
    }
}

/// Changes the `which`th of what `found` has, or `found` itself.
fn change(found: &mut Value, action: usize, which: usize, new: Option<Value>) {
    match (action, &mut *found) {
        (0, Value::Array(items)) if !items.is_empty() => {
            items.remove(which % items.len());
        }
        (1, Value::Array(items)) if !items.is_empty() => {
            items.push(items[which % items.len()].clone());
        }
        (0..2, Value::Object(members)) if !members.is_empty() => {
            let key = members.keys().nth(which % members.len()).cloned().unwrap_or_default();
            members.shift_remove(&key);
        }
        (2, Value::Number(number)) => {
            let scaled = number.as_f64().unwrap_or(1.0) * [-1.0, 1e-6, 1e6, 1e-20, 1e11][which % 5];
            *found = scaled.into();
        }
        _ => *found = new.unwrap_or_default(),
    }
}

fn is_break(byte: u8) -> bool {
    byte.is_ascii_whitespace() || b",:[]{}\"/".contains(&byte)
}

/// The word around a place gives way to one of [`WORDS`], or to another of the file.
fn change_word(bytes: &mut Vec<u8>, numbers: &mut Numbers) {
    let mut around = |bytes: &[u8]| {
        let place = numbers.below(bytes.len());
        let start = bytes[..place].iter().rposition(|&b| is_break(b)).map_or(0, |at| at + 1);
        let length = bytes[start..].iter().position(|&b| is_break(b));
        start..length.map_or(bytes.len(), |length| start + length)
    };
    let (old, other) = (around(bytes), around(bytes));
    let new = match numbers.below(3) {
        0 => bytes[other].to_vec(),
        _ => numbers.line(WORDS).as_bytes().to_vec(),
    };
    bytes.splice(old, new);
}

/// A line is left out, said twice, or moved.
fn change_line(bytes: &mut Vec<u8>, numbers: &mut Numbers) {
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|&b| b == b'\n').collect();
    if lines.is_empty() {
        return;
    }
    let (i, j) = (numbers.below(lines.len()), numbers.below(lines.len()));
    match numbers.below(3) {
        0 => drop(lines.remove(i)),
        1 => lines.insert(j, lines[i]),
        _ => lines.swap(i, j),
    }
    *bytes = lines.concat();
}

/// Some bytes give way to others, are left out, or said twice; or one bit changes.
fn change_bytes(bytes: &mut Vec<u8>, numbers: &mut Numbers) {
    let part = numbers.part(bytes.len());
    match numbers.below(6) {
        0 => bytes.truncate(part.start),
        1 => drop(bytes.drain(part)),
        2 => {
            let twice = bytes[part.clone()].to_vec();
            bytes.splice(part.end..part.end, twice);
        }
        3 => {
            let value = *numbers.of(&[0_u32, 1, 3, 0x7f80_0000, 0x7fff_ffff, 0xffff_ffff]);
            let word =
                if numbers.below(2) == 0 { value.to_le_bytes() } else { value.to_be_bytes() };
            for (to, byte) in bytes[part.start..].iter_mut().zip(word) {
                *to = byte;
            }
        }
        4 => bytes[part].iter_mut().for_each(|byte| *byte = numbers.word() as u8),
        _ => {
            let bit = numbers.below(8);
            bytes.iter_mut().skip(part.start).take(1).for_each(|byte| *byte ^= 1 << bit);
        }
    }
}

/// The beginning of one and the end of the other.
fn join(bytes: &mut Vec<u8>, other: &[u8], numbers: &mut Numbers) {
    bytes.truncate(numbers.below(bytes.len() + 1));
    bytes.extend_from_slice(&other[numbers.below(other.len() + 1)..]);
}

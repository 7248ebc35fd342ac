//! JSON with changes.

use serde_json::{Value, json};

/// `value` with a patch: objects are merged, and lists of objects place by place; other values are
/// replaced, and `null` removes one. If the patch of a list is an object, it is for each of them.
pub(crate) fn with(value: Value, patch: Value) -> Value {
    match (value, patch) {
        (Value::Array(old), patch @ Value::Object(_)) => {
            old.into_iter().map(|one| with(one, patch.clone())).collect()
        }
        (Value::Array(mut old), Value::Array(new)) if old.iter().all(Value::is_object) => {
            old.resize(old.len().max(new.len()), json!({}));
            old.iter_mut().zip(new).for_each(|(one, patch)| *one = with(one.take(), patch));
            old.into()
        }
        (value, Value::Object(changes)) => {
            let mut value = value.as_object().cloned().unwrap_or_default();
            for (key, change) in changes {
                let old = value.remove(&key).unwrap_or_default();
                value.insert(key, with(old, change));
            }
            value.retain(|_, value| !value.is_null());
            value.into()
        }
        (_, patch) => patch,
    }
}

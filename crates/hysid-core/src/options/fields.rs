//! Options as fields by their names.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// The fields of options by their names.
pub(super) fn fields_of(options: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(options) {
        Ok(Value::Object(fields)) => fields,
        other => unreachable!("options have named fields, not {other:?}"),
    }
}

/// The same options with other values of some fields.
pub(super) fn with_fields<T, F>(options: &T, others: F) -> T
where
    T: Serialize + DeserializeOwned,
    F: IntoIterator<Item = (String, Value)>,
{
    let mut fields = fields_of(options);
    fields.extend(others);
    serde_json::from_value(Value::Object(fields)).expect("options with fields that they have")
}

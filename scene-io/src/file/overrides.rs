//! Values from outside that replace those of a file.

use super::document::{self, Node, Value};
use super::reader::nearest;
use crate::Error;

/// Sets `key`, such as `film.width` or `shapes.0.material`. Its table must be there already, but
/// for those at the root; whether the table may hold the key is checked when it is read.
pub(super) fn apply(root: &mut Node, key: &str, text: &str) -> Result<(), Error> {
    let value = document::parse_override(key, text)?;
    let place = value.place.clone();
    let unknown = |problem: String| Error::Scene {
        place: place.clone(),
        field: key.to_owned(),
        problem,
    };
    let mut node = root;
    let steps: Vec<_> = key.split('.').collect();
    let Some((last, tables)) = steps.split_last() else {
        return Err(unknown("is empty: name a key".into()));
    };
    for (depth, step) in tables.iter().enumerate() {
        let absent = || Node {
            value: Value::Table(Default::default()),
            place: place.clone(),
            key: place.clone(),
        };
        node = match &mut node.value {
            Value::Table(entries) => {
                if depth == 0 {
                    entries.entry((*step).into()).or_insert_with(absent);
                }
                let near = nearest(step, entries.keys().map(String::as_str)).map(str::to_owned);
                let mend = near.map_or("add it to the file".into(), |n| {
                    format!("did you mean `{n}`?")
                });
                let absent = || unknown(format!("there is no `{step}`; {mend}"));
                entries.get_mut(*step).ok_or_else(absent)?
            }
            Value::Array(nodes) => element(nodes, step).map_err(&unknown)?,
            _ => return Err(unknown(format!("`{step}` is no table"))),
        };
    }
    match &mut node.value {
        Value::Table(entries) => {
            entries.insert((*last).into(), value);
        }
        Value::Array(nodes) => *element(nodes, last).map_err(&unknown)? = value,
        _ => return Err(unknown(format!("`{last}` is no key of a table"))),
    }
    Ok(())
}

fn element<'a>(nodes: &'a mut [Node], index: &str) -> Result<&'a mut Node, String> {
    let count = nodes.len();
    let node = index.parse().ok().and_then(|i: usize| nodes.get_mut(i));
    node.ok_or_else(|| format!("`{index}` must be a number below {count}, counting from 0"))
}
